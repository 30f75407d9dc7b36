/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the attribute file of an RVM model (CADC_Attributes_File: .att or .txt, "NEW name ... END" with "key:= value") and adds the
 * attributes to the model's nodes with the names of the elements. Thread: any. */
#ifndef PREPROCESS_IMPORT_CAD_ATTRIBUTES_H
#define PREPROCESS_IMPORT_CAD_ATTRIBUTES_H
#include "base/text/charset.h"
#include "preprocess/import/cad_model.h"

struct attribute_counts {
    /* elements: number of NEW ... END blocks in the attribute file; matched: number of those for which the model has a node */
    size_t elements, matched;
    size_t attributes; /* number of attributes added to nodes */
    struct charset_choice encoding;
};

struct attribute_params {
    const char *encoding; /* encoding of the attribute file, as the user stated it; NULL: none */
    /* encoding of the names in the model file, tried first, because one program writes both files; "": unknown */
    const char *model_encoding;
};

/* Parses an attribute file whose `count` bytes are in memory. Returns false if the file is broken: `why` names the broken line, and the
 * model keeps the attributes read before it. */
bool cad_attributes_read(struct cad_model *model, const char *bytes, size_t count, const struct attribute_params *params,
                         struct attribute_counts *counts, char *why, size_t why_bytes);

#endif
