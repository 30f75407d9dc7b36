/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solid items of other kinds, and what is cut from them. */
#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepOffsetAPI_ThruSections.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeHalfSpace.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <gp_Pln.hxx>

#include <cmath>

#include "preprocess/import/readers/ifc_shape.hh"

namespace ifc
{

namespace
{

constexpr double FAR_MM = 1e6; /* how far a half space reaches where it has a boundary */

/* Calls build(face) for each face and puts what comes together. */
template <typename builder> TopoDS_Shape each(const std::vector<TopoDS_Shape> &faces, const builder &build)
{
    TopoDS_Compound out;
    BRep_Builder into;
    if (faces.size() == 1)
        return build(faces[0]);
    into.MakeCompound(out);
    for (const TopoDS_Shape &face : faces)
        into.Add(out, build(face));
    return out;
}

TopoDS_Shape placed(const ifc_model &in, const value &at, const TopoDS_Shape &shape)
{
    return shape.Moved(TopLoc_Location(placement_of(in, at)));
}

TopoDS_Shape extruded(const ifc_model &in, const entity &item)
{
    entity profile = in.statements.get(item[0]);
    gp_Vec along = gp_Vec(direction_of(in, item[2], gp::DZ())) * (in.length * file::number(item[3]));
    TopoDS_Shape out;
    if (item.is("IFCEXTRUDEDAREASOLIDTAPERED")) {
        gp_Trsf end;
        end.SetTranslation(along);
        out = through_faces({ profile_of(in, profile).at(0), moved(profile_of(in, in.statements.get(item[4])).at(0), end) });
    } else {
        out = each(profile_shapes_of(in, profile), [&](const TopoDS_Shape &face) { return BRepPrimAPI_MakePrism(face, along).Shape(); });
    }
    return placed(in, item[1], out);
}

TopoDS_Shape revolved(const ifc_model &in, const entity &item)
{
    std::vector<TopoDS_Shape> faces = profile_shapes_of(in, in.statements.get(item[0]));
    entity axis = in.statements.get(item[2]);
    gp_Ax1 around(point_of(in, axis[0]), direction_of(in, axis[1], gp::DZ()));
    double angle = std::fmin(in.angle * std::fabs(file::number(item[3])), 2 * M_PI);
    if (file::number(item[3]) < 0)
        around.Reverse();
    TopoDS_Shape out = each(faces, [&](const TopoDS_Shape &face) {
        return angle > 2 * M_PI - 1e-9 ? BRepPrimAPI_MakeRevol(face, around).Shape() : BRepPrimAPI_MakeRevol(face, around, angle).Shape();
    });
    return placed(in, item[1], out);
}

/* The direction of the profile's X where the curve begins, and one that is square to it along the whole curve. */
struct trihedron {
    gp_Dir x, up;
};

/* X is normal to the surface. Surfaces that a straight line generates keep that line's direction along the curve. */
trihedron on_surface(const ifc_model &in, const entity &surface, const curve_piece &first)
{
    gp_Trsf place = placement_of(in, surface[surface.is("IFCSURFACEOFLINEAREXTRUSION") ? 1 : 0]);
    gp_Dir z = gp::DZ().Transformed(place);
    if (surface.is("IFCPLANE"))
        return { z, z };
    if (surface.is("IFCCYLINDRICALSURFACE")) {
        gp_Vec out(gp::Origin().Transformed(place), first.start());
        return { gp_Dir(out - gp_Vec(z) * out.Dot(gp_Vec(z))), z };
    }
    if (!surface.is("IFCSURFACEOFLINEAREXTRUSION"))
        throw unsupported("a profile that follows " + surface.type);
    gp_Dir along = direction_of(in, surface[2], gp::DZ()).Transformed(place);
    return { gp_Dir(first.tangent(false).Crossed(gp_Vec(along))), along };
}

/* Along a curve, with the profile's X towards a fixed direction, or normal to a surface. */
TopoDS_Shape along_curve(const ifc_model &in, const entity &item)
{
    bool whole = false;
    std::vector<curve_piece> pieces = trimmed(pieces_of(in, in.statements.get(item[2])), item[3], item[4], &whole);
    trihedron frame = { gp::DX(), gp::DX() };
    if (item.is("IFCFIXEDREFERENCESWEPTAREASOLID"))
        frame.x = frame.up = direction_of(in, item[5], gp::DX());
    else
        frame = on_surface(in, in.statements.get(item[5]), pieces.front());
    if (whole)
        printf("error\t1\tOpen CASCADE: #%d: its parameters are outside of its curve: the whole curve is taken\n", item.id);
    return placed(in, item[1], swept(profile_of(in, in.statements.get(item[0])), pieces, frame.x, frame.up));
}

TopoDS_Shape pyramid(double x, double y, double height)
{
    const gp_Pnt base[4] = { { 0, 0, 0 }, { x, 0, 0 }, { x, y, 0 }, { 0, y, 0 } };
    TopoDS_Wire low = BRepBuilderAPI_MakePolygon(base[0], base[1], base[2], base[3], Standard_True).Wire();
    BRepOffsetAPI_ThruSections loft(Standard_True, Standard_True);
    loft.AddWire(low);
    loft.AddVertex(BRepBuilderAPI_MakeVertex(gp_Pnt(x / 2, y / 2, height)));
    loft.Build();
    return loft.Shape();
}

/* A primitive, or a null shape for another type. */
TopoDS_Shape primitive(const ifc_model &in, const entity &item)
{
    TopoDS_Shape out;
    auto length = [&](size_t at) { return in.length * file::number(item[at]); };
    if (item.is("IFCBLOCK"))
        out = BRepPrimAPI_MakeBox(length(1), length(2), length(3)).Shape();
    else if (item.is("IFCRECTANGULARPYRAMID"))
        out = pyramid(length(1), length(2), length(3));
    else if (item.is("IFCRIGHTCIRCULARCONE"))
        out = BRepPrimAPI_MakeCone(length(2), 0, length(1)).Shape();
    else if (item.is("IFCRIGHTCIRCULARCYLINDER"))
        out = BRepPrimAPI_MakeCylinder(length(2), length(1)).Shape();
    else if (item.is("IFCSPHERE"))
        out = BRepPrimAPI_MakeSphere(length(1)).Shape();
    else
        return out;
    return placed(in, item[0], out);
}

TopoDS_Shape half_space(const ifc_model &in, const entity &item)
{
    entity surface = in.statements.get(item[0]);
    if (!surface.is("IFCPLANE"))
        throw unsupported("a half space of " + surface.type);
    gp_Trsf place = placement_of(in, surface[0]);
    gp_Dir away = gp::DZ().Transformed(place);
    gp_Pnt at = gp::Origin().Transformed(place), inside = at.Translated(gp_Vec(away) * (item[1].is_true() ? -1 : 1));
    TopoDS_Shape out = BRepPrimAPI_MakeHalfSpace(BRepBuilderAPI_MakeFace(gp_Pln(at, away)).Face(), inside).Solid();
    if (!item.is("IFCPOLYGONALBOUNDEDHALFSPACE"))
        return out;
    TopoDS_Wire boundary = wire_of(pieces_of(in, in.statements.get(item[3])));
    TopoDS_Face low = BRepBuilderAPI_MakeFace(gp_Pln(gp::XOY()), boundary, Standard_True).Face();
    gp_Trsf down;
    down.SetTranslation(gp_Vec(0, 0, -FAR_MM));
    TopoDS_Shape prism = BRepPrimAPI_MakePrism(BRepBuilderAPI_Transform(low, down).Shape(), gp_Vec(0, 0, 2 * FAR_MM)).Shape();
    return BRepAlgoAPI_Common(placed(in, item[2], prism), out).Shape();
}

TopoDS_Shape boolean(const ifc_model &in, const entity &item, int depth)
{
    TopoDS_Shape first = solid_of(in, in.statements.get(item[1]), depth + 1), second = solid_of(in, in.statements.get(item[2]), depth + 1);
    TopoDS_Shape out;
    if (item[0].is(".DIFFERENCE."))
        out = BRepAlgoAPI_Cut(first, second).Shape();
    else if (item[0].is(".UNION."))
        out = BRepAlgoAPI_Fuse(first, second).Shape();
    else
        out = BRepAlgoAPI_Common(first, second).Shape();
    if (out.IsNull())
        throw unsupported("a boolean operation that fails");
    return out;
}

} // namespace

bool is_built(const std::string &type)
{
    static const char *const types[] = { "IFCSWEPTDISKSOLID",
                                         "IFCSWEPTDISKSOLIDPOLYGONAL",
                                         "IFCADVANCEDBREP",
                                         "IFCADVANCEDBREPWITHVOIDS",
                                         "IFCREVOLVEDAREASOLID",
                                         "IFCFIXEDREFERENCESWEPTAREASOLID",
                                         "IFCSURFACECURVESWEPTAREASOLID",
                                         "IFCSECTIONEDSPINE",
                                         "IFCSECTIONEDSOLIDHORIZONTAL",
                                         "IFCEXTRUDEDAREASOLIDTAPERED",
                                         "IFCCSGSOLID",
                                         "IFCBLOCK",
                                         "IFCRECTANGULARPYRAMID",
                                         "IFCRIGHTCIRCULARCONE",
                                         "IFCRIGHTCIRCULARCYLINDER",
                                         "IFCSPHERE" };
    for (const char *known : types)
        if (type == known)
            return true;
    return false;
}

TopoDS_Shape solid_of(const ifc_model &in, const entity &item, int depth)
{
    if (depth > MAX_CHAIN)
        throw unsupported("its solids refer to each other in a circle");
    if (item.is("IFCSWEPTDISKSOLID") || item.is("IFCSWEPTDISKSOLIDPOLYGONAL"))
        return disk_of(in, item);
    if (item.is("IFCADVANCEDBREP") || item.is("IFCADVANCEDBREPWITHVOIDS"))
        return brep_of(in, item);
    if (item.is("IFCEXTRUDEDAREASOLID") || item.is("IFCEXTRUDEDAREASOLIDTAPERED"))
        return extruded(in, item);
    if (item.is("IFCREVOLVEDAREASOLID"))
        return revolved(in, item);
    if (item.is("IFCFIXEDREFERENCESWEPTAREASOLID") || item.is("IFCSURFACECURVESWEPTAREASOLID"))
        return along_curve(in, item);
    if (item.is("IFCSECTIONEDSPINE") || item.is("IFCSECTIONEDSOLIDHORIZONTAL"))
        return sections_of(in, item);
    if (item.is("IFCCSGSOLID"))
        return solid_of(in, in.statements.get(item[0]), depth + 1);
    if (item.is("IFCBOOLEANRESULT") || item.is("IFCBOOLEANCLIPPINGRESULT"))
        return boolean(in, item, depth);
    if (item.type.find("HALFSPACE") != std::string::npos)
        return half_space(in, item);
    if (has_flat_faces(item.type) && !has_edges(in, item))
        return flat_faces_of(in, item);
    if (has_flat_faces(item.type))
        return brep_of(in, item);
    TopoDS_Shape out = primitive(in, item);
    if (out.IsNull())
        throw unsupported(item.type);
    return out;
}

} // namespace ifc
