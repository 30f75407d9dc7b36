/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading PNG files in memory. Thread: any. */
#ifndef LINK_PNG_H
#define LINK_PNG_H
#include <stddef.h>

#include <cairo.h>

/* Returns the picture of a whole PNG file, owned by the caller (cairo_surface_destroy). NULL: it is none, or there is no memory. */
cairo_surface_t *png_read(const void *bytes, size_t count);

#endif
