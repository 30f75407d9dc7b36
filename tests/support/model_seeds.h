/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models of one wavy sheet, one for each encoding of glTF. */
#ifndef TESTS_MODEL_SEEDS_H
#define TESTS_MODEL_SEEDS_H
#include <stddef.h>
#include <stdint.h>

/* a wavy sheet of 2 m x 1 m: a grid of across x up squares, with waves along x; each array has vertex_count or index_count
   items */
struct wavy_sheet {
    uint32_t across, up, vertex_count, index_count;
    float (*positions)[3], (*normals)[3], (*texcoords)[2];
    uint8_t (*colors)[4];
    uint32_t *indices;
};

struct wavy_sheet sheet_create(uint32_t across, uint32_t up); /* The arrays are freed automatically after the test. */

enum { SEED_COUNT = 19 };

struct seed {
    const char *name;   /* file name of the model */
    uint32_t triangles; /* number of triangles in all nodes together */
    double tolerance_m; /* tolerance in metres when positions are compared */
    char *bytes;        /* the model file; the caller frees it with mem_free() */
    size_t size;
};

/* Writes the sheet as a glTF file in encoding number `number` of all; the sheet may have at most 65,535 vertices. */
void seed_make(struct seed *seed, int number, const struct wavy_sheet *sheet);

#endif
