/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the simplifying share. */
#ifndef PREPROCESS_LEVELS_IMPL_H
#define PREPROCESS_LEVELS_IMPL_H
#include "preprocess/levels/deviation.h"
#include "preprocess/levels/levels.h"

#define LEVELS_FARTHEST 0.08 /* of the size: a level that errs by more is never drawn larger than a dozen pixels */

/* --- welds and parts (levels_knots.c) --- */

/* Vertices that the simplifier takes for one: equal in all that it has to keep. Welds hang together in parts, by place. */
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
    double whole_m;                           /* of them all */
};

bool welds_init(struct welds *welds, const struct geometry *geometry); /* false: out of memory; finish copes */
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

void versions_make(struct versions *versions, const struct welds *welds, struct workers *workers);
void versions_finish(struct versions *versions);

/* --- parts that far levels leave out (levels_parts.c) --- */

struct omission {
    float from_m; /* left out of levels that err by so much or more; INFINITY: of none */
    bool alone;   /* no others are near; it is no larger than from_m */
};

/* Of each part. A part may be left out where it lies on others that are much larger, and where it is no more than a pixel large, and so are
   all others of its kind around it together. */
void omissions_find(struct omission *omissions, const struct welds *welds, struct workers *workers);

/* --- faces of what has no thickness any more (levels_facing.c) --- */

/* Unit length, or 0. */
void levels_normal(const struct welds *welds, const uint32_t corners[3], float n[3]);
/* Of a weld's used vertices the one whose normal suits a face best, also where it is wound the wrong way; one_side: whose normal looks
   its way most. UINT32_MAX: none is used. */
uint32_t levels_vertex(const struct welds *welds, const char *used, uint32_t weld, const float n[3], bool one_side);
/* By part: some face of the model looks the other way than its vertices. */
void levels_find_contrary(const struct welds *welds, char *contrary);
/* Moves corners of faces (welds, three each) that have no used vertex of their side to a weld beside that has one, if it is no farther than
   most_m, by part. Welds that had corners still have some. moved: by part. False: nothing was moved. */
bool levels_face(const struct welds *welds, const char *used, const char *contrary, const float *most_m, uint32_t *corners, size_t count,
                 char *moved);

#endif
