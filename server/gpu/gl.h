/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Windowless OpenGL 4.5 core contexts. All contexts of a process are of the same kind; each stays current on the thread that created it. */
#ifndef GPU_GL_H
#define GPU_GL_H
#include <stdbool.h>
#include <stdio.h>

#include "base/log/log.h"

enum gl_kind { GL_AUTO, GL_EGL_DEVICE, GL_EGL_SURFACELESS, GL_OSMESA };

struct gl_device { /* identifies an EGL device, either by its index in EGL's list or by its PCI address */
    int index;     /* -1: identified by the address */
    unsigned domain, bus, slot, function;
};

struct gl {
    enum gl_kind kind; /* kind of the GL context that was created, so never GL_AUTO */
    char vendor[128], renderer[128], version[128];
    bool software;       /* llvmpipe, softpipe, swrast */
    bool reads_in_place; /* true: a software driver that can read the caller's memory without a copy (GL_AMD_pinned_memory) */
    int max_texture_px, max_samples;
    const struct gl_impl *impl;
    struct log *log;
};

/* Parses "auto", "egl-device", "egl-surfaceless" or "osmesa". Returns false for any other name. */
bool gl_kind_parse(const char *name, enum gl_kind *kind);
const char *gl_kind_name(enum gl_kind kind);
/* Parses an index or a PCI address: "2", "65:00.0", "0000:65:00.0". Returns false for anything else. */
bool gl_device_parse(const char *text, struct gl_device *device);
/* Prints one line per EGL device: index, PCI address, renderer. Returns the number of devices. Leaves no context current. */
int gl_list_devices(FILE *out);
/* Creates a context and makes it current. Tries an EGL device (device NULL: the first working hardware device), EGL surfaceless
   and OSMesa, in this order, or only the requested kind. With a device, tries only that EGL device. While other contexts exist,
   tries only their kind. Returns NULL if none works; all reasons are logged. */
struct gl *gl_create(struct log *log, enum gl_kind kind, const struct gl_device *device);
void gl_destroy(struct gl **gl); /* destroys the context and sets *gl to NULL; accepts a pointer to NULL */

/* Returns true if the context is lost (the GPU was reset, or its driver restarted). Everything drawn or read back since the
   last call is then invalid, and so are all GL objects. Destroy everything that uses the context, then the context itself, and
   create a new one. */
bool gl_lost(const struct gl *gl);
/* For tests: destroys the underlying context, like a device reset. */
void gl_lose(struct gl *gl);

void gl_clear_errors(void); /* discards earlier errors, so that gl_no_errors() reports only later ones */
bool gl_no_errors(void);    /* returns true if GL has reported no error since the last check */
/* Returns how often this thread's contexts have run out of GPU memory, as far as the functions of this header noticed.
   Everything created or drawn between two calls with different results is invalid. */
unsigned gl_out_of_memory_count(void);
/* gl_pass_enter() and gl_pass_leave() enclose a render pass in a debug group. gl_pass_leave() logs the pass's GL errors under
   its name, and returns false if there were any. */
void gl_pass_enter(const char *name);
bool gl_pass_leave(struct gl *gl, const char *name);

#endif
