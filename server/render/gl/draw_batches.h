/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The draws of a pass, gathered by the state they need: each batch is one call, however many assets it shows. What differs between
   assets is in buffers: where they stand by instance, light and scalars by vertex (gpu/pool.h). Thread: the one of the GL context. */
#ifndef RENDER_GL_DRAW_BATCHES_H
#define RENDER_GL_DRAW_BATCHES_H
#include "gpu/mesh.h"
#include "gpu/pool.h"
#include "render/plan/culling.h"
#include "render/gl/model.h"

struct draw_instance {   /* as in shaders/instance.glsl */
    float normals[3][4]; /* rows of eye_from_normal; then blocks of light and field, nothing */
    float clip_from_file[16];
    float from_file[3][4]; /* rows */
};

struct draw_batch_state {
    GLuint program;
    const struct model *model;
    const struct pool_page *light, *field; /* field NULL: no data, or none at all */
    int front;                             /* as scene_asset.front */
    int material;                          /* -1: shaders do not look at it */
    int alone;                             /* an asset that shares its batches with no other; -1: none */
    bool two_sided, mirrored, cut, blend;
};

struct draw_command { /* for glMultiDrawElementsIndirect */
    uint32_t count, instances, first_index;
    int32_t base_vertex;
    uint32_t base_instance;
};

struct draw_batch {
    struct draw_batch_state state;
    size_t first, count; /* commands, when they are sorted */
    size_t older;        /* another one of the model; SIZE_MAX: none */
};

struct draw_batches { /* zero-initialise log excepted */
    struct log *log;
    struct draw_batch *at;
    size_t count, from; /* batches; draws join those from here on only */
    struct draw_instance *instances;
    struct draw_command *commands, *sorted; /* as they were added; by batch */
    uint32_t *batch_of, *place_of;          /* per command as they were added: its batch, and its place among the sorted */
    size_t *newest;                         /* per model: its newest batch */
    size_t instance_count, command_count;
    size_t capacity, instance_capacity, command_capacity, sorted_capacity, batch_of_capacity, place_capacity, newest_capacity;
    GLuint instance_buffer, command_buffer, place_buffer;
    size_t instance_room, command_room, place_room;
};

void draw_batches_finish(struct draw_batches *batches);
void draw_batches_begin(struct draw_batches *batches, size_t model_count);
uint32_t draw_batches_add_instance(struct draw_batches *batches, const struct draw_instance *instance); /* its number */
/* A batch of that state. model: number of its model. in_order: what is drawn before must stay so: only the newest will do. */
size_t draw_batches_choose(struct draw_batches *batches, const struct draw_batch_state *state, size_t model, bool in_order);
/* Adds a submesh, or of it only the clusters that are seen, and returns how many triangles these have. shown 0: not drawn unless the GPU
   says so. */
void draw_batches_add_submesh(struct draw_batches *batches, size_t batch, const struct model_submesh *submesh, uint32_t instance,
                              uint32_t shown);
int draw_batches_add_seen(struct draw_batches *batches, size_t batch, const struct model_submesh *submesh, uint32_t instance,
                          const struct culling *culling);
/* Sorts, and hands everything to the GPU. places: place_buffer, too. False: it has no room, logged. */
bool draw_batches_upload(struct draw_batches *batches, bool places);
void draw_batches_draw(const struct draw_batches *batches, const struct draw_batch *batch); /* with its state set and its mesh bound */

/* A buffer for what changes from picture to picture. False: the GPU has no room, logged. */
bool draw_batches_refill(struct log *log, GLuint *buffer, size_t *room, size_t bytes, const void *data);

#endif
