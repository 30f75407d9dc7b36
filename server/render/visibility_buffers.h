/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the pixels of pictures from still cameras are made of (which triangle, where in it, in what light), so that new values need new
   colours only. What such bytes mean is up to whoever draws; here they are kept, by content_shape_hash, up to a bound. The least recently
   used go first. Thread: the one of the GL context. */
#ifndef RENDER_VISIBILITY_BUFFERS_H
#define RENDER_VISIBILITY_BUFFERS_H
#include <stddef.h>
#include <stdint.h>

enum { VISIBILITY_BUFFERS = 16 };
struct visibility_buffer {
    uint64_t shape;
    void *at; /* NULL: empty */
    void (*destroy)(void *at);
    size_t bytes;
    uint64_t used;
};
struct visibility_buffers { /* zero-initialise, but for the bound */
    size_t bound_bytes, bytes;
    struct visibility_buffer buffers[VISIBILITY_BUFFERS];
    uint64_t uses;
};

/* Bytes that were made for that shape and filled. NULL: there are none. Valid until the next make or drop. */
void *visibility_buffers_find(struct visibility_buffers *store, uint64_t shape);
/* New ones, not set to anything; those that were there before go. The caller fills them at once, or drops them. NULL: more than the
   bound, or out of memory. */
void *visibility_buffers_make(struct visibility_buffers *store, uint64_t shape, size_t bytes);
/* Likewise, for what is not one piece: takes it over, and destroys it at once if it is more than the bound. */
void visibility_buffers_give(struct visibility_buffers *store, uint64_t shape, void *at, size_t bytes, void (*destroy)(void *at));
void visibility_buffers_drop(struct visibility_buffers *store, uint64_t shape);
void visibility_buffers_finish(struct visibility_buffers *store);

#endif
