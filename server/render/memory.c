/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sets the limit of each of a renderer's caches to a share of the renderer's memory limit. */
#include "render/memory.h"

#include "render/gl/gl_backend.h"
#include "render/renderer_impl.h"
#include "render/soft/soft.h"

const char *const render_store_names[RENDER_STORES] = { "shown fields", "light", "still pictures", "targets", "drawing", "models" };

/* Shares of the caches in the memory limit, after the working memory (STORE_ROOM) is subtracted. Half of FIELDS_SHARE is main
   memory, half GPU memory. */
static const double FIELDS_SHARE = 0.35, LIGHT_SHARE = 0.3, REFINED_SHARE = 0.15, PREVIEWS_SHARE = 0.1, TARGETS_SHARE = 0.1;
/* Working memory (STORE_ROOM) that exceeds this fraction of the memory limit is freed after each frame and allocated again for the next. */
static const double WORKING_SHARE = 0.4;

static size_t room_bytes(const struct renderer *renderer)
{
    return renderer->by_soft ? soft_room_bytes(renderer->by_soft) : 0;
}

void renderer_measure_memory(const struct renderer *renderer, size_t out[RENDER_STORES])
{
    out[STORE_FIELDS] = renderer->fields.bytes + pool_bytes_taken(renderer->fields.pool);
    out[STORE_LIGHT] = renderer->light.bytes;
    out[STORE_PICTURES] = 0;
    out[STORE_TARGETS] = renderer->by_gl ? targets_bytes(&renderer->by_gl->targets) : 0;
    out[STORE_ROOM] = room_bytes(renderer);
    out[STORE_MODELS] = 0;
    if (renderer->by_soft) {
        out[STORE_LIGHT] += soft_light_bytes(renderer->by_soft);
        out[STORE_PICTURES] = soft_kept_bytes(renderer->by_soft);
    }
    for (size_t i = 0; i < renderer->gpu_scene.model_count; i++)
        out[STORE_MODELS] += renderer->gpu_scene.models[i].mesh.bytes;
}

void renderer_bound_memory(struct renderer *renderer, size_t bytes)
{
    if (renderer->by_soft && (double)room_bytes(renderer) > WORKING_SHARE * (double)bytes)
        soft_drop_spare(renderer->by_soft);
    size_t room = room_bytes(renderer), least = bytes - (size_t)(WORKING_SHARE * (double)bytes);
    double left = (double)(room < bytes - least ? bytes - room : least);
    renderer->fields.bound_bytes = (size_t)(FIELDS_SHARE * left / 2);
    light_bound(&renderer->light, (size_t)(LIGHT_SHARE * left));
    if (renderer->by_gl)
        targets_bound(&renderer->by_gl->targets, (size_t)(TARGETS_SHARE * left));
    if (renderer->by_soft) {
        soft_bound(renderer->by_soft, TIER_PREVIEW, (size_t)(PREVIEWS_SHARE * left));
        soft_bound(renderer->by_soft, TIER_REFINED, (size_t)(REFINED_SHARE * left));
    }
}

void renderer_drop_caches(struct renderer *renderer)
{
    struct light_key usual = renderer_usual_light(renderer);
    fields_drop(&renderer->fields);
    light_drop(&renderer->light, &usual);
    if (renderer->by_gl)
        targets_finish(&renderer->by_gl->targets);
    if (renderer->by_soft)
        soft_rest(renderer->by_soft);
}
