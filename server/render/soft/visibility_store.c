/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Store of visibility buffers: a fixed array of slots, with a limit on the total size of the buffers. */
#include "render/soft/visibility_store.h"

static void empty(struct visibility_store *store, struct visibility_slot *buffer)
{
    if (buffer->at)
        buffer->destroy(buffer->at);
    store->bytes -= buffer->bytes;
    *buffer = (struct visibility_slot){ 0 };
}

static struct visibility_slot *find(struct visibility_store *store, uint64_t shape)
{
    for (int i = 0; i < VISIBILITY_SLOTS; i++)
        if (store->buffers[i].at && store->buffers[i].shape == shape)
            return &store->buffers[i];
    return NULL;
}

/* Returns the least recently used slot for a visibility buffer. empty_too: true: empty slots are also considered, and count as
   older than all others. */
static struct visibility_slot *oldest(struct visibility_store *store, bool empty_too)
{
    struct visibility_slot *found = NULL;
    for (int i = 0; i < VISIBILITY_SLOTS; i++) {
        struct visibility_slot *buffer = &store->buffers[i];
        if ((buffer->at || empty_too) && (!found || buffer->used < found->used))
            found = buffer;
    }
    return found;
}

void *visibility_store_find(struct visibility_store *store, uint64_t shape)
{
    struct visibility_slot *buffer = find(store, shape);
    if (!buffer)
        return NULL;
    buffer->used = ++store->uses;
    return buffer->at;
}

void visibility_store_give(struct visibility_store *store, uint64_t shape, void *at, size_t bytes, void (*destroy)(void *at))
{
    visibility_store_drop(store, shape);
    if (bytes > store->bound_bytes && !store->keeps_newest) {
        destroy(at);
        return;
    }
    while (store->bytes > 0 && store->bytes + bytes > store->bound_bytes)
        empty(store, oldest(store, false));
    struct visibility_slot *buffer = oldest(store, true);
    empty(store, buffer);
    *buffer = (struct visibility_slot){ .shape = shape, .at = at, .destroy = destroy, .bytes = bytes, .used = ++store->uses };
    store->bytes += bytes;
}

void visibility_store_bound(struct visibility_store *store, size_t bytes)
{
    store->bound_bytes = bytes;
    while (store->bytes > bytes)
        empty(store, oldest(store, false));
}

void visibility_store_drop(struct visibility_store *store, uint64_t shape)
{
    struct visibility_slot *buffer = find(store, shape);
    if (buffer)
        empty(store, buffer);
}

void visibility_store_finish(struct visibility_store *store)
{
    for (int i = 0; i < VISIBILITY_SLOTS; i++)
        empty(store, &store->buffers[i]);
}
