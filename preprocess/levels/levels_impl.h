/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files that simplify an asset into levels (levels*.c). */
#ifndef PREPROCESS_LEVELS_IMPL_H
#define PREPROCESS_LEVELS_IMPL_H
#include "preprocess/levels/deviation.h"
#include "preprocess/levels/levels.h"

#define LEVELS_FILLING 0.001 /* of the size: as a pixel where the asset fills the picture, */
#define LEVELS_SMALL 0.012   /* likewise, where it is a twelfth of it */
#define LEVELS_FARTHEST 0.08 /* of the size: a level that errs by more is never drawn larger than a dozen pixels */

/* --- welds and parts (levels_welds.c) --- */

/* Groups of vertices that the simplifier treats as one: equal in all attributes that it must keep. Welds hang together in parts (connected
   components, by position). */
struct welds {
    const struct geometry *geometry;
    size_t count, part_count;
    uint32_t *of_vertex;
    float (*positions_m)[3];
    uint32_t *primitive;                      /* of each weld */
    uint32_t *first, *vertices;               /* of each weld: its vertices */
    uint32_t *part;                           /* of each weld */
    uint32_t *first_there;                    /* of each weld: the first one at its place */
    float (*low_m)[3], (*high_m)[3], *size_m; /* of each part: its box, and that box's diagonal */
    double whole_m;                           /* size of the main part (gap_split.h) */
};

/* Groups the geometry's vertices into welds and parts. Returns false if out of memory; call welds_finish() in both cases. */
bool welds_init(struct welds *welds, const struct geometry *geometry);
/* Frees the arrays. */
void welds_finish(struct welds *welds);

/* --- versions (levels_versions.c) --- */

/* The triangles after so much simplifying, each version from the one before. */
struct version {
    uint32_t *welds; /* three to a triangle */
    size_t count;    /* of them */
    float *error_m;  /* of each part: no point of it is farther from its first version, nor the other way round; INFINITY: it is gone */
    uint32_t *tris;  /* of each part */
};

#define VERSIONS_MAX 24
struct versions {
    struct version at[VERSIONS_MAX]; /* the first as the model is */
    size_t count;
    struct deviation first; /* its surface */
};

/* Simplifies the asset step by step, each version from the one before, and measures the error of each part. workers may be NULL. */
void versions_make(struct versions *versions, const struct welds *welds, struct workers *workers);
/* Makes of triangles (welds, three each: count of them) a surface that is measured, of these parts only (NULL: of all). */
void levels_surface(struct deviation *surface, const struct welds *welds, const char *only, const uint32_t *corners, size_t count);
/* Frees all versions. */
void versions_finish(struct versions *versions);

/* --- parts that far levels leave out (levels_omissions.c) --- */

struct omission {
    float from_m; /* left out of levels that err by so much or more; INFINITY: of none */
    bool alone;   /* no others are near; it is no larger than from_m */
};

/* Decides for each part from which level error on it may be left out: where it lies on much larger parts, or is smaller than a pixel
   together with others of its kind around it. workers may be NULL. */
void omissions_find(struct omission *omissions, const struct welds *welds, struct workers *workers);

/* --- faces of what has no thickness any more (levels_facing.c) --- */

/* Writes the unit normal of the triangle of three welds, or 0 if it has no area. */
void levels_normal(const struct welds *welds, const uint32_t corners[3], float n[3]);
/* Returns, of a weld's vertices marked in `used`, the one whose normal fits the face normal n best, also if the face is wound the wrong
   way; with one_side, the one whose normal points most along n. UINT32_MAX if none is used. */
uint32_t levels_vertex(const struct welds *welds, const char *used, uint32_t weld, const float n[3], bool one_side);
/* Marks the parts that have a face in the model pointing against its vertices' normals. */
void levels_find_contrary(const struct welds *welds, char *contrary);
/* Where a thin part has lost its thickness, moves corners of faces (welds, three each) that have no used vertex on their side to a
   neighbouring weld that has one, no farther than most_m (by part). Marks the parts that changed in `moved`. Returns false if nothing was
   moved. */
bool levels_face(const struct welds *welds, const char *used, const char *contrary, const float *most_m, uint32_t *corners, size_t count,
                 char *moved);

#endif
