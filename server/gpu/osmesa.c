/* SPDX-License-Identifier: GPL-3.0-or-later */
/* GL contexts from OSMesa, a library that is looked up at run time, because Mesa 25.1 and later do not include it. */
#include <dlfcn.h>

#include <glad/gl.h>

#include "base/mem.h"
#include "gpu/gl_impl.h"

/* Constants from GL/osmesa.h, so that the build does not need that header. */
enum {
    OSMESA_FORMAT = 0x22,
    OSMESA_DEPTH_BITS = 0x30,
    OSMESA_PROFILE = 0x33,
    OSMESA_CORE_PROFILE = 0x34,
    OSMESA_CONTEXT_MAJOR_VERSION = 0x36,
    OSMESA_CONTEXT_MINOR_VERSION = 0x37,
    OSMESA_RGBA = 0x1908,
    OSMESA_UNSIGNED_BYTE = 0x1401
};

struct osmesa {
    struct gl base;
    void *library, *context;
    void *(*create)(const int *attributes, void *share);
    void (*destroy)(void *context);
    unsigned char (*make_current)(void *context, void *buffer, unsigned type, int width, int height);
    GLADapiproc (*get_proc)(const char *name);
    void *(*get_current)(void);
    /* OSMesa needs a buffer to make a context current; nothing is ever drawn to this one, because frames are drawn to framebuffers */
    unsigned char buffer[4 * 4 * 4];
};

static bool osmesa_current(const struct gl *gl)
{
    const struct osmesa *osmesa = (const struct osmesa *)gl;
    return osmesa->context && osmesa->get_current() == osmesa->context;
}

static void osmesa_lose(struct gl *gl)
{
    struct osmesa *osmesa = (struct osmesa *)gl;
    osmesa->make_current(NULL, NULL, 0, 0, 0);
    osmesa->destroy(osmesa->context);
    osmesa->context = NULL;
}

static void osmesa_destroy(struct gl *gl)
{
    struct osmesa *osmesa = (struct osmesa *)gl;
    if (osmesa->context)
        osmesa->destroy(osmesa->context);
    mem_free(osmesa); /* does not unload the OSMesa library, because its threads may still be ending */
}

static bool osmesa_load(struct osmesa *osmesa)
{
    static const char *const names[] = { "libOSMesa.so.8", "libOSMesa.so.6" };
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]) && !osmesa->library; i++)
        osmesa->library = dlopen(names[i], RTLD_NOW | RTLD_LOCAL);
    if (!osmesa->library)
        return false;
    *(void **)&osmesa->create = dlsym(osmesa->library, "OSMesaCreateContextAttribs");
    *(void **)&osmesa->destroy = dlsym(osmesa->library, "OSMesaDestroyContext");
    *(void **)&osmesa->make_current = dlsym(osmesa->library, "OSMesaMakeCurrent");
    *(void **)&osmesa->get_proc = dlsym(osmesa->library, "OSMesaGetProcAddress");
    *(void **)&osmesa->get_current = dlsym(osmesa->library, "OSMesaGetCurrentContext");
    return osmesa->create && osmesa->destroy && osmesa->make_current && osmesa->get_proc && osmesa->get_current;
}

static struct gl *osmesa_create(const struct gl_device *device, bool software, struct text *why)
{
    static const int attributes[] = { OSMESA_FORMAT,
                                      OSMESA_RGBA,
                                      OSMESA_DEPTH_BITS,
                                      24,
                                      OSMESA_PROFILE,
                                      OSMESA_CORE_PROFILE,
                                      OSMESA_CONTEXT_MAJOR_VERSION,
                                      4,
                                      OSMESA_CONTEXT_MINOR_VERSION,
                                      5,
                                      0 };
    struct osmesa *osmesa = mem_new(sizeof(*osmesa));
    (void)device, (void)software;
    osmesa->base = (struct gl){ .kind = GL_OSMESA, .impl = &gl_osmesa_impl };
    if (!osmesa_load(osmesa)) {
        text_add(why, "; osmesa: libOSMesa.so.8 or .6 cannot be loaded");
        goto error;
    }
    osmesa->context = osmesa->create(attributes, NULL);
    if (!osmesa->context || !osmesa->make_current(osmesa->context, osmesa->buffer, OSMESA_UNSIGNED_BYTE, 4, 4)) {
        text_add(why, "; osmesa: libOSMesa cannot create an OpenGL 4.5 core context");
        goto error;
    }
    if (!gl_others() && gladLoadGL(osmesa->get_proc) < GLAD_MAKE_VERSION(4, 5)) {
        text_add(why, "; osmesa: OpenGL is older than 4.5");
        goto error;
    }
    return &osmesa->base;
error:
    osmesa_destroy(&osmesa->base);
    return NULL;
}

const struct gl_impl gl_osmesa_impl = {
    .kind = GL_OSMESA, .name = "osmesa", .create = osmesa_create, .destroy = osmesa_destroy, .current = osmesa_current, .lose = osmesa_lose
};
