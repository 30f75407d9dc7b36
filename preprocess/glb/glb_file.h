/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the binary part of a GLB file (glTF 2.0): accessors over one growing buffer, and the file container. The caller supplies the JSON
 * that refers to the accessors. One thread per file. */
#ifndef PREPROCESS_GLB_GLB_FILE_H
#define PREPROCESS_GLB_GLB_FILE_H
#include <jansson.h>

#include "base/text/text.h"

enum { GLB_FLOAT = 5126, GLB_USHORT = 5123, GLB_UINT = 5125, GLB_VERTICES = 34962, GLB_INDICES = 34963 }; /* constants of glTF */

struct glb_file {
    json_t *views, *accessors;
    struct text bytes;
};

void glb_file_init(struct glb_file *file);
void glb_file_finish(struct glb_file *file);
/* Copies `count` elements of `each` bytes (a multiple of 4) into the buffer and adds an accessor for them. Returns the accessor's index. */
int glb_file_add(struct glb_file *file, const void *bytes, size_t each, size_t count, int component, const char *type, int target);
/* Like glb_file_add(), but for positions: also writes their minimum and maximum to the accessor, as glTF requires. Returns the
 * accessor's index. */
int glb_file_add_positions(struct glb_file *file, const float (*positions)[3], size_t count);
/* Adds accessors and buffer to `root` and writes the file. Returns 0 or -errno (-EFBIG: larger than the 4 GiB limit of GLB). */
int glb_file_save(struct glb_file *file, json_t *root, const char *path);
/* Writes a GLB file from any JSON and the bytes of its only buffer. Returns 0 or -errno (-EFBIG: larger than the 4 GiB limit of GLB). */
int glb_file_put(json_t *root, const struct text *bytes, const char *path);

#endif
