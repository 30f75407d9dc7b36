/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds solids that pass through cross-sections along a curve. */
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepTools.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <Geom_Line.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <gp_Ax3.hxx>

#include <cmath>

#include "preprocess/import/readers/ifc_shape.hh"

namespace ifc
{

namespace
{

TopoDS_Shape through(const std::vector<TopoDS_Wire> &sections)
{
    BRepOffsetAPI_ThruSections loft(Standard_True, Standard_True);
    for (const TopoDS_Wire &section : sections)
        loft.AddWire(section);
    loft.Build();
    if (!loft.IsDone())
        throw unsupported("sections that cannot be joined");
    return loft.Shape();
}

/* Returns the outlines of a face, the outer one first. */
std::vector<TopoDS_Wire> wires_of(const TopoDS_Face &face)
{
    std::vector<TopoDS_Wire> out = { BRepTools::OuterWire(face) };
    for (TopExp_Explorer at(face, TopAbs_WIRE); at.More(); at.Next())
        if (!at.Current().IsSame(out[0]))
            out.push_back(TopoDS::Wire(at.Current()));
    return out;
}

/* --- IfcSectionedSpine: each section has a placement of its own */

TopoDS_Shape spine_of(const ifc_model &in, const entity &item)
{
    const std::vector<value> &sections = item[1].list, &places = item[2].list;
    std::vector<TopoDS_Face> faces;
    if (sections.size() < 2 || sections.size() != places.size())
        throw unsupported("a spine without sections");
    for (size_t i = 0; i < sections.size(); i++)
        faces.push_back(moved(profile_of(in, in.statements.get(sections[i])).at(0), placement_of(in, places[i])));
    return through_faces(faces);
}

/* --- IfcSectionedSolidHorizontal: sections stand upright at distances along a curve */

struct station {
    double along_mm; /* position of the section along the curve from its start, millimetres */
    gp_Vec offset;   /* offset of the section from the curve to the left, up and ahead, millimetres */
    int profile;
};

/* Returns the placement of an upright section on the curve: X points left, Y up. */
gp_Trsf upright(const std::vector<curve_piece> &pieces, const station &at)
{
    double left_mm = at.along_mm;
    const curve_piece *part = &pieces.front();
    for (const curve_piece &one : pieces) {
        part = &one;
        if (left_mm <= length_of(one) + 1e-6 || &one == &pieces.back())
            break;
        left_mm -= length_of(one);
    }
    GeomAdaptor_Curve curve(part->curve);
    bool back = part->first > part->last;
    GCPnts_AbscissaPoint point(curve, back ? -left_mm : left_mm, part->first);
    gp_Pnt origin;
    gp_Vec ahead;
    if (!point.IsDone())
        throw unsupported("a section that is not on its curve");
    curve.D1(point.Parameter(), origin, ahead);
    gp_Vec level(back ? -ahead.X() : ahead.X(), back ? -ahead.Y() : ahead.Y(), 0);
    if (level.Magnitude() < 1e-9)
        throw unsupported("a section on a vertical curve");
    gp_Dir forward(level), left = gp::DZ().Crossed(forward);
    origin.Translate(gp_Vec(left) * at.offset.X() + gp_Vec(gp::DZ()) * at.offset.Y() + gp_Vec(forward) * at.offset.Z());
    gp_Trsf out;
    out.SetTransformation(gp_Ax3(origin, forward, left), gp_Ax3(gp::XOY()));
    return out;
}

station station_of(const ifc_model &in, const value &reference, const value &profile)
{
    entity place = in.statements.get(reference), at = place;
    if (place.is("IFCAXIS2PLACEMENTLINEAR")) {
        if (!direction_of(in, place[1], gp::DZ()).IsParallel(gp::DZ(), 1e-6))
            throw unsupported("a section that is not upright");
        at = in.statements.get(place[0]);
    }
    if (!at.is("IFCPOINTBYDISTANCEEXPRESSION") && !at.is("IFCDISTANCEEXPRESSION"))
        throw unsupported(at.type);
    auto length = [&](size_t i) { return in.length * file::number(at[i], 0); };
    return { length(0), gp_Vec(length(1), length(2), length(3)), profile.id };
}

/* Adds stations between two stations that have the same profile, where the curve between them is not straight. */
void add_between(const ifc_model &in, const std::vector<curve_piece> &pieces, station from, const station &to, std::vector<station> *out)
{
    double at = 0;
    for (const curve_piece &part : pieces) {
        double length = length_of(part), low = std::fmax(at, from.along_mm), high = std::fmin(at + length, to.along_mm);
        bool straight = part.curve->IsKind(STANDARD_TYPE(Geom_Line));
        at += length;
        if (high - low < 1e-6)
            continue;
        double turn = straight ? 0 : std::acos(std::fmax(-1, std::fmin(1, part.tangent(false).Dot(part.tangent(true)))));
        /* half the angle in radians by which the curve may turn along one chord without exceeding chord_mm */
        double chord = std::acos(1 - std::fmin(0.5, in.chord_mm * turn / length));
        int steps = straight ? 1 : std::max(8, static_cast<int>(std::ceil(turn / chord)));
        for (int i = 1; i <= steps; i++) {
            double share = (low + (high - low) * i / steps - from.along_mm) / (to.along_mm - from.along_mm);
            if (share > 1 - 1e-9)
                return;
            if (from.profile != to.profile)
                throw unsupported("a section that changes along a curve");
            out->push_back(
                { from.along_mm + share * (to.along_mm - from.along_mm), from.offset + (to.offset - from.offset) * share, from.profile });
        }
    }
}

TopoDS_Shape horizontal_of(const ifc_model &in, const entity &item)
{
    std::vector<curve_piece> pieces = pieces_of(in, in.statements.get(item[0]));
    const std::vector<value> &sections = item[1].list, &places = item[2].list;
    std::vector<station> stations;
    std::vector<TopoDS_Face> faces;
    if (sections.size() < 2 || sections.size() != places.size())
        throw unsupported("a directrix without sections");
    for (size_t i = 0; i < sections.size(); i++) {
        station next = station_of(in, places[i], sections[i]);
        if (i > 0)
            add_between(in, pieces, stations.back(), next, &stations);
        stations.push_back(next);
    }
    for (const station &at : stations)
        faces.push_back(moved(profile_of(in, in.statements.get(at.profile)).at(0), upright(pieces, at)));
    return through_faces(faces);
}

} // namespace

TopoDS_Shape through_faces(const std::vector<TopoDS_Face> &faces)
{
    TopoDS_Shape out;
    std::vector<std::vector<TopoDS_Wire>> outlines;
    for (const TopoDS_Face &face : faces) {
        outlines.push_back(wires_of(face));
        if (outlines.back().size() != outlines[0].size())
            throw unsupported("sections with different holes");
    }
    for (size_t i = 0; i < outlines[0].size(); i++) {
        std::vector<TopoDS_Wire> sections;
        for (const std::vector<TopoDS_Wire> &wires : outlines)
            sections.push_back(wires[i]);
        out = i == 0 ? through(sections) : BRepAlgoAPI_Cut(out, through(sections)).Shape();
    }
    return out;
}

TopoDS_Face moved(const TopoDS_Face &face, const gp_Trsf &place)
{
    return TopoDS::Face(BRepBuilderAPI_Transform(face, place, Standard_True).Shape());
}

TopoDS_Shape sections_of(const ifc_model &in, const entity &item)
{
    return item.is("IFCSECTIONEDSPINE") ? spine_of(in, item) : horizontal_of(in, item);
}

} // namespace ifc
