/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records primitives of an RVM file that the model does not show, and reports them by group. Thread: one per object. */
#ifndef PREPROCESS_IMPORT_RVM_LOSSES_H
#define PREPROCESS_IMPORT_RVM_LOSSES_H
#include "base/text/text.h"
#include "preprocess/import/cad_model.h"

/* values of rvm_loss.kind that enum rvm_kind does not have */
enum { RVM_UNKNOWN_KIND = 0, RVM_OBSTRUCTION = 1000, RVM_INSULATION };

struct rvm_loss {
    int node; /* index of the node of the primitive's group; -1: outside of all groups */
    int kind;
    size_t byte; /* byte offset in the file where the primitive's chunk begins */
    const char *why; /* reason for the loss, a string literal; NULL for obstruction and insulation volumes */
};

struct rvm_losses { /* zero-initialise */
    struct rvm_loss *at;
    size_t count, room;
};

void rvm_losses_add(struct rvm_losses *losses, int node, int kind, size_t byte, const char *why);
/* Sorts the lost primitives and appends report lines (format: findings.h): each group without triangles, each group that lost part of its
 * primitives, and the groups of obstruction and insulation volumes. primitives[i]: number of primitives that the file has for node i of the
 * model. */
void rvm_losses_say(struct rvm_losses *losses, const struct cad_model *model, const size_t *primitives, struct text *said);
void rvm_losses_finish(struct rvm_losses *losses);

#endif
