/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Primitives of an RVM file that the model does not show, named by group. Thread: one per object. */
#ifndef PREPROCESS_IMPORT_RVM_LOSSES_H
#define PREPROCESS_IMPORT_RVM_LOSSES_H
#include "base/text/text.h"
#include "preprocess/import/cad_model.h"

/* In the place of a kind of primitive (enum rvm_kind). */
enum { RVM_UNKNOWN_KIND = 0, RVM_OBSTRUCTION = 1000, RVM_INSULATION };

struct rvm_loss {
    int node; /* -1: outside of every group */
    int kind;
    size_t byte; /* offset in the file at which its chunk begins */
    const char *why; /* a literal; NULL for obstruction and insulation volumes */
};

struct rvm_losses { /* zero-initialise */
    struct rvm_loss *at;
    size_t count, room;
};

void rvm_losses_add(struct rvm_losses *losses, int node, int kind, size_t byte, const char *why);
/* Appends lines of findings.h: each group without triangles, each group that lost a part of its primitives, the groups of obstruction and
 * insulation volumes. primitives: of each node of the model, how many primitives the file has. Sorts the losses. */
void rvm_losses_say(struct rvm_losses *losses, const struct cad_model *model, const size_t *primitives, struct text *said);
void rvm_losses_finish(struct rvm_losses *losses);

#endif
