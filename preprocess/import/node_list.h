/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The nodes of a model as a table, a tree or JSON, for `plantcast nodes`. Call from any thread. */
#ifndef PREPROCESS_IMPORT_NODE_LIST_H
#define PREPROCESS_IMPORT_NODE_LIST_H
#include <regex.h>
#include <stdio.h>

#include "preprocess/import/model_outline.h"

struct node_list_params {
    const regex_t *grep; /* regular expression: print only nodes whose path or one of whose properties matches; NULL: print all nodes */
    int levels;          /* number of tree levels to print; 0: print a table of paths */
    bool json;
    double guessed_m; /* as for model_outline_summary() */
};

/* Prints one line per node of a model. Returns the number of nodes printed. */
size_t node_list_print(const struct model_outline *outline, const struct node_list_params *params, FILE *out);

#endif
