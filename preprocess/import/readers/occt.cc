/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast-import-occt INPUT OUTPUT.glb CHORD_MM UNITS UP ENCODING`: reads STEP and IGES with Open CASCADE, in its own process. The
 * assembly tree becomes nodes; each part is tessellated once and shared by its placements. For IFC files it builds some solids only
 * (ifc_shapes.hh); UNITS is then the path of a list of elements. Prints its findings; on failure the last line on stderr is the reason. */
#include <BRepMesh_IncrementalMesh.hxx>
#include <IGESControl_Reader.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <RWMesh_FaceIterator.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TDF_LabelMap.hxx>
#include <TDF_Tool.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
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
#include "preprocess/import/readers/reader.hh"

namespace
{

constexpr size_t MAX_NODES = 2'000'000; /* limit of output nodes: assemblies nested in assemblies can grow exponentially */
constexpr double ANGLE_RAD = 0.5;       /* largest angle in radians between neighbouring facets, where the chord error would allow more */
const double PLAIN[4] = { 0.35, 0.35, 0.35, 1 };

/* --- names, colours, places ------------------------------------------------------------------------------------------------------- */

std::string utf8_of(const TCollection_ExtendedString &from)
{
    std::vector<char> bytes(static_cast<size_t>(from.LengthOfCString()) + 1);
    char *at = bytes.data();
    from.ToUTF8CString(at);
    return at;
}

/* Suffix appended to names. Open CASCADE treats a name whose last character is not ASCII as empty and shows a number instead. */
constexpr char NAME_END[] = "`|";

std::string without_end(std::string name)
{
    size_t length = strlen(NAME_END);
    if (name.size() >= length && name.compare(name.size() - length, length, NAME_END) == 0)
        name.resize(name.size() - length);
    return name;
}

/* Returns the name of a label, or "" for a generated name such as "=>[0:1:1:3]", which Open CASCADE gives to components without a name. */
std::string name_of(const TDF_Label &label)
{
    Handle(TDataStd_Name) name;
    if (!label.FindAttribute(TDataStd_Name::GetID(), name))
        return "";
    std::string text = without_end(utf8_of(name->Get()));
    return text.compare(0, 3, "=>[") == 0 || text == "COMPOUND" || text == "SOLID" || text == "SHELL" || text == "ASSEMBLY" ? "" : text;
}

std::string layers_of(const Handle(XCAFDoc_LayerTool) & tool, const TDF_Label &label)
{
    Handle(TColStd_HSequenceOfExtendedString) names;
    std::string out;
    if (!tool->GetLayers(label, names) || names.IsNull())
        return out;
    for (int i = 1; i <= names->Length(); i++)
        out += (out.empty() ? "" : ", ") + without_end(utf8_of(names->Value(i)));
    return out;
}

/* Reads the colour of the label itself, not of its parts. */
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
    double origin[3]; /* origin of the mesh's vertices; it keeps precision for a part far from its own origin */
};

struct color_group { /* the triangles of one colour */
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
    std::map<std::string, occt_part> parts; /* tessellated parts, by label entry and inherited colour */
    size_t nodes = 0, places = 0, skipped_faces = 0, empty_parts = 0;
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

/* Tessellates a simple shape, once for each colour it inherits. mesh is -1 if the shape has no faces. */
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
    bool shown = false;
    if (!shape.IsNull()) {
        try {
            BRepMesh_IncrementalMesh(shape, r->chord_mm, Standard_False, ANGLE_RAD, Standard_True);
        } catch (const Standard_Failure &) {
            r->skipped_faces++;
        }
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
    } else {
        r->empty_parts++;
        std::string name = name_of(label);
        std::replace_if(name.begin(), name.end(), [](unsigned char c) { return c < ' '; }, ' ');
        printf("lost\t%s\t%s\tpart\t\t%s\n",
               entry.ToCString(), name.c_str(), shape.IsNull() ? "it has no shape" : "its shape has no faces");
    }
    r->parts[id] = made;
    return made;
}

/* --- the assembly ------------------------------------------------------------------------------------------------------------------- */

