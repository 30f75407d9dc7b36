/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A text that a person would have written, to be gone on with by hand or by matching tags. */
#include "preprocess/import/plant_draft.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "base/mem.h"
#include "base/text.h"

static const char head[] =
    "# The plant as its models were imported. Lengths are metres, Z is up. PLANT.md tells what else may stand here.\n"
    "plant:\n";
static const char tail[] = "\n"
                           "# What is measured: one group for each quantity, with the range of its legend.\n"
                           "groups:\n"
                           "  - { id: temperature, quantity: Temperature, unit: °C, min: 0, max: 100 }\n"
                           "\n"
                           "tags: tags.csv\n";
static const char tags_head[] = "Tag Name,Address,Data Type,Eng Units,Description,Source,Group,Asset,Node,X,Y,Z\n";

/* In the quotes of YAML. */
static void add_quoted(struct text *out, const char *text)
{
    text_add(out, "\"");
    for (; *text; text++)
        text_add(out, *text == '"' || *text == '\\' ? "\\%c" : "%c", *text);
    text_add(out, "\"");
}

struct choice {                  /* by node */
    bool *item, *shows, *unique; /* unique: no other node has its name */
    int *depth;
    bool typed; /* the model has elements of type ZONE */
};

static int by_name(const void *a, const void *b)
{
    return strcmp((*(const struct cad_node *const *)a)->name, (*(const struct cad_node *const *)b)->name);
}

static void find_unique(const struct cad_model *model, bool *unique)
{
    const struct cad_node **sorted = mem_array(model->node_count + 1, sizeof(*sorted)); /* ends in NULL */
    for (size_t i = 0; i < model->node_count; i++)
        sorted[i] = &model->nodes[i];
    qsort(sorted, model->node_count, sizeof(*sorted), by_name);
    for (size_t i = 0; i < model->node_count; i++) {
        bool first = i == 0 || strcmp(sorted[i - 1]->name, sorted[i]->name) != 0;
        unique[sorted[i] - model->nodes] = first && (!sorted[i + 1] || strcmp(sorted[i + 1]->name, sorted[i]->name) != 0);
    }
    mem_free(sorted);
}

/* An element of a zone is a piece of equipment, a pipe, a structure. Where nothing says what is a zone, the third level is taken, as the
 * hierarchy of these systems begins with site and zone; and whatever shows something above it. */
static void choose(const struct cad_model *model, struct choice *choice)
{
    for (size_t i = 0; i < model->node_count; i++) {
        const char *type = cad_node_attribute(&model->nodes[i], "Type");
        choice->typed |= type && !strcmp(type, "ZONE");
        choice->depth[i] = model->nodes[i].parent < 0 ? 0 : choice->depth[model->nodes[i].parent] + 1;
    }
    for (size_t i = model->node_count; i-- > 0;) {
        const struct cad_node *node = &model->nodes[i];
        choice->shows[i] |= node->triangle_count > 0;
        if (node->parent >= 0)
            choice->shows[node->parent] |= choice->shows[i];
    }
    for (size_t i = 0; i < model->node_count; i++) {
        const struct cad_node *node = &model->nodes[i];
        const char *above = node->parent < 0 ? NULL : cad_node_attribute(&model->nodes[node->parent], "Type");
        bool at_level = choice->typed ? above && !strcmp(above, "ZONE") : choice->depth[i] == 2, within = false;
        for (int up = node->parent; up >= 0 && !within; up = model->nodes[up].parent)
            within = choice->item[up];
        choice->item[i] = choice->shows[i] && !within && (at_level || node->triangle_count > 0);
    }
}

static void add_asset(struct text *out, const struct plant_draft_model *from, size_t number, bool unique)
{
    const struct cad_model *model = from->model;
    const struct cad_node *node = &model->nodes[number];
    const char *description = cad_node_attribute(node, "Description"), *name = node->name;
    unique = unique && *name;
    text_add(out, "  - { id: ");
    if (unique) {
        add_quoted(out, name + (name[0] == '/' && name[1]));
    } else {
        char *id = mem_printf("%s #%zu", *name ? name : "unnamed", number + 1);
        add_quoted(out, id);
        mem_free(id);
    }
    if (description && strcmp(description, "unset") != 0) {
        text_add(out, ", description: ");
        add_quoted(out, description);
    }
    if (node->parent >= 0 && model->nodes[node->parent].name[0]) {
        const char *area = model->nodes[node->parent].name;
        text_add(out, ", area: ");
        add_quoted(out, area + (area[0] == '/' && area[1]));
    }
    text_add(out, ", model: ");
    add_quoted(out, from->file);
    text_add(out, ", nodes: ");
    if (unique)
        add_quoted(out, name);
    else
        text_add(out, "\"#%zu\"", number + 1); /* after the root of the file */
    text_add(out, " }\n");
}

static int write_new(const struct plant_draft *draft, const char *file, const char *text)
{
    char *path = mem_printf("%s/%s", draft->folder, file);
    int status = 0;
    if (access(path, F_OK) == 0)
        printf("%s: stays as it is\n", path);
    else
        status = atomic_file_put(path, text, strlen(text));
    mem_free(path);
    return status;
}

int plant_draft_write(const struct plant_draft *draft)
{
    struct text out = { 0 };
    size_t assets = 0;
    text_add(&out, "%s  name: ", head);
    add_quoted(&out, draft->name);
    text_add(&out, "\n\nassets:\n");
    for (size_t m = 0; m < draft->count; m++) {
        const struct cad_model *model = draft->models[m].model;
        struct choice choice = { .item = mem_array(model->node_count + 1, sizeof(bool)),
                                 .shows = mem_array(model->node_count + 1, sizeof(bool)),
                                 .unique = mem_array(model->node_count + 1, sizeof(bool)),
                                 .depth = mem_array(model->node_count + 1, sizeof(int)) };
        find_unique(model, choice.unique);
        choose(model, &choice);
        for (size_t i = 0; i < model->node_count; i++)
            if (choice.item[i]) {
                add_asset(&out, &draft->models[m], i, choice.unique[i]);
                assets++;
            }
        mem_free(choice.item);
        mem_free(choice.shows);
        mem_free(choice.unique);
        mem_free(choice.depth);
    }
    text_add(&out, "%s", tail);
    int status = write_new(draft, "plant.yaml", out.at);
    if (status == 0)
        status = write_new(draft, "tags.csv", tags_head);
    if (status == 0)
        printf("%s/plant.yaml: %zu assets\n", draft->folder, assets);
    text_finish(&out);
    return status;
}
