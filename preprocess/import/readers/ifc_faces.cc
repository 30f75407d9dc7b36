/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds solids and surfaces from flat faces: faceted B-reps, surface models and face sets. A closed set of faces becomes a solid. */
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRep_Builder.hxx>
#include <ShapeFix_Face.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>

#include "preprocess/import/readers/ifc_shape.hh"

namespace ifc
{

namespace
{

constexpr size_t MAX_SEWN_FACES = 20000; /* maximum number of faces that are sewn to a solid; sewing more would take minutes */
constexpr double SEWN_MM = 1e-3;

using polygon = std::vector<gp_Pnt>;

struct flat_face {
    polygon outer;
    std::vector<polygon> holes;
};

gp_Vec normal_of(const polygon &points)
{
    gp_Vec out;
    for (size_t i = 1; i + 1 < points.size(); i++)
        out += gp_Vec(points[0], points[i]).Crossed(gp_Vec(points[0], points[i + 1]));
    return out;
}

TopoDS_Wire wire_through(const polygon &points)
{
    BRepBuilderAPI_MakePolygon wire;
    for (const gp_Pnt &point : points)
        wire.Add(point);
    wire.Close();
    return wire.IsDone() ? wire.Wire() : TopoDS_Wire();
}

/* Adds a flat face to the compound `to`. A face whose corners do not lie in a plane becomes a fan of triangles. Returns false,
 * and adds nothing, if the face has no area. */
bool add_face(const flat_face &from, TopoDS_Compound *to)
{
    BRep_Builder builder;
    TopoDS_Wire outer = normal_of(from.outer).Magnitude() > 1e-9 ? wire_through(from.outer) : TopoDS_Wire();
    if (outer.IsNull())
        return false;
    BRepBuilderAPI_MakeFace face(outer, Standard_True);
    if (face.IsDone()) {
        for (const polygon &hole : from.holes) {
            TopoDS_Wire inner = wire_through(hole);
            if (!inner.IsNull())
                face.Add(inner);
        }
        ShapeFix_Face fix(face.Face());
        fix.FixOrientation();
        builder.Add(*to, fix.Face());
        return true;
    }
    if (!from.holes.empty())
        throw unsupported("this IFC shape cannot be built: Plantcast does not support faces that have holes and are not flat");
    for (size_t i = 1; i + 1 < from.outer.size(); i++) {
        TopoDS_Wire corner = wire_through({ from.outer[0], from.outer[i], from.outer[i + 1] });
        if (!corner.IsNull() && BRepBuilderAPI_MakeFace(corner, Standard_True).IsDone())
            builder.Add(*to, BRepBuilderAPI_MakeFace(corner, Standard_True).Face());
    }
    return true;
}

TopoDS_Shape joined(const std::vector<flat_face> &faces)
{
    TopoDS_Compound all;
    BRep_Builder().MakeCompound(all);
    size_t made = 0;
    for (const flat_face &face : faces)
        made += add_face(face, &all);
    if (made == 0)
        throw unsupported("this IFC shape cannot be built: none of its faces has an area");
    if (made > MAX_SEWN_FACES)
        return all;
    BRepBuilderAPI_Sewing sewing(SEWN_MM);
    sewing.Add(all);
    sewing.Perform();
    TopoDS_Shape out = sewing.SewedShape();
    if (!out.IsNull() && out.ShapeType() == TopAbs_SHELL && out.Closed())
        return BRepBuilderAPI_MakeSolid(TopoDS::Shell(out)).Solid();
    return out.IsNull() ? TopoDS_Shape(all) : out;
}

/* --- loops of points */

polygon loop_of(const ifc_model &in, const entity &bound)
{
    entity loop = in.statements.get(bound[0]);
    polygon out;
    if (!loop.is("IFCPOLYLOOP"))
        throw unsupported("this IFC shape cannot be built: Plantcast does not support " + loop.type);
    for (const value &point : loop[0].list)
        out.push_back(point_of(in, point));
    if (bound[1].is(".F."))
        out.assign(out.rbegin(), out.rend());
    return out;
}

/* Reads an IFC face and appends it to `out`. A face with several outer bounds becomes several faces. If no bound is marked as
 * outer, the largest one counts as the outer bound. */
void take_face(const ifc_model &in, const entity &face, std::vector<flat_face> *out)
{
    std::vector<polygon> inner;
    size_t first = out->size(), largest = 0;
    for (const value &reference : face[0].list) {
        entity bound = in.statements.get(reference);
        polygon loop = loop_of(in, bound);
        if (bound.is("IFCFACEOUTERBOUND"))
            out->push_back({ loop, {} });
        else
            inner.push_back(loop);
    }
    if (out->size() == first && !inner.empty()) {
        for (size_t i = 1; i < inner.size(); i++)
            if (normal_of(inner[i]).Magnitude() > normal_of(inner[largest]).Magnitude())
                largest = i;
        out->push_back({ inner[largest], {} });
        inner.erase(inner.begin() + static_cast<std::ptrdiff_t>(largest));
    }
    if (out->size() > first)
        (*out)[first].holes = inner;
}

void take_shell(const ifc_model &in, const entity &shell, std::vector<flat_face> *out)
{
    for (const value &reference : shell[0].list)
        take_face(in, in.statements.get(reference), out);
}

/* --- face sets: faces as indices into a list of points */

polygon picked(const polygon &points, const value &indices, const value &renumbered)
{
    polygon out;
    for (const value &index : indices.list) {
        double at = file::number(index);
        if (!renumbered.list.empty()) {
            if (at < 1 || at > static_cast<double>(renumbered.list.size()))
                throw unsupported("this IFC shape cannot be built: a face has an index outside the list of points");
            at = file::number(renumbered.list[static_cast<size_t>(at) - 1]);
        }
        if (at < 1 || at > static_cast<double>(points.size()))
            throw unsupported("this IFC shape cannot be built: a face has an index outside the list of points");
        out.push_back(points[static_cast<size_t>(at) - 1]);
    }
    return out;
}

void take_face_set(const ifc_model &in, const entity &item, std::vector<flat_face> *out)
{
    polygon points = points_of(in, item[0]);
    if (item.is("IFCTRIANGULATEDFACESET")) {
        for (const value &corners : item[3].list)
            out->push_back({ picked(points, corners, item[4]), {} });
        return;
    }
    for (const value &reference : item[2].list) {
        entity face = in.statements.get(reference);
        out->push_back({ picked(points, face[0], item[3]), {} });
        for (const value &hole : face[1].list)
            out->back().holes.push_back(picked(points, hole, item[3]));
    }
}

} // namespace

bool has_flat_faces(const std::string &type)
{
    return type == "IFCFACETEDBREP" || type == "IFCFACETEDBREPWITHVOIDS" || type == "IFCFACEBASEDSURFACEMODEL" ||
           type == "IFCSHELLBASEDSURFACEMODEL" || type == "IFCTRIANGULATEDFACESET" || type == "IFCPOLYGONALFACESET";
}

bool has_edges(const ifc_model &in, const entity &item)
{
    if (item.type.find("SURFACEMODEL") == std::string::npos)
        return false;
    entity shell = in.statements.get(item[0].list.at(0)), face = in.statements.get(shell[0].list.at(0));
    return in.statements.get(in.statements.get(face[0].list.at(0))[0]).is("IFCEDGELOOP");
}

TopoDS_Shape flat_faces_of(const ifc_model &in, const entity &item)
{
    std::vector<flat_face> faces;
    if (item.type.find("FACESET") != std::string::npos) {
        take_face_set(in, item, &faces);
    } else if (item.type.compare(0, 14, "IFCFACETEDBREP") == 0) {
        take_shell(in, in.statements.get(item[0]), &faces);
        for (const value &reference : item[1].list)
            take_shell(in, in.statements.get(reference), &faces);
    } else {
        for (const value &reference : item[0].list)
            take_shell(in, in.statements.get(reference), &faces);
    }
    return joined(faces);
}

} // namespace ifc
