/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts calls of GL, every one, by standing before each of its functions. Thread: the one of the GL context. */
#ifndef TESTS_SUPPORT_GL_CALLS_H
#define TESTS_SUPPORT_GL_CALLS_H
#include <stdbool.h>
#include <stdint.h>

#include "gpu/gl.h"

bool gl_calls_begin(const struct gl *gl); /* from now on, for good. False: not on this kind of processor */
uint64_t gl_calls(void);                  /* so many since */
uint64_t gl_draw_calls(void);             /* of these, of functions named glDraw* and glMultiDraw* */

#endif
