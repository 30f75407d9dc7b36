/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The file formats that can be imported, looked up by file ending, and the reader of each. Call from any thread. */
#ifndef PREPROCESS_IMPORT_FORMATS_H
#define PREPROCESS_IMPORT_FORMATS_H
#include <stdbool.h>
#include <stdio.h>

enum format_reader { FORMAT_RVM, FORMAT_GLTF, FORMAT_PROGRAM };

struct import_format {
    const char *name;    /* name for people: "STEP" */
    const char *endings; /* file endings of the format, such as ".step .stp", in lower case */
    enum format_reader reader;
    /* FORMAT_PROGRAM only: file name of the reader program, which is searched in this program's folder and in ../libexec/plantcast/ */
    const char *program;
    const char *runtime; /* interpreter that runs the reader, such as "node"; NULL: the reader is an executable */
    const char *missing; /* advice printed if the reader program is not installed */
    const char *beside;  /* lower-case extensions of files that a model may refer to, such as ".mtl"; NULL: none */
    /* true: the reader always finds these files by links in its folder, because it may ignore case in their names. false: it finds them
     * next to the model, and by links only if the model was compressed */
    bool linked;
    bool unitless;       /* true: files of this format do not state a length unit, so --units applies */
    bool upless;         /* true: files of this format do not state the up axis, so --up applies */
};

/* Error message for a model in ifcXML, a form of IFC that the reader does not support. */
#define FORMAT_IFC_XML "IFC in XML (ifcXML) is not supported: export the model as IFC in STEP text (.ifc)"

/* Returns the format for the path's ending (in upper or lower case), or NULL if there is none. All endings except glTF's may be
 * followed by ".gz". */
const struct import_format *import_format_of(const char *path);
/* Finds the reader program of a format. Returns its path, which the caller frees with mem_free, or NULL if it is not installed. */
char *import_format_program(const struct import_format *format);
/* Finds the interpreter of a format's reader, such as node, in $PATH. Returns its path, which the caller frees with mem_free.
 * NULL: the format needs none, or it is not installed. */
char *import_format_runtime(const struct import_format *format);
/* Returns the advice to print if import_format_program() found no reader (static text). */
const char *import_format_missing(const struct import_format *format);
/* Prints the name of each format and whether this installation can read it. */
void import_formats_print(FILE *out);

#endif
