/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pixel buffers of frames: counts their bytes, and keeps a few released buffers for reuse. Reusing them is faster: fresh memory
   from the kernel costs more time in page faults than filling a frame takes. Reference-counted, because frames outlive their
   renderer. Call from any thread. A NULL pool neither counts nor reuses buffers. */
#ifndef RENDER_FRAME_POOL_H
#define RENDER_FRAME_POOL_H
#include <stddef.h>
#include <stdint.h>

struct frame_pool;
struct frame_pool *frame_pool_create(void); /* never NULL */
struct frame_pool *frame_pool_ref(struct frame_pool *pool);
void frame_pool_unref(struct frame_pool **pool);
/* Returns a pixel buffer with undefined content; release it with frame_pool_give(). NULL: out of memory. */
uint8_t *frame_pool_take(struct frame_pool *pool, size_t bytes);
/* Releases a buffer from frame_pool_take(). pixels may be NULL. */
void frame_pool_give(struct frame_pool *pool, uint8_t *pixels, size_t bytes);
/* returns the total size in bytes of all buffers of the pool, both in use and kept for reuse */
size_t frame_pool_bytes(const struct frame_pool *pool);
void frame_pool_drop_spares(struct frame_pool *pool);   /* frees the pixel buffers that are kept for reuse */

#endif
