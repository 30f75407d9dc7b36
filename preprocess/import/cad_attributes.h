/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the attribute file of an RVM model (CADC_Attributes_File: .att or .txt, "NEW name ... END" with "key:= value") and adds the
 * attributes to the model's nodes of the same names. Thread: any. */
#ifndef PREPROCESS_IMPORT_CAD_ATTRIBUTES_H
#define PREPROCESS_IMPORT_CAD_ATTRIBUTES_H
#include "base/text/charset.h"
#include "preprocess/import/cad_model.h"

struct attribute_counts {
    size_t elements, matched; /* elements: NEW ... END blocks of the file; matched: blocks for which the model has a node */
    size_t attributes;        /* count of attributes added to nodes */
    struct charset_choice encoding;
};

struct attribute_params {
    const char *encoding;       /* the user's choice for the attribute file; NULL: none */
    const char *model_encoding; /* encoding of the model's names, tried first, because one program writes both files; "": unknown */
};

/* Parses an attribute file that is wholly in memory. Returns false if the file is broken: `why` names the broken line, and the model keeps
 * the attributes read before it. */
bool cad_attributes_read(struct cad_model *model, const char *bytes, size_t count, const struct attribute_params *params,
                         struct attribute_counts *counts, char *why, size_t why_bytes);

#endif
