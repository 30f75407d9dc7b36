/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the nodes of a GLB file in depth-first order. Then adds each node's triangles and bounding box to its parent's, from
 * the last node to the first, so that children are complete before their parents. */
#include "preprocess/import/model_outline.h"

#include <stdio.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "base/text/utf8.h"
#include "plant/models/asset_size.h"
#include "preprocess/report/text_table.h"

static void add_up(struct model_outline *outline)
{
    outline->box = model_box_empty;
    outline->triangles = 0;
    for (size_t i = 0; i < outline->header.count; i++)
        outline->nodes[i].all_triangles = outline->nodes[i].triangles;
    for (size_t i = outline->header.count; i-- > 0;) {
        struct outline_node *node = &outline->nodes[i];
        int parent = outline->header.nodes[i].parent;
        struct model_box *above = parent < 0 ? &outline->box : &outline->nodes[parent].all;
        model_box_add(above, &node->all);
        *(parent < 0 ? &outline->triangles : &outline->nodes[parent].all_triangles) += node->all_triangles;
    }
}

bool model_outline_read(struct model_outline *outline, const char *path, char *why, size_t why_bytes)
{
    *outline = (struct model_outline){ 0 };
    if (!model_header_read(&outline->header, path, why, why_bytes))
        return false;
    const json_t *nodes = json_object_get(outline->header.json, "nodes");
    outline->nodes = mem_array(outline->header.count + 1, sizeof(*outline->nodes));
    for (size_t i = 0; i < outline->header.count; i++) {
        const struct model_node *from = &outline->header.nodes[i];
        const json_t *node = json_array_get(nodes, from->number);
        uint64_t own = model_header_triangles(&outline->header, i);
        outline->nodes[i] = (struct outline_node){ .name = from->name[0] ? from->name : from->mesh,
                                                   .extras = json_object_get(node, "extras"),
                                                   .triangles = own,
                                                   .all = outline->header.boxes[i],
                                                   .depth = from->parent < 0 ? 0 : outline->nodes[from->parent].depth + 1,
                                                   .unnamed = !from->name[0] };
        outline->unnamed += outline->nodes[i].unnamed;
    }
    add_up(outline);
    return true;
}

void model_outline_leave_out(struct model_outline *outline, const bool *by_number)
{
    for (size_t i = 0; i < outline->header.count; i++)
        if (by_number[outline->header.nodes[i].number])
            outline->nodes[i].triangles = 0;
    add_up(outline);
}

void model_outline_finish(struct model_outline *outline)
{
    model_header_finish(&outline->header);
    mem_free(outline->nodes);
    *outline = (struct model_outline){ 0 };
}

const char *model_outline_property(const struct outline_node *node, const char *name)
{
    const char *value = json_string_value(json_object_get(node->extras, name)), *key;
    json_t *group;
    if (value || !json_is_object(node->extras))
        return value;
    json_object_foreach((json_t *)node->extras, key, group)
    {
        value = json_string_value(json_object_get(group, name));
        if (value)
            return value;
    }
    return NULL;
}

void model_outline_add_printable(struct text *out, const char *text)
{
    for (size_t left = strlen(text); left > 0;) {
        size_t bytes = utf8_length(text, left);
        unsigned char first = (unsigned char)text[0], second = bytes > 1 ? (unsigned char)text[1] : 0;
        bool control = bytes == 0 || first < 32 || first == 127 || (first == 0xc2 && second < 0xa0);
        text_add_bytes(out, control ? "\xef\xbf\xbd" : text, control ? 3 : bytes);
        text += bytes > 0 ? bytes : 1;
        left -= bytes > 0 ? bytes : 1;
    }
}

void model_outline_name(const struct model_outline *outline, size_t node, struct text *out)
{
    if (outline->nodes[node].name[0])
        model_outline_add_printable(out, outline->nodes[node].name);
    else
        text_add(out, "#%u", outline->header.nodes[node].number);
}

void model_outline_path(const struct model_outline *outline, size_t node, struct text *out)
{
    int parent = outline->header.nodes[node].parent;
    if (parent >= 0) {
        model_outline_path(outline, (size_t)parent, out);
        text_add(out, "/");
    }
    model_outline_name(outline, node, out);
}

bool model_outline_extent(const struct model_box *box, double size[3], double centre[3])
{
    static const struct {
        int from, sign;
        /* by plant axis (Z up): index and sign of the glTF axis (Y up) that becomes this plant axis */
    } axes[3] = { { 0, 1 }, { 2, -1 }, { 1, 1 } };
    for (int axis = 0; axis < 3; axis++) {
        int from = axes[axis].from;
        if (!(box->low[from] <= box->high[from]))
            return false;
        size[axis] = box->high[from] - box->low[from];
        centre[axis] = axes[axis].sign * (box->low[from] + box->high[from]) / 2;
    }
    return true;
}

/* Returns whether plantcast-import wrote the model. Its unit is then certainly metres. */
static bool knows_units(const struct model_outline *outline)
{
    const char *generator = json_string_value(json_object_get(json_object_get(outline->header.json, "asset"), "generator"));
    return generator && !strncmp(generator, "plantcast-import", strlen("plantcast-import"));
}

void model_outline_summary(const struct model_outline *outline, double guessed_m, struct text *out)
{
    const struct plant_asset asset = { .unit_m = guessed_m > 0 ? guessed_m : 1 };
    double size[3], centre[3];
    char why[SIZE_WHY_BYTES], nodes[32];
    snprintf(nodes, sizeof(nodes), "%s", text_table_number(outline->header.count).text);
    text_add(out, "%s nodes, %s unnamed", nodes, text_table_number(outline->unnamed).text);
    text_add(out, "; %s triangles", text_table_number(outline->triangles).text);
    if (!model_outline_extent(&outline->box, size, centre)) {
        text_add(out, "; nothing in the model can be shown");
        return;
    }
    text_add(out, "; %.1f x %.1f x %.1f m if the unit is metres and Y is up; %.0f m from the origin", size[0], size[1], size[2],
             vec_length(centre));
    if (outline->header.partial)
        text_add(out, " (the extent of some nodes is unknown: instances, or positions without min and max)");
    if ((guessed_m > 0 || !knows_units(outline)) && asset_size_doubtful(&asset, size, 0, why))
        text_add(out, "\n%s", why);
}
