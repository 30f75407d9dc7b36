/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the IFC geometry items to build by following products to their representations, and tessellates each item once. */
#include "preprocess/import/readers/ifc_shapes.hh"

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_GTransform.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <climits>
#include <cmath>
#include <fstream>
#include <set>

#include "preprocess/import/readers/ifc_shape.hh"
#include "preprocess/import/readers/reader.hh"

namespace ifc
{

namespace
{

constexpr const char *GRID_PLACEMENT = "IFCGRIDPLACEMENT";
constexpr size_t REPRESENTATION = 6, PLACEMENT = 5; /* indices of the representation and the placement among a product statement's values */

/* --- units */

double si_prefix(const value &name)
{
    static const struct {
        const char *name;
        double factor;
    } prefixes[] = { { ".KILO.", 1e3 },   { ".HECTO.", 1e2 },  { ".DECI.", 1e-1 },
                     { ".CENTI.", 1e-2 }, { ".MILLI.", 1e-3 }, { ".MICRO.", 1e-6 } };
    for (const auto &prefix : prefixes)
        if (name.is(prefix.name))
            return prefix.factor;
    return 1;
}

double unit_of(const file &in, const entity &unit, int depth)
{
    if (unit.is("IFCSIUNIT"))
        return si_prefix(unit[2]);
    entity factor = in.get(unit[3]); /* an IfcConversionBasedUnit, such as the foot: a factor and another unit, which are multiplied */
    if (depth > MAX_CHAIN)
        throw unsupported("the IFC file cannot be read: its units refer to each other in a circle");
    return file::number(factor[0]) * unit_of(in, in.get(factor[1]), depth + 1);
}

ifc_model model_of(const file &in, double chord_mm)
{
    ifc_model out = { in, 1e3, 1, chord_mm, {}, false };
    in.each([&](int id, const std::string &type) {
        if (type == "IFCGRID")
            add_grid(id, &out);
        if (type != "IFCPROJECT")
            return;
        entity units = in.get(in.get(id)[8]);
        for (const value &reference : units[0].list) {
            entity unit = in.get(reference);
            if (unit[1].is(".LENGTHUNIT."))
                out.length = 1e3 * unit_of(in, unit, 0);
            else if (unit[1].is(".PLANEANGLEUNIT."))
                out.angle = unit_of(in, unit, 0);
        }
    });
    if (!(out.length > 0) || !(out.angle > 0))
        throw unsupported("the IFC file cannot be read: it has no valid unit of length or of plane angle");
    return out;
}

/* --- meshes */

struct ifc_part {
    int mesh;
    /* origin of the mesh's vertices, in millimetres: a point near the item, so that single precision is exact enough even far
       from the element's origin */
    double origin[3];
};

struct ifc_writer {
    const ifc_model &in;
    struct glb_scene *scene;
    std::map<int, ifc_part> parts; /* the shapes built so far, by id of their statement in the IFC file */
    /* by statement id of an item or element that could not be built and is left to web-ifc: the reason */
    std::map<int, std::string> failed;
    std::map<int, std::vector<int>> openings; /* by id of the element that openings are cut out of: ids of these openings */
    std::set<int> asked; /* ids of elements that web-ifc cannot build, or not completely */
    size_t elements = 0, placements = 0;
};

ifc_part add_mesh(ifc_writer *w, const TopoDS_Shape &shape, int id)
{
    triangles all = triangles_of(w->in, shape);
    if (volume_of(all) < 0) { /* the solid is inside out: reverse triangles and normals */
        for (size_t i = 0; i < all.corners.size(); i += 3)
            std::swap(all.corners[i], all.corners[i + 1]);
        for (gp_Vec &normal : all.normals)
            normal.Reverse();
    }
    ifc_part out = { -1, { 0, 0, 0 } };
    for (int axis = 0; axis < 3; axis++)
        out.origin[axis] = std::round(all.points[0].Coord(axis + 1));
    std::vector<float> positions, normals;
    for (size_t i = 0; i < all.points.size(); i++)
        for (int axis = 0; axis < 3; axis++) {
            positions.push_back(static_cast<float>(all.points[i].Coord(axis + 1) - out.origin[axis]));
            normals.push_back(static_cast<float>(all.normals[i].Coord(axis + 1)));
        }
    const double grey[4] = { 1, 1, 1, 1 };
    const struct glb_scene_triangles written = { reinterpret_cast<const float(*)[3]>(positions.data()),
                                                 reinterpret_cast<const float(*)[3]>(normals.data()),
                                                 all.points.size(),
                                                 all.corners.data(),
                                                 all.corners.size(),
                                                 glb_scene_material(w->scene, grey) };
    out.mesh = glb_scene_add_mesh(w->scene, ("#" + std::to_string(id)).c_str());
    glb_scene_add_triangles(w->scene, out.mesh, &written);
    return out;
}

/* Calls f(). If it throws, stores the exception's text as the reason why statement `id` could not be built, and returns false. */
template <typename function> bool attempt(ifc_writer *w, int id, const function &f)
{
    std::string why;
    try {
        f();
        return true;
    } catch (const Standard_Failure &e) {
        why = e.GetMessageString()[0] ? e.GetMessageString() : e.DynamicType()->Name();
    } catch (const unsupported &e) {
        why = e.what();
    } catch (const std::out_of_range &) {
        why = "the IFC file is truncated";
    }
    w->failed[id] = why;
    return false;
}

/* Builds and tessellates a geometry item unless that was done before. Returns false if it could not be built; reports the reason once. */
bool build(ifc_writer *w, const entity &item)
{
    if (w->parts.count(item.id) > 0 || w->failed.count(item.id) > 0)
        return w->parts.count(item.id) > 0;
    return attempt(w, item.id, [&] { w->parts[item.id] = add_mesh(w, solid_of(w->in, item, 0), item.id); });
}

/* --- items */

/* Returns whether a geometry item, or an operand of a boolean item, is of a type that this program always builds (is_built()). */
bool wanted(const ifc_model &in, const entity &item, int depth)
{
    if (depth > MAX_CHAIN)
        return false;
    if (item.is("IFCBOOLEANRESULT") || item.is("IFCBOOLEANCLIPPINGRESULT"))
        return wanted(in, in.statements.get(item[1]), depth + 1) || wanted(in, in.statements.get(item[2]), depth + 1);
    return is_built(item.type);
}

struct placed_item {
    int id;
    gp_GTrsf place;
};

/* Collects the geometry items of a representation and of the representations that it maps. Sets *whole to false if any item is
 * left to web-ifc. all: true collects items of every type, false only the types for which is_built() is true. */
void collect(ifc_writer *w, const entity &representation, const gp_GTrsf &above, int depth, bool all, std::vector<placed_item> *out,
             bool *whole)
{
    const ifc_model &in = w->in;
    if (depth > MAX_CHAIN)
        throw unsupported("this IFC shape cannot be built: representations refer to each other in a circle");
    for (const value &reference : representation[3].list) {
        entity item = in.statements.get(reference);
        if (item.is("IFCMAPPEDITEM")) {
            entity map = in.statements.get(item[0]);
            gp_GTrsf place = above * operator_of(in, in.statements.get(item[1])) * gp_GTrsf(placement_of(in, map[0]));
            collect(w, in.statements.get(map[1]), place, depth + 1, all, out, whole);
        } else if ((all || wanted(in, item, 0)) && build(w, item)) {
            out->push_back({ item.id, above });
        } else {
            *whole = false;
        }
    }
}

/* Converts a placement to a 4 x 4 matrix in metres, with Z up turned to Y up. */
void matrix_of(const gp_GTrsf &place, double scale, bool turn, const double shift[3], double out[16])
{
    static const int rows[3] = { 0, 2, 1 };
    for (int column = 0; column < 4; column++)
        for (int row = 0; row < 3; row++) {
            int from = turn ? rows[row] : row;
            double at = place.Value(from + 1, column + 1);
            for (int k = 0; column == 3 && k < 3; k++)
                at += place.Value(from + 1, k + 1) * shift[k];
            out[4 * column + row] = scale * (turn && row == 2 ? -at : at);
        }
    for (int column = 0; column < 4; column++)
        out[4 * column + 3] = column == 3;
}

/* Returns whether a representation shows the body of an element, not its axis, plan or clearance space. */
bool is_body(const entity &representation)
{
    static const char *const others[] = {
        "Axis", "FootPrint", "Box", "Annotation", "Profile", "Clearance", "Lighting", "CoG", "Reference"
    };
    for (const char *other : others)
        if (representation[1].text == other)
            return false;
    return representation.is("IFCSHAPEREPRESENTATION");
}

/* Collects the geometry items of a product's body. Returns true if no item is left to web-ifc. */
bool collect_all(ifc_writer *w, const entity &product, bool all, std::vector<placed_item> *out)
{
    bool whole = true;
    entity shape = w->in.statements.get(product[REPRESENTATION]);
    for (const value &reference : shape[2].list) {
        entity representation = w->in.statements.get(reference);
        if (is_body(representation))
            collect(w, representation, gp_GTrsf(), 0, all, out, &whole);
    }
    return whole;
}

/* --- openings */

TopoDS_Shape shape_at(const ifc_model &in, int item, const gp_GTrsf &place)
{
    TopoDS_Shape shape = solid_of(in, in.statements.get(item), 0);
    if (place.Form() == gp_Other)
        return BRepBuilderAPI_GTransform(shape, place, Standard_True).Shape();
    return BRepBuilderAPI_Transform(shape, place.Trsf(), Standard_True).Shape();
}

/* Cuts all openings of an element out of each of its geometry items. Each item gets the mesh that remains; an item of which
 * nothing remains is removed. */
void cut_openings(ifc_writer *w, const entity &product, std::vector<placed_item> *items, std::map<int, ifc_part> *meshes)
{
    const ifc_model &in = w->in;
    std::vector<TopoDS_Shape> cutters;
    gp_Trsf to_element = object_placement(in, product[PLACEMENT]).Inverted();
    for (int id : w->openings[product.id]) {
        entity opening = in.statements.get(id);
        std::vector<placed_item> parts;
        gp_GTrsf place(to_element * object_placement(in, opening[PLACEMENT]));
        if (!collect_all(w, opening, true, &parts))
            throw unsupported("this IFC element cannot be built: its opening #" + std::to_string(id) + " cannot be built");
        for (const placed_item &part : parts)
            cutters.push_back(shape_at(in, part.id, place * part.place));
    }
    std::vector<placed_item> left;
    for (const placed_item &item : *items) {
        TopoDS_Shape shape = shape_at(in, item.id, item.place);
        for (const TopoDS_Shape &cutter : cutters) {
            BRepAlgoAPI_Cut cut(shape, cutter);
            if (!cut.IsDone() || cut.Shape().IsNull())
                throw unsupported("this IFC element cannot be built: Open CASCADE cannot cut out its openings");
            shape = cut.Shape();
        }
        if (!TopExp_Explorer(shape, TopAbs_FACE).More())
            continue;
        (*meshes)[item.id] = add_mesh(w, shape, item.id);
        left.push_back({ item.id, gp_GTrsf() });
    }
    *items = left;
}

/* Finds the openings of each IFC element. Openings of an element without a shape are cut out of the elements it consists of. */
std::map<int, std::vector<int>> find_openings(const file &in)
{
    std::map<int, std::vector<int>> openings, consists_of;
    in.each([&](int id, const std::string &type) {
        if (type != "IFCRELVOIDSELEMENT" && type != "IFCRELAGGREGATES")
            return;
        try {
            entity relation = in.get(id);
            if (type == "IFCRELVOIDSELEMENT")
                openings[relation[4].id].push_back(relation[5].id);
            for (const value &part : relation[5].list)
                consists_of[relation[4].id].push_back(part.id);
        } catch (const unsupported &) { /* ignore a damaged statement, because web-ifc reports it */
        }
    });
    std::map<int, std::vector<int>> out = openings;
    for (const auto &entry : openings)
        for (int part : consists_of[entry.first])
            out[part].insert(out[part].end(), entry.second.begin(), entry.second.end());
    return out;
}

/* --- elements */

void add_element(ifc_writer *w, const entity &product)
{
    static const double zero[3] = { 0, 0, 0 };
    std::vector<placed_item> items;
    std::map<int, ifc_part> meshes;
    bool asked = w->asked.count(product.id) > 0, whole = collect_all(w, product, asked, &items), cut = false;
    if (items.empty())
        return;
    if (asked && whole && w->openings.count(product.id) > 0)
        cut = attempt(w, product.id, [&] { cut_openings(w, product, &items, &meshes); });
    double matrix[16];
    matrix_of(gp_GTrsf(object_placement(w->in, product[PLACEMENT])), 1e-3, true, zero, matrix);
    int node = glb_scene_add_node(w->scene, -1, ("#" + std::to_string(product.id)).c_str(), -1, matrix);
    if (whole)
        glb_scene_set_property(w->scene, node, "whole", "yes");
    if (cut)
        glb_scene_set_property(w->scene, node, "cut", "yes");
    for (const placed_item &item : items) {
        const ifc_part &from = cut ? meshes[item.id] : w->parts[item.id];
        matrix_of(item.place, 1, false, from.origin, matrix);
        glb_scene_add_node(w->scene, node, ("#" + std::to_string(item.id)).c_str(), from.mesh, matrix);
    }
    w->elements++;
}

bool has_any(const file &in)
{
    bool any = false;
    in.each([&](int, const std::string &type) { any |= is_built(type) || type == GRID_PLACEMENT; });
    return any;
}

/* Writes the grid placements, rewritten as local placements, to properties of a node of the GLB file. ifc.mjs puts them into
 * the IFC file that web-ifc reads. */
void add_placements(ifc_writer *w)
{
    std::map<int, std::string> statements;
    int last = 0;
    w->in.statements.each([&](int id, const std::string &) { last = id; });
    w->in.statements.each([&](int id, const std::string &type) {
        if (type != GRID_PLACEMENT)
            return;
        attempt(w, id, [&] {
            long long unused = last + 1LL + 4 * static_cast<long long>(statements.size());
            if (unused > INT_MAX - 3)
                throw unsupported("this IFC placement cannot be computed: the file has no unused statement number for it");
            statements[id] = as_local_placement(w->in, w->in.statements.get(id), static_cast<int>(unused));
        });
    });
    if (statements.empty())
        return;
    int node = glb_scene_add_node(w->scene, -1, "placements", -1, nullptr);
    for (const auto &entry : statements)
        glb_scene_set_property(w->scene, node, ("#" + std::to_string(entry.first)).c_str(), entry.second.c_str());
    w->placements = statements.size();
}

} // namespace

} // namespace ifc

