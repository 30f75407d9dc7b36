/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which files can be imported, by their endings, and by what. Thread: any. */
#ifndef PREPROCESS_IMPORT_FORMATS_H
#define PREPROCESS_IMPORT_FORMATS_H
#include <stdbool.h>
#include <stdio.h>

enum format_reader { FORMAT_RVM, FORMAT_GLTF, FORMAT_PROGRAM };

struct import_format {
    const char *name;    /* "STEP" */
    const char *endings; /* ".step .stp", lower case */
    enum format_reader reader;
    const char *program; /* FORMAT_PROGRAM: its file name, beside this program or in ../libexec/plantcast/ */
    const char *runtime; /* what runs that file; NULL: itself */
    const char *missing; /* what to do where the program is not there */
    const char *beside;  /* endings of files that a model refers to, ".mtl", lower case; NULL: none */
    bool unitless;       /* it does not say its units: --units may */
    bool upless;         /* nor which axis is up: --up may */
};

/* Returns the format of a path by its ending, in any case; NULL if it has none of these. */
const struct import_format *import_format_of(const char *path);
/* Finds the program of a format. Returns its path, to be freed with mem_free, or NULL. */
char *import_format_program(const struct import_format *format);
/* Finds the runtime of a format in PATH. Returns its path, to be freed with mem_free; NULL: the format has none, or it is not installed. */
char *import_format_runtime(const struct import_format *format);
/* Prints each format, and whether this build reads it. */
void import_formats_print(FILE *out);

#endif
