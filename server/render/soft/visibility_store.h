/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Store of visibility buffers of frames whose camera stands still, keyed by content_hash_shape(), so that a frame with new
   values only needs new colours. The store does not know what a buffer contains. If the buffers exceed the memory limit, the
   least recently used ones are evicted. Call only in the thread that owns the GL context. */
#ifndef RENDER_SOFT_VISIBILITY_STORE_H
#define RENDER_SOFT_VISIBILITY_STORE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { VISIBILITY_SLOTS = 16 };
struct visibility_slot {
    uint64_t shape;
    void *at; /* the buffer; NULL: empty slot */
    void (*destroy)(void *at);
    size_t bytes;
    uint64_t used;
};
struct visibility_store { /* zero-initialise, then set bound_bytes */
    size_t bound_bytes, bytes;
    /* true: if the newest buffer alone exceeds the memory limit, it is kept as the only one, until visibility_store_bound() is called */
    bool keeps_newest;
    struct visibility_slot buffers[VISIBILITY_SLOTS];
    uint64_t uses;
};

/* Returns the visibility buffer of frames with this hash, valid until the next visibility_store_give() or
   visibility_store_drop(). NULL: none. */
void *visibility_store_find(struct visibility_store *store, uint64_t shape);
/* Takes ownership of a visibility buffer and replaces any buffer with the same hash. Destroys the buffer immediately if it exceeds the
   memory limit and keeps_newest is false. */
void visibility_store_give(struct visibility_store *store, uint64_t shape, void *at, size_t bytes, void (*destroy)(void *at));
void visibility_store_bound(struct visibility_store *store, size_t bytes); /* sets the memory limit and evicts buffers that exceed it */
void visibility_store_drop(struct visibility_store *store, uint64_t shape);
void visibility_store_finish(struct visibility_store *store);

#endif
