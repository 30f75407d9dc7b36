/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pool of pixel buffers, which frames take and give back. A lock protects the pool. */
#include "render/frame_pool.h"

#include <pthread.h>
#include <stdatomic.h>

#include "base/mem.h"
#include "base/system/huge_pages.h"

enum { SPARES = 4 };
/* size in bytes of the largest pixel buffer that the pool keeps for reuse; larger frames are rare */
static const size_t SPARE_BYTES = (size_t)16 << 20;

struct spare_buffer {
    uint8_t *pixels;
    size_t bytes;
};
struct frame_pool {
    _Atomic int refs;
    _Atomic size_t bytes;
    pthread_mutex_t lock;
    /* --- below: under lock */
    struct spare_buffer spares[SPARES];
    int next;
};

struct frame_pool *frame_pool_create(void)
{
    struct frame_pool *pool = mem_new(sizeof(*pool));
    atomic_init(&pool->refs, 1);
    pthread_mutex_init(&pool->lock, NULL);
    return pool;
}

struct frame_pool *frame_pool_ref(struct frame_pool *pool)
{
    if (pool)
        atomic_fetch_add_explicit(&pool->refs, 1, memory_order_relaxed);
    return pool;
}

void frame_pool_unref(struct frame_pool **pool_ptr)
{
    struct frame_pool *pool = *pool_ptr;
    *pool_ptr = NULL;
    if (!pool || atomic_fetch_sub_explicit(&pool->refs, 1, memory_order_acq_rel) != 1)
        return;
    frame_pool_drop_spares(pool);
    pthread_mutex_destroy(&pool->lock);
    mem_free(pool);
}

uint8_t *frame_pool_take(struct frame_pool *pool, size_t bytes)
{
    uint8_t *pixels = NULL;
    if (pool) {
        pthread_mutex_lock(&pool->lock);
        for (int i = 0; i < SPARES && !pixels; i++)
            if (pool->spares[i].pixels && pool->spares[i].bytes == bytes) {
                pixels = pool->spares[i].pixels;
                pool->spares[i].pixels = NULL;
            }
        pthread_mutex_unlock(&pool->lock);
    }
    if (!pixels && (pixels = mem_try_array(bytes, 1))) {
        huge_pages_advise(pixels, bytes);
        if (pool)
            atomic_fetch_add_explicit(&pool->bytes, bytes, memory_order_relaxed);
    }
    return pixels;
}

void frame_pool_give(struct frame_pool *pool, uint8_t *pixels, size_t bytes)
{
    /* keeps this buffer for reuse. If there is no free place, it takes the place of the oldest spare buffer, which is freed
       below */
    if (pool && pixels && bytes <= SPARE_BYTES) {
        pthread_mutex_lock(&pool->lock);
        struct spare_buffer oldest = pool->spares[pool->next];
        pool->spares[pool->next] = (struct spare_buffer){ pixels, bytes };
        pool->next = (pool->next + 1) % SPARES;
        pthread_mutex_unlock(&pool->lock);
        pixels = oldest.pixels;
        bytes = oldest.bytes;
    }
    if (pool && pixels)
        atomic_fetch_sub_explicit(&pool->bytes, bytes, memory_order_relaxed);
    mem_free(pixels);
}

size_t frame_pool_bytes(const struct frame_pool *pool)
{
    return atomic_load_explicit(&pool->bytes, memory_order_relaxed);
}

void frame_pool_drop_spares(struct frame_pool *pool)
{
    pthread_mutex_lock(&pool->lock);
    for (int i = 0; i < SPARES; i++) {
        if (pool->spares[i].pixels)
            atomic_fetch_sub_explicit(&pool->bytes, pool->spares[i].bytes, memory_order_relaxed);
        mem_free(pool->spares[i].pixels);
        pool->spares[i].pixels = NULL;
    }
    pthread_mutex_unlock(&pool->lock);
}
