/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Generates the first plant file of an import, which users then edit by hand or with `plantcast match`. */
#include "preprocess/import/plant_draft.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/text.h"
#include "placing/tag_file.h"
#include "preprocess/glb/glb_scene.h"
#include "preprocess/import/import_fail.h"

static const char head[] = "# Plant file written by plantcast import. Lengths are in metres, Z is up. PLANT.md describes all keys.\n"
                           "plant:\n";
static const char tail[] = "\n"
                           "# Sensor groups: one group for each measured quantity, with the range of the legend.\n"
                           "groups:\n"
                           "  - { id: temperature, quantity: Temperature, unit: °C, min: 0, max: 100 }\n"
                           "\n"
                           "tags: tags.csv\n";
static const char begun[] = "# Nothing was imported yet: a person stands where the plant will be. `plantcast import` puts it here.\n"
                            "plant:\n"
                            "  name: New plant\n"
                            "\n"
                            "assets:\n"
                            "  - { id: person, description: 1.8 m tall, model: person.glb }\n";
static const char tags_head[] = "Tag Name,Address,Data Type,Eng Units,Description,Source,Group,Asset,Node,X,Y,Z\n";

/* Appends text as a quoted YAML scalar. */
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

struct draft_choice {    /* for the nodes of a model's outline: which become assets, and which have a unique name */
    bool *item, *unique; /* by node; item: it becomes an asset; unique: no other node has its name */
    bool typed, classed; /* typed: some nodes have the type property ZONE; classed: some nodes have IFC classes */
};

static int by_name(const void *a, const void *b)
{
    return strcmp((*(const struct outline_node *const *)a)->name, (*(const struct outline_node *const *)b)->name);
}

static void find_unique(const struct model_outline *outline, bool *unique)
{
    size_t count = outline->header.count;
    const struct outline_node **sorted = mem_array(count + 1, sizeof(*sorted)); /* the model's nodes sorted by name, terminated by NULL */
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

/* Returns the topmost tree level that has at least two nodes with geometry, or the deepest level if there is none. */
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

/* Returns whether an IFC class is a spatial container (site, building, storey, room ...), which contains elements but is not equipment. */
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

/* Chooses the nodes of a model that become assets: the children of ZONE nodes; else the IFC elements; else the nodes of one
 * tree level (equipment, pipes, structures). A node above a chosen one is also chosen if it has triangles of its own. Nodes
 * below a chosen node are not chosen. */
static void choose(const struct plant_draft_model *from, struct draft_choice *choice)
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
    /* an asset of another model already has this id: append the model's file name and the node's number */
    if (json_object_get(ids, id)) {
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

bool plant_draft_is_begun(const char *path)
{
    struct refusal why;
    char *text = tag_file_read(path, &why);
    bool is = text && !strncmp(text, begun, strlen(begun));
    mem_free(text);
    return is;
}

static int write_new(const char *folder, const char *file, const char *text)
{
    char *path = mem_printf("%s/%s", folder, file);
    bool there = access(path, F_OK) == 0;
    int status = there ? 0 : atomic_file_put(path, text, strlen(text));
    if (there)
        printf("%s: unchanged\n", path);
    else if (status != 0)
        import_fail(path, strerror(-status));
    mem_free(path);
    return status;
}

size_t plant_draft_add_assets(const struct plant_draft_model *model, const bool *wanted, json_t *ids, struct text *out)
{
    const struct model_outline *outline = &model->outline;
    struct draft_choice choice = { .item = mem_array(outline->header.count + 1, sizeof(bool)),
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

char *plant_draft_text(const struct plant_draft *draft, size_t *assets)
{
    struct text out = { 0 };
    json_t *ids = json_object();
    *assets = 0;
    text_add(&out, "%s  name: ", head);
    add_quoted(&out, draft->name);
    text_add(&out, "\n\nassets:\n");
    for (size_t m = 0; m < draft->count; m++)
        *assets += plant_draft_add_assets(&draft->models[m], NULL, ids, &out);
    json_decref(ids);
    text_add(&out, "%s", tail);
    return out.at;
}

const char *plant_draft_tags(void)
{
    return tags_head;
}

int plant_draft_write(const struct plant_draft *draft)
{
    size_t assets;
    char *text = plant_draft_text(draft, &assets);
    int status = write_new(draft->folder, "plant.yaml", text);
    if (status == 0)
        status = write_new(draft->folder, "tags.csv", tags_head);
    if (status == 0)
        printf("%s/plant.yaml: %zu assets\n", draft->folder, assets);
    mem_free(text);
    return status;
}

/* Writes the starter plant's model, a person made of boxes, as GLB: feet on the ground at the origin, facing the viewer, Y up. */
static int write_person(const char *path)
{
    static const float parts[][2][3] = { /* boxes that form the person: centre and size of each, metres */
                                         { { -0.1f, 0.42f, 0 }, { 0.14f, 0.84f, 0.16f } }, { { 0.1f, 0.42f, 0 }, { 0.14f, 0.84f, 0.16f } },
                                         { { 0, 1.14f, 0 }, { 0.4f, 0.6f, 0.22f } },       { { -0.26f, 1.1f, 0 }, { 0.1f, 0.64f, 0.12f } },
                                         { { 0.26f, 1.1f, 0 }, { 0.1f, 0.64f, 0.12f } },   { { 0, 1.48f, 0 }, { 0.1f, 0.08f, 0.1f } },
                                         { { 0, 1.66f, 0 }, { 0.18f, 0.28f, 0.2f } }
    };
    static const uint32_t corners[36] = { 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                          2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5 };
    struct glb_scene *scene = glb_scene_create("plantcast import");
    int mesh = glb_scene_add_mesh(scene, "person"), material = glb_scene_material(scene, (double[]){ 0.2, 0.3, 0.4, 1 });
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++) {
        float positions[8][3];
        for (int v = 0; v < 8; v++)
            for (int axis = 0; axis < 3; axis++)
                positions[v][axis] = parts[i][0][axis] + ((v >> axis & 1) ? 0.5f : -0.5f) * parts[i][1][axis];
        glb_scene_add_triangles(scene, mesh,
                                &(struct glb_scene_triangles){ .positions = (const float(*)[3])positions,
                                                               .vertex_count = 8,
                                                               .corners = corners,
                                                               .corner_count = 36,
                                                               .material = material });
    }
    glb_scene_add_node(scene, -1, "person", mesh, NULL);
    int status = glb_scene_write(scene, path);
    glb_scene_destroy(&scene);
    return status;
}

int plant_draft_begin(const char *folder)
{
    char *plant = mem_printf("%s/plant.yaml", folder), *person = mem_printf("%s/person.glb", folder);
    char *text = mem_printf("%s%s", begun, tail);
    int status = 0;
    if (access(plant, F_OK) != 0) {
        status = write_person(person);
        if (status != 0)
            import_fail(person, strerror(-status));
        if (status == 0)
            status = write_new(folder, "tags.csv", tags_head);
        if (status == 0)
            status = write_new(folder, "plant.yaml", text);
    }
    mem_free(text);
    mem_free(person);
    mem_free(plant);
    return status;
}
