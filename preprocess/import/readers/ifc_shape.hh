/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shapes of Open CASCADE, in millimetres, from representation items of an IFC file. All throw ifc::unsupported or Standard_Failure for
 * what they do not build. Thread: one. */
#ifndef PREPROCESS_IMPORT_READERS_IFC_SHAPE_HH
#define PREPROCESS_IMPORT_READERS_IFC_SHAPE_HH
#include <Geom_Curve.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <TopoDS_Wire.hxx>
#include <gp_GTrsf.hxx>
#include <gp_Trsf.hxx>

#include "preprocess/import/readers/ifc_file.hh"

namespace ifc
{

constexpr int MAX_CHAIN = 200; /* of curves, booleans and placements that refer to each other: more is a circle */

struct ifc_model {
    const file &statements;
    double length; /* mm per unit of the file */
    double angle;  /* radians per unit of the file */
    double chord_mm;
};

struct triangles {
    std::vector<gp_Pnt> points;
    std::vector<gp_Vec> normals;
    std::vector<uint32_t> corners;
};

/* A stretch of a curve. `span` is the length of its parameter range as the file counts it. */
struct curve_piece {
    Handle(Geom_Curve) curve;
    double first, last; /* first > last: it runs against the curve */
    double span;

    gp_Pnt start() const;
    gp_Pnt end() const;
    gp_Vec tangent(bool at_end) const; /* of length 1, in the direction of travel */
};

/* --- ifc_triangles.cc */
triangles triangles_of(const ifc_model &in, const TopoDS_Shape &shape);
/* Returns the volume that triangles enclose, in mm3; negative if they face inwards. */
double volume_of(const triangles &all);

/* --- ifc_curve.cc */
double length_of(const curve_piece &part); /* in mm */
gp_Pnt point_of(const ifc_model &in, const value &reference);
/* The points of an IfcCartesianPointList. */
std::vector<gp_Pnt> points_of(const ifc_model &in, const value &reference);
/* Of an IfcDirection; `otherwise` where it is absent. */
gp_Dir direction_of(const ifc_model &in, const value &reference, const gp_Dir &otherwise);
/* Of an IfcAxis2Placement2D or 3D; the identity where it is absent. */
gp_Trsf placement_of(const ifc_model &in, const value &reference);
/* Of an IfcCartesianTransformationOperator2D or 3D. */
gp_GTrsf operator_of(const ifc_model &in, const entity &from);
std::vector<curve_piece> pieces_of(const ifc_model &in, const entity &curve);
/* Returns what lies between two parameters, which count the spans of all pieces before them; an absent one is an end of the curve.
 * Parameters outside of the curve set *whole, and all pieces are returned. */
std::vector<curve_piece> trimmed(const std::vector<curve_piece> &pieces, const value &from, const value &to, bool *whole);
/* Straight lines through the points, with arcs of these radii at the corners. */
std::vector<curve_piece> rounded(const std::vector<gp_Pnt> &points, const std::vector<double> &radii, bool closed);
TopoDS_Wire wire_of(const std::vector<curve_piece> &pieces);

/* --- ifc_profile.cc */
/* The faces of a profile, in the XY plane. */
std::vector<TopoDS_Face> profile_of(const ifc_model &in, const entity &profile);
/* The same; of an open profile its curve, which sweeps a surface. */
std::vector<TopoDS_Shape> profile_shapes_of(const ifc_model &in, const entity &profile);

/* --- ifc_sweep.cc */
/* Sweeps faces along pieces, square to them. The faces are in the XY plane, whose X is turned towards `x` at the start. `up` turns with
 * none of them. */
TopoDS_Shape swept(const std::vector<TopoDS_Face> &faces, const std::vector<curve_piece> &pieces, const gp_Dir &x, const gp_Dir &up);
TopoDS_Shape disk_of(const ifc_model &in, const entity &item);

/* --- ifc_sections.cc */
/* Joins faces that follow each other, holes to holes. */
TopoDS_Shape through_faces(const std::vector<TopoDS_Face> &faces);
TopoDS_Face moved(const TopoDS_Face &face, const gp_Trsf &place);
/* An IfcSectionedSpine or IfcSectionedSolidHorizontal. */
TopoDS_Shape sections_of(const ifc_model &in, const entity &item);

/* --- ifc_brep.cc */
/* An IfcAdvancedBrep, read by Open CASCADE's reader for STEP, whose entities are the same. */
TopoDS_Shape brep_of(const ifc_model &in, const entity &item);

/* --- ifc_faces.cc */
bool has_flat_faces(const std::string &type);
/* Whether the faces of such an item are bounded by edges, not by points alone: ifc_brep.cc reads these. */
bool has_edges(const ifc_model &in, const entity &item);
TopoDS_Shape flat_faces_of(const ifc_model &in, const entity &item);

/* --- ifc_solid.cc */
/* Whether items of this type are always built here. Others are where web-ifc fails. */
bool is_built(const std::string &type);
/* A solid item, or a boolean result of such. */
TopoDS_Shape solid_of(const ifc_model &in, const entity &item, int depth);

} // namespace ifc

#endif
