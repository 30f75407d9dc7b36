/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What one way to a GL context provides; gl.c holds the table. */
#ifndef GPU_GL_IMPL_H
#define GPU_GL_IMPL_H
#include "base/text/text.h"
#include "gpu/gl.h"

struct gl_impl {
    enum gl_kind kind;
    const char *name;
    /* Makes a context current and loads GL's functions, unless gl_others: they draw with them. software: may be a software device, where
       none is asked for. NULL: the reasons are added to why. */
    struct gl *(*create)(const struct gl_device *device, bool software, struct text *why);
    void (*destroy)(struct gl *gl);
    bool (*current)(const struct gl *gl); /* the context is there and current */
    void (*lose)(struct gl *gl);          /* destroys the context, keeps the rest */
};

/* Other contexts of this kind are there, and maybe at work. For create and destroy, which are called one at a time. */
bool gl_others(void);

extern const struct gl_impl gl_egl_device_impl, gl_egl_surfaceless_impl, gl_osmesa_impl;

#endif
