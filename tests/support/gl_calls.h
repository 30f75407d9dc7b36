/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts all calls of GL: replaces the pointer to each GL function by a small piece of code that counts and calls the function.
   Call only in the thread that owns the GL context. */
#ifndef TESTS_SUPPORT_GL_CALLS_H
#define TESTS_SUPPORT_GL_CALLS_H
#include <stdbool.h>
#include <stdint.h>

#include "gpu/gl.h"

/* starts counting, which cannot be stopped again; returns false on processors other than x86-64 */
bool gl_calls_begin(const struct gl *gl);
uint64_t gl_calls(void);                  /* returns the number of GL calls since gl_calls_begin() */
uint64_t gl_draw_calls(void);             /* returns the number of calls of glDraw* and glMultiDraw* since gl_calls_begin() */

#endif
