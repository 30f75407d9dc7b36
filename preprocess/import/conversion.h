/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One model, of whatever format, as a GLB file. Thread: one at a time per process (child.h). */
#ifndef PREPROCESS_IMPORT_CONVERSION_H
#define PREPROCESS_IMPORT_CONVERSION_H
#include <stdbool.h>
#include <stddef.h>

#include "base/text/text.h"

enum { CONVERSION_WHY_BYTES = 512 };

struct conversion_params {
    double chord_m;
    const char *units, *up; /* of formats that do not say; NULL: guessed, and said */
    const char *mesh_units; /* of OBJ, STL, PLY and 3DS, where `units` is NULL; NULL: guessed, and said */
    const char *encoding;   /* of names; NULL: as the file says, or as they look, and said */
    bool keep_covered;      /* RVM: faces that lie on each other stay */
    int timeout_s;          /* of a reader that is another program */
    size_t memory_bytes;    /* likewise */
};

/* Reads the model at `path` and writes it to `glb` as glTF. What it noticed is appended to `said`, line by line. Returns false with the
 * reason, one line, in why. `folder` is for what is needed meanwhile; it may stay there. */
bool conversion_run(const char *path, const char *glb, const char *folder, const struct conversion_params *params, struct text *said,
                    char why[CONVERSION_WHY_BYTES]);

#endif
