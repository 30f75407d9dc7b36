/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Occlusion culling of assets: the GPU tests an asset's bounding box against the depth drawn so far, without writing depth. If
   a fragment of the box is visible, the shader enables the asset's draw commands in the command buffer, so the CPU reads
   nothing back. Conservative: the box encloses the asset with a margin larger than any rounding, so culling never changes a
   pixel. Call only in the thread that owns the GL context. */
#ifndef RENDER_GL_OCCLUSION_H
#define RENDER_GL_OCCLUSION_H
#include "render/gl/draw_batches.h"
#include "render/frame_context.h"

struct occlusion_box { /* layout that shaders/occlusion.vert reads */
    float clip_from_box[16];
    /* range of the asset's draw commands, which the test of its box enables: first_place: index of the first in
       draw_batches.sorted; place_count: number of commands */
    uint32_t first_place, place_count, unused[2];
};
/* occlusion state of one visible asset. The array of these has one more element than there are assets; in that element,
   boxes_before is the number of all boxes */
struct occlusion_asset {
    size_t boxes_before;
    bool tested;
    int triangles;
};

struct occlusion { /* culling state of the frame drawn last; zero-initialise, then set log */
    struct log *log;
    GLuint program, vao, box_buffer;
    struct occlusion_box *boxes;
    struct occlusion_asset *assets;
    size_t box_count, asset_count;
    size_t box_capacity, asset_capacity; /* number of elements for which `boxes` and `assets` have room */
    size_t box_room;                     /* size in bytes of the GPU buffer box_buffer, which holds the assets' bounding boxes */
};

/* Compiles the shader program that tests bounding boxes. On failure, logs the reason and returns false. */
bool occlusion_init(struct occlusion *occlusion, struct log *log);
void occlusion_finish(struct occlusion *occlusion);
/* Collects the boxes of all visible assets; call before the opaque draw commands are collected. Returns false if the frame has fewer than
   least_triangles triangles: the tests would cost more than they save, so all assets must be drawn. */
bool occlusion_begin(struct occlusion *occlusion, const struct frame_context *context, int least_triangles);
/* Returns how many of the visible assets, from index `first` on, the next round should draw before it tests again. The first round draws an
   eighth of all triangles, each later one but the last as many as all rounds before it. Pure. */
enum { OCCLUSION_ROUNDS = 6 };
size_t occlusion_round(const struct occlusion *occlusion, size_t first);
/* Stores the range of draw commands that the test of an asset's bounding box enables. */
void occlusion_decides(struct occlusion *occlusion, const struct occlusion_asset *asset, size_t first_command, size_t count);
/* Uploads the bounding boxes to the GPU. Logs and returns false when the GPU is out of memory. */
bool occlusion_upload(struct occlusion *occlusion);
/* Tests the boxes of visible assets first..end-1 against the depth drawn so far. Changes the program, bindings, face culling and polygon
   offset; all other GL state of the pass (render/gl/surface_pass.c) stays unchanged. */
void occlusion_test(const struct occlusion *occlusion, const struct draw_batches *batches, size_t first, size_t end);

#endif
