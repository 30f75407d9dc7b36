/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Leaves out what others hide: an asset's box is drawn against the depth of what was drawn before, into nothing; where some of it
   shows, the GPU itself says to draw the asset. Nothing waits, and nothing is left out that would change a pixel: the box holds the
   asset, and a rim more than rounding can make of it. Thread: the one of the GL context. */
#ifndef RENDER_GL_OCCLUSION_H
#define RENDER_GL_OCCLUSION_H
#include "render/gl/draw_batches.h"
#include "render/frame_context.h"

struct occlusion_box { /* as shaders/occlusion.vert reads it */
    float clip_from_box[16];
    uint32_t first_place, place_count, unused[2]; /* of its asset's commands (render/gl/draw_batches.h) */
};
struct occlusion_asset { /* of the picture's visible ones, or the end of their list */
    size_t boxes_before;
    bool tested;
    int triangles;
};

struct occlusion { /* zero-initialise log excepted; of the picture that was drawn last */
    struct log *log;
    GLuint program, vao, box_buffer;
    struct occlusion_box *boxes;
    struct occlusion_asset *assets;
    size_t box_count, asset_count;
    size_t box_capacity, asset_capacity; /* here */
    size_t box_room;                     /* on the GPU */
};

bool occlusion_init(struct occlusion *occlusion, struct log *log); /* false: logged */
void occlusion_finish(struct occlusion *occlusion);
/* Before what is not blended is gathered: boxes of all visible assets. False: there are fewer triangles than that; all are to be drawn. */
bool occlusion_begin(struct occlusion *occlusion, const struct frame_context *context, int least_triangles);
/* So many of the visible assets, from `first` on, can be drawn before it pays to test again. Each round but the last draws as many
   triangles as all before it, the first an eighth. */
enum { OCCLUSION_ROUNDS = 6 };
size_t occlusion_round(const struct occlusion *occlusion, size_t first);
/* The box of an asset that is tested decides about these commands. */
void occlusion_decides(struct occlusion *occlusion, const struct occlusion_asset *asset, size_t first_command, size_t count);
bool occlusion_upload(struct occlusion *occlusion); /* false: the GPU has no room for the boxes, logged */
/* Decides about these, by what was drawn until now. State of the pass (render/gl/surface_pass.c) is as before but for the program,
   what is bound,
   the culling of faces and the polygon offset. */
void occlusion_test(const struct occlusion *occlusion, const struct draw_batches *batches, size_t first, size_t end);
/* How many assets were left out; waits for the GPU. For tests and measurements. */
size_t occlusion_count(const struct occlusion *occlusion, const struct draw_batches *batches);

#endif
