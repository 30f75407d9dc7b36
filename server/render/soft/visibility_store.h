/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the pixels of pictures from still cameras are made of (which triangle, where in it, in what light), so that new values need new
   colours only. What that is made of is up to whoever draws; here it is kept, by content_hash_shape, up to a bound. The least recently
   used go first. Thread: the one of the GL context. */
#ifndef RENDER_SOFT_VISIBILITY_STORE_H
#define RENDER_SOFT_VISIBILITY_STORE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { VISIBILITY_SLOTS = 16 };
struct visibility_slot {
    uint64_t shape;
    void *at; /* NULL: empty */
    void (*destroy)(void *at);
    size_t bytes;
    uint64_t used;
};
struct visibility_store { /* zero-initialise, but for the bound */
    size_t bound_bytes, bytes;
    bool keeps_newest; /* even if it is more than the bound, alone, until that is set the next time */
    struct visibility_slot buffers[VISIBILITY_SLOTS];
    uint64_t uses;
};

/* What was given for that shape. NULL: there is nothing. Valid until the next give or drop. */
void *visibility_store_find(struct visibility_store *store, uint64_t shape);
/* Takes over what was made for that shape, in place of what was there before; destroys it at once if it is more than the bound, and the
   newest is not kept in any case. */
void visibility_store_give(struct visibility_store *store, uint64_t shape, void *at, size_t bytes, void (*destroy)(void *at));
void visibility_store_bound(struct visibility_store *store, size_t bytes); /* from now on */
void visibility_store_drop(struct visibility_store *store, uint64_t shape);
void visibility_store_finish(struct visibility_store *store);

#endif
