/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers by vertex of many assets in few buffers, which shaders read as texels: so one draw can show many assets. Slices begin at whole
   blocks, in which shaders count. Thread: the one of the GL context. */
#ifndef GPU_POOL_H
#define GPU_POOL_H
#include <stdbool.h>
#include <stddef.h>

#include <glad/gl.h>

#include "base/log/log.h"

enum { POOL_BLOCK = 64 }; /* texels; as in shaders/instance.glsl; of 4 bytes, what GL asks of offsets into storage buffers at most */

struct pool;
struct pool_page {
    struct pool *pool;
    GLuint buffer, texture;
    size_t texels;
    struct pool_slice *first; /* of those in it, by place */
};
struct pool_slice {
    struct pool_page *page;
    size_t block, count; /* where it begins; of texels */
    int holds;
    struct pool_slice *next;
};

/* format: of a texel. Every slice is to be released before the pool is destroyed. */
struct pool *pool_create(struct log *log, const char *name, GLenum format, size_t texel_bytes, GLbitfield flags);
void pool_destroy(struct pool **pool); /* &NULL is fine; leaves NULL */
/* So many slices of so many texels together are to be taken next: they shall lie in one page, if they can. */
void pool_expect(struct pool *pool, size_t texels, size_t slices);
/* Held once. NULL: the GPU has no room for so many texels, logged. */
struct pool_slice *pool_take(struct pool *pool, size_t count);
struct pool_slice *pool_ref(struct pool_slice *slice); /* NULL is fine */
void pool_unref(struct pool_slice **slice);            /* &NULL is fine; leaves NULL */
size_t pool_offset(const struct pool_slice *slice);    /* bytes, in the page's buffer */
size_t pool_bytes(const struct pool_slice *slice);
size_t pool_bytes_taken(const struct pool *pool); /* of all pages */

#endif
