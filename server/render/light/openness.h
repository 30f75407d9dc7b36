/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Openness (ambient occlusion, 0..255) at each vertex of a plant, stored in the file `openness` in the folder of prepared
   assets. Baking it is most of the cost of a light set on a processor, and it depends on neither sun nor environment. A damaged
   file, or one from another plant, program or GL driver, counts as missing. Call only in the thread that owns the GL context.
   */
#ifndef RENDER_OPENNESS_H
#define RENDER_OPENNESS_H
#include "base/files/cache_file.h"
#include "gpu/pool.h"
#include "render/gl/gpu_scene.h"

enum { OPENNESS_GROUND_PX = 256 }; /* width and height, in texels, of the texture with the ground's light */

struct openness { /* the mapped openness file: visible part of the sky at the texels of the ground, then at the vertices, asset by asset */
    struct cache_file file;
    size_t vertex; /* index, counted through all assets, of the next vertex whose openness is uploaded */
};

/* Opens the openness file of the plant. Returns false if there is no valid file; openness_close() is then not needed. */
bool openness_open(struct openness *openness, const struct gpu_scene *gpu_scene);
void openness_close(struct openness *openness); /* a zeroed struct is fine */
/* Uploads the next asset's openness into byte 2 of each texel of `slice`, the asset's range in the buffer of baked light. Logs
   and returns false when the GPU is out of memory. */
bool openness_upload(struct openness *openness, const struct gpu_scene *gpu_scene, const struct pool_slice *slice);
/* Uploads the ground's openness (visible part of the sky) into byte 1 of each texel of the ground's texture. */
void openness_upload_ground(const struct openness *openness, GLuint ground);

struct openness_writer; /* writer of the openness file, which runs on a thread of its own */
/* Starts to write the plant's openness file. slices: ranges with baked vertices in the GPU buffer, one per asset; ground: the ground's
   texture; both are read during the call. A failure to write is logged later. Returns NULL if the plant has no folder, or no thread could
   be started. */
struct openness_writer *openness_write(const struct gpu_scene *gpu_scene, struct pool_slice *const *slices, GLuint ground);
/* waits until the openness file is written and sets *writer to NULL; accepts a pointer to NULL */
void openness_writer_finish(struct openness_writer **writer);

#endif