/* Reads statement numbers separated by blanks from the file `path`. */
static std::set<int> numbers_in(const char *path)
{
    std::ifstream list(path);
    std::set<int> out;
    for (int number; list >> number;)
        out.insert(number);
    return out;
}

void ifc_shapes_write(const char *input, const char *output, double chord_mm, const char *asked)
{
    ifc::file statements(input);
    std::set<int> elements = numbers_in(asked);
    if (elements.empty() && !ifc::has_any(statements))
        return;
    ifc::ifc_model in = ifc::model_of(statements, chord_mm);
    ifc::ifc_writer w = { in, glb_scene_create("plantcast-import, Open CASCADE"), {}, {}, {}, elements };
    w.openings = elements.empty() ? w.openings : ifc::find_openings(statements);
    ifc::add_placements(&w);
    statements.each([&](int id, const std::string &) {
        try {
            if (!statements.is_rooted(id))
                return;
            ifc::entity product = statements.get(id);
            const ifc::value &shape = product[ifc::REPRESENTATION];
            if (shape.kind == ifc::value::REFERENCE && statements.get(shape).is("IFCPRODUCTDEFINITIONSHAPE"))
                ifc::add_element(&w, product);
        } catch (const ifc::unsupported &e) {
            w.failed[id] = e.what();
        } catch (const Standard_Failure &e) {
            w.failed[id] = e.GetMessageString();
        }
    });
    int failed = glb_scene_add_node(w.scene, -1, "failed", -1, nullptr);
    for (const auto &entry : w.failed)
        glb_scene_set_property(w.scene, failed, ("#" + std::to_string(entry.first)).c_str(), entry.second.c_str());
    if (w.elements + w.placements > 0 || !w.failed.empty())
        write_scene(&w.scene, output, ": set a larger --chord to make the output file smaller");
    else
        glb_scene_destroy(&w.scene);
}
