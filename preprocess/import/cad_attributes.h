/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the attribute file of an RVM model (CADC_Attributes_File: .att or .txt, "NEW name ... END" with "key:= value") and adds
 * each element's attributes to the model node of the same name. Call from any thread. */
#ifndef PREPROCESS_IMPORT_CAD_ATTRIBUTES_H
#define PREPROCESS_IMPORT_CAD_ATTRIBUTES_H
#include "base/text/charset.h"
#include "preprocess/import/cad_model.h"

struct attribute_counts {
    /* elements: number of NEW ... END blocks in the attribute file; matched: number of these blocks for which the model has a node */
    size_t elements, matched;
    size_t attributes; /* number of attributes added to nodes */
    struct charset_choice encoding;
};

struct attribute_params {
    const char *encoding; /* encoding of the attribute file as given by the user; NULL: not given */
    /* encoding of the names in the model file; tried first, because the same program usually writes both files; "": unknown */
    const char *model_encoding;
};

/* Parses the `count` bytes of an attribute file. Returns false if the file is malformed: `why` names the line, and the model
 * keeps the attributes read before it. */
bool cad_attributes_read(struct cad_model *model, const char *bytes, size_t count, const struct attribute_params *params,
                         struct attribute_counts *counts, char *why, size_t why_bytes);

#endif
