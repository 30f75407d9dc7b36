/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `step_samples FOLDER` writes CAD files for tests: the same skid (a plate with two pumps and six bolts) as STEP in three
   schemas and as IGES, in millimetres, inches and metres. */
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepToIGES_BREntity.hxx>
#include <IGESBasic_Group.hxx>
#include <IGESBasic_Name.hxx>
#include <IGESBasic_SingularSubfigure.hxx>
#include <IGESBasic_SubfigureDef.hxx>
#include <IGESCAFControl_Writer.hxx>
#include <IGESControl_Writer.hxx>
#include <IGESData_IGESModel.hxx>
#include <IGESData_LevelListEntity.hxx>
#include <IGESGeom_TransformationMatrix.hxx>
#include <IGESGraph_Color.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TColStd_HArray2OfReal.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>

#include <cstdio>
#include <string>
#include <vector>

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

/* Lengths are in millimetres: a plate of 2000 x 1000 x 20 with six bolts and two pumps, each a red cylinder and a green box
   with one blue side. */
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

/* --- IGES: Open CASCADE's writer loses the tree of assemblies, so this code makes each IGES entity itself
   ----------------------------- */

using entity = Handle(IGESData_IGESEntity);

struct iges_drawing {
    IGESControl_Writer writer;
    BRepToIGES_BREntity shapes;
    double unit_mm;

    iges_drawing(const char *unit, double mm) : writer(unit, 0), unit_mm(mm)
    {
        shapes.SetModel(writer.Model());
    }

    entity named(const entity &what, const char *text)
    {
        Handle(IGESBasic_Name) name = new IGESBasic_Name;
        name->Init(1, new TCollection_HAsciiString(text));
        what->AddProperty(name);
        return what;
    }
    Handle(IGESData_HArray1OfIGESEntity) list(const std::vector<entity> &from)
    {
        Handle(IGESData_HArray1OfIGESEntity) out = new IGESData_HArray1OfIGESEntity(1, static_cast<int>(from.size()));
        for (size_t i = 0; i < from.size(); i++)
            out->SetValue(static_cast<int>(i) + 1, from[i]);
        return out;
    }
    entity group(const std::vector<entity> &of, const char *text)
    {
        Handle(IGESBasic_Group) out = new IGESBasic_Group;
        out->Init(list(of));
        return named(out, text);
    }
    Handle(IGESBasic_SubfigureDef) figure(int depth, const std::vector<entity> &of, const char *text)
    {
        Handle(IGESBasic_SubfigureDef) out = new IGESBasic_SubfigureDef;
        out->Init(depth, new TCollection_HAsciiString(text), list(of));
        return out;
    }
    entity place(const Handle(IGESBasic_SubfigureDef) & of, double x, double y, double z, const char *text, double scale = 1)
    {
        Handle(IGESBasic_SingularSubfigure) out = new IGESBasic_SingularSubfigure;
        out->Init(of, gp_XYZ(x, y, z) / unit_mm, scale != 1, scale);
        return named(out, text);
    }
    /* Returns the entity with a transformation that lays its vertical axis along x and puts its origin at (x, y). */
    entity turned(const entity &what, double x, double y)
    {
        Handle(IGESGeom_TransformationMatrix) matrix = new IGESGeom_TransformationMatrix;
        Handle(TColStd_HArray2OfReal) rows = new TColStd_HArray2OfReal(1, 3, 1, 4, 0);
        rows->SetValue(1, 3, 1), rows->SetValue(2, 2, 1), rows->SetValue(3, 1, -1);
        rows->SetValue(1, 4, x / unit_mm), rows->SetValue(2, 4, y / unit_mm);
        matrix->Init(rows);
        what->InitTransf(matrix);
        return what;
    }
    entity colored(const entity &what, double red, double green, double blue) /* colour components in per cent */
    {
        Handle(IGESGraph_Color) color = new IGESGraph_Color;
        color->Init(red, green, blue, new TCollection_HAsciiString("a colour"));
        what->InitColor(color);
        return what;
    }
    /* Returns the faces of a shape as coloured IGES surfaces. Each surface has its own colour, because IGES groups have none.
       */
    std::vector<entity> sides(const TopoDS_Shape &of, double red, double green, double blue)
    {
        std::vector<entity> out;
        for (TopExp_Explorer side(of, TopAbs_FACE); side.More(); side.Next())
            out.push_back(colored(shapes.TransferShape(side.Current()), red, green, blue));
        return out;
    }
};

/* Writes the skid as IGES; in each motor one face is blue, the others are green. In addition to the STEP files, it contains a
   casing laid on its side ("Turned") and a bolt enlarged four times. */
bool write_iges(const std::string &path, const char *unit, double unit_mm)
{
    iges_drawing d(unit, unit_mm);
    entity plate = d.shapes.TransferShape(BRepPrimAPI_MakeBox(2000, 1000, 20).Shape());
    std::vector<entity> casing = d.sides(BRepPrimAPI_MakeCylinder(100, 300), 100, 0, 0);
    std::vector<entity> motor = d.sides(BRepPrimAPI_MakeBox(200, 200, 200), 0, 100, 0);
    d.colored(motor[0], 0, 0, 100);
    entity bolt = d.shapes.TransferShape(BRepPrimAPI_MakeCylinder(10, 50).Shape());
    auto casing_figure = d.figure(0, casing, "Casing"), bolt_figure = d.figure(0, { bolt }, "Bolt M20");
    auto motor_figure = d.figure(0, { d.group(motor, "Box") }, "Motor");
    auto pump = d.figure(1, { d.place(casing_figure, 0, 0, 0, "Casing:1"), d.place(motor_figure, 300, -100, 0, "Motor:1") }, "Pump");
    auto plate_figure = d.figure(0, { plate }, "Plate");
    std::vector<entity> all = { d.place(plate_figure, 0, 0, -20, "Plate:1"), d.place(pump, 300, 300, 0, "P-101A"),
                                d.place(pump, 300, 700, 0, "P-101B/1") };
    for (int i = 0; i < 6; i++)
        all.push_back(d.place(bolt_figure, 100 + 300 * i, 50, 0, ("Bolt:" + std::to_string(i + 1)).c_str()));
    all.push_back(d.turned(d.place(casing_figure, 0, 0, 0, "Turned"), 1000, 500));
    all.push_back(d.place(bolt_figure, 1500, 900, 0, "Large bolt", 4));
    d.writer.AddEntity(d.group(all, "Skid S-100"));
    d.writer.ComputeModel();
    return d.writer.Write(path.c_str());
}

/* Writes the six faces of a box as separate surfaces without a group, three on IGES level 1 and three on level 2, as many CAD
   systems export bodies. */
bool write_loose(const std::string &path)
{
    iges_drawing d("MM", 1);
    int count = 0;
    TopoDS_Shape box = BRepPrimAPI_MakeBox(100, 200, 300);
    for (TopExp_Explorer side(box, TopAbs_FACE); side.More(); side.Next()) {
        entity face = d.shapes.TransferShape(side.Current());
        face->InitLevel(Handle(IGESData_LevelListEntity)(), count++ < 3 ? 1 : 2);
        d.writer.AddEntity(face);
    }
    d.writer.ComputeModel();
    return d.writer.Write(path.c_str());
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
    good = good && write_iges(folder + "/tree.igs", "MM", 1) && write_iges(folder + "/inches.IGES", "INCH", 25.4) &&
           write_loose(folder + "/loose.igs");
    return good ? 0 : 1;
}
