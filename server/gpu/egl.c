/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Windowless GL contexts from EGL: on a chosen device, or on Mesa's surfaceless platform. */
#include <string.h>

#include <glad/egl.h>
#include <glad/gl.h>

#include "base/mem.h"
#include "gpu/egl_devices.h"
#include "gpu/gl_impl.h"

struct egl {
    struct gl base;
    EGLDisplay display;
    EGLContext context;
    bool used;
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

static bool egl_current(const struct gl *gl)
{
    const struct egl *egl = (const struct egl *)gl;
    return egl->context != EGL_NO_CONTEXT && eglGetCurrentContext() == egl->context;
}

static void egl_lose(struct gl *gl)
{
    struct egl *egl = (struct egl *)gl;
    eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(egl->display, egl->context);
    egl->context = EGL_NO_CONTEXT;
}

/* Destroys a context, but does not unload its driver: the leak checker suppresses leaks by the driver's name (tests/leaks.txt)
   and could not name an unloaded one. The display stays open for the next context, even if the context was lost. If the display
   is lost as well, the next attempt to create a context fails and closes the display, and the attempt after that reopens it. */
static void egl_destroy(struct gl *gl)
{
    struct egl *egl = (struct egl *)gl;
    bool used = egl->used;
    if (egl->context)
        egl_lose(gl);
    if (egl->display && !used && !gl_others())
        eglTerminate(egl->display);
    if (egl->display && eglReleaseThread) /* eglReleaseThread, a function of EGL 1.2, is NULL if the display could not be initialised */
        eglReleaseThread();
    if (!used && !gl_others())
        gladLoaderUnloadEGL();
    mem_free(egl);
}

static bool load_client(const char *name, struct text *why)
{
    if (gl_others() || gladLoaderLoadEGL(EGL_NO_DISPLAY))
        return true;
    text_add(why, "; %s: libEGL.so.1 cannot be loaded", name);
    return false;
}

/* Creates a context that reports its loss (GPU reset), if the driver supports that. Returns EGL_NO_CONTEXT on failure. */
static EGLContext create_context(EGLDisplay display, EGLConfig config)
{
    static const EGLint telling[] = { EGL_CONTEXT_MAJOR_VERSION,
                                      4,
                                      EGL_CONTEXT_MINOR_VERSION,
                                      5,
                                      EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                      EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                      EGL_LOSE_CONTEXT_ON_RESET,
                                      EGL_NONE };
    static const EGLint silent[] = {
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE
    };
    EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, telling);
    return context ? context : eglCreateContext(display, config, EGL_NO_CONTEXT, silent);
}

/* Creates a context on an initialised display and makes it current. Returns false with the reason appended to `why`. */
static bool make_current(struct egl *egl, const char *name, struct text *why)
{
    static const EGLint config_attributes[] = { EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE };
    EGLConfig config = EGL_NO_CONFIG_KHR;
    EGLint configs = 0;
    EGLint major = 0, minor = 0;
    if (!eglInitialize(egl->display, &major, &minor)) {
        text_add(why, "; %s: cannot initialise: %s", name, egl_error_text());
        return false;
    }
    if (!gl_others())
        gladLoaderLoadEGL(egl->display);
    if (!eglBindAPI(EGL_OPENGL_API)) {
        text_add(why, "; %s: EGL %d.%d has no desktop OpenGL", name, major, minor);
        return false;
    }
    if (!GLAD_EGL_KHR_no_config_context && (!eglChooseConfig(egl->display, config_attributes, &config, 1, &configs) || configs < 1)) {
        text_add(why, "; %s: no configuration renders OpenGL", name);
        return false;
    }
    egl->context = create_context(egl->display, config);
    if (!egl->context) {
        text_add(why, "; %s: no context: %s", name, egl_error_text());
        return false;
    }
    if (!eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl->context)) {
        text_add(why, "; %s: context cannot be made current without a surface: %s", name, egl_error_text());
        return false;
    }
    egl->used = true;
    if (!gl_others() && gladLoadGL((GLADloadfunc)eglGetProcAddress) < GLAD_MAKE_VERSION(4, 5)) {
        text_add(why, "; %s: OpenGL is older than 4.5", name);
        return false;
    }
    return true;
}

