/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A library that the loader finds before libEGL.so.1 (LD_LIBRARY_PATH) and that acts like a device that is reset or out of
   memory. FAULTY_EGL: path of the real library; FAULTS: a file with struct faults, which the test writes while this library
   reads it. A loss destroys the real context in the middle of a picture. From then on GL calls do nothing, and
   glGetGraphicsResetStatus reports the loss. */
#include <dlfcn.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <glad/egl.h>
#include <glad/gl.h>

#undef eglGetProcAddress

#define EXPORT __attribute__((visibility("default")))

enum { OBJECTS = 1 << 14, RENDERER_BYTES = 32 };
enum gl_object_kind { BUFFER, TEXTURE };

struct faults {
    /* --- below: written by the test */
    uint32_t losses;      /* number of contexts to destroy, counted from the beginning; a loss begins while `lost` is smaller */
    uint32_t loss_calls;  /* a requested loss happens with this GL call after the request; 0, 1: the next one */
    uint32_t refusals;    /* this many further creations of a context fail; the library counts down */
    uint32_t hardware;    /* nonzero: contexts claim to be rendered by a GPU, not in software; set before the first context is created */
    uint64_t room_bytes;  /* limit on the bytes of all buffers and textures; 0: unlimited */
    /* --- below: written by this library */
    uint32_t lost, contexts;  /* lost: number of contexts destroyed so far; contexts: number of existing contexts */
    uint64_t used_bytes, most_bytes;
    uint32_t objects, refused; /* objects: number of existing buffers and textures; refused: allocations refused because of room_bytes */
    uint32_t made;             /* number of contexts created so far */
};

struct object {
    EGLContext context;
    enum gl_object_kind kind;
    GLuint name;
    uint64_t bytes; /* size of the object; 0: the entry is free */
};

/* Only one thread calls GL at a time: a context belongs to one thread, and during a plant reload the other thread waits. */
static struct faults *faults;
static struct object objects[OBJECTS];
static EGLContext current, gone; /* current: the context in use; gone: the one that was lost, which stays current until it is replaced */
static EGLDisplay display;
static uint32_t calls_left;
static bool full; /* true: the next glGetError must report "out of memory" */
static struct {
    PFNEGLGETPROCADDRESSPROC get_proc;
    PFNEGLCREATECONTEXTPROC create_context;
    PFNEGLDESTROYCONTEXTPROC destroy_context;
    PFNEGLMAKECURRENTPROC make_current;
    PFNEGLGETCURRENTCONTEXTPROC get_current_context;
} real;

static void stop(const char *why)
{
    fprintf(stderr, "gl_faults: %s\n", why);
    abort();
}

