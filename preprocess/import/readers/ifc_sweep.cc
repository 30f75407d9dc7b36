/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sweeps profiles and disks (pipes) along curves. */
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepOffsetAPI_MakePipe.hxx>
#include <BRepOffsetAPI_MakePipeShell.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <Geom_Circle.hxx>
#include <Geom_Line.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <gp_Circ.hxx>
#include <gp_Pln.hxx>

#include <cmath>

#include "preprocess/import/readers/ifc_shape.hh"

namespace ifc
{

namespace
{

/* allowed relative difference between a sweep's volume and area times length; tessellating circles with 24 corners alone loses 1.1 % */
constexpr double VOLUME_SLACK = 0.04;

TopoDS_Shape wire_swept(const TopoDS_Wire &outline, const TopoDS_Wire &spine, const gp_Dir *up)
{
    BRepOffsetAPI_MakePipeShell pipe(spine);
    if (up)
        pipe.SetMode(*up);
    pipe.SetTransitionMode(BRepBuilderAPI_RightCorner);
    pipe.Add(outline);
    if (!pipe.IsReady())
        throw unsupported("this IFC shape cannot be built: Open CASCADE cannot sweep its profile along the curve");
    pipe.Build();
    if (!pipe.IsDone())
        throw unsupported("this IFC shape cannot be built: Open CASCADE cannot sweep its profile along the curve");
    pipe.MakeSolid(); /* ignores the return value: MakeSolid() returns false for a closed curve, whose tube has no ends to close */
    return pipe.Shape();
}

/* Returns a placement at the start of the first piece, with its XY plane perpendicular to the piece. up: the X axis points as
 * far as possible in this direction; NULL: in any. */
gp_Trsf start_of(const std::vector<curve_piece> &pieces, const gp_Dir *up)
{
    gp_Dir along(pieces.front().tangent(false));
    gp_Trsf out;
    gp_Ax3 frame = up && !along.IsParallel(*up, 1e-6) ? gp_Ax3(pieces.front().start(), along, *up) : gp_Ax3(pieces.front().start(), along);
    out.SetTransformation(frame, gp_Ax3(gp::XOY()));
    return out;
}

TopoDS_Shape along(const TopoDS_Face &face, const std::vector<curve_piece> &pieces, const gp_Dir *x, const gp_Dir *up)
{
    TopoDS_Face placed = TopoDS::Face(BRepBuilderAPI_Transform(face, start_of(pieces, x), Standard_True).Shape());
    TopoDS_Wire spine = wire_of(pieces), outer = BRepTools::OuterWire(placed);
    TopoDS_Shape out = wire_swept(outer, spine, up);
    for (TopExp_Explorer wires(placed, TopAbs_WIRE); wires.More(); wires.Next())
        if (!wires.Current().IsSame(outer)) {
            BRepAlgoAPI_Cut cut(out, wire_swept(TopoDS::Wire(wires.Current()), spine, up));
            if (!cut.IsDone())
                throw unsupported("this IFC shape cannot be built: Open CASCADE cannot sweep its hollow profile along the curve");
            out = cut.Shape();
        }
    return out;
}

/* Sweeps a disk along one piece of a curve. Lines and arcs are exact. */
TopoDS_Shape along_piece(const TopoDS_Face &face, const curve_piece &part)
{
    TopoDS_Face placed = TopoDS::Face(BRepBuilderAPI_Transform(face, start_of({ part }, nullptr), Standard_True).Shape());
    Handle(Geom_Circle) circle = Handle(Geom_Circle)::DownCast(part.curve);
    if (part.curve->IsKind(STANDARD_TYPE(Geom_Line)))
        return BRepPrimAPI_MakePrism(placed, gp_Vec(part.start(), part.end())).Shape();
    if (circle.IsNull())
        return BRepOffsetAPI_MakePipe(wire_of({ part }), placed).Shape();
    gp_Ax1 axis = part.first > part.last ? circle->Axis().Reversed() : circle->Axis();
    double angle = std::fabs(part.last - part.first);
    return angle > 2 * M_PI - 1e-9 ? BRepPrimAPI_MakeRevol(placed, axis).Shape() : BRepPrimAPI_MakeRevol(placed, axis, angle).Shape();
}

TopoDS_Shape disks_along(const TopoDS_Face &face, const std::vector<curve_piece> &pieces)
{
    TopoDS_Compound out;
    BRep_Builder builder;
    builder.MakeCompound(out);
    for (const curve_piece &part : pieces)
        builder.Add(out, along_piece(face, part));
    return out;
}

TopoDS_Shape pipe(const TopoDS_Face &face, const std::vector<curve_piece> &pieces)
{
    TopoDS_Face placed = TopoDS::Face(BRepBuilderAPI_Transform(face, start_of(pieces, nullptr), Standard_True).Shape());
    return BRepOffsetAPI_MakePipe(wire_of(pieces), placed).Shape();
}

TopoDS_Shape mitred(const TopoDS_Face &face, const std::vector<curve_piece> &pieces)
{
    return along(face, pieces, nullptr, nullptr);
}

/* Sweeps a disk along all pieces of a curve. The volume must be area times length: if a sweeping method gives another volume,
 * some triangles are wrong, and the next method is tried. The last method sweeps each piece separately, with closed ends and
 * without mitred corners. */
TopoDS_Shape disk_along(const ifc_model &in, const TopoDS_Face &face, double area, const std::vector<curve_piece> &pieces)
{
    using way = TopoDS_Shape (*)(const TopoDS_Face &, const std::vector<curve_piece> &);
    double expected = 0;
    for (const curve_piece &part : pieces)
        expected += area * length_of(part);
    for (way sweep : { way(pipe), way(mitred), way(disks_along) })
        try {
            TopoDS_Shape out = sweep(face, pieces);
            double volume = volume_of(triangles_of(in, out));
            if (std::fabs(volume - expected) < VOLUME_SLACK * expected)
                return out;
            if (std::fabs(volume + expected) < VOLUME_SLACK * expected)
                return out.Reversed();
        } catch (const Standard_Failure &) { /* this sweeping method failed: the loop tries the next one */
        } catch (const unsupported &) {
        }
    throw unsupported("this IFC shape cannot be built: Open CASCADE cannot sweep the pipe along its curve");
}

TopoDS_Face disk(double radius, double hole)
{
    auto circle = [](double r) { return TopoDS_Wire(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Circ(gp::XOY(), r)).Edge())); };
    BRepBuilderAPI_MakeFace face(gp_Pln(gp::XOY()), circle(radius));
    if (hole > 0)
        face.Add(TopoDS::Wire(circle(hole).Reversed()));
    return face.Face();
}

} // namespace

