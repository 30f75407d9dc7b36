/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cache of light sets (baked light), and the bake in progress. */
#include "render/light/light.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"

static const size_t LIGHT_BYTES = 256 << 20;
static const int64_t LOAD_TIMEOUT_NS = 60 * NS_PER_S; /* maximum time in nanoseconds to wait for an environment map to load */

static void find_ground(struct light *light)
{
    const struct gpu_scene *gpu_scene = light->gpu_scene;
    const struct scene *scene = gpu_scene->scene;
    int up = gpu_scene->up[1] > 0 ? 1 : 2, across[2] = { 0, up == 1 ? 2 : 1 };
    double side_m = 0.6 * gpu_scene->radius_m;
    for (int i = 0; i < 2; i++)
        side_m = fmax(side_m, scene->bounds_max_m[across[i]] - scene->bounds_min_m[across[i]]);
    side_m += 1.2 * gpu_scene->radius_m;
    /* places the ground slightly below the plant's lowest point, so that no surface of the plant coincides with it */
    light->ground_height_m = scene->bounds_min_m[up] - 0.001 * gpu_scene->radius_m;
    memset(light->plant_from_ground, 0, sizeof(light->plant_from_ground));
    for (int i = 0; i < 2; i++) {
        light->plant_from_ground[4 * i + across[i]] = side_m;
        light->plant_from_ground[12 + across[i]] = gpu_scene->middle_m[across[i]] - 0.5 * side_m;
    }
    light->plant_from_ground[8 + up] = 1;
    light->plant_from_ground[12 + up] = light->ground_height_m;
    light->plant_from_ground[15] = 1;
}

bool light_init(struct light *light, const struct gpu_scene *gpu_scene, struct environments *environments)
{
    *light = (struct light){ .gpu_scene = gpu_scene, .environments = environments };
    light_bound(light, LIGHT_BYTES);
    find_ground(light);
    return bake_programs_init(&light->programs, gpu_scene->gl->log);
}

static void drop(struct light *light, struct light_set *set)
{
    light->bytes -= set->bytes;
    light_set_finish(set, light->gpu_scene);
}

void light_finish(struct light *light)
{
    bake_abandon(&light->bake);
    for (int i = 0; i < LIGHT_SETS; i++)
        if (light->sets[i].id)
            drop(light, &light->sets[i]);
    openness_writer_finish(&light->writer);
    bake_programs_finish(&light->programs);
}

static bool same(const struct light_key *a, const struct light_key *b)
{
    return a->rough == b->rough && a->environment == b->environment && a->towards[0] == b->towards[0] && a->towards[1] == b->towards[1] &&
           a->towards[2] == b->towards[2] && visibility_equal(&a->shown, &b->shown);
}

static struct light_set *find(struct light *light, const struct light_key *key)
{
    for (int i = 0; i < LIGHT_SETS; i++)
        if (light->sets[i].id && same(&light->sets[i].key, key)) {
            light->sets[i].used = ++light->uses;
            return &light->sets[i];
        }
    return NULL;
}

struct light_set *light_near(struct light *light, const struct light_key *key)
{
    struct light_set *nearest = NULL;
    double most = -INFINITY;
    for (int i = 0; i < LIGHT_SETS; i++) {
        struct light_set *set = &light->sets[i];
        const double *a = set->key.towards, *b = key->towards;
        double alike = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + (set->key.environment == key->environment ? 8 : 0) +
                       (visibility_equal(&set->key.shown, &key->shown) ? 3 : 0);
        if (set->id && alike > most) {
            nearest = set;
            most = alike;
        }
    }
    if (nearest)
        nearest->used = ++light->uses;
    return nearest;
}

void light_bound(struct light *light, size_t bytes)
{
    size_t two = 2 * bake_bytes(light->gpu_scene);
    light->bound_bytes = two > bytes ? two : bytes;
}

void light_drop(struct light *light, const struct light_key *usual)
{
    struct light_set *known = find(light, usual), *kept = known ? known : light_near(light, usual);
    if (light->bake && (known || !same(bake_key(light->bake), usual)))
        bake_abandon(&light->bake);
    for (int i = 0; i < LIGHT_SETS; i++)
        if (light->sets[i].id && !light->sets[i].holds && &light->sets[i] != kept)
            drop(light, &light->sets[i]);
}

/* Returns an empty slot of the cache of light sets (baked light). First drops sets that no job holds, least recently used first,
   until there is room for `bytes` more. NULL: all slots are held. */
