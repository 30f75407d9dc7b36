/* SPDX-License-Identifier: GPL-3.0-or-later */
/* EGL's list of devices, and where each sits on the PCI bus. Private to gpu/. libEGL is loaded by the caller. */
#ifndef GPU_EGL_DEVICES_H
#define GPU_EGL_DEVICES_H
#include <glad/egl.h>

#include "base/text/text.h"
#include "gpu/gl.h"

enum { EGL_MAX_DEVICES = 64 };
struct egl_devices {
    EGLDeviceEXT at[EGL_MAX_DEVICES];
    int count;
};

/* Extensions of EGL itself, not of a display. */
bool egl_client_has(const char *name);
/* False: this EGL has none, or cannot list them; the reason is added to why. */
bool egl_devices_read(struct egl_devices *devices, const char *name, struct text *why);
bool egl_device_is_software(EGLDeviceEXT device);
/* Its PCI address, through the kernel's device file. False: it has none (software), or EGL does not say. */
bool egl_device_address(EGLDeviceEXT device, struct gl_device *address);
/* Index of the device asked for; -1: it is not there, and why says what is. */
int egl_devices_find(const struct egl_devices *devices, const struct gl_device *asked, const char *name, struct text *why);

#endif
