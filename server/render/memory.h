/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures, limits and frees the memory that a renderer keeps between frames. Call only in the thread that owns the GL context. */
#ifndef RENDER_MEMORY_H
#define RENDER_MEMORY_H
#include "render/renderer.h"

enum render_store {
    STORE_FIELDS,   /* vertex values of shown fields, in main memory and on the GPU */
    STORE_LIGHT,    /* baked light, on the GPU and as copies in main memory */
    STORE_PICTURES, /* visibility buffers (triangle and light of each pixel) of views with a still camera */
    STORE_TARGETS,  /* framebuffers */
    STORE_ROOM,     /* working memory (pixel buffers and lists) of the software renderer */
    STORE_MODELS,   /* geometry on the GPU, except data mapped from files; needed for every frame, so it is never evicted */
    RENDER_STORES
};
extern const char *const render_store_names[RENDER_STORES];

/* Writes the current size of each cache in bytes into `out`, indexed by enum render_store. */
void renderer_measure_memory(const struct renderer *renderer, size_t out[RENDER_STORES]);
/* Sets the memory limit for all caches; geometry (models) is not limited. The frame being drawn may exceed the limit. Call between
   frames. */
void renderer_bound_memory(struct renderer *renderer, size_t bytes);
/* Frees all caches; keeps the geometry (models) and the default light. Called when no clients are watching; no job may be in progress. */
void renderer_drop_caches(struct renderer *renderer);

#endif
