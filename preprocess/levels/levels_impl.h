/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files that simplify an asset into levels (levels*.c). */
#ifndef PREPROCESS_LEVELS_IMPL_H
#define PREPROCESS_LEVELS_IMPL_H
#include "preprocess/levels/deviation.h"
#include "preprocess/levels/levels.h"

#define LEVELS_FILLING 0.001 /* error relative to the asset's size that covers one pixel when the asset fills the picture */
#define LEVELS_SMALL 0.012   /* error relative to the asset's size that covers one pixel when the asset spans a twelfth of the picture */
/* largest error of a level, relative to the asset's size: a coarser level would be drawn only where the asset is smaller than about a dozen
 * pixels */
#define LEVELS_FARTHEST 0.08

/* --- welds and parts (levels_welds.c) --- */

/* A weld is a group of vertices that the simplifier treats as one: equal in all attributes that must be kept. A part is a connected
 * component of triangles; welds at the same position count as connected. */
struct welds {
    const struct geometry *geometry;
    size_t count, part_count;
    uint32_t *of_vertex;
    float (*positions_m)[3];
    uint32_t *primitive;                      /* primitive of each weld */
    uint32_t *first, *vertices;               /* vertices grouped by weld */
    uint32_t *part;                           /* part of each weld */
    uint32_t *first_there;                    /* by weld: the first weld at the same position */
    float (*low_m)[3], (*high_m)[3], *size_m; /* bounding box of each part, and the diagonal of that box */
    double whole_m;                           /* size of the asset's main part (gap_split.h), metres */
};

/* Groups the geometry's vertices into welds and parts. Returns false if out of memory; call welds_finish() in both cases. */
bool welds_init(struct welds *welds, const struct geometry *geometry);
/* Frees the arrays. */
void welds_finish(struct welds *welds);

/* --- versions (levels_versions.c) --- */

/* The asset's triangles after some simplification; each version is made from the one before. */
struct version {
    uint32_t *welds; /* three weld indices per triangle */
    size_t count;    /* number of weld indices, three per triangle */
    float *error_m;  /* by part: largest distance to the part in the first version, in either direction; INFINITY: the part is gone */
    uint32_t *tris;  /* by part: number of triangles */
};

#define VERSIONS_MAX 24
struct versions {
    struct version at[VERSIONS_MAX]; /* the first is the original model */
    size_t count;
    struct deviation first; /* surface of the first version */
};

/* Simplifies the asset step by step, each version from the one before, and measures the error of each part. workers may be NULL. */
void versions_make(struct versions *versions, const struct welds *welds, struct workers *workers);
/* Builds a surface for measuring from triangles (`count` welds, three each). only: parts to include (NULL: all). */
void levels_surface(struct deviation *surface, const struct welds *welds, const char *only, const uint32_t *corners, size_t count);
/* Frees all versions. */
void versions_finish(struct versions *versions);

/* --- omitted parts (levels_omissions.c) --- */

struct omission {
    float from_m; /* the part is omitted from levels with at least this error, metres; INFINITY: the part is never omitted */
    bool alone;   /* no larger part is near: the part and the small parts around it are together at most from_m large */
};

/* Writes for each part the level error from which the part may be omitted: because it lies on much larger parts, or because the part and
 * the small parts around it are together smaller than a pixel. workers may be NULL. */
void omissions_find(struct omission *omissions, const struct welds *welds, struct workers *workers);

/* --- flattened parts (levels_facing.c) --- */

/* Writes the unit normal of the triangle of three welds, or the zero vector if it has no area. */
void levels_normal(const struct welds *welds, const uint32_t corners[3], float n[3]);
/* Returns the vertex of a weld, among those marked in `used`, whose normal fits the face normal n best, ignoring the normal's sign; with
 * one_side, the one whose normal is closest to n. Returns UINT32_MAX if none is marked. */
uint32_t levels_vertex(const struct welds *welds, const char *used, uint32_t weld, const float n[3], bool one_side);
/* Marks in contrary[part] the parts in which, already in the model, the winding of a face contradicts its vertex normals. */
void levels_find_contrary(const struct welds *welds, char *contrary);
/* Repairs the shading of thin parts that have lost their thickness: if a face's corner (welds, three each) has no used vertex facing its
 * side, moves it to a neighbouring weld that has one, at most about most_m (by part) away. Marks changed parts in `moved`. Returns false if
 * nothing was moved. */
bool levels_face(const struct welds *welds, const char *used, const char *contrary, const float *most_m, uint32_t *corners, size_t count,
                 char *moved);

#endif
