/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds solids swept along a curve through several cross-sections. */
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_GTransform.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <Geom_Line.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
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
        throw unsupported("this IFC shape cannot be built: Open CASCADE cannot join its cross-sections to a solid");
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

/* --- IfcSectionedSpine: each section has its own placement */

TopoDS_Shape spine_of(const ifc_model &in, const entity &item)
{
    const std::vector<value> &sections = item[1].list, &places = item[2].list;
    std::vector<TopoDS_Face> faces;
    if (sections.size() < 2 || sections.size() != places.size())
        throw unsupported("this IFC shape cannot be built: its IfcSectionedSpine has no cross-sections, or does not place each of them");
    for (size_t i = 0; i < sections.size(); i++)
        faces.push_back(moved(profile_of(in, in.statements.get(sections[i])).at(0), placement_of(in, places[i])));
    return through_faces(faces);
}

/* --- IfcSectionedSolidHorizontal: sections stand upright at distances along a curve */

struct station {
    double along_mm; /* distance of the section from the curve's start, along the curve, millimetres */
    gp_Vec offset;   /* offset of the section from the curve, as components to the left, up and ahead, millimetres */
    int profile;
};

/* Returns the curve parameter of the point at a distance from the start of a piece of a curve. */
double parameter_at(const curve_piece &part, double distance_mm)
{
    if (part.level_mm > 0)
        return part.first + (part.last - part.first) * distance_mm / part.level_mm;
    GCPnts_AbscissaPoint point(GeomAdaptor_Curve(part.curve), part.first > part.last ? -distance_mm : distance_mm, part.first);
    if (!point.IsDone())
        throw unsupported("this IFC shape cannot be built: a cross-section is not on its curve");
    return point.Parameter();
}

/* Returns the placement of a section upright on the curve: X points left, Y up. */
gp_Trsf upright(const std::vector<curve_piece> &pieces, const station &at)
{
    double left_mm = at.along_mm;
    const curve_piece *part = &pieces.front();
    for (const curve_piece &one : pieces) {
        part = &one;
        if (left_mm <= distance_of(one) + 1e-6 || &one == &pieces.back())
            break;
        left_mm -= distance_of(one);
    }
    bool back = part->first > part->last;
    gp_Pnt origin;
    gp_Vec ahead;
    part->curve->D1(parameter_at(*part, left_mm), origin, ahead);
    gp_Vec level(back ? -ahead.X() : ahead.X(), back ? -ahead.Y() : ahead.Y(), 0);
    if (level.Magnitude() < 1e-9)
        throw unsupported("this IFC shape cannot be built: Plantcast does not support cross-sections where their curve is vertical");
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
            throw unsupported("this IFC shape cannot be built: Plantcast does not support cross-sections that are not upright");
        at = in.statements.get(place[0]);
    }
    if (!at.is("IFCPOINTBYDISTANCEEXPRESSION") && !at.is("IFCDISTANCEEXPRESSION"))
        throw unsupported("this IFC shape cannot be built: Plantcast does not support " + at.type);
    auto length = [&](size_t i) { return in.length * file::number(at[i], 0); };
    return { length(0), gp_Vec(length(1), length(2), length(3)), profile.id };
}

/* Returns the number of chords that approximate a piece of a curve. length_mm: length of the piece. */
int chords_of(const ifc_model &in, const curve_piece &piece, double length_mm)
{
    if (piece.curve->IsKind(STANDARD_TYPE(Geom_Line)))
        return 1;
    double turn = std::acos(std::fmax(-1, std::fmin(1, piece.tangent(false).Dot(piece.tangent(true)))));
    /* half the angle, in radians, that the curve may turn within one chord without exceeding chord_mm */
    double chord = std::acos(1 - std::fmin(0.5, in.chord_mm * turn / length_mm));
    return std::max(8, static_cast<int>(std::ceil(turn / chord)));
}

/* Where the curve between two cross-sections with the same profile is not straight, appends further sections between them to
   *out, so that the solid follows the curve. Throws `unsupported` if the two profiles differ. */
