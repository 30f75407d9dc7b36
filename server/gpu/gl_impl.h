/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interface that each way of creating GL contexts implements; gl.c lists the ways in a table. */
#ifndef GPU_GL_IMPL_H
#define GPU_GL_IMPL_H
#include "base/text/text.h"
#include "gpu/gl.h"

struct gl_impl {
    enum gl_kind kind;
    const char *name;
    /* Creates a context and makes it current. Also loads GL's functions, unless gl_others() returns true, because other
       contexts may be using the function pointers. software: may use a software device if no device is requested. Returns NULL
       on failure, with the reasons appended to `why`. */
    struct gl *(*create)(const struct gl_device *device, bool software, struct text *why);
    void (*destroy)(struct gl *gl);
    bool (*current)(const struct gl *gl); /* returns true if the GL context exists and is current in this thread */
    void (*lose)(struct gl *gl);          /* destroys the GL context but keeps the struct gl (for gl_lose()) */
};

/* Returns true if other contexts of this kind exist, which may be in use. Only `create` and `destroy` may call this, because
   gl.c runs only one of these at a time. */
bool gl_others(void);

extern const struct gl_impl gl_egl_device_impl, gl_egl_surfaceless_impl, gl_osmesa_impl;

#endif
