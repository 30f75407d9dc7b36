/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads RVM files as exported by AVEVA PDMS, E3D and Marine: binary, big-endian, a sequence of chunks (HEAD, MODL, COLR, CNTB
 * with primitives and CNTE, END:). There is no published specification; the layout was taken from open-source readers. Call
 * from any thread. */
#ifndef PREPROCESS_IMPORT_RVM_H
#define PREPROCESS_IMPORT_RVM_H
#include "base/text/charset.h"
#include "base/text/text.h"
#include "preprocess/import/cad_model.h"

struct rvm_counts {
    size_t primitives;
    size_t covered_faces; /* number of faces left out because a face of a neighbouring primitive covers them */
    double covered_m2;    /* total area of the covered faces that were left out, square metres */
    /* number of primitives left out because they have no extent or contain numbers that are not finite */
    size_t empty;
    size_t unknown_chunks, unknown_kinds; /* number of unknown chunks, and of primitives of unknown kinds; all are skipped */
    char unknown_chunk[40];               /* the first unknown chunk, as "ABCD at byte 120" */
    bool no_end;                          /* the file has no chunk END: it may have been cut off between two chunks */
    struct charset_choice encoding;       /* encoding of the names */
};

struct rvm_params {
    double chord_m;        /* largest allowed distance between a chord and the true surface, metres */
    bool keep_covered;     /* true: keep faces covered by a face of a neighbouring primitive; false: leave them out */
    const char *encoding;  /* encoding of the names given by the user; NULL: the encoding given in the file, else a detected one */
    struct text *findings; /* receives records about lost primitives for the import's report (format: findings.h); NULL: none */
};

/* Appends the groups of an RVM file and their triangles to the model; the file's `count` bytes are in memory. Returns false if
 * the file is malformed: `why` says what is wrong and at which byte, and the model may contain part of the file. */
bool rvm_read(struct cad_model *model, const void *bytes, size_t count, const struct rvm_params *params, struct rvm_counts *counts,
              char *why, size_t why_bytes);

#endif
