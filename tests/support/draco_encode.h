/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compresses meshes with Draco's own encoder, to make models for the importer's tests. */
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
    const float (*normals)[3];  /* vertex normals; NULL: none */
    const uint8_t (*colors)[4]; /* vertex colours; NULL: none */
    const uint32_t *indices;
    uint32_t vertex_count, index_count;
    int bits;        /* bits of quantisation; 0: none */
    bool sequential; /* true: sequential encoding; false: edgebreaker */
};

/* Returns the compressed mesh; the caller frees it with mem_free. *vertex_count: number of vertices that it decodes to. Unique
   ids: 0 for positions, followed by normals, then colours. Aborts on failure. */
unsigned char *draco_encode(const struct draco_input *input, size_t *size, uint32_t *vertex_count);

#ifdef __cplusplus
}
#endif
#endif
