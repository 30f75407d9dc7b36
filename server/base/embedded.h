/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shaders and colour maps that are embedded in the program, by name relative to shaders/. Immutable. Thread: any. */
#ifndef BASE_EMBEDDED_H
#define BASE_EMBEDDED_H

struct embedded_file {
    const char *name, *text;
};
extern const struct embedded_file embedded_files[]; /* ends with { 0, 0 }; made at build by deploy/embed */

const char *embedded_find(const char *name); /* returns the text (static), or NULL */

#endif
