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
    struct text printable = { 0 };
    model_outline_add_printable(&printable, text);
    text_add(out, "\"");
    for (const char *at = printable.at ? printable.at : ""; *at; at++)
        text_add(out, *at == '"' || *at == '\\' ? "\\%c" : "%c", *at);
    text_add(out, "\"");
    text_finish(&printable);
}

static bool is_printable(const char *text)
{
    struct text printable = { 0 };
    model_outline_add_printable(&printable, text);
    bool is = !strcmp(printable.at ? printable.at : "", text);
    text_finish(&printable);
    return is;
}

struct choice {          /* by node */
    bool *item, *unique; /* unique: no other node has its name */
    bool typed, classed; /* the model has elements of type ZONE, or classes of IFC */
};

static int by_name(const void *a, const void *b)
{
    return strcmp((*(const struct outline_node *const *)a)->name, (*(const struct outline_node *const *)b)->name);
}

static void find_unique(const struct model_outline *outline, bool *unique)
{
    size_t count = outline->header.count;
    const struct outline_node **sorted = mem_array(count + 1, sizeof(*sorted)); /* ends in NULL */
    for (size_t i = 0; i < count; i++)
        sorted[i] = &outline->nodes[i];
    qsort(sorted, count, sizeof(*sorted), by_name);
    for (size_t i = 0; i < count; i++) {
        bool first = i == 0 || strcmp(sorted[i - 1]->name, sorted[i]->name) != 0;
        bool same_as_next = sorted[i + 1] && !strcmp(sorted[i + 1]->name, sorted[i]->name);
        unique[sorted[i] - outline->nodes] = first && !same_as_next && !sorted[i]->unnamed && is_printable(sorted[i]->name);
    }
    mem_free(sorted);
}

/* The first level with two nodes that show something; the deepest where none has. */
static int branching_level(const struct model_outline *outline)
{
    int deepest = 0, level = 0;
    for (size_t i = 0; i < outline->header.count; i++)
        deepest = outline->nodes[i].depth > deepest ? outline->nodes[i].depth : deepest;
    size_t *shown = mem_array((size_t)deepest + 1, sizeof(*shown));
    for (size_t i = 0; i < outline->header.count; i++)
        shown[outline->nodes[i].depth] += outline->nodes[i].all_triangles > 0;
    while (level < deepest && shown[level] < 2)
        level++;
    mem_free(shown);
    return level;
}

static bool is_type(const struct model_outline *outline, int node, const char *type)
{
    const char *own = node < 0 ? NULL : model_outline_property(&outline->nodes[node], "Type");
    return own && !strcmp(own, type);
}

/* Sites, buildings, storeys and rooms hold the elements of an IFC model. */
static bool is_spatial(const char *class)
{
    static const char *const spatial[] = { "IfcProject",        "IfcSite",
                                           "IfcBuilding",       "IfcBuildingStorey",
                                           "IfcSpace",          "IfcFacility",
                                           "IfcFacilityPart",   "IfcFacilityPartCommon",
                                           "IfcRoad",           "IfcRoadPart",
                                           "IfcBridge",         "IfcBridgePart",
                                           "IfcRailway",        "IfcRailwayPart",
                                           "IfcMarineFacility", "IfcMarinePart",
                                           "IfcSpatialZone",    "IfcExternalSpatialElement" };
    for (size_t i = 0; i < sizeof(spatial) / sizeof(spatial[0]); i++)
        if (!strcmp(class, spatial[i]))
            return true;
    return false;
}

/* An element of a zone is a piece of equipment, a pipe, a structure. Where nothing says what is a zone, those of a level are taken; and
 * whatever shows something above it. */
