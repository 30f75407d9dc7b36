/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a renderer keeps for the next picture: how much of it, how much at most, and how it is given back. Thread: the one of the GL
   context. */
#ifndef RENDER_MEMORY_H
#define RENDER_MEMORY_H
#include "render/renderer.h"

enum render_store {
    STORE_FIELDS,   /* values at vertices that pictures showed, here and on the GPU */
    STORE_LIGHT,    /* baked, and read back */
    STORE_PICTURES, /* what still cameras see */
    STORE_TARGETS,  /* framebuffers */
    STORE_ROOM,     /* to draw in without a GPU */
    STORE_MODELS,   /* geometry on the GPU, and not in the files alone: not a cache */
    RENDER_STORES
};
extern const char *const render_store_names[RENDER_STORES];

/* Now, into out. */
void renderer_measure_memory(const struct renderer *renderer, size_t out[RENDER_STORES]);
/* All but the models together. What the picture that is drawn needs may pass it. Between pictures. */
void renderer_bound_memory(struct renderer *renderer, size_t bytes);
/* Nobody looks: all goes but the models and the light that most views have. No job may be under way. */
void renderer_drop_caches(struct renderer *renderer);

#endif
