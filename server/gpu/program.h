/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compiles shader programs from the embedded sources. Call only in the thread that owns the GL context. */
#ifndef GPU_PROGRAM_H
#define GPU_PROGRAM_H
#include <glad/gl.h>

#include "base/log/log.h"

struct program_params {
    /* names of the embedded files of vertex shader and fragment shader; NULL if `compute` names a compute shader instead */
    const char *vertex, *fragment;
    const char *compute;
    const char *defines; /* source lines such as #define to insert before the shader's source; NULL: none */
};
#define program_params(...) (&(struct program_params){ __VA_ARGS__ })

/* Compiles and links a program. A line `#include "x.glsl"` is replaced with that embedded file. Returns the program's GL name;
   0 on failure, with the compiler's messages logged. */
GLuint program_create(struct log *log, const struct program_params *params);
void program_destroy(GLuint *program); /* deletes the program and sets *program to 0; 0 is a no-op */

/* Compiles one stage from text. name: the text's name in log messages. On failure, logs the reason and returns 0. */
GLuint program_compile(struct log *log, GLenum stage, const char *name, const char *text, const char *defines);
/* Links two stages (0: none) into a program and deletes the stages. On failure, logs the reason and returns 0. */
GLuint program_link(struct log *log, const char *name, const GLuint stages[2]);

#endif