static struct gl *egl_from_display(const struct gl_impl *impl, EGLDisplay display, struct text *why)
{
    struct egl *egl = mem_new(sizeof(*egl));
    egl->base = (struct gl){ .kind = impl->kind, .impl = impl };
    egl->display = display;
    if (!display)
        text_add(why, "; %s: no display: %s", impl->name, egl_error_text());
    if (!display || !make_current(egl, impl->name, why)) {
        egl_destroy(&egl->base);
        return NULL;
    }
    return &egl->base;
}

static struct gl *egl_from_device(EGLDeviceEXT device, struct text *why)
{
    return egl_from_display(&gl_egl_device_impl, eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, NULL), why);
}

static struct gl *egl_device_create(const struct gl_device *asked, bool software, struct text *why)
{
    const struct gl_impl *impl = &gl_egl_device_impl;
    struct egl_devices devices;
    if (!load_client(impl->name, why) || !egl_devices_read(&devices, impl->name, why))
        return NULL;
    if (asked) {
        int found = egl_devices_find(&devices, asked, impl->name, why);
        return found >= 0 ? egl_from_device(devices.at[found], why) : NULL;
    }
    for (int hardware = 1; hardware >= (software ? 0 : 1); hardware--)
        for (int i = 0; i < devices.count; i++) {
            if (egl_device_is_software(devices.at[i]) == (bool)hardware)
                continue;
            struct gl *gl = egl_from_device(devices.at[i], why);
            if (gl)
                return gl;
            if (!load_client(impl->name, why))
                return NULL;
        }
    text_add(why, "; %s: none of %d EGL devices is a working GPU", impl->name, devices.count);
    return NULL;
}

int gl_list_devices(FILE *out)
{
    struct egl_devices devices;
    struct text why = { 0 };
    int count = 0;
    if (!load_client("egl-device", &why) || !egl_devices_read(&devices, "egl-device", &why))
        goto end;
    for (count = 0; count < devices.count; count++) {
        struct gl_device address;
        char where[32] = "no PCI address";
        if (egl_device_address(devices.at[count], &address))
            snprintf(where, sizeof(where), "%04x:%02x:%02x.%x", address.domain, address.bus, address.slot, address.function);
        why.length = 0;
        struct gl *gl = egl_from_device(devices.at[count], &why);
        fprintf(out, "%d  %-14s  %s%s\n", count, where, gl ? (const char *)glGetString(GL_RENDERER) : "cannot be used",
                gl ? "" : why.at + strlen(";"));
        if (gl)
            gl->impl->destroy(gl);
        if (!load_client("egl-device", &why))
            break;
    }
end:
    if (count == 0)
        fprintf(out, "no EGL device%s\n", why.at ? why.at : "");
    text_finish(&why);
    return count;
}

static struct gl *egl_surfaceless_create(const struct gl_device *device, bool software, struct text *why)
{
    const struct gl_impl *impl = &gl_egl_surfaceless_impl;
    (void)device, (void)software;
    if (!load_client(impl->name, why))
        return NULL;
    if (!egl_client_has("EGL_MESA_platform_surfaceless") || !eglGetPlatformDisplayEXT) {
        text_add(why, "; %s: libEGL has no surfaceless platform (EGL_MESA_platform_surfaceless)", impl->name);
        return NULL;
    }
    return egl_from_display(impl, eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL), why);
}

const struct gl_impl gl_egl_device_impl = { .kind = GL_EGL_DEVICE,
                                            .name = "egl-device",
                                            .current = egl_current,
                                            .lose = egl_lose,
                                            .create = egl_device_create,
                                            .destroy = egl_destroy };
const struct gl_impl gl_egl_surfaceless_impl = { .kind = GL_EGL_SURFACELESS,
                                                 .name = "egl-surfaceless",
                                                 .current = egl_current,
                                                 .lose = egl_lose,
                                                 .create = egl_surfaceless_create,
                                                 .destroy = egl_destroy };
