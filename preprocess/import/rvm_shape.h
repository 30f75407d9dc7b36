/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tessellates the primitives of RVM files (AVEVA PDMS, E3D, Marine). The number of corners of a round section depends only on
 * its radius and the chord error. The direction of its first corner depends only on the section's plane. Therefore two
 * primitives that meet with equal sections have the same corners there. Call from any thread. */
#ifndef PREPROCESS_IMPORT_RVM_SHAPE_H
#define PREPROCESS_IMPORT_RVM_SHAPE_H
#include "preprocess/import/cad_model.h"

enum rvm_kind { /* kinds of primitives; the values are the numbers used in RVM files */
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
    size_t first, count; /* index of the contour's first point in rvm_shape.points; number of its points */
    bool begins_polygon; /* true: this contour begins a polygon; false: it is a hole or another outline of the preceding polygon */
};

/* One primitive of an RVM file. Lengths in its own frame are usually in millimetres; to_plant transforms to the plant's frame in metres. */
struct rvm_shape {
    enum rvm_kind kind;
    double to_plant[12];                /* 3 x 4 matrix by columns; the last column is the translation */
    double numbers[RVM_MAX_NUMBERS];    /* dimensions of the primitive in the order of the RVM file; the first rvm_numbers[kind] are used */
    const struct rvm_contour *contours; /* contours, for the kind RVM_FACETS; NULL for other kinds */
    const double (*points)[3];          /* points in the primitive's own frame, for the kind RVM_FACETS */
    size_t contour_count;
    uint32_t open_faces; /* bit i set: face i of rvm_shape_faces() is left out, because a neighbour covers it */
};

extern const int rvm_numbers[RVM_FACETS + 1]; /* by kind of primitive: number of dimensions that follow the chunk's header */

/* A flat face of a primitive in the plant's frame: a circle or a rectangle. */
struct rvm_face {
    double centre_m[3], outward[3];
    double radius_m;                    /* radius of a circular face in metres; 0: the face is a rectangle */
    double half_m[2], directions[2][3]; /* rectangle: half of its side lengths in metres, and unit vectors along its sides */
};
enum { RVM_MAX_FACES = 6 };

/* Finds the flat faces of a primitive that a neighbour's face may cover, in the order of the bits of `open_faces`: both ends of
 * round or bent primitives, the base of a dish, the faces of a box, and top and bottom of a pyramid. Snouts with sheared ends
 * have none. Returns the number of faces. */
int rvm_shape_faces(const struct rvm_shape *shape, struct rvm_face faces[RVM_MAX_FACES]);

/* Appends the primitive's triangles (or its line) to the node. Chords deviate from the true surface by at most chord_m, but a
 * full turn always has between 8 and 256 corners. Returns NULL, or why nothing was added, such as "has no extent". */
const char *rvm_shape_tessellate(const struct rvm_shape *shape, double chord_m, struct cad_node *node);

#endif
