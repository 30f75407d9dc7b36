/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the attributes that come with an RVM file (CADC_Attributes_File: .att or .txt, "NEW name ... END" with "key:= value"), and gives
 * them to the model's nodes of those names. Thread: any. */
#ifndef PREPROCESS_IMPORT_CAD_ATTRIBUTES_H
#define PREPROCESS_IMPORT_CAD_ATTRIBUTES_H
#include "preprocess/import/cad_model.h"

struct attribute_counts {
    size_t elements, matched; /* NEW ... END, and those that a node was found for */
    size_t attributes;        /* given to nodes */
    size_t not_utf8;          /* lines that are read as Latin-1, or with U+FFFD where they are neither */
};

/* Returns false if the file is broken: `why` names the line; the model keeps what was read before it. */
bool cad_attributes_read(struct cad_model *model, const char *text, size_t length, struct attribute_counts *counts, char *why,
                         size_t why_bytes);

#endif
