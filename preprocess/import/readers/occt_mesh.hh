/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tessellates shapes with the library Open CASCADE. Thread: one per shape. */
#ifndef PREPROCESS_IMPORT_READERS_OCCT_MESH_HH
#define PREPROCESS_IMPORT_READERS_OCCT_MESH_HH
#include <TopoDS_Shape.hxx>

struct mesh_outcome {
    int faces = 0, missing = 0; /* faces: number of faces; missing: number of faces that have an area but no triangles */
};

/* Tessellates all faces of a shape in millimetres. Faces that Open CASCADE cannot tessellate are tried again as B-spline surfaces.
 * chord_mm: largest distance of a facet from its surface; angle_rad: largest angle between neighbouring facets. */
mesh_outcome occt_tessellate(const TopoDS_Shape &shape, double chord_mm, double angle_rad, bool parallel);

#endif
