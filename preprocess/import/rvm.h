/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads RVM files as exported by AVEVA PDMS, E3D and Marine: binary, big-endian, a chain of chunks (HEAD, MODL, COLR, CNTB with primitives
 * and CNTE, END:). There is no published specification; the layout follows open-source readers. Thread: any. */
#ifndef PREPROCESS_IMPORT_RVM_H
#define PREPROCESS_IMPORT_RVM_H
#include "base/text/charset.h"
#include "base/text/text.h"
#include "preprocess/import/cad_model.h"

struct rvm_counts {
    size_t primitives;
    size_t covered_faces;                 /* faces left out because they lie on a neighbour's face */
    double covered_m2;                    /* total area of covered_faces, square metres */
    size_t empty;                         /* primitives left out because they have no extent or contain non-finite numbers */
    size_t unknown_chunks, unknown_kinds; /* count of unknown chunks and primitives of unknown kinds, all skipped */
    char unknown_chunk[40];               /* the first unknown chunk, as "ABCD at byte 120" */
    struct charset_choice encoding;       /* encoding of the names */
};

struct rvm_params {
    double chord_m;        /* chord error: largest allowed distance in metres between a chord and the true surface */
    bool keep_covered;     /* keep faces that a neighbouring primitive's face covers; false: leave them out */
    const char *encoding;  /* the user's choice of encoding for the names; NULL: as stated by the file, else detected */
    struct text *findings; /* receives the lost primitives as lines in the format of findings.h; NULL: not wanted */
};

/* Appends the groups of an RVM file, wholly in memory at `bytes`, and their triangles to the model. Returns false if the file is broken:
 * `why` says what is wrong and at which byte, and the model may hold a part of the file. */
bool rvm_read(struct cad_model *model, const void *bytes, size_t count, const struct rvm_params *params, struct rvm_counts *counts,
              char *why, size_t why_bytes);

#endif