static void choose(const struct plant_draft_model *from, struct choice *choice)
{
    const struct model_outline *outline = &from->outline;
    int level = from->item_level ? from->item_level : branching_level(outline);
    bool *within = mem_array(outline->header.count + 1, sizeof(*within));
    for (size_t i = 0; i < outline->header.count; i++) {
        choice->typed |= is_type(outline, (int)i, "ZONE");
        choice->classed |= model_outline_property(&outline->nodes[i], "IfcClass") != NULL;
    }
    for (size_t i = 0; i < outline->header.count; i++) {
        const struct outline_node *node = &outline->nodes[i];
        int parent = outline->header.nodes[i].parent;
        const char *class = model_outline_property(node, "IfcClass");
        bool at_level = choice->typed     ? is_type(outline, parent, "ZONE")
                        : choice->classed ? class && !is_spatial(class)
                                          : node->depth == level;
        within[i] = parent >= 0 && (within[parent] || choice->item[parent]);
        choice->item[i] = node->all_triangles > 0 && !within[i] && (at_level || node->triangles > 0);
    }
    mem_free(within);
}

static const char *without_slash(const char *name)
{
    return name + (name[0] == '/' && name[1]);
}

static void add_key(struct text *out, const char *key, const char *text)
{
    text_add(out, ", %s: ", key);
    add_quoted(out, text);
}

static void add_asset(struct text *out, const struct plant_draft_model *from, size_t i, bool unique, json_t *ids)
{
    const struct model_outline *outline = &from->outline;
    const struct outline_node *node = &outline->nodes[i];
    const char *description = model_outline_property(node, "Description"), *name = node->name;
    int parent = outline->header.nodes[i].parent;
    unsigned number = outline->header.nodes[i].number;
    char *id = unique ? mem_strdup(without_slash(name)) : mem_printf("%s #%u", *name ? name : "unnamed", number);
    if (json_object_get(ids, id)) { /* of another model */
        char *other = mem_printf("%s (%s #%u)", id, from->file, number);
        mem_free(id);
        id = other;
    }
    json_object_set_new_nocheck(ids, id, json_true());
    text_add(out, "  - { id: ");
    add_quoted(out, id);
    mem_free(id);
    if (description && strcmp(description, "unset") != 0)
        add_key(out, "description", description);
    if (parent >= 0 && outline->nodes[parent].depth > 0 && outline->nodes[parent].name[0])
        add_key(out, "area", without_slash(outline->nodes[parent].name));
    add_key(out, "model", from->file);
    if (from->units)
        text_add(out, ", units: %s", from->units);
    if (from->up)
        text_add(out, ", up: %s", from->up);
    if (unique) {
        add_key(out, "nodes", name);
    } else {
        char *pattern = mem_printf("#%u", number);
        add_key(out, "nodes", pattern);
        mem_free(pattern);
    }
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

size_t plant_draft_add_assets(const struct plant_draft_model *model, const bool *wanted, json_t *ids, struct text *out)
{
    const struct model_outline *outline = &model->outline;
    struct choice choice = { .item = mem_array(outline->header.count + 1, sizeof(bool)),
                             .unique = mem_array(outline->header.count + 1, sizeof(bool)) };
    size_t added = 0;
    find_unique(outline, choice.unique);
    choose(model, &choice);
    for (size_t i = 0; i < outline->header.count; i++)
        if (choice.item[i] && (!wanted || wanted[i])) {
            add_asset(out, model, i, choice.unique[i], ids);
            added++;
        }
    mem_free(choice.item);
    mem_free(choice.unique);
    return added;
}

int plant_draft_write(const struct plant_draft *draft)
{
    struct text out = { 0 };
    size_t assets = 0;
    json_t *ids = json_object();
    text_add(&out, "%s  name: ", head);
    add_quoted(&out, draft->name);
    text_add(&out, "\n\nassets:\n");
    for (size_t m = 0; m < draft->count; m++)
        assets += plant_draft_add_assets(&draft->models[m], NULL, ids, &out);
    json_decref(ids);
    text_add(&out, "%s", tail);
    int status = write_new(draft, "plant.yaml", out.at);
    if (status == 0)
        status = write_new(draft, "tags.csv", tags_head);
    if (status == 0)
        printf("%s/plant.yaml: %zu assets\n", draft->folder, assets);
    text_finish(&out);
    return status;
}
