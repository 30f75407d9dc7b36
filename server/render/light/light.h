/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A cache of baked light within a memory limit: shadow map, and light at each vertex and on the ground. Light is baked once per
   direction of the sun, environment and visible assets (render/light/bake.h). Call only in the thread that owns the GL context. */
#ifndef RENDER_LIGHT_H
#define RENDER_LIGHT_H
#include "render/light/bake.h"
#include "render/light/environments.h"

enum { LIGHT_SETS = 8 };
struct light {
    const struct gpu_scene *gpu_scene;
    struct environments *environments;
    struct bake_programs programs;
    /* matrix to plant coordinates from the ground's texture coordinates (x, y) and the height above the ground (z) */
    double plant_from_ground[16];
    double ground_height_m; /* coordinate of the ground plane along the plant's up axis, in metres */
    /* GPU memory of all light sets (baked light) in bytes. bound_bytes: limit; bytes: in use. A set that a job holds
       (light_hold) is never dropped, even above the limit */
    size_t bound_bytes, bytes;
    struct light_set sets[LIGHT_SETS];
    struct bake *bake; /* in progress; NULL: none */
    uint64_t uses, last_id;
    /* true: the file with the plant's openness (visible part of the sky) has been written, or writing was attempted and failed */
    bool kept;
    /* thread that writes the plant's openness (visible part of the sky) to a file; NULL: nothing is being written */
    struct openness_writer *writer;
};

/* Compiles the shader programs for baking; bakes no light yet. On failure, logs the reason and returns false. */
bool light_init(struct light *light, const struct gpu_scene *gpu_scene, struct environments *environments);
void light_finish(struct light *light);
/* Returns the light set (baked light) for `key`; if it is not cached, bakes it and waits. With key->rough, the bake takes a
   fraction of the time; frames show such a rough set until the first full set is ready. Logs and returns NULL when the GPU is
   out of memory. */
struct light_set *light_get(struct light *light, const struct light_key *key);
/* Returns the cached light set (baked light) most similar to `key`. Sets of the same environment come first, then sets with the
   same visible assets, then the nearest direction of the sun. NULL: none is cached. */
struct light_set *light_near(struct light *light, const struct light_key *key);
/* Bakes the light set for `key` for about budget_ns, at least one step, unless another set is being baked. Returns true if the set is
   cached, so that light_get() does not wait. */
bool light_step(struct light *light, const struct light_key *key, int64_t budget_ns);
/* Sets the memory limit and drops light sets (baked light) beyond it, but keeps two: one to show while the next is baked. */
void light_bound(struct light *light, size_t bytes);
/* Drops all light sets (baked light) but the one for `usual` or, if that is not cached, the most similar one. Abandons the bake
   in progress unless it is for `usual`. */
void light_drop(struct light *light, const struct light_key *usual);
/* Hold and release a light set (baked light); a held set is not dropped. light_release() accepts NULL. */
void light_hold(struct light_set *set);
void light_release(struct light_set *set);

#endif
