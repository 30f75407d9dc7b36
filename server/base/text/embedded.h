/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text files that are embedded in the program: shaders and colour maps, by name relative to shaders/, and the fleet page, by its path.
   Immutable. Thread: any. */
#ifndef BASE_TEXT_EMBEDDED_H
#define BASE_TEXT_EMBEDDED_H

struct embedded_file {
    const char *name, *text;
};
extern const struct embedded_file embedded_files[]; /* ends with { 0, 0 }; made at build by deploy/embed */

const char *embedded_find(const char *name); /* returns the text (static), or NULL */

#endif
