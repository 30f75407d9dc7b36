/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interface of a way to create GL contexts; gl.c holds the table. */
#ifndef GPU_GL_IMPL_H
#define GPU_GL_IMPL_H
#include "base/text/text.h"
#include "gpu/gl.h"

struct gl_impl {
    enum gl_kind kind;
    const char *name;
    /* Creates a context and makes it current. Loads GL's functions too, unless gl_others() is true: other contexts may be using the
       function pointers. software: may use a software device, if none is requested. NULL: failed, with the reasons appended to `why`. */
    struct gl *(*create)(const struct gl_device *device, bool software, struct text *why);
    void (*destroy)(struct gl *gl);
    bool (*current)(const struct gl *gl); /* returns whether the context exists and is current */
    void (*lose)(struct gl *gl);          /* destroys the context but keeps the struct */
};

/* Returns whether other contexts of this kind exist, possibly in use. Only create and destroy may call this; they are called one at a
   time. */
bool gl_others(void);

extern const struct gl_impl gl_egl_device_impl, gl_egl_surfaceless_impl, gl_osmesa_impl;

#endif
