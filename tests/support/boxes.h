/* SPDX-License-Identifier: GPL-3.0-or-later */
/* glTF models of boxes, whose areas and volumes are known. */
#ifndef TESTS_BOXES_H
#define TESTS_BOXES_H
#include "tests/support/model_maker.h"

/* Adds a node with a mesh of its own, a closed box of 12 triangles and 8 vertices between the corners low and high, in the
   model's units and axes. Returns the index of the mesh. */
int boxes_add(struct model_maker *maker, const char *node, const double low[3], const double high[3]);
/* Adds a primitive with these vertices to a mesh. mode: glTF's number of the kind of primitive (0 points, 1 lines, 4
   triangles). */
void boxes_add_primitive(struct model_maker *maker, int mesh, int mode, const float (*corners)[3], size_t count);

#endif
