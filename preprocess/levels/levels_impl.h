/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declarations shared by the files that simplify an asset into levels (levels*.c). */
#ifndef PREPROCESS_LEVELS_IMPL_H
#define PREPROCESS_LEVELS_IMPL_H
#include "preprocess/levels/deviation.h"
#include "preprocess/levels/levels.h"

/* error of a level of detail, relative to the asset's size, that equals one pixel when the asset fills the picture */
#define LEVELS_FILLING 0.001
/* error of a level of detail, relative to the asset's size, that equals one pixel when the asset spans a twelfth of the picture */
#define LEVELS_SMALL 0.012
/* largest error of a level, relative to the asset's size; a coarser level would only be drawn where the asset is smaller than
 * about a dozen pixels */
#define LEVELS_FARTHEST 0.08

/* --- welds (groups of equal vertices) and parts (connected components), made by levels_welds.c --- */

/* A weld is a group of vertices that the simplifier treats as one: they have the same position and equal values of all
 * attributes to be kept. A part is a connected component of triangles; welds at the same position count as connected. */
struct welds {
    const struct geometry *geometry;
    size_t count, part_count;
    uint32_t *of_vertex;
    float (*positions_m)[3];
    uint32_t *primitive;                      /* by weld (group of equal vertices): its primitive */
    uint32_t *first, *vertices;               /* indices of vertices, grouped by weld (group of equal vertices) */
    uint32_t *part;                           /* by weld (group of equal vertices): its part (connected component) */
    uint32_t *first_there;                    /* by weld (group of equal vertices): lowest index of a weld at the same position */
    float (*low_m)[3], (*high_m)[3], *size_m; /* by part (connected component): its bounding box, and the length of the box's diagonal */
    double whole_m;                           /* size of the asset's main part (base/math/gap_split.h), metres */
};

/* Groups the geometry's vertices into welds (groups of equal vertices) and parts (connected components). Returns false if out
 * of memory. In either case, call welds_finish(). */
bool welds_init(struct welds *welds, const struct geometry *geometry);
/* Frees the arrays. */
void welds_finish(struct welds *welds);

/* --- versions (levels_versions.c) --- */

/* A version: the asset's triangles after some simplification steps. Each version is made from the previous one. */
struct version {
    uint32_t *welds; /* by triangle corner: its weld (group of equal vertices) */
    size_t count;    /* number of elements of `welds`; three per triangle */
    /* by part (connected component): largest distance between this version and the first one, in either direction, metres;
     * INFINITY: the part has no triangles left */
    float *error_m;
    uint32_t *tris; /* by part (connected component): number of its triangles */
};

#define VERSIONS_MAX 24
struct versions {
    struct version at[VERSIONS_MAX]; /* versions (simplification steps), each coarser than the previous one; at[0] is the original model */
    size_t count;
    struct deviation first; /* surface of the original model; errors are measured from it */
};

/* Makes the versions (simplification steps), simplifying each from the previous one, and measures the error of each part in
 * each version. workers may be NULL. */
void versions_make(struct versions *versions, const struct welds *welds, struct workers *workers);
/* Prepares a surface for measuring distances of triangles from it: `count` welds (groups of equal vertices), three per
 * triangle. only: by part, nonzero if it is included; NULL: all parts are. */
void levels_surface(struct deviation *surface, const struct welds *welds, const char *only, const uint32_t *corners, size_t count);
/* Frees all versions. */
void versions_finish(struct versions *versions);

/* --- omitted parts (levels_omissions.c) --- */

struct omission {
    float from_m; /* smallest error, in metres, of a level of detail that omits the part; INFINITY: no level omits it */
    /* true: no larger part is near: the part belongs to a group of small neighbouring parts, whose size is from_m */
    bool alone;
};

/* Writes, by part (connected component), the minimum error of a level of detail that may omit it. Either the part lies on much
 * larger parts, or it and the small parts around it are together no larger than the error. workers may be NULL. */
void omissions_find(struct omission *omissions, const struct welds *welds, struct workers *workers);

/* --- flattened parts (levels_facing.c) --- */

/* Writes the unit normal of the triangle whose corners are these three welds (groups of equal vertices), or the zero vector if
 * it has no area. */
void levels_normal(const struct welds *welds, const uint32_t corners[3], float n[3]);
/* Returns the vertex of a weld (group of equal vertices at one position) whose normal is closest to the face normal n. used: by
 * vertex: nonzero if the level may use it; other vertices are ignored. Without one_side, a normal in the opposite direction
 * counts as equally close. Returns UINT32_MAX if the level may use no vertex of the weld. */
uint32_t levels_vertex(const struct welds *welds, const char *used, uint32_t weld, const float n[3], bool one_side);
/* Sets contrary[part] for each part in which the winding of a face contradicts its vertex normals even in the original model;
 * the shading of such a part cannot be repaired. */
void levels_find_contrary(const struct welds *welds, char *contrary);
/* Repairs the shading of thin parts flattened by simplification: there, a face may have corners whose vertex normals all point
 * to its back. corners: three welds (groups of equal vertices at one position) per face. used: by vertex, nonzero if the level
 * may use it. If a corner's weld has no usable vertex with a normal to the front, moves the corner to a neighbouring weld with
 * such a vertex. Moves are at most about most_m[part] long. contrary: from levels_find_contrary(); these parts stay unchanged.
 * Sets moved[part] for changed parts. Returns false if no corner was moved. */
bool levels_face(const struct welds *welds, const char *used, const char *contrary, const float *most_m, uint32_t *corners, size_t count,
                 char *moved);

#endif
