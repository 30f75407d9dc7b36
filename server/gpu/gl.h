/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An OpenGL 4.5 core context without a window. One back end per process; current on the thread that made it, for life. */
#ifndef GPU_GL_H
#define GPU_GL_H
#include <stdbool.h>

#include "base/log.h"

enum gl_kind { GL_AUTO, GL_EGL_DEVICE, GL_EGL_SURFACELESS, GL_OSMESA };

struct gl {
    enum gl_kind kind; /* what it became; never GL_AUTO */
    char vendor[128], renderer[128], version[128];
    bool software; /* llvmpipe, softpipe, swrast */
    int max_texture_px, max_samples;
    const struct gl_impl *impl;
    struct log *log;
};

/* "auto", "egl-device", "egl-surfaceless", "osmesa". False: unknown. */
bool gl_kind_parse(const char *name, enum gl_kind *kind);
const char *gl_kind_name(enum gl_kind kind);
/* Tries in the order EGL device (`device`: index, -1 = first with hardware), EGL surfaceless, OSMesa, or only the one asked for.
   NULL: none works; every reason is logged. */
struct gl *gl_create(struct log *log, enum gl_kind kind, int device);
void gl_destroy(struct gl **gl); /* &NULL is fine; leaves NULL */

/* Around everything a pass does: a debug group, and on leaving the GL errors of the pass, logged by its name. False: there was one. */
void gl_pass_enter(const char *name);
bool gl_pass_leave(struct gl *gl, const char *name);

#endif
