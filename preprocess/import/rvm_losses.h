/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records the primitives of an RVM file that are missing from the model, and reports them by group. Call from one thread per object. */
#ifndef PREPROCESS_IMPORT_RVM_LOSSES_H
#define PREPROCESS_IMPORT_RVM_LOSSES_H
#include "base/text/text.h"
#include "preprocess/import/cad_model.h"

/* values of rvm_loss.kind besides those of enum rvm_kind */
enum { RVM_UNKNOWN_KIND = 0, RVM_OBSTRUCTION = 1000, RVM_INSULATION };

struct rvm_loss {
    int node; /* index of the node of the primitive's group; -1: outside all groups */
    int kind;
    size_t byte; /* byte offset of the primitive's chunk in the file */
    const char *why; /* why the primitive is missing, a string literal; NULL for obstruction and insulation volumes */
};

struct rvm_losses { /* zero-initialise */
    struct rvm_loss *at;
    size_t count, room;
};

void rvm_losses_add(struct rvm_losses *losses, int node, int kind, size_t byte, const char *why);
/* Sorts the lost primitives and appends records for the import's report (format: findings.h): for each group without triangles,
   each group that lost some of its primitives, and the groups of obstruction and insulation volumes. primitives[i]: number of
   primitives in the file for node i of the model. */
void rvm_losses_say(struct rvm_losses *losses, const struct cad_model *model, const size_t *primitives, struct text *said);
void rvm_losses_finish(struct rvm_losses *losses);

#endif