static struct light_set *make_room(struct light *light, size_t bytes)
{
    for (;;) {
        struct light_set *oldest = NULL, *empty = NULL;
        for (int i = 0; i < LIGHT_SETS; i++) {
            struct light_set *set = &light->sets[i];
            if (!set->id)
                empty = set;
            else if (!set->holds && (!oldest || set->used < oldest->used))
                oldest = set;
        }
        if ((empty && light->bytes + bytes <= light->bound_bytes) || !oldest)
            return empty;
        drop(light, oldest);
    }
}

/* Finds a cached light set (baked light) whose openness (visible part of the sky) is also right for a new set with `key`, so
   that it can be copied. NULL: there is none. */
static const struct light_set *find_open(const struct light *light, const struct light_key *key)
{
    double most = bake_least_open(light->gpu_scene, &key->shown);
    for (int i = 0; i < LIGHT_SETS; i++) {
        const struct light_set *set = &light->sets[i];
        if (set->id && !set->key.rough && bake_least_open(light->gpu_scene, &set->key.shown) <= most)
            return set;
    }
    return NULL;
}

static bool begin(struct light *light, const struct light_key *key)
{
    const struct light_set *from = find_open(light, key);
    struct openness openness = { 0 };
    bool kept = !from && !key->rough && openness_open(&openness, light->gpu_scene);
    light->bake = bake_begin(light->gpu_scene, &light->programs, light->plant_from_ground, key, from, kept ? &openness : NULL);
    light->kept |= kept;
    openness_close(&openness);
    return light->bake != NULL;
}

/* Starts to write the openness (visible part of the sky) of a light set to the openness file, unless that was done already. Openness of a
   set that was baked while assets were hidden is never written, because it was raised to a lower bound. */
static void keep_openness(struct light *light, const struct light_set *set)
{
    if (light->kept || set->key.rough || bake_least_open(light->gpu_scene, &set->key.shown) > 0)
        return;
    light->kept = true;
    light->writer = openness_write(light->gpu_scene, set->baked, set->ground);
}

static void drop_rough(struct light *light)
{
    for (int i = 0; i < LIGHT_SETS; i++)
        if (light->sets[i].id && light->sets[i].key.rough && !light->sets[i].holds)
            drop(light, &light->sets[i]);
}

/* Ends the bake, whose GL calls must all have been issued, and puts its light set (baked light) into the cache. On failure,
   logs the reason and returns NULL. */
static struct light_set *end(struct light *light)
{
    struct light_set baked, *set;
    if (!bake_end(&light->bake, &baked))
        return NULL;
    drop_rough(light);
    set = make_room(light, baked.bytes);
    if (!set) {
        log_err(light->gpu_scene->gl->log,
                "light: cannot store the light computed for another view, because pictures being drawn use all %d slots", LIGHT_SETS);
        light_set_finish(&baked, light->gpu_scene);
        return NULL;
    }
    *set = baked;
    set->id = ++light->last_id;
    set->used = ++light->uses;
    light->bytes += set->bytes;
    keep_openness(light, set);
    return set;
}

struct light_set *light_get(struct light *light, const struct light_key *key)
{
    struct light_set *set = find(light, key);
    if (set)
        return set;
    environments_wait(light->environments, key->environment, LOAD_TIMEOUT_NS);
    if (light->bake && !same(bake_key(light->bake), key))
        bake_abandon(&light->bake);
    if (!light->bake && !begin(light, key))
        return NULL;
    environments_bind(light->environments, key->environment);
    while (!bake_step(light->bake)) {
    }
    return end(light);
}

bool light_step(struct light *light, const struct light_key *key, int64_t budget_ns)
{
    int64_t start_ns = clock_mono_ns(), spent_ns = 0, last_ns = 0;
    bool issued = false;
    if (find(light, key))
        return true;
    if (!environments_wait(light->environments, key->environment, budget_ns / 2))
        return false;
    if (!light->bake && !begin(light, key))
        /* The bake could not begin. The function says that the light is ready, so that the caller calls light_get(), which
           tries again and reports the failure. */
        return true;
    environments_bind(light->environments, bake_key(light->bake)->environment);
    while (!issued && spent_ns + last_ns <= budget_ns) {
        issued = bake_step(light->bake);
        glFinish();
        last_ns = clock_mono_ns() - start_ns - spent_ns;
        spent_ns += last_ns;
    }
    return issued && end(light) && find(light, key);
}

void light_hold(struct light_set *set)
{
    set->holds++;
}

void light_release(struct light_set *set)
{
    if (set)
        set->holds--;
}
