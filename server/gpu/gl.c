/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses a way to create a GL context, and reads the context's capabilities. */
#include "gpu/gl.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include <glad/gl.h>

#include "gpu/gl_impl.h"

struct attempt {
    const struct gl_impl *impl;
    /* software: this attempt may use a software device even if the caller requested no device; again: this attempt repeats an
       earlier one, now with software devices allowed */
    bool software, again;
};
static const struct attempt attempts[] = {
    { &gl_egl_device_impl, false, false },
    { &gl_egl_surfaceless_impl, true, false },
    { &gl_egl_device_impl, true, true },
    { &gl_osmesa_impl, true, false },
};
enum { ATTEMPTS = sizeof(attempts) / sizeof(attempts[0]) };

/* Contexts of this process. EGL cannot be used while an OSMesa context exists, so all contexts must be of the same kind. */
static struct {
    pthread_mutex_t lock; /* lock that a thread holds while it creates or destroys a GL context */
    /* --- below: under lock */
    int count;         /* number of living contexts */
    enum gl_kind kind; /* kind of the existing contexts */
} living = { .lock = PTHREAD_MUTEX_INITIALIZER };

bool gl_others(void)
{
    return living.count > 0;
}

bool gl_kind_parse(const char *name, enum gl_kind *kind)
{
    if (!strcmp(name, "auto")) {
        *kind = GL_AUTO;
        return true;
    }
    for (int i = 0; i < ATTEMPTS; i++)
        if (!strcmp(name, attempts[i].impl->name)) {
            *kind = attempts[i].impl->kind;
            return true;
        }
    return false;
}

const char *gl_kind_name(enum gl_kind kind)
{
    for (int i = 0; i < ATTEMPTS; i++)
        if (attempts[i].impl->kind == kind)
            return attempts[i].impl->name;
    return "auto";
}

static void GLAD_API_PTR on_debug_message(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length, const GLchar *text,
                                          const void *log)
{
    (void)source, (void)id, (void)length;
    if (type == GL_DEBUG_TYPE_ERROR || severity == GL_DEBUG_SEVERITY_HIGH)
        log_at((struct log *)log, type == GL_DEBUG_TYPE_ERROR ? LOG_ERROR : LOG_WARN, "gl: %s", text);
}

static void copy_string(char out[128], GLenum name)
{
    const GLubyte *text = glGetString(name);
    snprintf(out, 128, "%s", text ? (const char *)text : "?");
}

static bool has_extension(const char *name)
{
    GLint count = 0;
    glGetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; i++) {
        const GLubyte *known = glGetStringi(GL_EXTENSIONS, (GLuint)i);
        if (known && !strcmp((const char *)known, name))
            return true;
    }
    return false;
}

static void read_capabilities(struct gl *gl)
{
    copy_string(gl->vendor, GL_VENDOR);
    copy_string(gl->renderer, GL_RENDERER);
    copy_string(gl->version, GL_VERSION);
    gl->software = strstr(gl->renderer, "llvmpipe") || strstr(gl->renderer, "softpipe") || strstr(gl->renderer, "swrast");
    gl->reads_in_place = gl->software && has_extension("GL_AMD_pinned_memory");
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &gl->max_texture_px);
    glGetIntegerv(GL_MAX_SAMPLES, &gl->max_samples);
}

/* Sets the GL state on which every pass relies: rows from the top, depth 1 (near) to 0 (far). */
static void set_conventions(struct gl *gl)
{
    glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
    glClearDepth(0.0);
    glDepthFunc(GL_GEQUAL);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glDisable(GL_DITHER);
    glDebugMessageCallback(on_debug_message, gl->log);
}

/* Tries the kinds of contexts in order, or only `kind` unless it is GL_AUTO. Appends the reasons for failed attempts to `why`,
   each preceded by "; ". Returns NULL if none works. */
static struct gl *attempt_all(enum gl_kind kind, const struct gl_device *device, struct text *why)
{
    /* true: the caller asks for a kind or a device, so that even the first attempt may use a software device */
    bool asked = kind != GL_AUTO || device;
    for (int i = 0; i < ATTEMPTS; i++) {
        const struct attempt *attempt = &attempts[i];
        bool wanted = kind == GL_AUTO ? !device || attempt->impl->kind == GL_EGL_DEVICE : attempt->impl->kind == kind;
        if ((living.count > 0 && attempt->impl->kind != living.kind) || (asked && attempt->again))
            continue;
        struct gl *gl = wanted ? attempt->impl->create(device, asked || attempt->software, why) : NULL;
        if (gl)
            return gl;
    }
    return NULL;
}

struct gl *gl_create(struct log *log, enum gl_kind kind, const struct gl_device *device)
{
    struct text why = { 0 };
    pthread_mutex_lock(&living.lock);
    struct gl *gl = attempt_all(kind, device, &why);
    if (gl) {
        living.kind = gl->kind;
        living.count++;
    }
    pthread_mutex_unlock(&living.lock);
    const char *reasons = why.length ? why.at : "; nothing left to try";
    if (gl) {
        gl->log = log;
        read_capabilities(gl);
        set_conventions(gl);
        log_info(log, "gl: %s: %s, %s%s", gl->impl->name, gl->renderer, gl->version, why.length ? reasons : "");
    } else {
        log_err(log, "no OpenGL 4.5 context (%s): install libegl1 and libgl1-mesa-dri, or libosmesa6%s", gl_kind_name(kind), reasons);
    }
    text_finish(&why);
    return gl;
}

bool gl_lost(const struct gl *gl)
{
    return !gl->impl->current(gl) || glGetGraphicsResetStatus() != GL_NO_ERROR;
}

void gl_lose(struct gl *gl)
{
    gl->impl->lose(gl);
}

void gl_destroy(struct gl **gl)
{
    if (!*gl)
        return;
    pthread_mutex_lock(&living.lock);
    living.count--;
    (*gl)->impl->destroy(*gl);
    pthread_mutex_unlock(&living.lock);
    *gl = NULL;
}

static _Thread_local unsigned shortages; /* number of GL_OUT_OF_MEMORY errors on this thread so far */

static GLenum next_error(void)
{
    GLenum error = glGetError();
    shortages += error == GL_OUT_OF_MEMORY;
    return error;
}

void gl_clear_errors(void)
{
    for (int i = 0; i < 8 && next_error() != GL_NO_ERROR; i++) { /* reads at most 8 errors: a lost GL context reports errors forever */
    }
}

bool gl_no_errors(void)
{
    return next_error() == GL_NO_ERROR;
}

unsigned gl_out_of_memory_count(void)
{
    return shortages;
}

void gl_pass_enter(const char *name)
{
    glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, -1, name);
}

bool gl_pass_leave(struct gl *gl, const char *name)
{
    glPopDebugGroup();
    GLenum error = next_error();
    if (error == GL_NO_ERROR)
        return true;
    log_err(gl->log, "gl: OpenGL error while drawing pass %s: 0x%04x", name, error);
    return false;
}
