/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How open each place of a plant is (ambient occlusion, 0..255), kept in the file `openness` beside the prepared assets: on a processor it
   is most of what a set of light costs to bake, and it changes with neither sun nor environment. A file of another plant, program or GL,
   or a damaged one, counts as missing. Thread: the one of the GL context. */
#ifndef RENDER_OPENNESS_H
#define RENDER_OPENNESS_H
#include "base/files/cache_file.h"
#include "gpu/pool.h"
#include "render/gl/gpu_scene.h"

enum { OPENNESS_GROUND_PX = 256 }; /* side of the ground's texture */

struct openness { /* mapped: the ground's texels, then those of the vertices, asset by asset */
    struct cache_file file;
    size_t vertex; /* that comes next */
};

/* Opens the plant's file. Returns false if there is none that is valid; then there is nothing to close. */
bool openness_open(struct openness *openness, const struct gpu_scene *gpu_scene);
void openness_close(struct openness *openness); /* a zeroed one is fine */
/* Uploads that of the next asset into the third byte of each texel of its slice. Returns false if the GPU is out of memory (logged). */
bool openness_upload(struct openness *openness, const struct gpu_scene *gpu_scene, const struct pool_slice *slice);
/* Uploads that of the ground into the second byte of each texel. */
void openness_upload_ground(const struct openness *openness, GLuint ground);

struct openness_writer; /* a file that is being written, by a thread */
/* Begins to write the plant's file from such slices, one for each asset, and such a ground. Returns NULL if the plant has no folder, or
   there is no thread. That it cannot be written is logged, once it is known. */
struct openness_writer *openness_write(const struct gpu_scene *gpu_scene, struct pool_slice *const *slices, GLuint ground);
void openness_writer_finish(struct openness_writer **writer); /* waits for its end; &NULL is fine; leaves NULL */

#endif