static void set_up(void)
{
    Dl_info self;
    const char *path = getenv("FAULTS"), *library = getenv("FAULTY_EGL");
    int file = path ? open(path, O_RDWR | O_CLOEXEC) : -1;
    void *egl = library ? dlopen(library, RTLD_NOW | RTLD_LOCAL) : NULL;
    if (file < 0 || !egl)
        stop("FAULTS and FAULTY_EGL name files that can be opened");
    faults = mmap(NULL, sizeof(*faults), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (faults == MAP_FAILED)
        stop("FAULTS cannot be mapped");
    /* Keeps this library loaded: after an unload, the next dlopen would find the real one, which has the same name. */
    if (!dladdr((void *)&faults, &self) || !dlopen(self.dli_fname, RTLD_NOW | RTLD_NODELETE))
        stop("this library cannot stay");
    close(file);
    *(void **)&real.get_proc = dlsym(egl, "eglGetProcAddress");
    *(void **)&real.create_context = dlsym(egl, "eglCreateContext");
    *(void **)&real.destroy_context = dlsym(egl, "eglDestroyContext");
    *(void **)&real.make_current = dlsym(egl, "eglMakeCurrent");
    *(void **)&real.get_current_context = dlsym(egl, "eglGetCurrentContext");
}

/* --- memory --------------------------------------------------------------------------------------------------------------------- */

static void forget(struct object *object)
{
    faults->used_bytes -= object->bytes;
    faults->objects--;
    *object = (struct object){ 0 };
}

static void forget_context(EGLContext context)
{
    for (int i = 0; i < OBJECTS; i++)
        if (objects[i].bytes && objects[i].context == context)
            forget(&objects[i]);
}

static void forget_named(enum gl_object_kind kind, GLsizei count, const GLuint *names)
{
    for (GLsizei n = 0; n < count; n++)
        for (int i = 0; names[n] && i < OBJECTS; i++)
            if (objects[i].bytes && objects[i].context == current && objects[i].kind == kind && objects[i].name == names[n])
                forget(&objects[i]);
}

/* Counts an allocation. Returns false if there is no memory left; glGetError then reports it. */
static bool take_room(enum gl_object_kind kind, GLuint name, uint64_t bytes)
{
    int i = 0;
    if (gone == current || !name || !bytes)
        return true; /* nothing is counted in a lost context, without an object or for zero bytes */
    if (faults->room_bytes && faults->used_bytes + bytes > faults->room_bytes) {
        faults->refused++;
        full = true;
        return false;
    }
    while (i < OBJECTS && objects[i].bytes)
        i++;
    if (i == OBJECTS)
        stop("too many objects");
    objects[i] = (struct object){ .context = current, .kind = kind, .name = name, .bytes = bytes };
    faults->objects++;
    faults->used_bytes += bytes;
    if (faults->used_bytes > faults->most_bytes)
        faults->most_bytes = faults->used_bytes;
    return true;
}

/* --- loss ----------------------------------------------------------------------------------------------------------------------- */

static void lose(void)
{
    real.make_current(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (!real.destroy_context(display, current))
        stop("a context cannot be destroyed");
    forget_context(current);
    gone = current;
    faults->contexts--;
    faults->lost++;
}

/* Runs before each GL call below. */
static void call(void)
{
    if (gone == current || faults->lost >= faults->losses) {
        calls_left = faults->loss_calls;
        return;
    }
    if (calls_left == 0 || --calls_left == 0)
        lose();
}

/* --- replaced EGL functions --------------------------------------------------------------------------------------------------------- */

static EGLContext EGLAPIENTRY create_context(EGLDisplay on, EGLConfig config, EGLContext share, const EGLint *attributes)
{
    if (faults->refusals > 0) {
        faults->refusals--;
        return EGL_NO_CONTEXT;
    }
    EGLContext context = real.create_context(on, config, share, attributes);
    if (context) {
        faults->contexts++;
        faults->made++;
    }
    return context;
}

static EGLBoolean EGLAPIENTRY destroy_context(EGLDisplay on, EGLContext context)
{
    if (context == gone) {
        gone = EGL_NO_CONTEXT;
        return EGL_TRUE;
    }
    forget_context(context);
    faults->contexts--;
    return real.destroy_context(on, context);
}

static EGLBoolean EGLAPIENTRY make_current(EGLDisplay on, EGLSurface draw, EGLSurface read, EGLContext context)
{
    display = on;
    current = context;
    return context && context == gone ? EGL_FALSE : real.make_current(on, draw, read, context);
}

static EGLContext EGLAPIENTRY get_current_context(void)
{
    return gone && gone == current ? gone : real.get_current_context();
}

/* --- replaced GL functions ---------------------------------------------------------------------------------------------------------- */

/* Replaces a GL function by one that runs call() and then the real function. */
#define PASS(name, type, params, args)            \
    static type(GLAD_API_PTR *real_##name) params; \
    static type GLAD_API_PTR call_##name params   \
    {                                             \
        call();                                   \
        return real_##name args;                  \
    }
/* Replaces a GL function that allocates `bytes` bytes for an object. */
#define TAKE(name, params, args, kind, object, bytes) \
    static void(GLAD_API_PTR *real_##name) params;     \
    static void GLAD_API_PTR call_##name params       \
    {                                                 \
        call();                                       \
        if (take_room(kind, object, bytes))           \
            real_##name args;                         \
    }
#define FORGET(name, kind)                                              \
    static void(GLAD_API_PTR *real_##name)(GLsizei n, const GLuint *names); \
    static void GLAD_API_PTR call_##name(GLsizei n, const GLuint *names) \
    {                                                                   \
        call();                                                         \
        forget_named(kind, n, names);                                   \
        real_##name(n, names);                                          \
    }

PASS(glBindFramebuffer, void, (GLenum a, GLuint b), (a, b))
PASS(glBindTextureUnit, void, (GLuint a, GLuint b), (a, b))
PASS(glBindBufferBase, void, (GLenum a, GLuint b, GLuint c), (a, b, c))
PASS(glBindVertexArray, void, (GLuint a), (a))
PASS(glUseProgram, void, (GLuint a), (a))
PASS(glClear, void, (GLbitfield a), (a))
PASS(glMultiDrawElements, void, (GLenum a, const GLsizei *b, GLenum c, const void *const *d, GLsizei e), (a, b, c, d, e))
PASS(glDrawArrays, void, (GLenum a, GLint b, GLsizei c), (a, b, c))
PASS(glDispatchCompute, void, (GLuint a, GLuint b, GLuint c), (a, b, c))
PASS(glMemoryBarrier, void, (GLbitfield a), (a))
PASS(glReadPixels, void, (GLint a, GLint b, GLsizei c, GLsizei d, GLenum e, GLenum f, void *g), (a, b, c, d, e, f, g))
PASS(glFenceSync, GLsync, (GLenum a, GLbitfield b), (a, b))
PASS(glClientWaitSync, GLenum, (GLsync a, GLbitfield b, GLuint64 c), (a, b, c))
PASS(glMapNamedBufferRange, void *, (GLuint a, GLintptr b, GLsizeiptr c, GLbitfield d), (a, b, c, d))
PASS(glNamedBufferSubData, void, (GLuint a, GLintptr b, GLsizeiptr c, const void *d), (a, b, c, d))
PASS(glPopDebugGroup, void, (void), ())
TAKE(glNamedBufferStorage, (GLuint b, GLsizeiptr bytes, const void *data, GLbitfield flags), (b, bytes, data, flags), BUFFER, b,
     (uint64_t)bytes)
TAKE(glTextureStorage2D, (GLuint t, GLsizei levels, GLenum format, GLsizei w, GLsizei h), (t, levels, format, w, h), TEXTURE, t,
     (uint64_t)w *(uint64_t)h * 4)
TAKE(glTextureStorage3D, (GLuint t, GLsizei levels, GLenum format, GLsizei w, GLsizei h, GLsizei d), (t, levels, format, w, h, d),
     TEXTURE, t, (uint64_t)w *(uint64_t)h *(uint64_t)d * 4)
TAKE(glTextureStorage2DMultisample, (GLuint t, GLsizei samples, GLenum format, GLsizei w, GLsizei h, GLboolean fixed),
     (t, samples, format, w, h, fixed), TEXTURE, t, (uint64_t)w *(uint64_t)h *(uint64_t)samples * 4)
FORGET(glDeleteBuffers, BUFFER)
FORGET(glDeleteTextures, TEXTURE)

static PFNGLGETERRORPROC real_glGetError;
static GLenum GLAD_API_PTR call_glGetError(void)
{
    call();
    bool told = full;
    full = false;
    if (gone == current)
        return GL_CONTEXT_LOST;
    return told ? GL_OUT_OF_MEMORY : real_glGetError();
}

static PFNGLGETGRAPHICSRESETSTATUSPROC real_glGetGraphicsResetStatus;
static GLenum GLAD_API_PTR call_glGetGraphicsResetStatus(void)
{
    call();
    return gone == current ? GL_UNKNOWN_CONTEXT_RESET : real_glGetGraphicsResetStatus();
}

static PFNGLGETSTRINGPROC real_glGetString;
static const GLubyte *GLAD_API_PTR call_glGetString(GLenum name)
{
    return name == GL_RENDERER && faults->hardware ? (const GLubyte *)"a processor that says it is a GPU" : real_glGetString(name);
}

/* --- loading -------------------------------------------------------------------------------------------------------------------- */

#define ENTRY(name) { #name, (GLADapiproc)call_##name, (GLADapiproc *)&real_##name }
static const struct {
    const char *name;
    /* ours: function of this library that replaces the real one; real: where to store the real one's address; NULL: it is
       stored already */
    GLADapiproc ours, *real;
} functions[] = {
    { "eglCreateContext", (GLADapiproc)create_context, NULL },
    { "eglDestroyContext", (GLADapiproc)destroy_context, NULL },
    { "eglMakeCurrent", (GLADapiproc)make_current, NULL },
    { "eglGetCurrentContext", (GLADapiproc)get_current_context, NULL },
    ENTRY(glBindFramebuffer),
    ENTRY(glBindTextureUnit),
    ENTRY(glBindBufferBase),
    ENTRY(glBindVertexArray),
    ENTRY(glUseProgram),
    ENTRY(glClear),
    ENTRY(glMultiDrawElements),
    ENTRY(glDrawArrays),
    ENTRY(glDispatchCompute),
    ENTRY(glMemoryBarrier),
    ENTRY(glReadPixels),
    ENTRY(glFenceSync),
    ENTRY(glClientWaitSync),
    ENTRY(glMapNamedBufferRange),
    ENTRY(glNamedBufferSubData),
    ENTRY(glPopDebugGroup),
    ENTRY(glNamedBufferStorage),
    ENTRY(glTextureStorage2D),
    ENTRY(glTextureStorage3D),
    ENTRY(glTextureStorage2DMultisample),
    ENTRY(glDeleteBuffers),
    ENTRY(glDeleteTextures),
    ENTRY(glGetError),
    ENTRY(glGetGraphicsResetStatus),
    ENTRY(glGetString),
};

EXPORT GLADapiproc eglGetProcAddress(const char *name);
GLADapiproc eglGetProcAddress(const char *name)
{
    if (!faults)
        set_up();
    GLADapiproc found = (GLADapiproc)real.get_proc(name);
    for (size_t i = 0; i < sizeof(functions) / sizeof(functions[0]); i++) {
        if (strcmp(functions[i].name, name))
            continue;
        if (functions[i].real)
            *functions[i].real = found;
        return functions[i].ours;
    }
    return found;
}