void add(occt_reader *r, const TDF_Label &label, int parent, XCAFPrs_Style style, int depth)
{
    static const double zero[3] = { 0, 0, 0 };
    TDF_Label product = label;
    if (depth > MAX_DEPTH)
        refuse("its assembly is nested deeper than %d levels, or in a circle", MAX_DEPTH);
    if (++r->nodes > MAX_NODES)
        refuse("more than %zu parts", MAX_NODES);
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

/* Reports entities that could not be read as the type that they claim: their content is missing or wrong. */
void say_damaged(const Handle(Interface_InterfaceModel) & model)
{
    int damaged = 0, first = 0;
    for (int i = 1; i <= model->NbEntities(); i++)
        if (model->IsErrorEntity(i)) {
            damaged++;
            first = first ? first : i;
        }
    if (damaged > 0)
        printf("error\t1\tOpen CASCADE: %d of its %d entities could not be read, the first one is number %d\n",
               damaged, model->NbEntities(), first);
}

/* Appends NAME_END to each string that has characters beyond ASCII, either raw or as STEP escapes. */
std::string with_name_ends(const std::string &text)
{
    std::string out;
    bool within = false, beyond = false;
    for (size_t i = 0; i < text.size(); i++) {
        size_t comment = !within && text.compare(i, 2, "/*") == 0 ? text.find("*/", i + 2) : std::string::npos;
        if (comment != std::string::npos) {
            out.append(text, i, comment + 2 - i);
            i = comment + 1;
            continue;
        }
        if (within && text[i] == '\'' && text.compare(i, 2, "''") == 0) {
            out += "''";
            i++;
            continue;
        }
        if (text[i] == '\'') {
            if (within && beyond)
                out += NAME_END;
            within = !within;
            beyond = false;
        }
        beyond |= within && (static_cast<unsigned char>(text[i]) >= 0x80 || text[i] == '\\');
        out += text[i];
    }
    return out;
}

/* Ensures that a STEP file is readable as UTF-8, which Open CASCADE expects. Standard STEP is ASCII with escapes, but many programs write
 * names in their system's encoding. If a name is not plain ASCII, writes a converted copy to `copy`. Returns the path to read. */
const char *step_in_utf8(const char *path, const std::string &copy, const char *asked)
{
    std::string text = read_whole(path);
    text_encoding encoding;
    encoding.choose(text, asked, "");
    encoding.say();
    std::string converted = with_name_ends(encoding.utf8(text));
    if (converted == text)
        return path;
    text.swap(converted);
    FILE *file = fopen(copy.c_str(), "wb");
    bool good = file && fwrite(text.data(), 1, text.size(), file) == text.size();
    if (file && fclose(file) != 0)
        good = false;
    if (!good)
        refuse("%s", strerror(errno));
    return copy.c_str();
}

/* Reads a STEP file into the document. Returns the units stated by the file. */
std::string read_step(const char *path, Handle(TDocStd_Document) document)
{
    STEPCAFControl_Reader step;
    step.SetColorMode(Standard_True);
    step.SetNameMode(Standard_True);
    step.SetLayerMode(Standard_True);
    if (step.ReadFile(path) != IFSelect_RetDone)
        refuse("it is no STEP file, or is cut off");
    TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
    step.ChangeReader().FileUnits(lengths, angles, solid_angles);
    if (!step.Transfer(document))
        refuse("its shapes could not be read");
    say_damaged(step.Reader().WS()->Model());
    std::string units;
    for (int i = 1; i <= lengths.Length(); i++)
        if (units.find(lengths.Value(i).ToCString()) == std::string::npos)
            units += (units.empty() ? "" : ", ") + std::string(lengths.Value(i).ToCString());
    return units;
}

std::string read_iges(const char *path, Handle(TDocStd_Document) document, const char *asked)
{
    IGESControl_Reader iges;
    Interface_Static::SetCVal("read.iges.sequence", "none");
    if (iges.ReadFile(path) != IFSelect_RetDone)
        refuse("it is no IGES file, or is cut off");
    text_encoding encoding;
    encoding.choose(read_whole(path), asked, "");
    encoding.say();
    iges_tree_add(iges, document, encoding);
    if (iges.NbShapes() < 1)
        refuse("its shapes could not be read");
    say_damaged(iges.WS()->Model());
    return iges_units(iges);
}

/* Computes the root matrix: millimetres to metres, and Z up to Y up unless the model is Y up already. */
void root_matrix(bool y_up, double out[16])
{
    const double z_up[16] = { 1e-3, 0, 0, 0, 0, 0, -1e-3, 0, 0, 1e-3, 0, 0, 0, 0, 0, 1 };
    const double as_is[16] = { 1e-3, 0, 0, 0, 0, 1e-3, 0, 0, 0, 0, 1e-3, 0, 0, 0, 0, 1 };
    memcpy(out, y_up ? as_is : z_up, sizeof(z_up));
}

void convert(const char *input, const char *output, double chord_mm, bool y_up, const char *asked)
{
    Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
    Handle(TDocStd_Document) document;
    XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
    bool iges = has_ending(input, ".igs") || has_ending(input, ".iges");
    Interface_Static::SetCVal("xstep.cascade.unit", "MM");
    std::string copy = std::string(output) + ".step";
    std::string units = iges ? read_iges(input, document, asked) : read_step(step_in_utf8(input, copy, asked), document);
    remove(copy.c_str());
    const char *slash = strrchr(input, '/'), *base = slash ? slash + 1 : input;
    std::string stem(base, strrchr(base, '.') ? static_cast<size_t>(strrchr(base, '.') - base) : strlen(base));
    occt_reader r = {};
    r.shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
    r.colors = XCAFDoc_DocumentTool::ColorTool(document->Main());
    r.layers = XCAFDoc_DocumentTool::LayerTool(document->Main());
    r.scene = glb_scene_create("plantcast-import, Open CASCADE");
    r.chord_mm = chord_mm;
    double matrix[16];
    root_matrix(y_up, matrix);
    int root = glb_scene_add_node(r.scene, -1, stem.c_str(), -1, matrix);
    TDF_LabelSequence free;
    r.shapes->GetFreeShapes(free);
    for (int i = 1; i <= free.Length(); i++)
        add(&r, free.Value(i), root, XCAFPrs_Style(), 0);
    if (r.places == 0)
        refuse("there is no surface in it");
    write_scene(&r.scene, output, ": a larger --chord makes it smaller");
    size_t made = 0;
    for (const auto &entry : r.parts)
        made += entry.second.mesh >= 0;
    printf("%zu parts in %zu places; chord error %g mm; %s up\n", made, r.places, chord_mm, y_up ? "Y" : "Z");
    if (!units.empty())
        printf("its units are: %s\n", units.c_str());
    if (r.skipped_faces > 0)
        printf("left out: %zu faces that could not be tessellated\n", r.skipped_faces);
    if (r.empty_parts > 0)
        printf("%zu parts have no triangles\n", r.empty_parts);
}

/* Runs convert(). Translates Open CASCADE's exceptions, which do not derive from std::exception, to refuse(). */
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
        refuse("its shapes could not be read: %s", e.GetMessageString());
    } catch (const std::exception &) {
        throw;
    } catch (...) {
        refuse("its shapes could not be read");
    }
}

} // namespace

int main(int argc, char **argv)
{
    return reader_main(argc, argv, "plantcast-import-occt", convert_or_refuse);
}