void add_between(const ifc_model &in, const std::vector<curve_piece> &pieces, station from, const station &to, std::vector<station> *out)
{
    double at = 0;
    for (const curve_piece &part : pieces) {
        double length = distance_of(part), low = std::fmax(at, from.along_mm), high = std::fmin(at + length, to.along_mm);
        at += length;
        if (high - low < 1e-6)
            continue;
        int steps = chords_of(in, part, length);
        for (int i = 1; i <= steps; i++) {
            double share = (low + (high - low) * i / steps - from.along_mm) / (to.along_mm - from.along_mm);
            if (share > 1 - 1e-9)
                return;
            if (from.profile != to.profile)
                throw unsupported(
                    "this IFC shape cannot be built: Plantcast does not support cross-sections that change along a curved part");
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
        throw unsupported("this IFC shape cannot be built: its curve (Directrix) has no cross-sections, or does not place each of them");
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

/* --- sections perpendicular to a curve */

struct section_frame {
    gp_Pnt at;
    gp_Dir along, x;
    gp_Dir plane; /* normal of the section's plane; differs from the curve's direction `along` at a corner */
};

section_frame frame_at(const curve_piece &piece, double parameter, const gp_Dir &reference)
{
    gp_Pnt at;
    gp_Vec along;
    piece.curve->D1(parameter, at, along);
    if (along.Magnitude() < 1e-9)
        throw unsupported("this IFC shape cannot be built: its curve has no direction at one of the curve's points");
    if (piece.first > piece.last)
        along.Reverse();
    if (gp_Dir(along).IsParallel(reference, 1e-6))
        throw unsupported("this IFC shape cannot be built: the reference direction of its swept profile is parallel to the curve");
    return { at, gp_Dir(along), gp_Ax3(at, gp_Dir(along), reference).XDirection(), gp_Dir(along) };
}

/* Returns the transform from the XY plane to a section's plane. At a corner, moves the profile along its curve into that plane. */
gp_GTrsf section_place(const section_frame &from)
{
    gp_Trsf upright;
    gp_GTrsf shear;
    upright.SetTransformation(gp_Ax3(from.at, from.along, from.x), gp_Ax3(gp::XOY()));
    double share = from.along.Dot(from.plane);
    for (int row = 1; row <= 3; row++)
        for (int column = 1; column <= 3; column++)
            shear.SetValue(row, column, (row == column) - from.along.Coord(row) * from.plane.Coord(column) / share);
    /* adds a translation to the shear that moves the profile into the section's plane, so that the corner point of the curve
       stays in place */
    gp_XYZ at = from.at.XYZ(), moved = at;
    shear.Transforms(moved);
    shear.SetTranslationPart(at - moved);
    return shear * gp_GTrsf(upright);
}

bool same_section(const section_frame &a, const section_frame &b)
{
    gp_XYZ first(1, 0, 0), second(1, 0, 0);
    section_place(a).Transforms(first);
    section_place(b).Transforms(second);
    return (first - second).Modulus() < 1e-3;
}

/* Returns the frames of the sections of one or more solids. At a corner where the profile would rotate about the curve, one
 * solid ends and the next begins. */
std::vector<std::vector<section_frame>> frames_of(const ifc_model &in, const std::vector<curve_piece> &pieces, const gp_Dir &reference)
{
    std::vector<std::vector<section_frame>> out(1);
    for (size_t i = 0; i < pieces.size(); i++) {
        int steps = chords_of(in, pieces[i], length_of(pieces[i]));
        double range = pieces[i].last - pieces[i].first;
        if (i == 0)
            out.back().push_back(frame_at(pieces[i], pieces[i].first, reference));
        for (int k = 1; k <= steps; k++)
            out.back().push_back(frame_at(pieces[i], pieces[i].first + range * k / steps, reference));
        if (i + 1 == pieces.size())
            break;
        section_frame next = frame_at(pieces[i + 1], pieces[i + 1].first, reference), &last = out.back().back();
        if (next.along.Angle(last.along) > 3)
            throw unsupported("this IFC shape cannot be built: its curve turns back on itself");
        last.plane = next.plane = gp_Dir(next.along.XYZ() + last.along.XYZ());
        if (!same_section(last, next))
            out.push_back({ next });
    }
    return out;
}

} // namespace

TopoDS_Shape along_frames(const ifc_model &in, const std::vector<TopoDS_Face> &faces, const std::vector<curve_piece> &pieces,
                          const gp_Dir &reference)
{
    TopoDS_Compound out;
    BRep_Builder builder;
    builder.MakeCompound(out);
    for (const std::vector<section_frame> &frames : frames_of(in, pieces, reference))
        for (const TopoDS_Face &face : faces) {
            std::vector<TopoDS_Face> sections;
            for (const section_frame &frame : frames)
                sections.push_back(TopoDS::Face(BRepBuilderAPI_GTransform(face, section_place(frame), Standard_True).Shape()));
            builder.Add(out, through_faces(sections));
        }
    return out;
}

TopoDS_Shape through_faces(const std::vector<TopoDS_Face> &faces)
{
    TopoDS_Shape out;
    std::vector<std::vector<TopoDS_Wire>> outlines;
    for (const TopoDS_Face &face : faces) {
        outlines.push_back(wires_of(face));
        if (outlines.back().size() != outlines[0].size())
            throw unsupported("this IFC shape cannot be built: its cross-sections have different numbers of holes");
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
