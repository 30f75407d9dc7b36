/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists the devices (GPUs) that EGL knows, with their PCI addresses. */
#include "gpu/egl_devices.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

bool gl_device_parse(const char *text, struct gl_device *device)
{
    struct gl_device out = { .index = -1 };
    int end = 0;
    if (sscanf(text, "%4x:%2x:%2x.%1x%n", &out.domain, &out.bus, &out.slot, &out.function, &end) == 4 && !text[end])
        goto good;
    out.domain = 0;
    if (sscanf(text, "%2x:%2x.%1x%n", &out.bus, &out.slot, &out.function, &end) == 3 && !text[end])
        goto good;
    if (strspn(text, "0123456789") == strlen(text) && sscanf(text, "%3d%n", &out.index, &end) == 1 && !text[end])
        goto good;
    return false;
good:
    *device = out;
    return true;
}

static bool has_word(const char *all, const char *name)
{
    size_t length = strlen(name);
    for (const char *at = all; at && (at = strstr(at, name)); at += length)
        if ((at == all || at[-1] == ' ') && (at[length] == ' ' || !at[length]))
            return true;
    return false;
}

/* asks EGL itself, because the flags of the function loader (glad) describe the most recently initialised display */
bool egl_client_has(const char *name)
{
    return has_word(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), name);
}

bool egl_devices_read(struct egl_devices *devices, const char *name, struct text *why)
{
    EGLint count = 0;
    devices->count = 0;
    if (!egl_client_has("EGL_EXT_platform_device") || !eglQueryDevicesEXT || !eglGetPlatformDisplayEXT) {
        text_add(why, "; %s: libEGL cannot list devices (EGL_EXT_platform_device)", name);
        return false;
    }
    if (!eglQueryDevicesEXT(EGL_MAX_DEVICES, devices->at, &count) || count < 1) {
        text_add(why, "; %s: no device", name);
        return false;
    }
    devices->count = count;
    return true;
}

bool egl_device_is_software(EGLDeviceEXT device)
{
    return has_word(eglQueryDeviceStringEXT(device, EGL_EXTENSIONS), "EGL_MESA_device_software");
}

/* Reads a PCI address from the target of the link /sys/dev/char/226:0/device, such as .../0000:65:00.0. Returns false if the
   target has none. */
static bool address_of_file(const char *path, struct gl_device *address)
{
    struct stat file;
    char link[64], target[PATH_MAX];
    if (stat(path, &file) != 0)
        return false;
    snprintf(link, sizeof(link), "/sys/dev/char/%u:%u/device", major(file.st_rdev), minor(file.st_rdev));
    ssize_t n = readlink(link, target, sizeof(target) - 1);
    if (n <= 0)
        return false;
    target[n] = 0;
    const char *slash = strrchr(target, '/');
    return gl_device_parse(slash ? slash + 1 : target, address) && address->index < 0;
}

bool egl_device_address(EGLDeviceEXT device, struct gl_device *address)
{
    const char *extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS), *path = NULL;
    if (has_word(extensions, "EGL_EXT_device_drm"))
        path = eglQueryDeviceStringEXT(device, EGL_DRM_DEVICE_FILE_EXT);
    if (path && address_of_file(path, address))
        return true;
    path = NULL;
    if (has_word(extensions, "EGL_EXT_device_drm_render_node"))
        path = eglQueryDeviceStringEXT(device, EGL_DRM_RENDER_NODE_FILE_EXT);
    return path && address_of_file(path, address);
}

int egl_devices_find(const struct egl_devices *devices, const struct gl_device *asked, const char *name, struct text *why)
{
    if (asked->index >= 0 && asked->index < devices->count)
        return asked->index;
    if (asked->index >= 0) {
        text_add(why, "; %s: device %d was requested, but there are only %d (counted from 0)", name, asked->index, devices->count);
        return -1;
    }
    for (int i = 0; i < devices->count; i++) {
        struct gl_device is;
        if (egl_device_address(devices->at[i], &is) && is.domain == asked->domain && is.bus == asked->bus && is.slot == asked->slot &&
            is.function == asked->function)
            return i;
    }
    text_add(why, "; %s: none of %d devices is at PCI address %04x:%02x:%02x.%x", name, devices->count, asked->domain, asked->bus,
             asked->slot, asked->function);
    return -1;
}
