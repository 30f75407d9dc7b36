/* SPDX-License-Identifier: GPL-3.0-or-later */
/* OpenGL 4.5 core contexts without a window. One back end at a time in a process; each is current on the thread that made it, for life. */
#ifndef GPU_GL_H
#define GPU_GL_H
#include <stdbool.h>
#include <stdio.h>

#include "base/log/log.h"

enum gl_kind { GL_AUTO, GL_EGL_DEVICE, GL_EGL_SURFACELESS, GL_OSMESA };

struct gl_device { /* one EGL device, by its place in the list or by its PCI address */
    int index;     /* -1: by address */
    unsigned domain, bus, slot, function;
};

struct gl {
    enum gl_kind kind; /* what it became; never GL_AUTO */
    char vendor[128], renderer[128], version[128];
    bool software; /* llvmpipe, softpipe, swrast */
    bool reads_in_place; /* software that draws from the caller's memory without a copy (GL_AMD_pinned_memory) */
    int max_texture_px, max_samples;
    const struct gl_impl *impl;
    struct log *log;
};

/* "auto", "egl-device", "egl-surfaceless", "osmesa". False: unknown. */
bool gl_kind_parse(const char *name, enum gl_kind *kind);
const char *gl_kind_name(enum gl_kind kind);
/* "2", "65:00.0", "0000:65:00.0". False: neither. */
bool gl_device_parse(const char *text, struct gl_device *device);
/* One line for each EGL device: index, PCI address, what draws. Their number. Leaves no context current. */
int gl_list_devices(FILE *out);
/* Tries in the order EGL device (device NULL: the first with hardware that works), EGL surfaceless, OSMesa, or only the kind asked for;
   with a device only EGL devices. While there is a context already, only of its kind. NULL: none works; every reason is logged. */
struct gl *gl_create(struct log *log, enum gl_kind kind, const struct gl_device *device);
void gl_destroy(struct gl **gl); /* &NULL is fine; leaves NULL */

/* The context is gone (the GPU was reset, its driver restarted): whatever was drawn or read back since it was last asked is worth
   nothing, and so is every object in it. Destroy all that hangs on it, then gl itself, and make a new one. */
bool gl_lost(const struct gl *gl);
/* Destroys the context underneath, as a reset of the device does. So that tests can see what comes after. */
void gl_lose(struct gl *gl);

void gl_clear_errors(void); /* those of what was done before, so that the next one is of what is done now */
bool gl_no_errors(void);    /* there was none since */
/* How often the GPU was out of memory in the contexts of this thread, as far as was asked above or below: what was made or drawn before
   it rose is worth nothing. */
unsigned gl_out_of_memory_count(void);
/* Around everything a pass does: a debug group, and on leaving the GL errors of the pass, logged by its name. False: there was one. */
void gl_pass_enter(const char *name);
bool gl_pass_leave(struct gl *gl, const char *name);

#endif
