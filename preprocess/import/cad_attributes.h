/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the attributes that come with an RVM file (CADC_Attributes_File: .att or .txt, "NEW name ... END" with "key:= value"), and gives
 * them to the model's nodes of those names. Thread: any. */
#ifndef PREPROCESS_IMPORT_CAD_ATTRIBUTES_H
#define PREPROCESS_IMPORT_CAD_ATTRIBUTES_H
#include "base/text/charset.h"
#include "preprocess/import/cad_model.h"

struct attribute_counts {
    size_t elements, matched; /* NEW ... END, and those that a node was found for */
    size_t attributes;        /* given to nodes */
    struct charset_choice encoding;
};

struct attribute_params {
    const char *encoding;       /* as a person says; NULL: nobody has */
    const char *model_encoding; /* that of the model's names: the same program wrote both; "": unknown */
};

/* `bytes` is the whole file. Returns false if the file is broken: `why` names the line; the model keeps what was read before it. */
bool cad_attributes_read(struct cad_model *model, const char *bytes, size_t count, const struct attribute_params *params,
                         struct attribute_counts *counts, char *why, size_t why_bytes);

#endif
