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
    size_t covered_faces; /* number of faces left out because a neighbouring primitive's face covers them */
    double covered_m2;    /* total area in square metres of the faces that covered_faces counts */
    /* number of primitives left out because they have no extent or contain numbers that are not finite */
    size_t empty;
    size_t unknown_chunks, unknown_kinds; /* number of unknown chunks, and of primitives of unknown kinds; all are skipped */
    char unknown_chunk[40];               /* the first unknown chunk, as "ABCD at byte 120" */
    struct charset_choice encoding;       /* encoding of the names */
};

struct rvm_params {
    double chord_m;        /* largest allowed distance in metres between a chord and the true surface */
    bool keep_covered;     /* true: keep faces that a neighbouring primitive's face covers; false: leave them out */
    const char *encoding;  /* encoding of the names, as the user stated it; NULL: the encoding that the file states, else a detected one */
    struct text *findings; /* receives report lines (format: findings.h) about lost primitives; NULL: not wanted */
};

/* Appends the groups of an RVM file, whose `count` bytes are in memory, and their triangles to the model. Returns false if the file is
 * broken: `why` says what is wrong and at which byte, and the model may hold a part of the file. */
bool rvm_read(struct cad_model *model, const void *bytes, size_t count, const struct rvm_params *params, struct rvm_counts *counts,
              char *why, size_t why_bytes);

#endif
