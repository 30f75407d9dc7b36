/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds shapes of Open CASCADE, in millimetres, from representation items (geometry statements) of an IFC file. All functions throw
 * ifc::unsupported or Standard_Failure for items that they cannot build. Thread: one. */
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

/* maximum number of curves, booleans or placements that refer to each other in a chain; a longer chain is taken for a cycle */
constexpr int MAX_CHAIN = 200;

struct ifc_model {
    const file &statements;
    double length; /* length unit of the IFC file in millimetres */
    double angle;  /* angle unit of the IFC file in radians */
    double chord_mm;
    std::map<int, int> grids; /* by id of a grid axis: id of the placement of its grid; without the axes of grids that have none */
    bool lacks_grid;          /* true: a grid statement is damaged, so that `grids` lacks its axes */
};

struct triangles {
    std::vector<gp_Pnt> points;
    std::vector<gp_Vec> normals;
    std::vector<uint32_t> corners;
};

/* A piece of a curve. `span`: length of its parameter range in the units of the IFC file. */
struct curve_piece {
    Handle(Geom_Curve) curve;
    double first, last; /* parameter range; first > last: the piece runs against the curve's direction */
    double span;
    double level_mm = 0; /* length, in plan view, of a piece of an alignment; 0: the curve is not an alignment */

    gp_Pnt start() const;
    gp_Pnt end() const;
    gp_Vec tangent(bool at_end) const; /* unit tangent vector of the piece at its start or end, in the direction of travel */
};

/* --- ifc_triangles.cc */
triangles triangles_of(const ifc_model &in, const TopoDS_Shape &shape);
/* Returns the volume in cubic millimetres that the triangles enclose; negative if they face inwards. */
double volume_of(const triangles &all);

/* --- ifc_curve.cc */
double length_of(const curve_piece &part); /* Returns the length of a piece of a curve, in millimetres. */
/* Returns the length along which IFC measures distances on a piece of a curve, in mm: for an alignment its length in plan view, for any
 * other curve its length. */
double distance_of(const curve_piece &part);
gp_Pnt point_of(const ifc_model &in, const value &reference);
/* Returns the points of an IfcCartesianPointList. */
std::vector<gp_Pnt> points_of(const ifc_model &in, const value &reference);
/* Returns the direction of an IfcDirection, or `otherwise` if the reference is absent. */
gp_Dir direction_of(const ifc_model &in, const value &reference, const gp_Dir &otherwise);
/* Returns the placement of an IfcAxis2Placement2D or 3D, or the identity if the reference is absent. */
gp_Trsf placement_of(const ifc_model &in, const value &reference);
/* Returns the transform of an IfcCartesianTransformationOperator2D or 3D. */
gp_GTrsf operator_of(const ifc_model &in, const entity &from);
std::vector<curve_piece> pieces_of(const ifc_model &in, const entity &curve);
/* Returns the part of a curve between two parameters. A parameter is the sum of the spans of all pieces from the start of the curve. An
 * absent parameter means the start or the end of the curve. If a parameter is outside the curve, sets *whole and returns all pieces. */
std::vector<curve_piece> trimmed(const std::vector<curve_piece> &pieces, const value &from, const value &to, bool *whole);
/* Returns straight lines between the points, with corners rounded by arcs of these radii. */
std::vector<curve_piece> rounded(const std::vector<gp_Pnt> &points, const std::vector<double> &radii, bool closed);
TopoDS_Wire wire_of(const std::vector<curve_piece> &pieces);

/* --- ifc_alignment.cc */
bool is_alignment(const ifc_model &in, const entity &curve);
std::vector<curve_piece> alignment_of(const ifc_model &in, const entity &curve);

/* --- ifc_placement.cc */
/* Adds the axes of the IfcGrid with this id to out->grids. If several grids have the same axis, the first counts. */
void add_grid(int id, ifc_model *out);
gp_Trsf object_placement(const ifc_model &in, const value &reference);
/* Returns the statements of a local placement that is equal to an IfcGridPlacement and has its number. `unused` and the three numbers after
 * it become the numbers of other statements. */
std::string as_local_placement(const ifc_model &in, const entity &from, int unused);

/* --- ifc_profile.cc */
/* Returns the faces of an IFC profile (cross-section), in the XY plane. */
std::vector<TopoDS_Face> profile_of(const ifc_model &in, const entity &profile);
/* Returns the faces of an IFC profile (cross-section). For an open profile, returns its curve instead, which sweeps a surface and not a
 * solid. */
std::vector<TopoDS_Shape> profile_shapes_of(const ifc_model &in, const entity &profile);

/* --- ifc_sweep.cc */
/* Sweeps the faces of a profile perpendicularly along the pieces of a curve. The faces lie in the XY plane; at the start their X axis is
 * turned towards `x`. `up` is a direction that stays fixed along the whole path. */
TopoDS_Shape swept(const std::vector<TopoDS_Face> &faces, const std::vector<curve_piece> &pieces, const gp_Dir &x, const gp_Dir &up);
TopoDS_Shape disk_of(const ifc_model &in, const entity &item);

/* --- ifc_sections.cc */
/* Joins consecutive cross-sections to a solid: outline to outline and hole to hole. */
TopoDS_Shape through_faces(const std::vector<TopoDS_Face> &faces);
/* Sweeps the faces of a profile along a curve that is not perpendicular to `reference` everywhere. The faces are perpendicular to the
 * curve; their X axes point towards `reference`. */
TopoDS_Shape along_frames(const ifc_model &in, const std::vector<TopoDS_Face> &faces, const std::vector<curve_piece> &pieces,
                          const gp_Dir &reference);
TopoDS_Face moved(const TopoDS_Face &face, const gp_Trsf &place);
/* Builds an IfcSectionedSpine or IfcSectionedSolidHorizontal. */
TopoDS_Shape sections_of(const ifc_model &in, const entity &item);

/* --- ifc_brep.cc */
/* Builds an IfcAdvancedBrep with Open CASCADE's STEP reader: STEP has the same entities under other names. */
TopoDS_Shape brep_of(const ifc_model &in, const entity &item);

/* --- ifc_faces.cc */
bool has_flat_faces(const std::string &type);
/* Returns whether the faces of a geometry item are bounded by edges (curves), and not only by points. ifc_brep.cc reads items with
 * edges. */
bool has_edges(const ifc_model &in, const entity &item);
TopoDS_Shape flat_faces_of(const ifc_model &in, const entity &item);

/* --- ifc_solid.cc */
/* Returns whether this program always builds geometry items of this type. Items of other types are built only if web-ifc fails on them. */
bool is_built(const std::string &type);
/* Builds a solid from an IFC geometry item, or from the boolean result of such items. depth: number of items that refer to this one in a
 * chain (MAX_CHAIN). */
TopoDS_Shape solid_of(const ifc_model &in, const entity &item, int depth);

} // namespace ifc

#endif
