/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draco's own encoder, for models to read back. */
#ifndef TESTS_DRACO_ENCODE_H
#define TESTS_DRACO_ENCODE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct draco_input {
    const float (*positions)[3];
    const float (*normals)[3];  /* NULL: none */
    const uint8_t (*colors)[4]; /* NULL: none */
    const uint32_t *indices;
    uint32_t vertex_count, index_count;
    int bits;        /* of quantisation; 0: none */
    bool sequential; /* else edgebreaker */
};

/* The compressed mesh, to be freed with mem_free; vertex_count is what it decodes to. Unique ids: 0 positions, then normals, then colours.
   Aborts when it cannot. */
unsigned char *draco_encode(const struct draco_input *input, size_t *size, uint32_t *vertex_count);

#ifdef __cplusplus
}
#endif
#endif
