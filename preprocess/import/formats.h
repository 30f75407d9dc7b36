/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The file formats that can be imported, found by file ending, and the reader of each. Thread: any. */
#ifndef PREPROCESS_IMPORT_FORMATS_H
#define PREPROCESS_IMPORT_FORMATS_H
#include <stdbool.h>
#include <stdio.h>

enum format_reader { FORMAT_RVM, FORMAT_GLTF, FORMAT_PROGRAM };

struct import_format {
    const char *name;    /* name for people: "STEP" */
    const char *endings; /* file endings of the format, such as ".step .stp", in lower case */
    enum format_reader reader;
    /* file name of the reader program, only for FORMAT_PROGRAM; searched in the folder of this program and in ../libexec/plantcast/ */
    const char *program;
    const char *runtime; /* interpreter that runs the reader, such as "node"; NULL: the reader is an executable */
    const char *missing; /* advice printed if the reader program is not installed */
    const char *beside;  /* file endings of further files that a model may refer to, such as ".mtl", lower case; NULL: none */
    bool unitless;       /* true: the format states no length unit, so --units applies */
    bool upless;         /* true: the format does not state which axis is up, so --up applies */
};

/* Error message for a model in ifcXML, a form of IFC that the reader does not support. */
#define FORMAT_IFC_XML "IFC in XML (ifcXML) is not supported: export the model as IFC in STEP text (.ifc)"

/* Returns the format that the path's ending (in upper or lower case) belongs to, or NULL if there is none. All but glTF may be followed by
 * ".gz". */
const struct import_format *import_format_of(const char *path);
/* Finds the reader program of a format. Returns its path, which the caller frees with mem_free, or NULL if it is not installed. */
char *import_format_program(const struct import_format *format);
/* Finds the interpreter of a format's reader, such as node, in the folders of $PATH. Returns its path, which the caller frees with
 * mem_free. NULL: the format needs none, or it is not installed. */
char *import_format_runtime(const struct import_format *format);
/* Returns the advice to print if import_format_program() found no reader (static text). */
const char *import_format_missing(const struct import_format *format);
/* Prints the name of each format and whether this installation can read it. */
void import_formats_print(FILE *out);

#endif
