/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The nodes of a model as a table, a tree or JSON, for `plantcast nodes`. Thread: any. */
#ifndef PREPROCESS_IMPORT_NODE_LIST_H
#define PREPROCESS_IMPORT_NODE_LIST_H
#include <regex.h>
#include <stdio.h>

#include "preprocess/import/model_outline.h"

struct node_list_params {
    const regex_t *grep; /* only nodes whose path or property it finds; NULL: all */
    int levels;          /* 0: a table of paths; else a tree of so many levels */
    bool json;
};

/* Prints the nodes, a line for each, and returns how many there were. */
size_t node_list_print(const struct model_outline *outline, const struct node_list_params *params, FILE *out);

#endif
