/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shader programs from the embedded sources. Thread: the one of the GL context. */
#ifndef GPU_PROGRAM_H
#define GPU_PROGRAM_H
#include <glad/gl.h>

#include "base/log/log.h"

struct program_params {
    const char *vertex, *fragment; /* names of embedded files; or */
    const char *compute;
    const char *defines; /* lines put before the source, or NULL */
};
#define program_params(...) (&(struct program_params){ __VA_ARGS__ })

/* A whole line `#include "x.glsl"` is replaced by that embedded file. 0 on failure: the compiler's text is logged. */
GLuint program_create(struct log *log, const struct program_params *params);
void program_destroy(GLuint *program); /* &0 is fine; leaves 0 */

/* One stage from text; name is for messages. 0 on failure, logged. */
GLuint program_compile(struct log *log, GLenum stage, const char *name, const char *text, const char *defines);
/* Deletes the stages (0 = none). 0 on failure, logged. */
GLuint program_link(struct log *log, const char *name, const GLuint stages[2]);

#endif
