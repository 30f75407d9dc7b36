/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts one model of any supported format to a GLB file. One conversion at a time per process, because
 * child.h waits for signals of the whole process. */
#ifndef PREPROCESS_IMPORT_CONVERSION_H
#define PREPROCESS_IMPORT_CONVERSION_H
#include <stdbool.h>
#include <stddef.h>

#include "base/text/charset.h"
#include "base/text/text.h"

enum { CONVERSION_WHY_BYTES = 512 };

struct conversion_params {
    double chord_m;
    const char *units, *up; /* length unit and up axis to assume for formats that do not state them; NULL: guess and print the guess */
    const char *mesh_units; /* length unit to assume for OBJ, STL, PLY and 3DS if `units` is NULL; NULL: guess and print the guess */
    /* encoding of names in the model; "": the encoding given in the file, else a detected one, which is printed */
    char encoding[CHARSET_NAME_BYTES];
    bool keep_covered;   /* true: RVM faces covered by the face of a neighbouring primitive are kept; false: they are left out */
    int timeout_s;       /* time limit for an external reader program, seconds */
    size_t memory_bytes; /* memory limit for an external reader program, bytes */
};

/* Reads the model at `path` and writes it to `glb` as glTF. Appends the reader's output (findings.h) to `said`, line by line. Temporary
 * files go to `folder` and may remain there. Returns false with the reason, one line, in why. */
bool conversion_run(const char *path, const char *glb, const char *folder, const struct conversion_params *params, struct text *said,
                    char why[CONVERSION_WHY_BYTES]);

#endif
