/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The primitives of RVM files (AVEVA PDMS, E3D, Marine) as triangles. A round section has a number of corners that depends on its radius
 * and the chord error alone, and its first corner lies in a direction that depends on its plane alone: where two primitives meet with equal
 * sections, they meet corner to corner. Thread: any. */
#ifndef PREPROCESS_IMPORT_RVM_SHAPE_H
#define PREPROCESS_IMPORT_RVM_SHAPE_H
#include "preprocess/import/cad_model.h"

enum rvm_kind { /* as the files number them */
                RVM_PYRAMID = 1,
                RVM_BOX,
                RVM_RECTANGULAR_TORUS,
                RVM_CIRCULAR_TORUS,
                RVM_ELLIPTICAL_DISH,
                RVM_SPHERICAL_DISH,
                RVM_SNOUT,
                RVM_CYLINDER,
                RVM_SPHERE,
                RVM_LINE,
                RVM_FACETS
};
enum { RVM_MAX_NUMBERS = 9 };

struct rvm_contour {
    size_t first, count; /* in struct rvm_shape's points */
    bool begins_polygon; /* else it belongs to the polygon before it */
};

/* One primitive. Its own frame is in millimetres as a rule; `to_plant` leads to the plant's frame in metres. */
struct rvm_shape {
    enum rvm_kind kind;
    double to_plant[12];                /* three columns of three, then the translation */
    double numbers[RVM_MAX_NUMBERS];    /* in the order of the file: rvm_numbers[kind] of them */
    const struct rvm_contour *contours; /* RVM_FACETS */
    const double (*points)[3];          /* likewise, in the primitive's own frame */
    size_t contour_count;
    uint32_t open_faces; /* bit i: the i-th of rvm_shape_faces is covered by a neighbour and is left out */
};

extern const int rvm_numbers[RVM_FACETS + 1]; /* how many numbers follow the header of each kind */

/* A flat face of a primitive, in the plant's frame: a circle, or a rectangle about its centre. */
struct rvm_face {
    double centre_m[3], outward[3];
    double radius_m;                    /* 0: a rectangle */
    double half_m[2], directions[2][3]; /* half the sides of a rectangle, and where they point */
};
enum { RVM_MAX_FACES = 6 };

/* Finds the flat faces that a neighbour may cover, numbered as in `open_faces`, and returns how many they are: both ends of what is
 * round or bent, the base of a dish, the faces of a box, top and bottom of a pyramid. Snouts with sheared ends have none. */
int rvm_shape_faces(const struct rvm_shape *shape, struct rvm_face faces[RVM_MAX_FACES]);

/* Appends the primitive's triangles (or its line) to the node. No chord is further than chord_m from the true surface, except that a whole
 * turn has 8 to 256 corners. Returns NULL; or why nothing was added, as "has no extent". */
const char *rvm_shape_tessellate(const struct rvm_shape *shape, double chord_m, struct cad_node *node);

#endif
