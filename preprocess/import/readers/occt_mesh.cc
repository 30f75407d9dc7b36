/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tessellates with BRepMesh, which leaves out faces whose boundary it cannot unfold into a plane, such as a cone that includes
 * its apex. Most of these faces can be tessellated after conversion to B-spline surfaces. */
#include "preprocess/import/readers/occt_mesh.hh"

#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

#include <cmath>

namespace
{

/* area in square millimetres below which the loss of a face is not counted, because the face is too small to be seen */
constexpr double LEAST_MM2 = 1e-6;

Handle(Poly_Triangulation) triangles_of(const TopoDS_Face &face, TopLoc_Location *place)
{
    Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, *place);
    return mesh.IsNull() || mesh->NbTriangles() == 0 ? Handle(Poly_Triangulation)() : mesh;
}

bool is_tessellated(const TopoDS_Face &face)
{
    TopLoc_Location place;
    return !triangles_of(face, &place).IsNull();
}

void mesh(const TopoDS_Shape &shape, double chord_mm, double angle_rad, bool parallel)
{
    try {
        BRepMesh_IncrementalMesh(shape, chord_mm, Standard_False, angle_rad, parallel);
    } catch (const Standard_Failure &) {
        /* a failed tessellation is not reported here, because the caller looks for faces without triangles anyway */
    }
}

void mesh_as_spline(const TopoDS_Face &face, double chord_mm, double angle_rad)
{
    try {
        TopoDS_Face plain = TopoDS::Face(face.Located(TopLoc_Location()).Oriented(TopAbs_FORWARD));
        TopoDS_Shape spline = BRepBuilderAPI_NurbsConvert(plain, Standard_True).Shape();
        TopExp_Explorer faces(spline, TopAbs_FACE);
        mesh(spline, chord_mm, angle_rad, false);
        TopLoc_Location place;
        Handle(Poly_Triangulation) found = faces.More() ? triangles_of(TopoDS::Face(faces.Current()), &place) : nullptr;
        if (found.IsNull())
            return;
        for (int i = 1; i <= found->NbNodes(); i++)
            found->SetNode(i, found->Node(i).Transformed(place.Transformation()));
        found->RemoveUVNodes(); /* remove the surface parameters: they belong to the B-spline surface, not to the original one */
        found->ComputeNormals();
        BRep_Builder().UpdateFace(plain, found);
    } catch (const Standard_Failure &) {
        return;
    }
}

/* Returns the area of a face in mm2, or 0 if Open CASCADE cannot compute it. */
double area_of(const TopoDS_Face &face)
{
    try {
        GProp_GProps of;
        BRepGProp::SurfaceProperties(face, of);
        return std::isfinite(of.Mass()) ? std::fabs(of.Mass()) : 0;
    } catch (const Standard_Failure &) {
        return 0;
    }
}

} // namespace

mesh_outcome occt_tessellate(const TopoDS_Shape &shape, double chord_mm, double angle_rad, bool parallel)
{
    mesh_outcome out;
    mesh(shape, chord_mm, angle_rad, parallel);
    for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next()) {
        const TopoDS_Face &face = TopoDS::Face(faces.Current());
        double area = is_tessellated(face) ? 0 : area_of(face);
        out.faces++;
        if (area > LEAST_MM2)
            mesh_as_spline(face, chord_mm, angle_rad);
        out.missing += area > LEAST_MM2 && !is_tessellated(face);
    }
    return out;
}
