/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models of a rolling sheet, one for each way in which glTF can say it. */
#ifndef TESTS_MODEL_SEEDS_H
#define TESTS_MODEL_SEEDS_H
#include <stddef.h>
#include <stdint.h>

struct wavy_sheet { /* a grid of across x up squares over 2 m x 1 m, rolling along x; every array has vertex_count or index_count items */
    uint32_t across, up, vertex_count, index_count;
    float (*positions)[3], (*normals)[3], (*texcoords)[2];
    uint8_t (*colors)[4];
    uint32_t *indices;
};

void sheet_init(struct wavy_sheet *sheet, uint32_t across, uint32_t up);
void sheet_finish(struct wavy_sheet *sheet);

enum { SEED_COUNT = 19 };

struct seed {
    const char *name;   /* of its file */
    uint32_t triangles; /* of all nodes together */
    double tolerance_m; /* of its positions */
    char *bytes;        /* mem_free */
    size_t size;
};

/* Makes the seed of that number from a sheet of at most 65535 vertices. */
void seed_make(struct seed *seed, int number, const struct wavy_sheet *sheet);

#endif
