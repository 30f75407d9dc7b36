/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Collects the draw commands of a render pass into batches that need the same GL state. Each batch is one GL call, however many
   assets it draws. Data that differ between assets are in GPU buffers: the placement per instance, light and field values per
   vertex (gpu/pool.h). Order of calls to draw_batches_*: begin, choose and add, upload, draw. Call only in the thread that owns
   the GL context. */
#ifndef RENDER_GL_DRAW_BATCHES_H
#define RENDER_GL_DRAW_BATCHES_H
#include "gpu/mesh.h"
#include "gpu/pool.h"
#include "render/plan/culling.h"
#include "render/gl/model.h"

struct draw_instance { /* as in shaders/instance.glsl */
    /* Rows of the matrix that transforms the asset's normals to eye space. normals[0][3] is the index of the asset's first
       block in the baked light buffer, normals[1][3] that in the field value buffer; normals[2][3] is unused. */
    float normals[3][4];
    float clip_from_file[16];
    float from_file[3][4]; /* rows */
};

struct draw_batch_state {
    GLuint program;
    GLuint depth_program; /* draws the batch's depth before its colours; 0: the depth is not drawn first */
    const struct gl_model *model;
    /* buffers (pool.h) with baked light and with field values per vertex; field NULL: the asset has no sensor group or no reading */
    const struct pool_page *light, *field;
    int front;    /* as scene_asset.front */
    int material; /* index of the material in the model; -1: the shader program reads no material */
    /* index of the asset if it must not share its batch with others (one_by_one in surface_pass.h); -1: the batch may be shared */
    int alone;
    bool two_sided, mirrored, cut, blend;
};

struct draw_command { /* for glMultiDrawElementsIndirect */
    uint32_t count, instances, first_index;
    int32_t base_vertex;
    uint32_t base_instance;
};

struct draw_batch {
    struct draw_batch_state state;
    /* this batch's commands in the array `sorted`: index of the first, and number; valid after draw_batches_upload() */
    size_t first, count;
    /* index of the model's previous batch: links the list of the model's batches that is searched for one of equal state; SIZE_MAX: none */
    size_t older;
};

struct draw_batches { /* zero-initialise, then set log */
    struct log *log;
    struct draw_batch *at;
    size_t count, from; /* count: number of batches; from: a new draw command may be added only to batches from this index on */
    struct draw_instance *instances;
    /* commands: draw commands in the order in which they were added; sorted: the same commands, ordered by batch */
    struct draw_command *commands, *sorted;
    /* by index in `commands`: batch_of: index of the command's batch; place_of: the command's index in `sorted` */
    uint32_t *batch_of, *place_of;
    /* by model: index of its most recently made batch, the first element of the list that draw_batch.older links */
    size_t *newest;
    size_t instance_count, command_count;
    size_t capacity, instance_capacity, command_capacity, sorted_capacity, batch_of_capacity, place_capacity, newest_capacity;
    GLuint instance_buffer, command_buffer, place_buffer;
    size_t instance_room, command_room, place_room;
};

/* Frees the memory and the GL buffers of *batches. */
void draw_batches_finish(struct draw_batches *batches);
/* Removes all batches, commands and instances at the beginning of a pass. */
void draw_batches_begin(struct draw_batches *batches, size_t model_count);
/* Copies an instance (an asset's placement) into the list of instances and returns its index there. */
uint32_t draw_batches_add_instance(struct draw_batches *batches, const struct draw_instance *instance);
/* Returns the index of a batch with this state; adds a batch if there is none. model: the model's index. in_order: draw
   commands must keep the order in which they are added, so only the newest batch may be reused. */
size_t draw_batches_choose(struct draw_batches *batches, const struct draw_batch_state *state, size_t model, bool in_order);
/* Adds the draw of a whole submesh. shown: 1: the submesh is drawn; 0: it is drawn only if an occlusion test on the GPU enables the draw
   (render/gl/occlusion.h). */
void draw_batches_add_submesh(struct draw_batches *batches, size_t batch, const struct model_submesh *submesh, uint32_t instance,
                              uint32_t shown);
/* Adds draws of the clusters of a submesh that survive culling. Returns the number of triangles added. */
int draw_batches_add_seen(struct draw_batches *batches, size_t batch, const struct model_submesh *submesh, uint32_t instance,
                          const struct culling *culling);
/* Sorts the draw commands by batch, and uploads commands and instances to the GPU. places true: also uploads, for each command,
   its index in `sorted` (place_buffer). Logs and returns false when the GPU is out of memory. */
bool draw_batches_upload(struct draw_batches *batches, bool places);
/* Draws one batch. The caller has set the GL state that the batch needs and bound its mesh. */
void draw_batches_draw(const struct draw_batches *batches, const struct draw_batch *batch);

/* Overwrites a GL buffer with the new data of a frame, and grows it if needed. *room: size of the buffer in bytes. Logs and
   returns false when the GPU is out of memory. */
bool draw_batches_refill(struct log *log, GLuint *buffer, size_t *room, size_t bytes, const void *data);

#endif
