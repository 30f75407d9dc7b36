/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds profiles (cross-sections that are swept to solids), whose outlines consist of lines and arcs, or of curves in the
 * file. Ignores the slopes of flanges. */
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepBuilderAPI_GTransform.hxx>
#include <GCPnts_QuasiUniformDeflection.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <ShapeFix_Face.hxx>
#include <TopoDS.hxx>
#include <gp_Circ.hxx>
#include <gp_Elips.hxx>
#include <gp_Pln.hxx>

#include <cmath>

#include "preprocess/import/readers/ifc_shape.hh"

namespace ifc
{

namespace
{

/* A corner of a profile's outline in millimetres, rounded by `radius`. */
struct outline_corner {
    double x, y, radius;
};

TopoDS_Wire outline(const std::vector<outline_corner> &corners)
{
    std::vector<gp_Pnt> points;
    std::vector<double> radii;
    for (const outline_corner &at : corners) {
        points.emplace_back(at.x, at.y, 0);
        radii.push_back(at.radius);
    }
    return wire_of(rounded(points, radii, true));
}

TopoDS_Wire rectangle(double width, double height, double radius)
{
    double x = width / 2, y = height / 2;
    return outline({ { -x, -y, radius }, { x, -y, radius }, { x, y, radius }, { -x, y, radius } });
}

TopoDS_Wire circle(double radius)
{
    return BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Circ(gp::XOY(), radius)).Edge());
}

TopoDS_Wire ellipse(double a, double b)
{
    gp_Ax2 axes = a >= b ? gp::XOY() : gp_Ax2(gp::Origin(), gp::DZ(), gp::DY());
    return BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Elips(axes, std::max(a, b), std::min(a, b))).Edge());
}

std::vector<TopoDS_Face> faces_of(const TopoDS_Wire &outer, const std::vector<TopoDS_Wire> &holes)
{
    BRepBuilderAPI_MakeFace face(gp_Pln(gp::XOY()), outer, Standard_True);
    if (!face.IsDone())
        throw unsupported("this IFC shape cannot be built: the outline of its profile (cross-section) is not closed, or crosses itself");
    for (const TopoDS_Wire &hole : holes)
        face.Add(hole);
    ShapeFix_Face fix(face.Face());
    fix.FixOrientation();
    return { fix.Face() };
}

/* dimensions of a parametrised profile in millimetres: its statement's values from the third on; 0: absent */
using lengths = std::vector<double>;

/* Dimensions of an I profile in millimetres; its top and bottom flanges may differ. Each fillet is the radius of the rounding
   between the web and that flange. */
struct i_profile {
    double depth, web, bottom, bottom_thick, bottom_fillet, top, top_thick, top_fillet;
};

TopoDS_Wire i_shape(const i_profile &i)
{
    double y = i.depth / 2, b = i.bottom / 2, t = i.top / 2, w = i.web / 2, low = -y + i.bottom_thick, high = y - i.top_thick;
    double bottom_fillet = i.bottom_fillet, top_fillet = i.top_fillet;
    return outline({ { -b, -y, 0 }, { b, -y, 0 }, { b, low, 0 }, { w, low, bottom_fillet }, { w, high, top_fillet }, { t, high, 0 },
                     { t, y, 0 }, { -t, y, 0 }, { -t, high, 0 }, { -w, high, top_fillet }, { -w, low, bottom_fillet }, { -b, low, 0 } });
}

TopoDS_Wire l_shape(const lengths &d)
{
    double y = d[0] / 2, x = (d[1] > 0 ? d[1] : d[0]) / 2, t = d[2];
    return outline({ { -x, -y, 0 }, { x, -y, 0 }, { x, -y + t, d[4] }, { -x + t, -y + t, d[3] }, { -x + t, y, d[4] }, { -x, y, 0 } });
}

TopoDS_Wire u_shape(const lengths &d)
{
    double y = d[0] / 2, x = d[1] / 2, web = d[2], flange = d[3];
    return outline({ { -x, -y, 0 }, { x, -y, 0 }, { x, -y + flange, d[5] }, { -x + web, -y + flange, d[4] }, { -x + web, y - flange, d[4] },
                     { x, y - flange, d[5] }, { x, y, 0 }, { -x, y, 0 } });
}

TopoDS_Wire t_shape(const lengths &d)
{
    double y = d[0] / 2, x = d[1] / 2, web = d[2] / 2, flange = d[3];
    return outline({ { -web, -y, d[6] }, { web, -y, d[6] }, { web, y - flange, d[4] }, { x, y - flange, d[5] }, { x, y, 0 }, { -x, y, 0 },
                     { -x, y - flange, d[5] }, { -web, y - flange, d[4] } });
}

