/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast-import-occt INPUT OUTPUT.glb CHORD_MM UNITS UP ENCODING`: reads STEP and IGES with Open CASCADE, in its own
   process. The assembly tree becomes nodes; each part is tessellated once and shared by its placements. For IFC files, this
   program builds only some solids (ifc_shapes.hh), and UNITS is the path of a list of elements. Prints records for the import's
   report (format: findings.h). On failure the last line on stderr is the reason. */
#include <BRepBndLib.hxx>
#include <Bnd_Box.hxx>
#include <IGESControl_Reader.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <RWMesh_FaceIterator.hxx>
#include <STEPCAFControl_ExternFile.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPConstruct_UnitContext.hxx>
#include <Standard_Failure.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>
#include <StepShape_ShapeDimensionRepresentation.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <TDF_LabelMap.hxx>
#include <TDF_Tool.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Shape.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_WorkSession.hxx>

#include <array>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <string>
#include <strings.h>
#include <vector>

#include "preprocess/glb/glb_scene.h"
#include "preprocess/import/readers/ifc_shapes.hh"
#include "preprocess/import/readers/iges_tree.hh"
#include "preprocess/import/readers/occt_losses.hh"
#include "preprocess/import/readers/occt_mesh.hh"
#include "preprocess/import/readers/reader.hh"
#include "preprocess/import/readers/step_files.hh"

namespace
{

/* maximum number of nodes in the GLB file; assemblies that contain others several times can expand to exponentially many nodes */
constexpr size_t MAX_NODES = 2'000'000;
constexpr size_t MOST_NAMED = 20;
/* the chord error (distance between facets and the true surface) is at most the model's size divided by this, so that tiny
   models keep their shape */
constexpr double CHORDS_PER_MODEL = 100;
constexpr double ANGLE_RAD = 0.5; /* largest angle in radians between neighbouring facets, even where the chord error would allow more */
const double PLAIN[4] = { 0.35, 0.35, 0.35, 1 };

/* --- names, colours, places ------------------------------------------------------------------------------------------------------- */

std::string utf8_of(const TCollection_ExtendedString &from)
{
    std::vector<char> bytes(static_cast<size_t>(from.LengthOfCString()) + 1);
    char *at = bytes.data();
    from.ToUTF8CString(at);
    return at;
}

/* Returns the name of an XCAF label, or "" if Open CASCADE generated the name, such as "=>[0:1:1:3]" for components without one. */
std::string name_of(const TDF_Label &label)
{
    Handle(TDataStd_Name) name;
    if (!label.FindAttribute(TDataStd_Name::GetID(), name))
        return "";
    std::string text = step_name_without_mark(utf8_of(name->Get()));
    return text.compare(0, 3, "=>[") == 0 || text == "COMPOUND" || text == "SOLID" || text == "SHELL" || text == "ASSEMBLY" ? "" : text;
}

std::string layers_of(const Handle(XCAFDoc_LayerTool) & tool, const TDF_Label &label)
{
    Handle(TColStd_HSequenceOfExtendedString) names;
    std::string out;
    if (!tool->GetLayers(label, names) || names.IsNull())
        return out;
    for (int i = 1; i <= names->Length(); i++)
        out += (out.empty() ? "" : ", ") + step_name_without_mark(utf8_of(names->Value(i)));
    return out;
}

/* Reads the colour of the XCAF label itself, not of its parts. */
void take_color(const Handle(XCAFDoc_ColorTool) & tool, const TDF_Label &label, XCAFPrs_Style *style)
{
    Quantity_ColorRGBA color;
    if (tool->GetColor(label, XCAFDoc_ColorSurf, color) || tool->GetColor(label, XCAFDoc_ColorGen, color))
        style->SetColorSurf(color);
}

void matrix_of(const TopLoc_Location &location, const double shift[3], double out[16])
{
    const gp_Trsf &t = location.Transformation();
    for (int column = 0; column < 4; column++)
        for (int row = 0; row < 4; row++)
            out[4 * column + row] = row < 3 ? t.Value(row + 1, column + 1) : column == 3;
    for (int row = 0; row < 3; row++)
        for (int k = 0; k < 3; k++)
            out[12 + row] += out[4 * k + row] * shift[k];
}

/* --- parts ---------------------------------------------------------------------------------------------------------------------------- */

struct occt_part { /* a tessellated shape */
    int mesh;
    /* origin of the mesh's vertices, near the part: single precision then suffices even far from the part's own origin */
    double origin[3];
};

struct color_group { /* triangles of a shape that have the same colour */
    std::vector<gp_Pnt> points;
    std::vector<gp_Dir> normals;
    std::vector<uint32_t> corners;
};

struct occt_reader {
    Handle(XCAFDoc_ShapeTool) shapes;
    Handle(XCAFDoc_ColorTool) colors;
    Handle(XCAFDoc_LayerTool) layers;
    struct glb_scene *scene;
    double chord_mm;
    /* tessellated parts, by XCAF label and by the colour that the part inherits from its assembly */
    std::map<std::string, occt_part> parts;
    /* external files of a STEP assembly, by the names that the copies use for them (step_files.hh) */
    std::map<std::string, step_external> externals;
    size_t nodes = 0, places = 0, skipped_faces = 0;
    std::vector<std::string> lines; /* names of parts that consist only of curves or points */
};

using key = std::array<double, 4>;

void take_face(occt_reader *r, RWMesh_FaceIterator &face, std::map<key, color_group> *groups)
{
    key color = { PLAIN[0], PLAIN[1], PLAIN[2], PLAIN[3] };
    if (face.HasFaceColor()) {
        const Quantity_ColorRGBA &rgba = face.FaceColor();
        color = { rgba.GetRGB().Red(), rgba.GetRGB().Green(), rgba.GetRGB().Blue(), static_cast<double>(rgba.Alpha()) };
    }
    color_group *to = &(*groups)[color];
    uint32_t first = static_cast<uint32_t>(to->points.size());
    for (int i = face.NodeLower(); i <= face.NodeUpper(); i++) {
        gp_Pnt point = face.NodeTransformed(i);
        if (!std::isfinite(point.X()) || !std::isfinite(point.Y()) || !std::isfinite(point.Z())) {
            to->points.resize(first);
            to->normals.resize(first);
            r->skipped_faces++;
            return;
        }
        to->points.push_back(point);
        to->normals.push_back(face.HasNormals() ? face.NormalTransformed(i) : gp_Dir(0, 0, 1));
    }
    for (int i = face.ElemLower(); i <= face.ElemUpper(); i++) {
        Poly_Triangle triangle = face.TriangleOriented(i);
        for (int corner = 1; corner <= 3; corner++)
            to->corners.push_back(first + static_cast<uint32_t>(triangle.Value(corner) - face.NodeLower()));
    }
}

void find_origin(const std::map<key, color_group> &groups, double origin[3])
{
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    for (const auto &entry : groups)
        for (const gp_Pnt &point : entry.second.points)
            for (int axis = 0; axis < 3; axis++) {
                low[axis] = std::fmin(low[axis], point.Coord(axis + 1));
                high[axis] = std::fmax(high[axis], point.Coord(axis + 1));
            }
    for (int axis = 0; axis < 3; axis++)
        origin[axis] = std::round((low[axis] + high[axis]) / 2);
}

void write_groups(occt_reader *r, const std::map<key, color_group> &groups, const occt_part &to)
{
    for (const auto &entry : groups) {
        const color_group &from = entry.second;
        if (from.corners.empty())
            continue;
        std::vector<float> positions, normals;
        for (size_t i = 0; i < from.points.size(); i++)
            for (int axis = 0; axis < 3; axis++) {
                positions.push_back(static_cast<float>(from.points[i].Coord(axis + 1) - to.origin[axis]));
                normals.push_back(static_cast<float>(from.normals[i].Coord(axis + 1)));
            }
        const struct glb_scene_triangles triangles = { reinterpret_cast<const float(*)[3]>(positions.data()),
                                                       reinterpret_cast<const float(*)[3]>(normals.data()),
                                                       from.points.size(),
                                                       from.corners.data(),
                                                       from.corners.size(),
                                                       glb_scene_material(r->scene, entry.first.data()) };
        glb_scene_add_triangles(r->scene, to.mesh, &triangles);
    }
}

/* Returns why a shape has no faces, for the reader's output; "" if it consists only of curves or points, which is no loss. */
std::string reason_without_faces(const occt_reader *r, const TopoDS_Shape &shape)
{
    if (!shape.IsNull() && TopExp_Explorer(shape, TopAbs_VERTEX).More())
        return "";
    bool missing = std::any_of(r->externals.begin(), r->externals.end(), [](const auto &each) { return !each.second.found; });
    return missing ? "the part's shape is empty, or its file is missing" : "the part's shape is empty";
}

/* Prints a line of the reader's output about a part that lost some or all of its faces. */
void say_lost_part(occt_reader *r, const TDF_Label &label, const char *id, const mesh_outcome &of)
{
    std::string name = one_line(name_of(label)), why;
    if (of.faces == 0)
        why = reason_without_faces(r, XCAFDoc_ShapeTool::GetShape(label));
    else if (of.missing == 0)
        why = "the part's " + std::to_string(of.faces) + " faces have no extent, or coordinates that are infinite or not numbers";
    else
        why = std::to_string(of.missing) + " of the part's " + std::to_string(of.faces) + " faces could not be converted to triangles";
    if (why.empty())
        r->lines.push_back(name.empty() ? "a part without a name" : name);
    else
        printf("lost\t%s\t%s\tpart\t\t%s\n", id, name.c_str(), why.c_str());
}

/* Returns the tessellated mesh of a shape without sub-assemblies. A shape that inherits different colours has a separate mesh
 * for each. mesh is -1 if the shape has no faces. */
occt_part part_of(occt_reader *r, const TDF_Label &label, const XCAFPrs_Style &style)
{
    TCollection_AsciiString entry;
    TDF_Tool::Entry(label, entry);
    std::string id = entry.ToCString();
    if (style.IsSetColorSurf())
        id += Quantity_ColorRGBA::ColorToHex(style.GetColorSurfRGBA()).ToCString();
    auto known = r->parts.find(id);
    if (known != r->parts.end())
        return known->second;
    occt_part made = { -1, { 0, 0, 0 } };
    std::map<key, color_group> groups;
    TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
    mesh_outcome outcome;
    bool shown = false;
    if (!shape.IsNull()) {
        outcome = occt_tessellate(shape, r->chord_mm, ANGLE_RAD, true);
        for (RWMesh_FaceIterator face(label, TopLoc_Location(), Standard_True, style); face.More(); face.Next())
            if (!face.IsEmptyMesh())
                take_face(r, face, &groups);
        for (const auto &group : groups)
            shown |= !group.second.corners.empty();
    }
    if (shown) {
        find_origin(groups, made.origin);
        made.mesh = glb_scene_add_mesh(r->scene, name_of(label).c_str());
        write_groups(r, groups, made);
    }
    if (!shown || outcome.missing > 0)
        say_lost_part(r, label, entry.ToCString(), outcome);
    r->parts[id] = made;
    return made;
}

/* --- the assembly ------------------------------------------------------------------------------------------------------------------- */

void add(occt_reader *r, const TDF_Label &label, int parent, XCAFPrs_Style style, int depth)
{
    static const double zero[3] = { 0, 0, 0 };
    TDF_Label product = label;
    if (depth > MAX_DEPTH)
        refuse("assemblies are nested deeper than %d levels, or in a circle", MAX_DEPTH);
    if (++r->nodes > MAX_NODES)
        refuse("the model has more than %zu parts, the most that Plantcast supports", MAX_NODES);
    if (XCAFDoc_ShapeTool::IsReference(label) && !XCAFDoc_ShapeTool::GetReferredShape(label, product))
        return;
    take_color(r->colors, label, &style);
    std::string own = name_of(label), name = own.empty() ? name_of(product) : own;
    bool assembly = XCAFDoc_ShapeTool::IsAssembly(product);
    occt_part shown = { -1, { 0, 0, 0 } };
    if (assembly)
        take_color(r->colors, product, &style);
    else
        shown = part_of(r, product, style);
    double matrix[16];
    matrix_of(XCAFDoc_ShapeTool::GetLocation(label), assembly ? zero : shown.origin, matrix);
    int node = glb_scene_add_node(r->scene, parent, name.c_str(), shown.mesh, matrix);
    r->places += shown.mesh >= 0;
    if (product != label && !name_of(product).empty() && name_of(product) != name)
        glb_scene_set_property(r->scene, node, "Product", name_of(product).c_str());
    std::string layers = layers_of(r->layers, product);
    if (!layers.empty())
        glb_scene_set_property(r->scene, node, "Layer", layers.c_str());
    TDF_LabelSequence components;
    if (assembly && XCAFDoc_ShapeTool::GetComponents(product, components))
        for (int i = 1; i <= components.Length(); i++)
            add(r, components.Value(i), node, style, depth + 1);
}

/* --- files --------------------------------------------------------------------------------------------------------------------- */

bool has_ending(const char *path, const char *ending)
{
    size_t length = strlen(path), count = strlen(ending);
    return length > count && !strcasecmp(path + length - count, ending);
}

/* Returns whether a shape's context states a unit of length. Reads the context as Open CASCADE's transfer does. */
bool has_length_unit(const Handle(StepRepr_RepresentationContext) & context)
{
    Handle(StepRepr_GlobalUnitAssignedContext) units = Handle(StepRepr_GlobalUnitAssignedContext)::DownCast(context);
    auto exact = Handle(StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx)::DownCast(context);
    auto plain = Handle(StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext)::DownCast(context);
    if (!exact.IsNull())
        units = exact->GlobalUnitAssignedContext();
    else if (!plain.IsNull())
        units = plain->GlobalUnitAssignedContext();
    STEPConstruct_UnitContext factors;
    if (!units.IsNull())
        factors.ComputeFactors(units);
    return !units.IsNull() && factors.LengthDone();
}

/* Returns the length units of a STEP file's products at the top. */
std::string length_units(STEPControl_Reader *reader)
{
    TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
    std::string units;
    reader->FileUnits(lengths, angles, solid_angles);
    for (int i = 1; i <= lengths.Length(); i++)
        if (units.find(lengths.Value(i).ToCString()) == std::string::npos)
            units += (units.empty() ? "" : ", ") + std::string(lengths.Value(i).ToCString());
    return units;
}

/* Prints an error if the context of any shape states no unit of length: Open CASCADE then takes the shape to be in millimetres.
 * prefix: begins the error. */
void say_missing_units(const Handle(Interface_InterfaceModel) & model, const std::string &prefix)
{
    bool missing = false;
    for (int i = 1; i <= model->NbEntities() && !missing; i++) {
        Handle(StepShape_ShapeRepresentation) shape = Handle(StepShape_ShapeRepresentation)::DownCast(model->Value(i));
        missing = !shape.IsNull() && !shape->IsKind(STANDARD_TYPE(StepShape_ShapeDimensionRepresentation)) &&
                  !has_length_unit(shape->ContextOfItems());
    }
    if (missing)
        printf("error\t1\t%sthe file states no unit of length for some or all shapes: assuming mm; if that is wrong, state the unit in "
               "the CAD program and export the model again\n",
               prefix.c_str());
}

/* Reads a STEP file into the XCAF document. Returns the file's length units. */
std::string read_step(const char *path, const char *output, Handle(TDocStd_Document) document, const char *asked,
                      std::map<std::string, step_external> *externals)
{
    const step_files files = step_files_prepare(path, std::string(output, strrchr(output, '/') + 1), asked);
    STEPCAFControl_Reader step;
    step.SetColorMode(Standard_True);
    step.SetNameMode(Standard_True);
    step.SetLayerMode(Standard_True);
    if (step.ReadFile(files.main.c_str()) != IFSelect_RetDone)
        refuse("this is not a STEP file, or the file is truncated");
    const std::string units = length_units(&step.ChangeReader());
    say_missing_units(step.Reader().WS()->Model(), "");
    bool transferred = step.Transfer(document);
    occt_losses_say(step.Reader().WS(), "");
    for (NCollection_DataMap<TCollection_AsciiString, Handle(STEPCAFControl_ExternFile)>::Iterator each(step.ExternFiles()); each.More();
         each.Next()) {
        auto file = files.externals.find(each.Key().ToCString());
        if (file != files.externals.end() && !each.Value()->GetWS().IsNull() && each.Value()->GetLoadStatus() == IFSelect_RetDone) {
            const std::string prefix = one_line(file->second.named) + ": ";
            occt_losses_say(each.Value()->GetWS(), prefix);
            say_missing_units(each.Value()->GetWS()->Model(), prefix);
        }
    }
    for (const std::string &copy : files.copies)
        remove(copy.c_str());
    for (const auto &each : files.externals)
        if (!each.second.found)
            printf("error\t1\tthe model refers to file %s, which is not in the model's folder, so its parts are not shown\n",
                   one_line(each.second.named).c_str());
    *externals = files.externals;
    if (!transferred)
        refuse("Open CASCADE could not read the shapes in the CAD file: export the model again");
    return units;
}

std::string read_iges(const char *path, Handle(TDocStd_Document) document, const char *asked)
{
    IGESControl_Reader iges;
    Interface_Static::SetCVal("read.iges.sequence", "none");
    if (iges.ReadFile(path) != IFSelect_RetDone)
        refuse("this is not an IGES file, or the file is truncated");
    text_encoding encoding;
    encoding.choose(read_whole(path), asked, "");
    encoding.say();
    iges_tree_add(iges, document, encoding);
    occt_losses_say(iges.WS(), "");
    if (iges.NbShapes() < 1)
        refuse("Open CASCADE could not read the shapes in the CAD file: export the model again");
    return iges_units(iges);
}

void say_lines(const occt_reader &r)
{
    std::string names;
    for (size_t i = 0; i < r.lines.size() && i < MOST_NAMED; i++)
        names += (i > 0 ? ", " : "") + r.lines[i];
    if (!r.lines.empty())
        printf("not shown: %zu parts that consist only of curves or points: %s%s\n", r.lines.size(), names.c_str(),
               r.lines.size() > MOST_NAMED ? ", ..." : "");
}

/* Computes the root node's matrix: millimetres to metres, and also Z up to Y up if y_up is false. */
void root_matrix(bool y_up, double out[16])
{
    const double z_up[16] = { 1e-3, 0, 0, 0, 0, 0, -1e-3, 0, 0, 1e-3, 0, 0, 0, 0, 0, 1 };
    const double as_is[16] = { 1e-3, 0, 0, 0, 0, 1e-3, 0, 0, 0, 0, 1e-3, 0, 0, 0, 0, 1 };
    memcpy(out, y_up ? as_is : z_up, sizeof(z_up));
}

/* Returns the diagonal of the bounding box around all shapes in millimetres; infinity if there is no box. */
double longest_mm(const occt_reader &r, const TDF_LabelSequence &shapes)
{
    Bnd_Box box;
    for (int i = 1; i <= shapes.Length(); i++)
        BRepBndLib::Add(r.shapes->GetShape(shapes.Value(i)), box, Standard_False);
    double diagonal = box.IsVoid() || box.IsOpen() ? 0 : std::sqrt(box.SquareExtent());
    return diagonal > 0 ? diagonal : INFINITY;
}

void convert(const char *input, const char *output, double chord_mm, bool y_up, const char *asked)
{
    Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
    Handle(TDocStd_Document) document;
    XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
    bool iges = has_ending(input, ".igs") || has_ending(input, ".iges");
    Interface_Static::SetCVal("xstep.cascade.unit", "MM");
    occt_reader r = {};
    std::string units = iges ? read_iges(input, document, asked) : read_step(input, output, document, asked, &r.externals);
    const char *slash = strrchr(input, '/'), *base = slash ? slash + 1 : input;
    std::string stem(base, strrchr(base, '.') ? static_cast<size_t>(strrchr(base, '.') - base) : strlen(base));
    r.shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
    r.colors = XCAFDoc_DocumentTool::ColorTool(document->Main());
    r.layers = XCAFDoc_DocumentTool::LayerTool(document->Main());
    r.scene = glb_scene_create("plantcast-import, Open CASCADE");
    double matrix[16];
    root_matrix(y_up, matrix);
    int root = glb_scene_add_node(r.scene, -1, stem.c_str(), -1, matrix);
    TDF_LabelSequence free;
    r.shapes->GetFreeShapes(free);
    r.chord_mm = chord_mm = std::fmin(chord_mm, longest_mm(r, free) / CHORDS_PER_MODEL);
    for (int i = 1; i <= free.Length(); i++)
        add(&r, free.Value(i), root, XCAFPrs_Style(), 0);
    say_lines(r);
    if (r.places == 0)
        refuse("the file contains no surface: export solids or surfaces, not only curves and points");
    write_scene(&r.scene, output, ": set a larger --chord to make the output file smaller");
    size_t made = 0;
    for (const auto &entry : r.parts)
        made += entry.second.mesh >= 0;
    printf("%zu parts in %zu places; chord error %g mm; %s axis up\n", made, r.places, chord_mm, y_up ? "Y" : "Z");
    if (!units.empty())
        printf("units: %s\n", units.c_str());
    if (r.skipped_faces > 0)
        printf("left out: %zu faces whose coordinates are infinite or not numbers\n", r.skipped_faces);
}

/* Runs convert() and calls refuse() for Open CASCADE exceptions, which do not derive from std::exception. */
void convert_or_refuse(char **arguments)
{
    double chord_mm = strtod(arguments[2], nullptr);
    try {
        if (has_ending(arguments[0], ".ifc")) {
            Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
            ifc_shapes_write(arguments[0], arguments[1], chord_mm, arguments[3]);
        } else {
            convert(arguments[0], arguments[1], chord_mm, !strcmp(arguments[4], "y"), arguments[5]);
        }
    } catch (const Standard_Failure &e) {
        refuse("Open CASCADE could not read the shapes in the CAD file: %s", e.GetMessageString());
    } catch (const std::exception &) {
        throw;
    } catch (...) {
        refuse("Open CASCADE could not read the shapes in the CAD file: export the model again");
    }
}

} // namespace

int main(int argc, char **argv)
{
    return reader_main(argc, argv, "plantcast-import-occt", convert_or_refuse);
}
