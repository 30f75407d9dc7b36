/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads RVM files, as AVEVA PDMS, E3D and Marine export them: binary, big-endian, a chain of chunks (HEAD, MODL, COLR, CNTB with
 * primitives and CNTE, END:). There is no published specification; the layout is as open readers describe it. Thread: any. */
#ifndef PREPROCESS_IMPORT_RVM_H
#define PREPROCESS_IMPORT_RVM_H
#include "base/text/charset.h"
#include "base/text/text.h"
#include "preprocess/import/cad_model.h"

struct rvm_counts {
    size_t primitives;
    size_t covered_faces;                 /* lie on a neighbour's face: left out */
    double covered_m2;                    /* how large they are, together */
    size_t empty;                         /* primitives without extent, or with numbers that are not finite: left out */
    size_t unknown_chunks, unknown_kinds; /* skipped */
    char unknown_chunk[40];               /* the first one, as "ABCD at byte 120" */
    struct charset_choice encoding;       /* of its names */
};

struct rvm_params {
    double chord_m;    /* no chord is further from the surface */
    bool keep_covered; /* faces that lie on a neighbour's face stay */
    const char *encoding; /* of its names, as a person says; NULL: as the file says, or as they look */
    struct text *findings; /* losses are appended, as lines of findings.h; NULL: not wanted */
};

/* Appends the file's groups and their triangles to the model. `bytes` is the whole file.
 * Returns false if the file is broken: `why` says what is wrong and at which byte, and the model may hold a part of it. */
bool rvm_read(struct cad_model *model, const void *bytes, size_t count, const struct rvm_params *params, struct rvm_counts *counts,
              char *why, size_t why_bytes);

#endif
