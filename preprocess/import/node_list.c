/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints a model's nodes line by line, without building the whole text first: a model may have a hundred thousand nodes. */
#include "preprocess/import/node_list.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "preprocess/report/text_table.h"

/* Appends `name=value` for each of a node's properties, including properties inside groups. */
static void add_properties(struct text *out, const json_t *extras, int level)
{
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)extras, key, value)
    {
        if (json_is_object(value)) {
            if (level < 4)
                add_properties(out, value, level + 1);
            continue;
        }
        char *other = json_is_string(value) ? NULL : json_dumps(value, JSON_COMPACT | JSON_ENCODE_ANY | JSON_REAL_PRECISION(9));
        const char *text = other ? other : json_string_value(value);
        if (text && text[0] && strcmp(text, "unset") != 0) {
            text_add(out, "%s", out->length ? "; " : "");
            model_outline_add_printable(out, key);
            text_add(out, "=");
            model_outline_add_printable(out, text);
        }
        free(other);
    }
}

static bool wanted(const struct node_list_params *params, const char *path, const struct text *properties)
{
    return !params->grep || regexec(params->grep, path, 0, NULL, 0) == 0 ||
           (properties->at && regexec(params->grep, properties->at, 0, NULL, 0) == 0);
}

static json_t *triple(const double v[3])
{
    return json_pack("[f,f,f]", v[0], v[1], v[2]);
}

static void print_json(const struct model_outline *outline, size_t i, const char *path, bool first, FILE *out)
{
    const struct outline_node *node = &outline->nodes[i];
    const struct model_node *from = &outline->header.nodes[i];
    double size[3], centre[3];
    json_t *line =
        json_pack("{s:i,s:s,s:s,s:s,s:i,s:i,s:I,s:I}", "number", (int)from->number, "name", from->name, "mesh", from->mesh, "path", path,
                  "depth", node->depth, "parent", from->parent < 0 ? -1 : (int)outline->header.nodes[from->parent].number, "triangles",
                  (json_int_t)node->all_triangles, "own_triangles", (json_int_t)node->triangles);
    if (model_outline_extent(&node->all, size, centre)) {
        json_object_set_new(line, "size", triple(size));
        json_object_set_new(line, "centre", triple(centre));
    }
    if (node->extras)
        json_object_set(line, "properties", (json_t *)node->extras);
    char *text = json_text(line, 7);
    fprintf(out, "%s%s", first ? "" : ",\n", text);
    mem_free(text);
}

static void print_line(const struct model_outline *outline, size_t i, const char *path, const struct text *properties, int levels,
                       FILE *out)
{
    const struct outline_node *node = &outline->nodes[i];
    double size[3], centre[3];
    fprintf(out, "#%-6u %10s  ", outline->header.nodes[i].number, text_table_number(node->all_triangles).text);
    if (model_outline_extent(&node->all, size, centre)) {
        char text[64];
        snprintf(text, sizeof(text), "%.3g x %.3g x %.3g", size[0], size[1], size[2]);
        fprintf(out, "%-26s", text);
        snprintf(text, sizeof(text), "%.2f, %.2f, %.2f", centre[0], centre[1], centre[2]);
        fprintf(out, "  %-28s", text);
    } else {
        fprintf(out, "%-26s  %-28s", "", "");
    }
    fprintf(out, "  %*s%s%s%s\n", levels ? 2 * node->depth : 0, "", path, properties->length ? "  | " : "",
            properties->length ? properties->at : "");
}

static void print_head(const struct model_outline *outline, const struct node_list_params *params, FILE *out)
{
    struct text summary = { 0 };
    double size[3], centre[3];
    model_outline_summary(outline, params->guessed_m, &summary);
    if (!params->json) {
        fprintf(out, "%s\n%-7s %10s  %-26s  %-28s  %s\n", summary.at, "number", "triangles", "size m", "centre m (z up)",
                "path | properties");
    } else {
        json_t *head = json_pack("{s:s,s:I,s:I,s:I}", "summary", summary.at, "nodes", (json_int_t)outline->header.count, "unnamed",
                                 (json_int_t)outline->unnamed, "triangles", (json_int_t)outline->triangles);
        if (model_outline_extent(&outline->box, size, centre)) {
            json_object_set_new(head, "size", triple(size));
            json_object_set_new(head, "centre", triple(centre));
        }
        char *text = json_text(head, 7);
        fprintf(out, "%.*s,\"list\":[\n", (int)strlen(text) - 1, text);
        mem_free(text);
    }
    text_finish(&summary);
}

/* Returns the last component of a node's path; a tree prints it in place of the whole path. */
static const char *own_part(const struct model_outline *outline, size_t i, const struct text *path)
{
    struct text above = { 0 };
    int parent = outline->header.nodes[i].parent;
    if (parent >= 0)
        model_outline_path(outline, (size_t)parent, &above);
    const char *part = path->at + (parent >= 0 ? above.length + 1 : 0);
    text_finish(&above);
    return part;
}

size_t node_list_print(const struct model_outline *outline, const struct node_list_params *params, FILE *out)
{
    size_t count = 0;
    print_head(outline, params, out);
    for (size_t i = 0; i < outline->header.count; i++) {
        struct text path = { 0 }, properties = { 0 };
        if (params->levels && outline->nodes[i].depth >= params->levels)
            continue;
        model_outline_path(outline, i, &path);
        if (params->grep || !params->json)
            add_properties(&properties, outline->nodes[i].extras, 0);
        if (wanted(params, path.at, &properties)) {
            if (params->json)
                print_json(outline, i, path.at, count == 0, out);
            else
                print_line(outline, i, params->levels ? own_part(outline, i, &path) : path.at, &properties, params->levels, out);
            count++;
        }
        text_finish(&path);
        text_finish(&properties);
    }
    if (params->json)
        fprintf(out, "\n]}\n");
    return count;
}
