/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derived tags, which are computed from other tags: parses their expressions, and sorts the tags so that each comes after the
   tags in its expression. */
#include <math.h>

#include "base/mem.h"
#include "plant/tags/expression.h"
#include "plant/tags/tag_links.h"

enum mark { UNSEEN, OPEN, DONE };

struct derived_walk {
    struct plant *plant;
    char *marks; /* [tag]: state of the tag in the depth-first search (enum mark) */
};

static int find_tag(const void *plant, const char *name)
{
    return plant_find_tag(plant, name);
}

static bool parse(const struct tag_link *link, struct plant *plant, struct diag *diag)
{
    struct plant_tag *tag = &plant->tags[link->tag];
    char why[200];
    size_t at;
    tag->expression = expression_parse(tag->signal.address + 1, find_tag, plant, why, &at);
    if (!tag->expression)
        diag_error(diag, plant->files.tags_path, link->line, link->column, "Address: '%.60s': %s, at character %zu", tag->signal.address,
                   why, at + 2);
    return tag->expression != NULL;
}

/* Warns if tags of one quantity, such as two temperatures, enter an expression in different units: expressions use the units of
   the tags' rows, without conversion. */
static void check_units(const struct tag_link *link, const struct plant *plant, struct diag *diag)
{
    const struct plant_tag *tag = &plant->tags[link->tag];
    const int *inputs;
    size_t count = expression_inputs(tag->expression, &inputs);
    for (size_t i = 0; i < count; i++) {
        const struct plant_tag *first = &plant->tags[inputs[0]], *one = &plant->tags[inputs[i]];
        const struct plant_tag *other =
            unit_kind(tag->scale.own_unit) && unit_kind(tag->scale.own_unit) == unit_kind(one->scale.own_unit) ? tag : first;
        struct unit_change change;
        if (units_compare(one->scale.own_unit, other->scale.own_unit, &change) != UNITS_CONVERT)
            continue;
        diag_warning(diag, plant->files.tags_path, link->line, link->column,
                     "Address: '%.60s' combines %.60s in %.20s with %.60s in %.20s; convert one of the tags in the expression",
                     tag->signal.address, one->name, one->scale.own_unit, other->name, other->scale.own_unit);
        return;
    }
}

/* Adds the derived tags in a tag's expression, then the tag itself, to the sorted list (depth first). Unless its row states
   stale_s, the tag gets the largest stale_s of its inputs. Returns false on a cycle. */
static bool visit(struct derived_walk *walk, int index)
{
    struct plant_tag *tag = &walk->plant->tags[index];
    const int *inputs;
    if (!tag->expression || walk->marks[index] == DONE)
        return true;
    if (walk->marks[index] == OPEN)
        return false;
    walk->marks[index] = OPEN;
    size_t count = expression_inputs(tag->expression, &inputs);
    for (size_t i = 0; i < count; i++) {
        if (!visit(walk, inputs[i]))
            return false;
        if (!tag->validity.states_stale)
            tag->validity.stale_s = fmax(tag->validity.stale_s, walk->plant->tags[inputs[i]].validity.stale_s);
    }
    walk->marks[index] = DONE;
    walk->plant->derived[walk->plant->derived_count++] = index;
    return true;
}

void tag_derived_resolve(const struct tag_links *derived, struct plant *plant, struct diag *diag)
{
    struct derived_walk walk = { .plant = plant, .marks = mem_array(plant->tag_count, 1) };
    size_t good = 0;
    for (size_t i = 0; i < derived->count; i++) {
        if (!parse(&derived->at[i], plant, diag))
            continue;
        check_units(&derived->at[i], plant, diag);
        good++;
    }
    plant->derived = mem_array(good, sizeof(*plant->derived));
    for (size_t i = 0; i < derived->count; i++) {
        const struct tag_link *link = &derived->at[i];
        if (visit(&walk, (int)link->tag))
            continue;
        diag_error(diag, plant->files.tags_path, link->line, link->column, "Address: '%.60s' is computed from itself",
                   plant->tags[link->tag].name);
        break; /* stops after reporting the first cycle: the search from another tag of the same cycle would report it again */
    }
    mem_free(walk.marks);
}
