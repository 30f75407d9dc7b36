/* SPDX-License-Identifier: GPL-3.0-or-later */
/* EGL's list of devices, and their PCI addresses. Private to gpu/. The caller loads libEGL. */
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

/* Returns true if EGL itself, as opposed to a display, has an extension. */
bool egl_client_has(const char *name);
/* Reads the list of devices. Returns false, with the reason appended to `why`, if this EGL has no devices or cannot list them. */
bool egl_devices_read(struct egl_devices *devices, const char *name, struct text *why);
bool egl_device_is_software(EGLDeviceEXT device);
/* Finds a device's PCI address through the kernel's device file. Returns false if the device has none (software) or EGL does
   not report the file. */
bool egl_device_address(EGLDeviceEXT device, struct gl_device *address);
/* Returns the index of the requested device; -1: it does not exist, and the existing devices are appended to `why`. */
int egl_devices_find(const struct egl_devices *devices, const struct gl_device *asked, const char *name, struct text *why);

#endif
