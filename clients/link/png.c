/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes PNG files in memory with cairo. */
#include "clients/link/png.h"

#include <string.h>

struct bytes {
    const char *at;
    size_t left;
};

static cairo_status_t take(void *arg, unsigned char *out, unsigned int count)
{
    struct bytes *bytes = arg;
    if (count > bytes->left)
        return CAIRO_STATUS_READ_ERROR;
    memcpy(out, bytes->at, count);
    bytes->at += count;
    bytes->left -= count;
    return CAIRO_STATUS_SUCCESS;
}

cairo_surface_t *png_read(const void *bytes, size_t count)
{
    struct bytes rest = { bytes, count };
    cairo_surface_t *picture = cairo_image_surface_create_from_png_stream(take, &rest);
    if (cairo_surface_status(picture) == CAIRO_STATUS_SUCCESS)
        return picture;
    cairo_surface_destroy(picture);
    return NULL;
}
