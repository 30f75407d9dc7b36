/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light that stands still: shadow maps, and what reaches each vertex and the ground, worked out once for each place of the sun.
   What was worked out is kept, as much as fits in a bound. Thread: the one of the GL context. */
#ifndef RENDER_LIGHT_H
#define RENDER_LIGHT_H
#include "render/light/bake.h"
#include "render/light/environments.h"

enum { LIGHT_SETS = 8 };
struct light {
    const struct gpu_scene *gpu_scene;
    struct environments *environments;
    struct bake_programs programs;
    double plant_from_ground[16]; /* from texture coordinates on the ground, and height over it */
    double ground_height_m;       /* along `up` */
    size_t bound_bytes, bytes;    /* of all sets; one that is in use stays in any case */
    struct light_set sets[LIGHT_SETS];
    struct bake *bake; /* under way; NULL: none */
    uint64_t uses, last_id;
};

bool light_init(struct light *light, const struct gpu_scene *gpu_scene, struct environments *environments); /* false: logged */
void light_finish(struct light *light);
/* The light of that sun and those surroundings; baked now if it is not known, which takes a fraction of the time if it is rough: such a
   set is there until the first other one is. NULL: out of GPU memory, logged. */
struct light_set *light_get(struct light *light, const struct light_key *key);
/* The ready one most like it: of the same surroundings if there is one, then of what is shown, then with the sun nearest. NULL: none
   is ready. */
struct light_set *light_near(struct light *light, const struct light_key *key);
/* Likewise; bakes on for about that long, and a bit at least, if nothing else is under way. True: light_get does not wait now. */
bool light_step(struct light *light, const struct light_key *key, int64_t budget_ns);
/* So many bytes at most, but two sets at least: one to show while the next is baked. */
void light_bound(struct light *light, size_t bytes);
void light_drop(struct light *light, const struct light_key *usual); /* drops all but that one, and what is under way */
/* While it is held, a set stays. */
void light_hold(struct light_set *set);
void light_release(struct light_set *set); /* NULL is fine */

#endif
