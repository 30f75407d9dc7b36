/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shaders and colour maps that are built into the program, by name relative to shaders/. Immutable. */
#ifndef BASE_EMBEDDED_H
#define BASE_EMBEDDED_H

struct embedded_file {
    const char *name, *text;
};
extern const struct embedded_file embedded_files[]; /* ends with { 0, 0 }; made at build by deploy/embed */

const char *embedded_find(const char *name); /* the text, or NULL */

#endif
