/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Leaves out what others hide: an asset's box is drawn against the depth of what was drawn before, into nothing; where some of it
   shows, the GPU itself says to draw the asset. Nothing waits, and nothing is left out that would change a pixel: the box holds the
   asset, and a rim more than rounding can make of it. Thread: the one of the GL context. */
#ifndef RENDER_HIDDEN_H
#define RENDER_HIDDEN_H
#include "render/picture.h"

struct hidden_box { /* as shaders/hidden.vert reads it */
    float clip_from_box[16];
    uint32_t first_command, command_count, unused[2];
};
struct hidden_command { /* for glMultiDrawElementsIndirect */
    uint32_t count, instances, first_index;
    int32_t base_vertex;
    uint32_t base_instance;
};
struct hidden_asset { /* of the picture's visible ones, or the end of their list */
    size_t boxes_before;
    size_t first_command; /* of its batches, in their order */
    bool tested;
    int triangles;
};

struct hidden { /* zero-initialise log excepted; of the picture that was drawn last */
    struct log *log;
    GLuint program, vao, box_buffer, command_buffer;
    struct hidden_box *boxes;
    struct hidden_command *commands;
    struct hidden_asset *assets;
    size_t box_count, command_count, asset_count;
    size_t box_capacity, command_capacity, asset_capacity; /* here */
    size_t box_room, command_room;                         /* on the GPU */
};

bool hidden_init(struct hidden *hidden, struct log *log); /* false: logged */
void hidden_finish(struct hidden *hidden);
/* Before what is not blended is drawn: boxes and commands of all visible assets. False: there are fewer triangles than that, or no
   memory for it; all are to be drawn. */
bool hidden_begin(struct hidden *hidden, const struct picture *picture, int least_triangles);
/* So many of the visible assets, from `first` on, can be drawn before it pays to test again. */
size_t hidden_round(const struct hidden *hidden, size_t first);
/* Decides about these, by what was drawn until now. State of the pass (render/solid.c) is as before but for the program, what is bound
   and the polygon offset. */
void hidden_test(const struct hidden *hidden, size_t first, size_t end);
/* Draws a batch if its asset is seen; command: the batch's first. */
void hidden_draw_batch(const struct hidden *hidden, size_t command, const struct model_batch *batch);
/* How many assets were left out; waits for the GPU. For tests and measurements. */
size_t hidden_count(const struct hidden *hidden);

#endif
