/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads points, placements and curves from an IFC file. A curve becomes a list of consecutive Open CASCADE curves (pieces). */
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <GC_MakeArcOfCircle.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_Circle.hxx>
#include <Geom_Ellipse.hxx>
#include <Geom_Line.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <Precision.hxx>
#include <ShapeExtend_WireData.hxx>
#include <ShapeFix_Wire.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TopoDS.hxx>
#include <gp_Ax2.hxx>
#include <gp_Ax3.hxx>

#include <cmath>

#include "preprocess/import/readers/ifc_shape.hh"

namespace ifc
{

namespace
{

/* length in millimetres below which a piece of a curve is dropped, because a profile cannot be swept along it */
constexpr double SHORTEST_MM = 1e-4;
/* largest gap in millimetres between two consecutive pieces of a curve whose ends are joined */
constexpr double JOINT_MM = 1;

std::vector<curve_piece> pieces_within(const ifc_model &in, const entity &curve, int depth);

gp_Pnt coordinates_of(const ifc_model &in, const value &from)
{
    double at[3] = { 0, 0, 0 };
    for (size_t i = 0; i < 3 && i < from.list.size(); i++)
        at[i] = in.length * file::number(from.list[i]);
    return { at[0], at[1], at[2] };
}

bool straight(const gp_Pnt &from, const gp_Pnt &to, double span, std::vector<curve_piece> *out)
{
    double length = from.Distance(to);
    if (length < Precision::Confusion())
        return false;
    out->push_back({ new Geom_Line(from, gp_Dir(gp_Vec(from, to))), 0, length, span });
    return true;
}

void add_arc(const gp_Pnt &from, const gp_Pnt &through, const gp_Pnt &to, std::vector<curve_piece> *out)
{
    GC_MakeArcOfCircle arc(from, through, to);
    if (!arc.IsDone()) { /* the three points are collinear, so there is no arc through them: use a straight line */
        straight(from, to, 1, out);
        return;
    }
    out->push_back({ arc.Value()->BasisCurve(), arc.Value()->FirstParameter(), arc.Value()->LastParameter(), 1 });
}

std::vector<curve_piece> polyline(const ifc_model &in, const value &points)
{
    std::vector<curve_piece> out;
    for (size_t i = 0; i + 1 < points.list.size(); i++)
        straight(point_of(in, points.list[i]), point_of(in, points.list[i + 1]), 1, &out);
    return out;
}

std::vector<curve_piece> indexed(const ifc_model &in, const entity &curve)
{
    std::vector<gp_Pnt> points = points_of(in, curve[0]);
    std::vector<curve_piece> out;
    for (size_t i = 0; curve[1].absent() && i + 1 < points.size(); i++)
        straight(points[i], points[i + 1], 1, &out);
    for (const value &segment : curve[1].list) {
        const std::vector<value> &indices = segment.list.empty() ? segment.list : segment.list[0].list;
        std::vector<gp_Pnt> at;
        for (const value &index : indices) {
            double number = file::number(index);
            if (number < 1 || number > static_cast<double>(points.size()))
                throw unsupported("this IFC shape cannot be built: a curve has an index outside its list of points");
            at.push_back(points[static_cast<size_t>(number) - 1]);
        }
        if (segment.text == "IFCARCINDEX" && at.size() == 3)
            add_arc(at[0], at[1], at[2], &out);
        else
            for (size_t i = 0; i + 1 < at.size(); i++)
                straight(at[i], at[i + 1], 1, &out);
    }
    return out;
}

/* Returns where a curve is trimmed, as a parameter in the curve's units. An IfcTrimmingSelect gives a parameter, a point on the
   curve, or both. by_point: if both are given, uses the point. */
double trim_at(const ifc_model &in, const curve_piece &basis, const value &select, bool by_point, double per_unit)
{
    const value *parameter = nullptr, *point = nullptr;
    for (const value &one : select.list)
        (one.kind == value::REFERENCE ? point : parameter) = &one;
    if (point && (by_point || !parameter)) {
        GeomAPI_ProjectPointOnCurve onto(point_of(in, *point), basis.curve);
        if (onto.NbPoints() < 1)
            throw unsupported("this IFC shape cannot be built: a trimming point of an IfcTrimmedCurve is not on its curve");
        return onto.LowerDistanceParameter();
    }
    if (!parameter)
        throw unsupported("this IFC shape cannot be built: an IfcTrimmedCurve lacks its trimming points");
    return file::number(*parameter) * per_unit;
}

/* Returns the whole basis curve of a trimmed curve as one piece. Throws `unsupported` if it has several pieces. */
curve_piece basis_of(const ifc_model &in, const entity &curve);

std::vector<curve_piece> trimmed_curve(const ifc_model &in, const entity &curve, int depth)
{
    entity from = in.statements.get(curve[0]);
    bool same = !curve[3].is(".F."), by_point = curve[4].is(".CARTESIAN.");
    if (from.is("IFCPOLYLINE") || from.is("IFCCOMPOSITECURVE") || from.is("IFCINDEXEDPOLYCURVE")) {
        bool whole = false;
        if (curve[1].list.empty() || curve[2].list.empty())
            throw unsupported("this IFC shape cannot be built: an IfcTrimmedCurve lacks its trimming points");
        std::vector<curve_piece> out = trimmed(pieces_within(in, from, depth + 1), curve[1].list[0], curve[2].list[0], &whole);
        if (whole || !same)
            throw unsupported("this IFC shape cannot be built: Plantcast does not support a trimmed or reversed " + from.type);
        return out;
    }
    curve_piece basis = basis_of(in, from);
    double per_unit = 1;
    if (from.is("IFCLINE"))
        per_unit = basis.last / basis.span;
    else if (from.is("IFCCIRCLE") || from.is("IFCELLIPSE"))
        per_unit = in.angle;
    double first = trim_at(in, basis, curve[1], by_point, per_unit), last = trim_at(in, basis, curve[2], by_point, per_unit);
    double turn = basis.curve->IsPeriodic() ? basis.curve->Period() : 0;
    if (turn > 0) {
        while (same && last <= first + Precision::PConfusion())
            last += turn;
        while (!same && last >= first - Precision::PConfusion())
            last -= turn;
        while (std::fabs(last - first) > turn + Precision::PConfusion())
            last += last > first ? -turn : turn;
    }
    return { { basis.curve, first, last, std::fabs(last - first) / per_unit } };
}

std::vector<curve_piece> composite(const ifc_model &in, const entity &curve, int depth)
{
    std::vector<curve_piece> out;
    for (const value &reference : curve[0].list) {
        entity segment = in.statements.get(reference);
        if (segment.type.compare(0, 24, "IFCCOMPOSITECURVESEGMENT") != 0 && !segment.is("IFCREPARAMETRISEDCOMPOSITECURVESEGMENT"))
            throw unsupported("this IFC shape cannot be built: Plantcast does not support " + segment.type);
        std::vector<curve_piece> parts = pieces_within(in, in.statements.get(segment[2]), depth + 1);
        if (segment[1].is(".F.")) {
            for (curve_piece &part : parts)
                std::swap(part.first, part.last);
            parts.assign(parts.rbegin(), parts.rend());
        }
        out.insert(out.end(), parts.begin(), parts.end());
    }
    return out;
}

Handle(Geom_Curve) spline(const ifc_model &in, const entity &curve)
{
    const std::vector<value> &points = curve[1].list, &counts = curve[5].list, &knots = curve[6].list;
    if (points.size() < 2 || counts.size() < 2 || counts.size() != knots.size())
        throw unsupported("this IFC shape cannot be built: a B-spline curve has too few points or knots");
    TColgp_Array1OfPnt poles(1, static_cast<int>(points.size()));
    TColStd_Array1OfReal weights(1, poles.Length()), at(1, static_cast<int>(knots.size()));
    TColStd_Array1OfInteger multiplicities(1, at.Length());
    bool rational = curve.is("IFCRATIONALBSPLINECURVEWITHKNOTS") && curve[8].list.size() == points.size();
    for (int i = 1; i <= poles.Length(); i++) {
        poles(i) = point_of(in, points[static_cast<size_t>(i) - 1]);
        weights(i) = rational ? file::number(curve[8].list[static_cast<size_t>(i) - 1]) : 1;
    }
    for (int i = 1; i <= at.Length(); i++) {
        at(i) = file::number(knots[static_cast<size_t>(i) - 1]);
        multiplicities(i) = static_cast<int>(file::number(counts[static_cast<size_t>(i) - 1]));
    }
    return new Geom_BSplineCurve(poles, weights, at, multiplicities, static_cast<int>(file::number(curve[0])));
}

curve_piece basis_of(const ifc_model &in, const entity &curve)
{
    const double turn = 2 * M_PI;
    if (curve.is("IFCLINE")) {
        entity vector = in.statements.get(curve[1]);
        gp_Dir along = direction_of(in, vector[0], gp::DX());
        return { new Geom_Line(point_of(in, curve[0]), along), 0, in.length *file::number(vector[1]), 1 };
    }
    if (curve.is("IFCCIRCLE")) {
        Handle(Geom_Circle) circle = new Geom_Circle(gp::XOY(), in.length * file::number(curve[1]));
        circle->Transform(placement_of(in, curve[0]));
        return { circle, 0, turn, turn / in.angle };
    }
    if (curve.is("IFCELLIPSE")) {
        double a = in.length * file::number(curve[1]), b = in.length * file::number(curve[2]);
        if (a < b)
            throw unsupported(
                "this IFC shape cannot be built: Plantcast does not support an IfcEllipse whose SemiAxis2 is longer than SemiAxis1");
        Handle(Geom_Ellipse) ellipse = new Geom_Ellipse(gp::XOY(), a, b);
        ellipse->Transform(placement_of(in, curve[0]));
        return { ellipse, 0, turn, turn / in.angle };
    }
    if (curve.is("IFCBSPLINECURVEWITHKNOTS") || curve.is("IFCRATIONALBSPLINECURVEWITHKNOTS")) {
        Handle(Geom_Curve) made = spline(in, curve);
        return { made, made->FirstParameter(), made->LastParameter(), made->LastParameter() - made->FirstParameter() };
    }
    throw unsupported("this IFC shape cannot be built: Plantcast does not support " + curve.type);
}

std::vector<curve_piece> pieces_within(const ifc_model &in, const entity &curve, int depth)
{
    if (depth > MAX_CHAIN)
        throw unsupported("this IFC shape cannot be built: curves refer to each other in a circle");
    if (curve.is("IFCPOLYLINE"))
        return polyline(in, curve[0]);
    if (curve.is("IFCINDEXEDPOLYCURVE"))
        return indexed(in, curve);
    if (curve.is("IFCTRIMMEDCURVE"))
        return trimmed_curve(in, curve, depth);
    if (is_alignment(in, curve))
        return alignment_of(in, curve);
    if (curve.is("IFCCOMPOSITECURVE"))
        return composite(in, curve, depth);
    return { basis_of(in, curve) };
}

} // namespace

double length_of(const curve_piece &part)
{
    return GCPnts_AbscissaPoint::Length(GeomAdaptor_Curve(part.curve), std::fmin(part.first, part.last), std::fmax(part.first, part.last));
}

double distance_of(const curve_piece &part)
{
    return part.level_mm > 0 ? part.level_mm : length_of(part);
}

gp_Pnt curve_piece::start() const
{
    return curve->Value(first);
}
gp_Pnt curve_piece::end() const
{
    return curve->Value(last);
}

gp_Vec curve_piece::tangent(bool at_end) const
{
    gp_Pnt at;
    gp_Vec along;
    curve->D1(at_end ? last : first, at, along);
    if (along.Magnitude() < Precision::Confusion())
        along = gp_Vec(start(), end());
    if (along.Magnitude() < Precision::Confusion())
        throw unsupported("this IFC shape cannot be built: a curve has no length");
    return first > last ? -along.Normalized() : along.Normalized();
}

gp_Pnt point_of(const ifc_model &in, const value &reference)
{
    entity point = in.statements.get(reference);
    if (!point.is("IFCCARTESIANPOINT"))
        throw unsupported("this IFC shape cannot be built: Plantcast does not support " + point.type);
    return coordinates_of(in, point[0]);
}

std::vector<gp_Pnt> points_of(const ifc_model &in, const value &reference)
{
    std::vector<gp_Pnt> out;
    entity list = in.statements.get(reference);
    for (const value &at : list[0].list)
        out.push_back(coordinates_of(in, at));
    return out;
}

gp_Dir direction_of(const ifc_model &in, const value &reference, const gp_Dir &otherwise)
{
    double at[3] = { 0, 0, 0 };
    if (reference.absent())
        return otherwise;
    entity direction = in.statements.get(reference);
    for (size_t i = 0; i < 3 && i < direction[0].list.size(); i++)
        at[i] = file::number(direction[0].list[i]);
    if (std::hypot(at[0], at[1], at[2]) < Precision::Confusion())
        return otherwise;
    return { at[0], at[1], at[2] };
}

/* Returns a frame with the given Z axis, and an X axis as close to direction `x` as possible. */
static gp_Ax3 frame_of(const gp_Pnt &origin, const gp_Dir &z, const gp_Dir &x)
{
    return z.IsParallel(x, 1e-9) ? gp_Ax3(origin, z) : gp_Ax3(origin, z, x);
}

gp_Trsf placement_of(const ifc_model &in, const value &reference)
{
    gp_Trsf out;
    if (reference.absent())
        return out;
    entity from = in.statements.get(reference);
    bool flat = from.is("IFCAXIS2PLACEMENT2D");
    gp_Dir z = flat ? gp::DZ() : direction_of(in, from[1], gp::DZ()), x = direction_of(in, from[flat ? 1 : 2], gp::DX());
    if (!flat && !from.is("IFCAXIS2PLACEMENT3D"))
        throw unsupported("this IFC shape cannot be built: Plantcast does not support " + from.type);
    out.SetTransformation(frame_of(point_of(in, from[0]), z, x), gp_Ax3(gp::XOY()));
    return out;
}

gp_GTrsf operator_of(const ifc_model &in, const entity &from)
{
    bool flat = from.type.find("OPERATOR2D") != std::string::npos;
    gp_Dir x = direction_of(in, from[0], gp::DX()), z = flat ? gp::DZ() : direction_of(in, from[4], gp::DZ());
    if (!flat && from[0].absent() && !from[4].absent())
        x = gp_Ax3(gp::Origin(), z).XDirection();
    if (!flat && !z.IsParallel(x, 1e-9)) /* makes the X axis perpendicular to the Z axis */
        x = gp_Ax3(gp::Origin(), z, x).XDirection();
    gp_Dir square = z.Crossed(x);
    double side = square.Dot(direction_of(in, from[1], square)) >= 0 ? 1 : -1; /* -1: the transform mirrors */
    double scale = file::number(from[3], 1);
    const double scales[3] = { scale, file::number(from[flat ? 4 : 5], scale), flat ? 1 : file::number(from[6], scale) };
    const gp_XYZ axes[3] = { x.XYZ(), square.XYZ() * side, z.XYZ() };
    gp_GTrsf out;
    for (int column = 1; column <= 3; column++)
        for (int row = 1; row <= 3; row++)
            out.SetValue(row, column, axes[column - 1].Coord(row) * scales[column - 1]);
    gp_Pnt origin = point_of(in, from[2]);
    out.SetTranslationPart(origin.XYZ());
    return out;
}

std::vector<curve_piece> pieces_of(const ifc_model &in, const entity &curve)
{
    std::vector<curve_piece> out;
    for (const curve_piece &part : pieces_within(in, curve, 0))
        if (length_of(part) > SHORTEST_MM)
            out.push_back(part);
    if (out.empty())
        throw unsupported("this IFC shape cannot be built: a curve has no length");
    return out;
}

std::vector<curve_piece> trimmed(const std::vector<curve_piece> &pieces, const value &from, const value &to, bool *whole)
{
    double total = 0;
    for (const curve_piece &part : pieces)
        total += part.span;
    double first = file::number(from, 0), last = file::number(to, total), slack = 1e-5 * total;
    if (std::fabs(first) <= slack && std::fabs(last - total) <= slack)
        return pieces;
    if (first < -slack || last > total + slack || first >= last) {
        *whole = true;
        return pieces;
    }
    std::vector<curve_piece> out;
    double at = 0;
    for (const curve_piece &part : pieces) {
        double low = std::fmax(0, (first - at) / part.span), high = std::fmin(1, (last - at) / part.span);
        at += part.span;
        if (high - low < 1e-9)
            continue;
        double length = part.last - part.first;
        out.push_back({ part.curve, part.first + low * length, part.first + high * length, (high - low) * part.span,
                        (high - low) * part.level_mm });
    }
    return out;
}

std::vector<curve_piece> rounded(const std::vector<gp_Pnt> &points, const std::vector<double> &radii, bool closed)
{
    std::vector<curve_piece> out;
    size_t count = points.size();
    /* by corner: where the arc that rounds the corner begins and ends on the corner's two lines */
    std::vector<gp_Pnt> before = points, after = points;
    for (size_t i = closed ? 0 : 1; i + (closed ? 0 : 1) < count; i++) {
        gp_Vec in(points[i], points[(i + count - 1) % count]), on(points[i], points[(i + 1) % count]);
        double radius = radii.empty() ? 0 : radii[i % radii.size()], angle = in.Angle(on);
        if (radius < Precision::Confusion() || angle > M_PI - 1e-6 || angle < 1e-6)
            continue;
        double back = std::fmin(radius / std::tan(angle / 2), std::fmin(in.Magnitude(), on.Magnitude()) / (closed ? 2 : 1));
        before[i] = points[i].Translated(in.Normalized() * back);
        after[i] = points[i].Translated(on.Normalized() * back);
    }
    for (size_t i = 0; i < count; i++) {
        if (before[i].Distance(after[i]) > Precision::Confusion()) {
            gp_Vec middle(points[i], gp_Pnt((before[i].XYZ() + after[i].XYZ()) / 2));
            double half = before[i].Distance(after[i]) / 2, back = before[i].Distance(points[i]), radius = back * half / middle.Magnitude();
            gp_Pnt centre = points[i].Translated(middle.Normalized() * std::hypot(back, radius));
            add_arc(before[i], centre.Translated(gp_Vec(centre, points[i]).Normalized() * radius), after[i], &out);
        }
        if (i + 1 < count || closed)
            straight(after[i], before[(i + 1) % count], 1, &out);
    }
    return out;
}

TopoDS_Wire wire_of(const std::vector<curve_piece> &pieces)
{
    Handle(ShapeExtend_WireData) data = new ShapeExtend_WireData;
    for (const curve_piece &part : pieces) {
        double low = std::fmin(part.first, part.last), high = std::fmax(part.first, part.last);
        BRepBuilderAPI_MakeEdge edge(part.curve, low, high);
        if (!edge.IsDone())
            throw unsupported("this IFC shape cannot be built: a curve has no length");
        data->Add(part.first > part.last ? TopoDS::Edge(edge.Edge().Reversed()) : edge.Edge());
    }
    for (size_t i = 0; i + 1 < pieces.size(); i++)
        if (pieces[i].end().Distance(pieces[i + 1].start()) > JOINT_MM)
            throw unsupported("this IFC shape cannot be built: a curve has gaps");
    Handle(ShapeFix_Wire) fix = new ShapeFix_Wire;
    fix->Load(data);
    fix->SetPrecision(Precision::Confusion());
    fix->SetMaxTolerance(JOINT_MM);
    fix->ClosedWireMode() = pieces.front().start().Distance(pieces.back().end()) < 1e-3;
    fix->FixConnected();
    fix->FixGaps3d();
    return fix->WireAPIMake().IsNull() ? fix->Wire() : fix->WireAPIMake();
}

} // namespace ifc
