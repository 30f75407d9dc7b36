/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sorts the unreadable primitives of an RVM file by group, and prints one record per group for the import's report (format:
   findings.h). */
#include "preprocess/import/rvm_losses.h"

#include <stdlib.h>

#include "base/mem.h"
#include "preprocess/import/rvm_shape.h"

enum { MAX_NAMED = 20 };

void rvm_losses_add(struct rvm_losses *losses, int node, int kind, size_t byte, const char *why)
{
    mem_grow(&losses->at, &losses->room, losses->count + 1, sizeof(*losses->at));
    losses->at[losses->count++] = (struct rvm_loss){ node, kind, byte, why };
}

static int by_node(const void *a, const void *b)
{
    const struct rvm_loss *x = a, *y = b;
    return x->node != y->node ? (x->node > y->node) - (x->node < y->node) : (x->byte > y->byte) - (x->byte < y->byte);
}

static const char *name_of(int kind)
{
    static const char *const names[RVM_FACETS + 1] = {
        [RVM_PYRAMID] = "pyramid",          [RVM_BOX] = "box",
        [RVM_RECTANGULAR_TORUS] = "rectangular torus", [RVM_CIRCULAR_TORUS] = "circular torus",
        [RVM_ELLIPTICAL_DISH] = "elliptical dish",     [RVM_SPHERICAL_DISH] = "spherical dish",
        [RVM_SNOUT] = "snout",              [RVM_CYLINDER] = "cylinder",
        [RVM_SPHERE] = "sphere",            [RVM_LINE] = "line",
        [RVM_FACETS] = "facet group"
    };
    return kind > RVM_UNKNOWN_KIND && kind <= RVM_FACETS ? names[kind] : "primitive";
}

/* Reports the lost primitives of one group: `count` entries, starting at `first`. */
static void say_group(const struct rvm_loss *first, size_t count, const struct cad_node *node, size_t primitives, struct text *said)
{
    const char *name = *node->name ? node->name : "a group without a name";
    if (node->triangle_count + node->line_count == 0)
        text_add(said, "lost\tbyte %zu\t%s\tgroup\t\t", first->byte, name);
    else
        text_add(said, "error\t%zu\tRVM: %s: ", count, name);
    text_add(said, "%zu of the %zu primitives of the group %s left out: %s at byte %zu: %s\n", count, primitives, count > 1 ? "are" : "is",
             name_of(first->kind), first->byte, first->why);
}

static void say_volumes(const struct rvm_losses *losses, int kind, const char *what, const struct cad_model *model,
                        struct text *said)
{
    size_t count = 0, groups = 0;
    int last = -1;
    struct text names = { 0 };
    for (size_t i = 0; i < losses->count; i++) {
        if (losses->at[i].kind != kind)
            continue;
        count++;
        if (losses->at[i].node >= 0 && losses->at[i].node != last && groups++ < MAX_NAMED)
            text_add(&names, "%s%s", groups > 1 ? ", " : " of ", model->nodes[losses->at[i].node].name);
        last = losses->at[i].node;
    }
    if (count > 0)
        text_add(said, "left out: %zu %s volume%s%s%s\n", count, what, count > 1 ? "s" : "", names.at ? names.at : "",
                 groups > MAX_NAMED ? ", ..." : "");
    text_finish(&names);
}

void rvm_losses_say(struct rvm_losses *losses, const struct cad_model *model, const size_t *primitives, struct text *said)
{
    size_t at = 0;
    if (losses->count > 0)
        qsort(losses->at, losses->count, sizeof(*losses->at), by_node);
    while (at < losses->count && losses->at[at].node < 0)
        at++;
    for (size_t i = 0; i < model->node_count; i++) {
        const struct cad_node *node = &model->nodes[i];
        const struct rvm_loss *first = NULL;
        size_t count = 0;
        for (; at < losses->count && losses->at[at].node == (int)i; at++)
            if (losses->at[at].why) {
                first = first ? first : &losses->at[at];
                count++;
            }
        if (first)
            say_group(first, count, node, primitives[i], said);
        else if (primitives[i] > 0 && node->triangle_count + node->line_count == 0)
            text_add(
                said,
                "lost\t#%zu\t%s\tgroup\t\tall faces of the group coincide with faces of neighbouring groups (--keep-covered keeps such "
                "faces)\n",
                i, node->name);
    }
    say_volumes(losses, RVM_OBSTRUCTION, "obstruction", model, said);
    say_volumes(losses, RVM_INSULATION, "insulation", model, said);
}

void rvm_losses_finish(struct rvm_losses *losses)
{
    mem_free(losses->at);
    *losses = (struct rvm_losses){ 0 };
}
