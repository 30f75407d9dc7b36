/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A surface in a file, so that what was made once need not be made again: it takes a fiftieth of the time. Thread: any. */
#ifndef SURFACE_SURFACE_STORE_H
#define SURFACE_SURFACE_STORE_H
#include "base/pack.h"
#include "surface/surface.h"

void surface_pack(const struct surface *surface, struct text *to);
/* Distances on it are the same to the last bit. NULL: the bytes are no surface, or out of memory. */
struct surface *surface_unpack(struct unpack *from, struct log *log, struct workers *workers);

/* Its file holds that and no more (base/cache_file.h). */
#define SURFACE_MAGIC "PLCSURF2"

#endif
