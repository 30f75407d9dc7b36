/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `step_samples FOLDER`: a skid with two pumps and six bolts, as STEP in three schemas, in millimetres and inches, and as IGES. */
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <IGESCAFControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>

#include <cstdio>
#include <string>

namespace
{

TopLoc_Location moved(double x, double y, double z)
{
    gp_Trsf t;
    t.SetTranslation(gp_Vec(x, y, z));
    return TopLoc_Location(t);
}

void name(const TDF_Label &label, const char *text)
{
    TDataStd_Name::Set(label, TCollection_ExtendedString(text, Standard_True));
}

/* Lengths in millimetres: a plate of 2000 x 1000 x 20, on it two pumps, each a red cylinder and a green box with one blue side, and six
 * bolts. */
Handle(TDocStd_Document) make_skid()
{
    Handle(TDocStd_Document) document;
    XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
    Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
    Handle(XCAFDoc_ColorTool) colors = XCAFDoc_DocumentTool::ColorTool(document->Main());
    TopoDS_Shape casing = BRepPrimAPI_MakeCylinder(100, 300), motor = BRepPrimAPI_MakeBox(200, 200, 200);
    TDF_Label plate = shapes->AddShape(BRepPrimAPI_MakeBox(2000, 1000, 20), Standard_False);
    TDF_Label casing_label = shapes->AddShape(casing, Standard_False), motor_label = shapes->AddShape(motor, Standard_False);
    TDF_Label bolt = shapes->AddShape(BRepPrimAPI_MakeCylinder(10, 50), Standard_False);
    name(plate, "Plate");
    name(casing_label, "Casing");
    name(motor_label, "Motor");
    name(bolt, "Bolt M20");
    colors->SetColor(casing_label, Quantity_Color(1, 0, 0, Quantity_TOC_RGB), XCAFDoc_ColorSurf);
    colors->SetColor(motor_label, Quantity_Color(0, 1, 0, Quantity_TOC_RGB), XCAFDoc_ColorSurf);
    TopExp_Explorer side(motor, TopAbs_FACE);
    colors->SetColor(shapes->AddSubShape(motor_label, side.Current()), Quantity_Color(0, 0, 1, Quantity_TOC_RGB), XCAFDoc_ColorSurf);
    TDF_Label pump = shapes->NewShape(), skid = shapes->NewShape();
    name(pump, "Pump");
    name(skid, "Skid S-100");
    name(shapes->AddComponent(pump, casing_label, moved(0, 0, 0)), "Casing:1");
    name(shapes->AddComponent(pump, motor_label, moved(300, -100, 0)), "Motor:1");
    name(shapes->AddComponent(skid, plate, moved(0, 0, -20)), "Plate:1");
    name(shapes->AddComponent(skid, pump, moved(300, 300, 0)), "P-101A");
    name(shapes->AddComponent(skid, pump, moved(300, 700, 0)), "펌프/P-101B");
    for (int i = 0; i < 6; i++)
        name(shapes->AddComponent(skid, bolt, moved(100 + 300 * i, 50, 0)), ("Bolt:" + std::to_string(i + 1)).c_str());
    shapes->UpdateAssemblies();
    return document;
}

bool write_step(const Handle(TDocStd_Document) & document, const std::string &path, const char *schema, const char *unit)
{
    Interface_Static::SetCVal("write.step.schema", schema);
    Interface_Static::SetCVal("write.step.unit", unit);
    STEPCAFControl_Writer writer;
    return writer.Transfer(document, STEPControl_AsIs) && writer.Write(path.c_str()) == IFSelect_RetDone;
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 2) {
        fprintf(stderr, "usage: step_samples FOLDER\n");
        return 2;
    }
    Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
    std::string folder = argv[1];
    Handle(TDocStd_Document) skid = make_skid();
    STEPCAFControl_Writer defines_its_settings;
    bool good = write_step(skid, folder + "/skid_203.step", "AP203", "MM") &&
                write_step(skid, folder + "/skid_214.stp", "AP214IS", "INCH") &&
                write_step(skid, folder + "/skid_242.STEP", "AP242DIS", "M");
    IGESCAFControl_Writer iges;
    good = good && iges.Transfer(skid) && iges.Write((folder + "/skid.igs").c_str());
    return good ? 0 : 1;
}
