/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds IFC 4.3 alignments: plan curves made of curve segments, and gradient curves, which add heights to a plan curve. */
#include <GeomAPI_Interpolate.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_Circle.hxx>
#include <Geom_Line.hxx>
#include <TColStd_HArray1OfReal.hxx>
#include <TColgp_HArray1OfPnt.hxx>

#include <algorithm>
#include <cmath>

#include "preprocess/import/readers/ifc_shape.hh"

namespace ifc
{

namespace
{

constexpr double STEP_RAD = 0.05;    /* largest change of a curve's direction between two interpolated points, in radians */
constexpr double MOST_TURN_RAD = 50; /* maximum change of direction along one alignment segment, in radians */
constexpr double LEAST_MM = 1e-3;    /* length in millimetres below which a segment only marks the end of its curve */
/* largest distance in millimetres between the start of an alignment's plan curve and the point where its grades (pieces of the
   height profile) begin */
constexpr double JOINT_MM = 1;

/* A segment of an alignment's plan curve. turn(d): direction at d millimetres from its start minus the direction at the start,
 * in radians. */
struct plan_segment {
    gp_XY start;
    double heading_rad, length_mm;
    std::function<double(double)> turn;
    bool straight;
};

/* One grade of an alignment; it ends where the next grade begins. height(d): height in millimetres, and slope, at d millimetres
 * after at_mm. at_mm: length along the plan curve at which the grade begins. */
struct grade {
    double at_mm;
    std::function<gp_XY(double)> height;
    bool straight;
};

/* The values of an IfcCurveSegment. */
struct segment_values {
    entity parent;
    gp_XY start;
    /* from_mm: where the segment starts, as a length along its parent curve; length_mm: negative if the segment runs against
     * the parent curve's direction */
    double heading_rad, from_mm, length_mm;
};

/* Converts an IFC measure (a length or a parameter of the parent curve) to a length along the parent curve in millimetres. */
double measure_of(const ifc_model &in, const entity &parent, const value &measure)
{
    double number = file::number(measure);
    if (measure.text != "IFCPARAMETERVALUE")
        return in.length * number;
    if (parent.is("IFCLINE"))
        return in.length * number * file::number(in.statements.get(parent[1])[1]);
    if (parent.is("IFCCIRCLE"))
        return in.length * file::number(parent[1]) * in.angle * number;
    if (number != 0)
        throw unsupported("this IFC shape cannot be built: Plantcast does not support lengths given as parameters of " + parent.type);
    return 0;
}

segment_values segment_of(const ifc_model &in, const value &reference)
{
    entity segment = in.statements.get(reference);
    if (!segment.is("IFCCURVESEGMENT"))
        throw unsupported("this IFC shape cannot be built: Plantcast does not support " + segment.type);
    gp_Trsf place = placement_of(in, segment[1]);
    if (!gp::DZ().Transformed(place).IsEqual(gp::DZ(), 1e-9))
        throw unsupported(
            "this IFC shape cannot be built: Plantcast does not support alignment segments that are tilted out of their plane");
    gp_Dir along = gp::DX().Transformed(place);
    gp_XYZ at = place.TranslationPart();
    entity parent = in.statements.get(segment[4]);
    double from = measure_of(in, parent, segment[2]), length = measure_of(in, parent, segment[3]);
    return { parent, { at.X(), at.Y() }, std::atan2(along.Y(), along.X()), from, length };
}

/* --- the plan */

/* Returns a function that maps a length from the parent curve's origin to the curve's direction there, in radians. */
std::function<double(double)> heading_of(const ifc_model &in, const entity &parent)
{
    if (parent.is("IFCLINE"))
        return [](double) { return 0; };
    /* radius if the parent curve is a circle, constant if it is a clothoid; in millimetres */
    double size = in.length * file::number(parent[1]);
    if (!(std::fabs(size) > LEAST_MM))
        throw unsupported("this IFC shape cannot be built: in its alignment, the radius of an arc or clothoid is missing or 0");
    if (parent.is("IFCCIRCLE"))
        return [size](double s) { return s / size; };
    if (parent.is("IFCCLOTHOID"))
        return [size](double s) { return std::copysign(s * s / (2 * size * size), size); };
    throw unsupported("this IFC shape cannot be built: Plantcast does not support " + parent.type);
}

plan_segment plan_segment_of(const ifc_model &in, const segment_values &from)
{
    std::function<double(double)> heading = heading_of(in, from.parent);
    double start = from.from_mm, way = from.length_mm < 0 ? -1 : 1;
    auto turn = [=](double d) { return heading(start + way * d) - heading(start); };
    return { from.start, from.heading_rad, std::fabs(from.length_mm), turn, from.parent.is("IFCLINE") };
}

/* Converts a piece of a curve to a segment of a plan curve. Throws `unsupported` unless the piece is a line or an arc. */
plan_segment plan_segment_of(const curve_piece &piece)
{
    gp_Vec along = piece.tangent(false);
    Handle(Geom_Circle) circle = Handle(Geom_Circle)::DownCast(piece.curve);
    if (circle.IsNull() && !piece.curve->IsKind(STANDARD_TYPE(Geom_Line)))
        throw unsupported(
            "this IFC shape cannot be built: the horizontal layout of its alignment may contain only lines, arcs and clothoids");
    double curvature = circle.IsNull() ? 0 : (circle->Axis().Direction().Z() > 0) == (piece.last > piece.first) ? 1 : -1;
    curvature /= circle.IsNull() ? 1 : circle->Radius();
    auto turn = [curvature](double d) { return curvature * d; };
    return { { piece.start().X(), piece.start().Y() }, std::atan2(along.Y(), along.X()), length_of(piece), turn, circle.IsNull() };
}

std::vector<plan_segment> plan_of(const ifc_model &in, const entity &curve)
{
    std::vector<plan_segment> out;
    if (!is_alignment(in, curve)) {
        for (const curve_piece &piece : pieces_of(in, curve))
            out.push_back(plan_segment_of(piece));
        return out;
    }
    for (const value &reference : curve[0].list) {
        segment_values segment = segment_of(in, reference);
        if (std::fabs(segment.length_mm) > LEAST_MM)
            out.push_back(plan_segment_of(in, segment));
    }
    return out;
}

/* --- heights */

std::function<gp_XY(double)> arc_of(double height, double heading, double radius)
{
    return [=](double d) {
        double sine = std::sin(heading) + d / radius;
        if (!(std::fabs(sine) < 1))
            throw unsupported("this IFC shape cannot be built: a segment of its alignment's vertical layout is longer than its arc");
        return gp_XY(height + radius * (std::cos(heading) - std::cos(std::asin(sine))), std::tan(std::asin(sine)));
    };
}

/* Returns a function for the heights along an IfcPolynomialCurve, such as a parabola. Throws `unsupported` unless the curve's
 * parameter is its x coordinate. */
std::function<gp_XY(double)> polynomial_of(const ifc_model &in, const segment_values &segment)
{
    const std::vector<value> &x = segment.parent[1].list, &y = segment.parent[2].list;
    if (x.size() != 2 || file::number(x[0]) != 0 || file::number(x[1]) != 1 || segment.from_mm != 0 || y.size() < 2)
        throw unsupported("this IFC shape cannot be built: Plantcast does not support an IfcPolynomialCurve whose x is not the distance");
    if (std::fabs(file::number(y[1]) - std::tan(segment.heading_rad)) > 1e-4)
        throw unsupported("this IFC shape cannot be built: Plantcast does not support a rotated IfcPolynomialCurve");
    std::vector<double> terms;
    for (const value &term : y)
        terms.push_back(file::number(term));
    double height = segment.start.Y(), unit = in.length;
    return [=](double d) {
        double sum = 0, slope = 0;
        for (size_t i = terms.size() - 1; i > 0; i--) {
            slope = slope * d / unit + static_cast<double>(i) * terms[i];
            sum = (sum + terms[i]) * d / unit;
        }
        return gp_XY(height + unit * sum, slope);
    };
}

grade grade_of(const ifc_model &in, const segment_values &segment)
{
    double at = segment.start.X(), height = segment.start.Y(), heading = segment.heading_rad, slope = std::tan(heading);
    if (!(std::cos(heading) > 1e-6))
        throw unsupported(
            "this IFC shape cannot be built: Plantcast does not support a vertical segment in an alignment's vertical layout");
    if (segment.parent.is("IFCLINE"))
        return { at, [=](double d) { return gp_XY(height + slope * d, slope); }, true };
    if (segment.parent.is("IFCPOLYNOMIALCURVE"))
        return { at, polynomial_of(in, segment), false };
    double radius = segment.parent.is("IFCCIRCLE") ? in.length * file::number(segment.parent[1]) : 0;
    if (!(radius > LEAST_MM))
        throw unsupported("this IFC shape cannot be built: its alignment's vertical layout must not contain " + segment.parent.type);
    return { at, arc_of(height, heading, std::copysign(radius, segment.length_mm)), false };
}

/* Returns the grades of an IfcGradientCurve. *end_mm receives the distance at which they end, if a segment without length gives it. */
std::vector<grade> grades_of(const ifc_model &in, const entity &curve, double *end_mm)
{
    std::vector<grade> out;
    for (const value &reference : curve[0].list) {
        segment_values segment = segment_of(in, reference);
        if (std::fabs(segment.length_mm) <= LEAST_MM)
            *end_mm = segment.start.X();
        else
            out.push_back(grade_of(in, segment));
        if (out.size() > 1 && out.back().at_mm < out[out.size() - 2].at_mm)
            throw unsupported(
                "this IFC shape cannot be built: the segments of its alignment's vertical layout are not in order of distance");
    }
    if (out.empty() || std::fabs(out[0].at_mm) > JOINT_MM)
        throw unsupported(
            "this IFC shape cannot be built: its alignment's vertical layout does not begin at the start of the horizontal layout");
    return out;
}

/* --- curves in space */

/* Given the point `at`, `from` millimetres after the start of a plan segment, returns the point `to` millimetres after the
 * start. Integrates the direction by Simpson's rule. */
gp_XY advanced(const plan_segment &along, const gp_XY &at, double from, double to)
{
    gp_XY sum(0, 0);
    const double weights[3] = { 1, 4, 1 };
    for (int i = 0; i < 3; i++) {
        double heading = along.heading_rad + along.turn(from + (to - from) * i / 2);
        sum += gp_XY(std::cos(heading), std::sin(heading)) * weights[i];
    }
    return at + sum * ((to - from) / 6);
}

/* Builds the part of a plan segment between two distances from its start, with the heights of one grade. before_mm: length of
 * the plan curve before the segment. *at: the plan curve's point at `from`; receives the point at `to`. */
curve_piece piece_of(const ifc_model &in, const plan_segment &along, const grade &heights, double before_mm, double from, double to,
                     gp_XY *at)
{
    auto height = [&](double d) { return heights.height(before_mm + d - heights.at_mm); };
    double rise = std::atan(height(to).Y()) - std::atan(height(from).Y());
    double turn = std::fabs(along.turn(to) - along.turn(from)) + std::fabs(rise), span = (to - from) / in.length;
    if (!(turn < MOST_TURN_RAD))
        throw unsupported("this IFC shape cannot be built: a segment of its alignment turns by more than 50 rad: the segment's numbers are "
                          "probably wrong");
    int steps = along.straight && heights.straight ? 1 : std::max(8, static_cast<int>(std::ceil(turn / STEP_RAD)));
    Handle(TColgp_HArray1OfPnt) points = new TColgp_HArray1OfPnt(1, steps + 1);
    Handle(TColStd_HArray1OfReal) distances = new TColStd_HArray1OfReal(1, steps + 1);
    for (int i = 0; i <= steps; i++) {
        double d = from + (to - from) * i / steps;
        if (i > 0)
            *at = advanced(along, *at, distances->Value(i), d);
        points->SetValue(i + 1, gp_Pnt(at->X(), at->Y(), height(d).X()));
        distances->SetValue(i + 1, d);
    }
    if (steps == 1) {
        gp_Vec line(points->First(), points->Last());
        return { new Geom_Line(points->First(), gp_Dir(line)), 0, line.Magnitude(), span, to - from };
    }
    auto tangent = [&](double d) {
        double heading = along.heading_rad + along.turn(d);
        return gp_Vec(std::cos(heading), std::sin(heading), height(d).Y());
    };
    GeomAPI_Interpolate curve(points, distances, Standard_False, 1e-6);
    curve.Load(tangent(from), tangent(to), Standard_False);
    curve.Perform();
    if (!curve.IsDone())
        throw unsupported("this IFC shape cannot be built: Open CASCADE cannot compute the curve of its alignment");
    return { Handle(Geom_Curve)(curve.Curve()), from, to, span, to - from };
}

} // namespace

bool is_alignment(const ifc_model &in, const entity &curve)
{
    return curve.is("IFCGRADIENTCURVE") || (curve.is("IFCCOMPOSITECURVE") && !curve[0].list.empty() &&
                                            in.statements.get(curve[0].list[0]).is("IFCCURVESEGMENT"));
}

std::vector<curve_piece> alignment_of(const ifc_model &in, const entity &curve)
{
    bool rises = curve.is("IFCGRADIENTCURVE");
    entity base = rises ? in.statements.get(curve[2]) : curve;
    if (rises && base.is("IFCGRADIENTCURVE"))
        throw unsupported(
            "this IFC shape cannot be built: Plantcast does not support an IfcGradientCurve based on another IfcGradientCurve");
    double end_mm = HUGE_VAL, before_mm = 0;
    std::vector<grade> grades = { { 0, [](double) { return gp_XY(0, 0); }, true } };
    if (rises)
        grades = grades_of(in, curve, &end_mm);
    std::vector<curve_piece> out;
    for (const plan_segment &along : plan_of(in, base)) {
        double d = 0, last = std::fmin(along.length_mm, end_mm - before_mm);
        gp_XY at = along.start;
        for (size_t i = 0; i < grades.size() && d < last; i++) {
            double to = i + 1 < grades.size() ? std::fmin(last, grades[i + 1].at_mm - before_mm) : last;
            if (to - d < LEAST_MM)
                continue;
            out.push_back(piece_of(in, along, grades[i], before_mm, d, to, &at));
            d = to;
        }
        before_mm += along.length_mm;
    }
    return out;
}

} // namespace ifc
