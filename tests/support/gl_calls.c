/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Machine code for each GL function: increments a counter and jumps to the real function. */
#include "tests/support/gl_calls.h"

#include <dlfcn.h>
#include <string.h>
#include <sys/mman.h>

#include <glad/gl.h>

static uint64_t calls, draws;

uint64_t gl_calls(void)
{
    return calls;
}

uint64_t gl_draw_calls(void)
{
    return draws;
}

#ifdef __x86_64__
enum { STEP_BYTES = 48, STEPS_BYTES = 1 << 17 };
typedef GLADapiproc get_proc_fn(const char *name);
static get_proc_fn *get_proc;
static uint8_t *steps;
static size_t used;

/* Appends the instructions `mov r11, where` and `inc qword [r11]`. */
static uint8_t *put_count(uint8_t *at, const uint64_t *where)
{
    memcpy(at, (const uint8_t[]){ 0x49, 0xbb }, 2);
    memcpy(at + 2, &where, 8);
    memcpy(at + 10, (const uint8_t[]){ 0x49, 0xff, 0x03 }, 3);
    return at + 13;
}

static GLADapiproc stand_before(const char *name)
{
    GLADapiproc real = get_proc(name), step = NULL;
    uint8_t *at = steps + used;
    if (!real || used + STEP_BYTES > STEPS_BYTES)
        return real;
    memcpy(&step, &at, sizeof(step));
    at = put_count(at, &calls);
    if (!strncmp(name, "glDraw", 6) || !strncmp(name, "glMultiDraw", 11))
        at = put_count(at, &draws);
    memcpy(at, (const uint8_t[]){ 0x49, 0xbb }, 2); /* mov r11, real; jmp r11 */
    memcpy(at + 2, &real, 8);
    memcpy(at + 10, (const uint8_t[]){ 0x41, 0xff, 0xe3 }, 3);
    used += STEP_BYTES;
    return step;
}

bool gl_calls_begin(const struct gl *gl)
{
    bool osmesa = gl->kind == GL_OSMESA;
    void *library = dlopen(osmesa ? "libOSMesa.so.8" : "libEGL.so.1", RTLD_NOW);
    void *found = library ? dlsym(library, osmesa ? "OSMesaGetProcAddress" : "eglGetProcAddress") : NULL;
    steps = mmap(NULL, STEPS_BYTES, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    memcpy(&get_proc, &found, sizeof(get_proc));
    return found && steps != MAP_FAILED && gladLoadGL(stand_before) != 0;
}
#else
bool gl_calls_begin(const struct gl *gl)
{
    (void)gl;
    return false;
}
#endif