TopoDS_Wire c_shape(const lengths &d)
{
    double y = d[0] / 2, x = d[1] / 2, t = d[2], girth = d[3], inner = d[4], outer = inner > 0 ? inner + t : 0;
    return outline({ { -x, -y, outer }, { x, -y, outer }, { x, -y + girth, 0 }, { x - t, -y + girth, 0 }, { x - t, -y + t, inner },
                     { -x + t, -y + t, inner }, { -x + t, y - t, inner }, { x - t, y - t, inner }, { x - t, y - girth, 0 },
                     { x, y - girth, 0 }, { x, y, outer }, { -x, y, outer } });
}

TopoDS_Wire z_shape(const lengths &d)
{
    double y = d[0] / 2, x = d[1], web = d[2] / 2, flange = d[3];
    return outline({ { -web, -y, 0 }, { x - web, -y, 0 }, { x - web, -y + flange, d[5] }, { web, -y + flange, d[4] }, { web, y, 0 },
                     { web - x, y, 0 }, { web - x, y - flange, d[5] }, { -web, y - flange, d[4] } });
}

std::vector<TopoDS_Face> parametric(const std::string &type, const lengths &d)
{
    if (type == "IFCRECTANGLEPROFILEDEF")
        return faces_of(rectangle(d[0], d[1], 0), {});
    if (type == "IFCROUNDEDRECTANGLEPROFILEDEF")
        return faces_of(rectangle(d[0], d[1], d[2]), {});
    if (type == "IFCRECTANGLEHOLLOWPROFILEDEF")
        return faces_of(rectangle(d[0], d[1], d[4]), { rectangle(d[0] - 2 * d[2], d[1] - 2 * d[2], d[3]) });
    if (type == "IFCCIRCLEPROFILEDEF")
        return faces_of(circle(d[0]), {});
    if (type == "IFCCIRCLEHOLLOWPROFILEDEF")
        return faces_of(circle(d[0]), { circle(d[0] - d[1]) });
    if (type == "IFCELLIPSEPROFILEDEF")
        return faces_of(ellipse(d[0], d[1]), {});
    if (type == "IFCISHAPEPROFILEDEF")
        return faces_of(i_shape({ d[1], d[2], d[0], d[3], d[4], d[0], d[3], d[4] }), {});
    if (type == "IFCASYMMETRICISHAPEPROFILEDEF")
        return faces_of(i_shape({ d[1], d[2], d[0], d[3], d[4], d[5], d[6] > 0 ? d[6] : d[3], d[7] }), {});
    if (type == "IFCLSHAPEPROFILEDEF")
        return faces_of(l_shape(d), {});
    if (type == "IFCUSHAPEPROFILEDEF")
        return faces_of(u_shape(d), {});
    if (type == "IFCTSHAPEPROFILEDEF")
        return faces_of(t_shape(d), {});
    if (type == "IFCCSHAPEPROFILEDEF")
        return faces_of(c_shape(d), {});
    if (type == "IFCZSHAPEPROFILEDEF")
        return faces_of(z_shape(d), {});
    if (type == "IFCTRAPEZIUMPROFILEDEF") {
        double left = -d[0] / 2, low = -d[2] / 2;
        return faces_of(outline({ { left, low, 0 }, { -left, low, 0 }, { left + d[3] + d[1], -low, 0 }, { left + d[3], -low, 0 } }), {});
    }
    throw unsupported("this IFC shape cannot be built: Plantcast does not support " + type);
}

/* Returns points along the pieces of a curve. The chords between them deviate from the curve by at most chord_mm. */
std::vector<gp_Pnt> points_along(const std::vector<curve_piece> &pieces, double chord_mm)
{
    std::vector<gp_Pnt> out = { pieces.front().start() };
    for (const curve_piece &part : pieces) {
        double low = std::fmin(part.first, part.last), high = std::fmax(part.first, part.last);
        GCPnts_QuasiUniformDeflection along(GeomAdaptor_Curve(part.curve), chord_mm, low, high);
        for (int i = 2; along.IsDone() && i <= along.NbPoints(); i++)
            out.push_back(along.Value(part.first > part.last ? along.NbPoints() + 1 - i : i));
    }
    return out;
}

/* Returns the outline of a strip of constant thickness along a centre line in the XY plane. Corners are mitred; the ends are
 * perpendicular to the line. */
