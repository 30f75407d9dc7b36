/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What one way to a GL context provides; gl.c holds the table. */
#ifndef GPU_GL_IMPL_H
#define GPU_GL_IMPL_H
#include "gpu/gl.h"

struct gl_impl {
    enum gl_kind kind;
    const char *name;
    /* Makes a context current and loads GL's functions. device: index or -1; software: may be a software device.
       NULL: the reason is logged. */
    struct gl *(*create)(struct log *log, int device, bool software);
    void (*destroy)(struct gl *gl);
};

extern const struct gl_impl gl_egl_device_impl, gl_egl_surfaceless_impl, gl_osmesa_impl;

#endif
