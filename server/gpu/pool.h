/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Per-vertex numbers of many assets in a few GPU buffers (pages), so that one draw can show many assets. Shaders read the
   buffers as texels. Each slice (an asset's range in a page) begins at a multiple of POOL_BLOCK texels, because shaders address
   slices by block index. Call only in the thread that owns the GL context. */
#ifndef GPU_POOL_H
#define GPU_POOL_H
#include <stdbool.h>
#include <stddef.h>

#include <glad/gl.h>

#include "base/log/log.h"

/* texels per block; must match shaders/instance.glsl. With 4-byte texels, a block meets the strictest alignment that GL may
   demand of storage buffer offsets */
enum { POOL_BLOCK = 64 };

struct pool;
struct pool_page {
    struct pool *pool;
    GLuint buffer, texture;
    size_t texels;
    struct pool_slice *first; /* first slice (an asset's range) of the page; the page's slices are listed in order of offset */
};
struct pool_slice {
    struct pool_page *page;
    size_t block, count; /* block: index of the slice's first block in the page; count: number of texels */
    int holds;
    struct pool_slice *next;
};

/* Creates a pool. format: GL format of a texel. All slices (ranges of assets) must be released before the pool is destroyed. */
struct pool *pool_create(struct log *log, const char *name, GLenum format, size_t texel_bytes, GLbitfield flags);
void pool_destroy(struct pool **pool); /* frees the pool and its buffers and sets *pool to NULL; accepts a pointer to NULL */
/* Announces the slices (ranges of assets) that will be taken next, so that they get into the same page if possible. texels: sum
   of their sizes. */
void pool_expect(struct pool *pool, size_t texels, size_t slices);
/* Takes a slice (range for one asset) of `count` texels, with one reference. Logs and returns NULL if the GPU has no room for
   it. */
struct pool_slice *pool_take(struct pool *pool, size_t count);
struct pool_slice *pool_ref(struct pool_slice *slice); /* NULL is fine */
void pool_unref(struct pool_slice **slice);            /* drops a reference and sets *slice to NULL; accepts a pointer to NULL */
size_t pool_offset(const struct pool_slice *slice);    /* returns the slice's offset in bytes in its page's buffer */
size_t pool_bytes(const struct pool_slice *slice);
size_t pool_bytes_taken(const struct pool *pool); /* bytes of all pages */

#endif
