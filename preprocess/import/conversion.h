/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts one model of any supported format to a GLB file. Thread: one conversion at a time per process (child.h). */
#ifndef PREPROCESS_IMPORT_CONVERSION_H
#define PREPROCESS_IMPORT_CONVERSION_H
#include <stdbool.h>
#include <stddef.h>

#include "base/text/text.h"

enum { CONVERSION_WHY_BYTES = 512 };

struct conversion_params {
    double chord_m;
    const char *units, *up; /* units and up axis for formats that do not state them; NULL: guess them, and print the guess */
    const char *mesh_units; /* units for OBJ, STL, PLY and 3DS where `units` is NULL; NULL: guess them, and print the guess */
    const char *encoding;   /* encoding of names in the model; NULL: as stated by the file, else detected and printed */
    bool keep_covered;      /* RVM: keep faces that are covered by a neighbour's face */
    int timeout_s;          /* seconds that an external reader program may run */
    size_t memory_bytes;    /* bytes of memory that an external reader program may use */
};

/* Reads the model at `path` and writes it to `glb` as glTF. Appends what the reader printed to `said`, line by line. Temporary files go to
 * `folder` and may remain there. Returns false with the reason, one line, in why. */
bool conversion_run(const char *path, const char *glb, const char *folder, const struct conversion_params *params, struct text *said,
                    char why[CONVERSION_WHY_BYTES]);

#endif