TopoDS_Shape swept(const std::vector<TopoDS_Face> &faces, const std::vector<curve_piece> &pieces, const gp_Dir &x, const gp_Dir &up)
{
    if (faces.size() == 1)
        return along(faces[0], pieces, &x, &up);
    TopoDS_Compound out;
    BRep_Builder builder;
    builder.MakeCompound(out);
    for (const TopoDS_Face &face : faces)
        builder.Add(out, along(face, pieces, &x, &up));
    return out;
}

TopoDS_Shape disk_of(const ifc_model &in, const entity &item)
{
    double radius = in.length * file::number(item[1]), hole = in.length * file::number(item[2], 0);
    double fillet = item.is("IFCSWEPTDISKSOLIDPOLYGONAL") ? in.length * file::number(item[5], 0) : 0;
    bool whole = false;
    if (radius <= 0 || hole >= radius)
        throw unsupported("this IFC shape cannot be built: the outer radius of the pipe is 0, or not larger than its inner radius");
    std::vector<curve_piece> pieces = trimmed(pieces_of(in, in.statements.get(item[0])), item[3], item[4], &whole);
    if (whole)
        printf(
            "error\t1\tIFC statement #%d: the start and end parameters are beyond the curve, so the solid is built along the whole curve\n",
            item.id);
    if (fillet > 0) {
        std::vector<gp_Pnt> points = { pieces.front().start() };
        for (const curve_piece &part : pieces)
            points.push_back(part.end());
        pieces = rounded(points, { fillet }, false);
    }
    return disk_along(in, disk(radius, hole), M_PI * (radius * radius - hole * hole), pieces);
}

} // namespace ifc
