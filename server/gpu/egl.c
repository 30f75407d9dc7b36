/* SPDX-License-Identifier: GPL-3.0-or-later */
/* GL contexts from EGL without a window: a chosen device, or Mesa's surfaceless platform. */
#include <stdlib.h>
#include <string.h>

#include <glad/egl.h>
#include <glad/gl.h>

#include "base/mem.h"
#include "gpu/gl_impl.h"

enum { MAX_DEVICES = 64 };

struct egl {
    struct gl base;
    EGLDisplay display;
    EGLContext context;
};

static const char *egl_error_text(void)
{
    switch (eglGetError()) {
    case EGL_SUCCESS: return "no reason given";
    case EGL_NOT_INITIALIZED: return "EGL_NOT_INITIALIZED";
    case EGL_BAD_ACCESS: return "EGL_BAD_ACCESS";
    case EGL_BAD_ALLOC: return "EGL_BAD_ALLOC";
    case EGL_BAD_ATTRIBUTE: return "EGL_BAD_ATTRIBUTE";
    case EGL_BAD_CONFIG: return "EGL_BAD_CONFIG";
    case EGL_BAD_MATCH: return "EGL_BAD_MATCH (no OpenGL 4.5 core)";
    case EGL_BAD_PARAMETER: return "EGL_BAD_PARAMETER";
    default: return "another EGL error";
    }
}

/* A driver that was in use stays loaded: its own leaks are known by its name (tests/leaks.txt), which an unloaded one has lost. */
static void egl_destroy(struct gl *gl)
{
    struct egl *egl = (struct egl *)gl;
    bool used = egl->context != EGL_NO_CONTEXT;
    if (used) {
        eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(egl->display, egl->context);
    } else if (egl->display) {
        eglTerminate(egl->display);
    }
    if (egl->display && eglReleaseThread) /* EGL 1.2: not loaded yet where the display could not be initialised */
        eglReleaseThread();
    if (!used)
        gladLoaderUnloadEGL();
    mem_free(egl);
}

static bool load_client(struct log *log, const char *name)
{
    if (gladLoaderLoadEGL(EGL_NO_DISPLAY))
        return true;
    log_info(log, "gl: %s: libEGL.so.1 cannot be loaded", name);
    return false;
}

/* From an initialised display to a current context. */
static bool make_current(struct log *log, struct egl *egl, const char *name)
{
    static const EGLint config_attributes[] = { EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE };
    static const EGLint context_attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE
    };
    EGLConfig config = EGL_NO_CONFIG_KHR;
    EGLint configs = 0;
    EGLint major = 0, minor = 0;
    if (!eglInitialize(egl->display, &major, &minor)) {
        log_info(log, "gl: %s: cannot initialise: %s", name, egl_error_text());
        return false;
    }
    gladLoaderLoadEGL(egl->display);
    if (!eglBindAPI(EGL_OPENGL_API)) {
        log_info(log, "gl: %s: EGL %d.%d has no desktop OpenGL", name, major, minor);
        return false;
    }
    if (!GLAD_EGL_KHR_no_config_context && (!eglChooseConfig(egl->display, config_attributes, &config, 1, &configs) || configs < 1)) {
        log_info(log, "gl: %s: no configuration renders OpenGL", name);
        return false;
    }
    egl->context = eglCreateContext(egl->display, config, EGL_NO_CONTEXT, context_attributes);
    if (!egl->context) {
        log_info(log, "gl: %s: no context: %s", name, egl_error_text());
        return false;
    }
    if (!eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl->context)) {
        log_info(log, "gl: %s: context cannot be made current without a surface: %s", name, egl_error_text());
        return false;
    }
    if (gladLoadGL((GLADloadfunc)eglGetProcAddress) < GLAD_MAKE_VERSION(4, 5)) {
        log_info(log, "gl: %s: OpenGL is older than 4.5", name);
        return false;
    }
    return true;
}

static struct gl *egl_from_display(struct log *log, const struct gl_impl *impl, EGLDisplay display)
{
    struct egl *egl = mem_new(sizeof(*egl));
    egl->base = (struct gl){ .kind = impl->kind, .impl = impl };
    egl->display = display;
    if (!display)
        log_info(log, "gl: %s: no display: %s", impl->name, egl_error_text());
    if (!display || !make_current(log, egl, impl->name)) {
        egl_destroy(&egl->base);
        return NULL;
    }
    return &egl->base;
}

static bool device_is_software(EGLDeviceEXT device)
{
    const char *extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
    return extensions && strstr(extensions, "EGL_MESA_device_software");
}

static struct gl *egl_device_create(struct log *log, int device, bool software)
{
    const struct gl_impl *impl = &gl_egl_device_impl;
    EGLDeviceEXT devices[MAX_DEVICES];
    EGLint count = 0;
    if (!load_client(log, impl->name))
        return NULL;
    if (!GLAD_EGL_EXT_platform_device || !eglQueryDevicesEXT || !eglGetPlatformDisplayEXT) {
        log_info(log, "gl: %s: this EGL cannot list devices", impl->name);
        return NULL;
    }
    if (!eglQueryDevicesEXT(MAX_DEVICES, devices, &count) || count < 1) {
        log_info(log, "gl: %s: no device", impl->name);
        return NULL;
    }
    if (device >= count) {
        log_info(log, "gl: %s: device %d asked for, there are %d", impl->name, device, count);
        return NULL;
    }
    for (int hardware = 1; hardware >= (software ? 0 : 1); hardware--)
        for (int i = 0; i < count; i++) {
            if (device >= 0 ? i != device : device_is_software(devices[i]) == (bool)hardware)
                continue;
            struct gl *gl = egl_from_display(log, impl, eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL));
            if (gl || device >= 0)
                return gl;
            if (!load_client(log, impl->name))
                return NULL;
        }
    log_info(log, "gl: %s: none of %d devices is hardware that works", impl->name, count);
    return NULL;
}

static struct gl *egl_surfaceless_create(struct log *log, int device, bool software)
{
    const struct gl_impl *impl = &gl_egl_surfaceless_impl;
    (void)device, (void)software;
    if (!load_client(log, impl->name))
        return NULL;
    if (!GLAD_EGL_MESA_platform_surfaceless || !eglGetPlatformDisplayEXT) {
        log_info(log, "gl: %s: this EGL has no surfaceless platform", impl->name);
        return NULL;
    }
    return egl_from_display(log, impl, eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL));
}

const struct gl_impl gl_egl_device_impl = {
    .kind = GL_EGL_DEVICE, .name = "egl-device", .create = egl_device_create, .destroy = egl_destroy
};
const struct gl_impl gl_egl_surfaceless_impl = {
    .kind = GL_EGL_SURFACELESS, .name = "egl-surfaceless", .create = egl_surfaceless_create, .destroy = egl_destroy
};
