/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes PNG files in memory. Call from any thread. */
#ifndef LINK_PNG_H
#define LINK_PNG_H
#include <stddef.h>

#include <cairo.h>

/* Decodes a complete PNG file. The caller destroys the surface (cairo_surface_destroy). Returns NULL if the bytes are not a PNG file or
   memory is short. */
cairo_surface_t *png_read(const void *bytes, size_t count);

#endif
