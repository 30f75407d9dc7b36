/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts shapes to triangles. */
#include <BRep_Tool.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

#include <cmath>

#include "preprocess/import/readers/ifc_shape.hh"
#include "preprocess/import/readers/occt_mesh.hh"

namespace ifc
{

namespace
{

/* largest angle between neighbouring facets of a curved surface: 24 facets per circle, as in web-ifc */
constexpr double ANGLE_RAD = M_PI / 12;

void take_face(const TopoDS_Face &face, triangles *to)
{
    TopLoc_Location place;
    Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, place);
    if (mesh.IsNull())
        throw unsupported("this IFC shape cannot be built: Open CASCADE could not tessellate one of its faces");
    const gp_Trsf &moved = place.Transformation();
    bool reversed = (face.Orientation() == TopAbs_REVERSED) != moved.IsNegative();
    uint32_t first = static_cast<uint32_t>(to->points.size());
    mesh->ComputeNormals();
    for (int i = 1; i <= mesh->NbNodes(); i++) {
        gp_Vec normal = gp_Vec(mesh->Normal(i)).Transformed(moved);
        to->points.push_back(mesh->Node(i).Transformed(moved));
        to->normals.push_back(reversed ? -normal : normal);
    }
    for (int i = 1; i <= mesh->NbTriangles(); i++) {
        int at[3];
        mesh->Triangle(i).Get(at[0], at[1], at[2]);
        if (reversed)
            std::swap(at[1], at[2]);
        for (int corner : at)
            to->corners.push_back(first + static_cast<uint32_t>(corner - 1));
    }
}

} // namespace

triangles triangles_of(const ifc_model &in, const TopoDS_Shape &shape)
{
    triangles out;
    occt_tessellate(shape, in.chord_mm, ANGLE_RAD, false);
    for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next())
        take_face(TopoDS::Face(faces.Current()), &out);
    if (out.corners.empty())
        throw unsupported("this IFC shape cannot be built: none of its faces has triangles");
    for (const gp_Pnt &at : out.points)
        if (!std::isfinite(at.X()) || !std::isfinite(at.Y()) || !std::isfinite(at.Z()))
            throw unsupported("this IFC shape cannot be built: one of its coordinates is infinite or not a number");
    return out;
}

double volume_of(const triangles &all)
{
    double volume = 0;
    const gp_Pnt origin = all.points.empty() ? gp_Pnt() : all.points[0];
    for (size_t i = 0; i + 2 < all.corners.size(); i += 3) {
        gp_Vec a(origin, all.points[all.corners[i]]), b(origin, all.points[all.corners[i + 1]]), c(origin, all.points[all.corners[i + 2]]);
        volume += a.DotCross(b, c) / 6;
    }
    return volume;
}

} // namespace ifc
