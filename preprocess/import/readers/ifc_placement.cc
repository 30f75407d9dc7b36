/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the placements of IFC objects, and rewrites placements in a grid, which web-ifc does not compute, as local placements. */
#include <GeomAPI.hxx>
#include <Geom2dAPI_InterCurveCurve.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <Geom_Circle.hxx>
#include <Geom_Line.hxx>
#include <gp_Ax3.hxx>
#include <gp_Pln.hxx>

#include <cmath>

#include "preprocess/import/readers/ifc_shape.hh"

namespace ifc
{

namespace
{

constexpr double NEAR_MM = 1e-6; /* tolerance of intersections, millimetres */
constexpr size_t AXES = 7, AXES_END = 10; /* indices of the axis lists in an IFCGRID statement; the index of its placement is 5 */

/* An intersection of two grid axes, and the direction of the first axis there. */
struct crossing {
    gp_Pnt at;
    gp_Vec along;
};

/* Returns the curves of an IfcGridAxis, moved to the left by `offset_mm`. */
std::vector<curve_piece> axis_of(const ifc_model &in, const entity &axis, double offset_mm)
{
    std::vector<curve_piece> out = pieces_of(in, in.statements.get(axis[1]));
    for (curve_piece &piece : out) {
        if (axis[2].is(".F."))
            std::swap(piece.first, piece.last);
        gp_Vec left = gp_Vec(gp::DZ()).Crossed(piece.tangent(false)) * offset_mm;
        Handle(Geom_Circle) circle = Handle(Geom_Circle)::DownCast(piece.curve);
        if (std::fabs(offset_mm) <= NEAR_MM)
            continue;
        if (!circle.IsNull())
            circle->SetRadius(circle->Radius() + left.Dot(gp_Vec(circle->Location(), piece.start()).Normalized()));
        else if (piece.curve->IsKind(STANDARD_TYPE(Geom_Line)))
            piece.curve->Translate(left);
        else
            throw unsupported("this IFC placement cannot be computed: Plantcast does not support an offset from a grid axis that is "
                              "neither a line nor an arc");
    }
    return out;
}

Handle(Geom2d_Curve) in_plane(const curve_piece &piece, bool whole)
{
    Handle(Geom2d_Curve) curve = GeomAPI::To2d(piece.curve, gp_Pln(gp::XOY()));
    if (whole)
        return curve;
    return new Geom2d_TrimmedCurve(curve, std::fmin(piece.first, piece.last), std::fmax(piece.first, piece.last));
}

/* Finds the first intersection of two grid axes. whole: also beyond the ends of the axes. */
bool find_crossing(const std::vector<curve_piece> &first, const std::vector<curve_piece> &second, bool whole, crossing *out)
{
    for (const curve_piece &one : first)
        for (const curve_piece &other : second) {
            Geom2dAPI_InterCurveCurve both(in_plane(one, whole), in_plane(other, whole), NEAR_MM);
            if (both.NbPoints() < 1)
                continue;
            gp_Pnt2d at = both.Point(1);
            gp_Pnt on_first;
            one.curve->D1(both.Intersector().Point(1).ParamOnFirst(), on_first, out->along);
            out->at = gp_Pnt(at.X(), at.Y(), on_first.Z());
            if (one.first > one.last)
                out->along.Reverse();
            return true;
        }
    return false;
}

crossing crossing_of(const ifc_model &in, const value &reference)
{
    entity from = in.statements.get(reference);
    if (!from.is("IFCVIRTUALGRIDINTERSECTION") || from[0].list.size() != 2)
        throw unsupported("this IFC placement cannot be computed: Plantcast does not support " + from.type);
    auto offset = [&](size_t i) { return i < from[1].list.size() ? in.length * file::number(from[1].list[i]) : 0; };
    std::vector<curve_piece> axes[2];
    for (size_t i = 0; i < 2; i++)
        axes[i] = axis_of(in, in.statements.get(from[0].list[i]), offset(i));
    crossing out;
    bool lines = axes[0].size() == 1 && axes[1].size() == 1;
    if (!find_crossing(axes[0], axes[1], false, &out) && (!lines || !find_crossing(axes[0], axes[1], true, &out)))
        throw unsupported("this IFC placement cannot be computed: the two grid axes do not meet");
    out.at.Translate(gp_Vec(0, 0, offset(2)));
    return out;
}

/* Returns the id of the placement of the grid that contains an axis, or 0. */
int grid_placement(const ifc_model &in, int axis)
{
    auto found = in.grids.find(axis);
    if (found == in.grids.end() && in.lacks_grid)
        throw unsupported("this IFC placement cannot be computed: its grid is damaged");
    return found == in.grids.end() ? 0 : found->second;
}

/* An IFC placement: the transform `place` relative to the placement `above`; `above` absent: relative to the origin of the IFC
   file. */
struct relative_placement {
    value above;
    gp_Trsf place;
};

relative_placement in_grid(const ifc_model &in, const entity &from)
{
    /* IFC 4.3 inserts a first value into the statement: the placement that this one is relative to */
    size_t at = from.values.size() > 2 ? 1 : 0;
    crossing origin = crossing_of(in, from[at]);
    relative_placement out;
    if (at > 0)
        out.above = from[0];
    int grid = out.above.absent() ? grid_placement(in, in.statements.get(from[at])[0].list[0].id) : 0;
    if (grid > 0) {
        out.above.kind = value::REFERENCE;
        out.above.id = grid;
    }
    gp_Vec x = origin.along;
    if (!from[at + 1].absent() && in.statements.get(from[at + 1]).is("IFCDIRECTION"))
        x = gp_Vec(direction_of(in, from[at + 1], gp::DX()));
    else if (!from[at + 1].absent())
        x = gp_Vec(origin.at, crossing_of(in, from[at + 1]).at);
    x.SetZ(0);
    if (x.Magnitude() < NEAR_MM)
        throw unsupported("this IFC placement cannot be computed: it has no direction");
    out.place.SetTransformation(gp_Ax3(origin.at, gp::DZ(), gp_Dir(x)), gp_Ax3(gp::XOY()));
    return out;
}

gp_Trsf placement_within(const ifc_model &in, const value &reference, int depth)
{
    if (reference.absent())
        return gp_Trsf();
    entity from = in.statements.get(reference);
    if (depth > MAX_CHAIN)
        throw unsupported("this IFC placement cannot be computed: placements refer to each other in a circle");
    if (from.is("IFCGRIDPLACEMENT")) {
        relative_placement grid = in_grid(in, from);
        return placement_within(in, grid.above, depth + 1) * grid.place;
    }
    bool linear = from.is("IFCLINEARPLACEMENT") && !from[2].absent();
    if (!from.is("IFCLOCALPLACEMENT") && !linear)
        throw unsupported("this IFC placement cannot be computed: Plantcast does not support " + from.type);
    return placement_within(in, from[0], depth + 1) * placement_of(in, from[linear ? 2 : 1]);
}

std::string numbers(const gp_XYZ &from, double unit)
{
    char out[128];
    snprintf(out, sizeof(out), "%#.15G,%#.15G,%#.15G", from.X() / unit, from.Y() / unit, from.Z() / unit);
    return out;
}

} // namespace

void add_grid(int id, ifc_model *out)
{
    try {
        entity grid = out->statements.get(id);
        for (size_t list = AXES; list < AXES_END && grid[5].id > 0; list++)
            for (const value &axis : grid[list].list)
                out->grids.insert({ axis.id, grid[5].id });
    } catch (const unsupported &) {
        out->lacks_grid = true;
    }
}

gp_Trsf object_placement(const ifc_model &in, const value &reference)
{
    return placement_within(in, reference, 0);
}

std::string as_local_placement(const ifc_model &in, const entity &from, int unused)
{
    relative_placement grid = in_grid(in, from);
    auto id = [unused](int i) { return "#" + std::to_string(unused + i); };
    gp_XYZ z = gp::DZ().Transformed(grid.place).XYZ(), x = gp::DX().Transformed(grid.place).XYZ();
    std::string above = grid.above.absent() ? "$" : "#" + std::to_string(grid.above.id);
    return "#" + std::to_string(from.id) + "=IFCLOCALPLACEMENT(" + above + "," + id(0) + ");" + id(0) + "=IFCAXIS2PLACEMENT3D(" + id(1) +
           "," + id(2) + "," + id(3) + ");" + id(1) + "=IFCCARTESIANPOINT((" + numbers(grid.place.TranslationPart(), in.length) + "));" +
           id(2) + "=IFCDIRECTION((" + numbers(z, 1) + "));" + id(3) + "=IFCDIRECTION((" + numbers(x, 1) + "));";
}

} // namespace ifc
