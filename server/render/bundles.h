/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The draws of a pass, gathered by the state they need: each bundle is one call, however many assets it shows. What differs between
   assets is in buffers: where they stand by instance, light and scalars by vertex (gpu/pool.h). Thread: the one of the GL context. */
#ifndef RENDER_BUNDLES_H
#define RENDER_BUNDLES_H
#include "gpu/mesh.h"
#include "gpu/pool.h"
#include "render/culling.h"
#include "render/model.h"

struct bundle_instance { /* as in shaders/instance.glsl */
    float normals[3][4]; /* rows of eye_from_normal; then blocks of light and field, nothing */
    float clip_from_file[16];
    float from_file[3][4]; /* rows */
};

struct bundle_state {
    GLuint program;
    const struct model *model;
    const struct pool_page *light, *field; /* field NULL: no data, or none at all */
    int front;                             /* as scene_asset.front */
    int material;                          /* -1: shaders do not look at it */
    int alone;                             /* an asset that shares its bundles with no other; -1: none */
    bool two_sided, mirrored, cut, blend;
};

struct bundle_command { /* for glMultiDrawElementsIndirect */
    uint32_t count, instances, first_index;
    int32_t base_vertex;
    uint32_t base_instance;
};

struct bundle {
    struct bundle_state state;
    size_t first, count; /* commands, when they are sorted */
    size_t older;        /* another one of the model; SIZE_MAX: none */
};

struct bundles { /* zero-initialise log excepted */
    struct log *log;
    struct bundle *at;
    size_t count, from; /* bundles; draws join those from here on only */
    struct bundle_instance *instances;
    struct bundle_command *commands, *sorted; /* as they were added; by bundle */
    uint32_t *bundle_of, *place_of;           /* per command as they were added: its bundle, and its place among the sorted */
    size_t *newest;                           /* per model: its newest bundle */
    size_t instance_count, command_count;
    size_t capacity, instance_capacity, command_capacity, sorted_capacity, bundle_of_capacity, place_capacity, newest_capacity;
    GLuint instance_buffer, command_buffer, place_buffer;
    size_t instance_room, command_room, place_room;
};

void bundles_finish(struct bundles *bundles);
void bundles_begin(struct bundles *bundles, size_t model_count);
uint32_t bundles_add_instance(struct bundles *bundles, const struct bundle_instance *instance); /* its number */
/* A bundle of that state. model: number of its model. in_order: what is drawn before must stay so: only the newest will do. */
size_t bundles_choose(struct bundles *bundles, const struct bundle_state *state, size_t model, bool in_order);
/* A batch, or of it only clusters that are seen; then returns how many triangles these have. shown: 0: not drawn unless the GPU says so. */
void bundles_add_batch(struct bundles *bundles, size_t bundle, const struct model_batch *batch, uint32_t instance, uint32_t shown);
int bundles_add_seen(struct bundles *bundles, size_t bundle, const struct model_batch *batch, uint32_t instance,
                     const struct culling *culling);
/* Sorts, and hands everything to the GPU. places: place_buffer, too. False: it has no room, logged. */
bool bundles_upload(struct bundles *bundles, bool places);
void bundles_draw(const struct bundles *bundles, const struct bundle *bundle); /* with its state set and its mesh bound */

/* A buffer for what changes from picture to picture. False: the GPU has no room, logged. */
bool bundles_refill(struct log *log, GLuint *buffer, size_t *room, size_t bytes, const void *data);

#endif