TopoDS_Wire thickened(const std::vector<curve_piece> &pieces, double thickness, double chord_mm)
{
    std::vector<gp_Pnt> line = points_along(pieces, chord_mm), right;
    std::vector<outline_corner> out;
    for (size_t i = 0; i < line.size(); i++) {
        size_t before = i > 0 ? i - 1 : 0, after = i + 1 < line.size() ? i : i - 1;
        gp_Vec in(line[before], line[before + 1]), on(line[after], line[after + 1]);
        gp_Vec left = gp_Vec(gp::DZ()).Crossed(in.Normalized()) + gp_Vec(gp::DZ()).Crossed(on.Normalized());
        if (left.Magnitude() < 0.2) /* reject a corner so acute that its mitre would be longer than ten thicknesses */
            throw unsupported("this IFC shape cannot be built: the centre line of its profile (cross-section) turns back on itself");
        gp_Vec side = left.Normalized() * (thickness / 2 / (left.Magnitude() / 2));
        out.push_back({ line[i].X() + side.X(), line[i].Y() + side.Y(), 0 });
        right.push_back(line[i].Translated(-side));
    }
    for (size_t i = right.size(); i-- > 0;)
        out.push_back({ right[i].X(), right[i].Y(), 0 });
    return outline(out);
}

std::vector<TopoDS_Face> profile_within(const ifc_model &in, const entity &profile, int depth);

/* Returns the faces of a derived or composite IFC profile: a transformed profile, or several profiles together. */
std::vector<TopoDS_Face> assembled(const ifc_model &in, const entity &profile, int depth)
{
    std::vector<TopoDS_Face> out;
    if (profile.is("IFCCOMPOSITEPROFILEDEF")) {
        for (const value &reference : profile[2].list)
            for (const TopoDS_Face &face : profile_within(in, in.statements.get(reference), depth + 1))
                out.push_back(face);
        return out;
    }
    gp_GTrsf place;
    if (profile.is("IFCMIRROREDPROFILEDEF"))
        place.SetValue(1, 1, -1);
    else
        place = operator_of(in, in.statements.get(profile[3]));
    for (const TopoDS_Face &face : profile_within(in, in.statements.get(profile[2]), depth + 1)) {
        TopoDS_Face moved = TopoDS::Face(BRepBuilderAPI_GTransform(face, place, Standard_True).Shape());
        out.push_back(moved);
    }
    return out;
}

std::vector<TopoDS_Face> profile_within(const ifc_model &in, const entity &profile, int depth)
{
    if (depth > MAX_CHAIN)
        throw unsupported("this IFC shape cannot be built: profiles refer to each other in a circle");
    if (profile.is("IFCARBITRARYCLOSEDPROFILEDEF") || profile.is("IFCARBITRARYPROFILEDEFWITHVOIDS")) {
        std::vector<TopoDS_Wire> holes;
        for (const value &reference : profile[3].list)
            holes.push_back(wire_of(pieces_of(in, in.statements.get(reference))));
        return faces_of(wire_of(pieces_of(in, in.statements.get(profile[2]))), holes);
    }
    if (profile.is("IFCCENTERLINEPROFILEDEF"))
        return faces_of(thickened(pieces_of(in, in.statements.get(profile[2])), in.length * file::number(profile[3]), in.chord_mm), {});
    if (profile.is("IFCCOMPOSITEPROFILEDEF") || profile.is("IFCDERIVEDPROFILEDEF") || profile.is("IFCMIRROREDPROFILEDEF"))
        return assembled(in, profile, depth);
    lengths d(10);
    for (size_t i = 0; i < d.size(); i++)
        d[i] = profile[3 + i].kind == value::NUMBER ? in.length * profile[3 + i].number : 0;
    std::vector<TopoDS_Face> out = parametric(profile.type, d);
    TopLoc_Location place(placement_of(in, profile[2]));
    for (TopoDS_Face &face : out)
        face = TopoDS::Face(face.Moved(place));
    return out;
}

} // namespace

std::vector<TopoDS_Face> profile_of(const ifc_model &in, const entity &profile)
{
    return profile_within(in, profile, 0);
}

std::vector<TopoDS_Shape> profile_shapes_of(const ifc_model &in, const entity &profile)
{
    if (profile.is("IFCARBITRARYOPENPROFILEDEF"))
        return { wire_of(pieces_of(in, in.statements.get(profile[2]))) };
    std::vector<TopoDS_Face> faces = profile_of(in, profile);
    return { faces.begin(), faces.end() };
}

} // namespace ifc
