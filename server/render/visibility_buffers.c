/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A short list with a bound on its bytes. */
#include "render/visibility_buffers.h"

#include <stdbool.h>

static void empty(struct visibility_buffers *store, struct visibility_buffer *buffer)
{
    if (buffer->at)
        buffer->destroy(buffer->at);
    store->bytes -= buffer->bytes;
    *buffer = (struct visibility_buffer){ 0 };
}

static struct visibility_buffer *find(struct visibility_buffers *store, uint64_t shape)
{
    for (int i = 0; i < VISIBILITY_BUFFERS; i++)
        if (store->buffers[i].at && store->buffers[i].shape == shape)
            return &store->buffers[i];
    return NULL;
}

/* An empty place is older than all others. */
static struct visibility_buffer *oldest(struct visibility_buffers *store, bool empty_too)
{
    struct visibility_buffer *found = NULL;
    for (int i = 0; i < VISIBILITY_BUFFERS; i++) {
        struct visibility_buffer *buffer = &store->buffers[i];
        if ((buffer->at || empty_too) && (!found || buffer->used < found->used))
            found = buffer;
    }
    return found;
}

void *visibility_buffers_find(struct visibility_buffers *store, uint64_t shape)
{
    struct visibility_buffer *buffer = find(store, shape);
    if (!buffer)
        return NULL;
    buffer->used = ++store->uses;
    return buffer->at;
}

void visibility_buffers_give(struct visibility_buffers *store, uint64_t shape, void *at, size_t bytes, void (*destroy)(void *at))
{
    visibility_buffers_drop(store, shape);
    if (bytes > store->bound_bytes) {
        destroy(at);
        return;
    }
    while (store->bytes + bytes > store->bound_bytes)
        empty(store, oldest(store, false));
    struct visibility_buffer *buffer = oldest(store, true);
    empty(store, buffer);
    *buffer = (struct visibility_buffer){ .shape = shape, .at = at, .destroy = destroy, .bytes = bytes, .used = ++store->uses };
    store->bytes += bytes;
}

void visibility_buffers_bound(struct visibility_buffers *store, size_t bytes)
{
    store->bound_bytes = bytes;
    while (store->bytes > bytes)
        empty(store, oldest(store, false));
}

void visibility_buffers_drop(struct visibility_buffers *store, uint64_t shape)
{
    struct visibility_buffer *buffer = find(store, shape);
    if (buffer)
        empty(store, buffer);
}

void visibility_buffers_finish(struct visibility_buffers *store)
{
    for (int i = 0; i < VISIBILITY_BUFFERS; i++)
        empty(store, &store->buffers[i]);
}
