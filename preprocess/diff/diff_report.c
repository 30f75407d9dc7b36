/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints the comparison of two plants (diff_run()) as text and as JSON (REPORT.md). */
#include <jansson.h>
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "preprocess/diff/diff.h"
#include "preprocess/report/text_table.h"

static void add_number(struct text_table *table, bool shown, int digits, double value)
{
    if (shown)
        text_table_add(table, "%.*f", digits, value);
    else
        text_table_add(table, "%s", "");
}

static void add_asset(struct text_table *table, const struct diff_asset *asset)
{
    static const char *const marks[DIFF_CHANGES] = { " ", "+", "-", ">", "~", "?" };
    bool changed = asset->change == DIFF_CHANGED, moved = asset->change == DIFF_MOVED || (changed && asset->moved_m > asset->tolerance_m);
    text_table_add(table, "%s", marks[asset->change]);
    text_table_add(table, "%s", asset->id);
    text_table_add(table, "%s", diff_changes[asset->change]);
    add_number(table, moved, 3, asset->moved_m);
    for (int axis = 0; axis < 3; axis++)
        add_number(table, moved, 3, asset->move_m[axis]);
    add_number(table, asset->change == DIFF_MOVED && asset->turned_deg > 0.01, 2, asset->turned_deg);
    add_number(table, changed, 3, asset->apart_m);
    add_number(table, asset->triangles[0] > 0, 0, (double)asset->triangles[0]);
    add_number(table, asset->triangles[1] > 0, 0, (double)asset->triangles[1]);
    text_table_add(table, "%s", asset->why ? asset->why : "");
}

static void assets_text(const struct diff *diff, FILE *out)
{
    static const struct text_table_column columns[] = {
        { "", false }, { "asset", false },     { "change", false }, { "moved m", true },   { "x", true },   { "y", true },
        { "z", true }, { "turned deg", true }, { "apart m", true }, { "triangles", true }, { "now", true }, { "why", false },
    };
    struct text_table table = { .columns = columns, .column_count = sizeof(columns) / sizeof(columns[0]) };
    for (int change = DIFF_CHANGES - 1; change > DIFF_SAME; change--)
        for (size_t i = 0; i < diff->asset_count; i++)
            if ((int)diff->assets[i].change == change)
                add_asset(&table, &diff->assets[i]);
    if (table.cell_count)
        text_table_print(&table, SIZE_MAX, out);
    text_table_finish(&table);
}

static int farthest_first(const void *a, const void *b)
{
    const struct diff_sensor *const *p = a, *const *q = b;
    return (*p)->moved_m > (*q)->moved_m ? -1 : (*p)->moved_m < (*q)->moved_m;
}

static void sensors_text(const struct diff *diff, FILE *out)
{
    static const struct text_table_column columns[] = {
        { "tag", false }, { "asset", false }, { "surface moved m", true }, { "place moved m", true }, { "from the surface m", true },
        { "now", true },
    };
    struct text_table table = { .columns = columns, .column_count = sizeof(columns) / sizeof(columns[0]) };
    const struct diff_sensor **order = mem_array(diff->sensor_count, sizeof(*order));
    size_t count = 0;
    for (size_t i = 0; i < diff->sensor_count; i++)
        if (diff->sensors[i].far_moved)
            order[count++] = &diff->sensors[i];
    qsort(order, count, sizeof(*order), farthest_first);
    for (size_t i = 0; i < count; i++) {
        text_table_add(&table, "%s", order[i]->tag);
        text_table_add(&table, "%s", order[i]->asset);
        text_table_add(&table, "%.4f", order[i]->moved_m);
        text_table_add(&table, "%.4f", order[i]->place_moved_m);
        text_table_add(&table, "%.4f", order[i]->distance_m[0]);
        text_table_add(&table, "%.4f", order[i]->distance_m[1]);
    }
    if (count) {
        fprintf(out, "\nSensors whose surface moved\n");
        text_table_print(&table, SIZE_MAX, out);
    }
    text_table_finish(&table);
    mem_free(order);
}

static void names_text(const char *what, const char *const *names, size_t count, FILE *out)
{
    if (!count)
        return;
    fprintf(out, "\n%s:", what);
    for (size_t i = 0; i < count; i++)
        fprintf(out, " %s", names[i]);
    fprintf(out, "\n");
}

static void other_assets_text(const struct diff *diff, FILE *out)
{
    bool any = false;
    for (size_t i = 0; i < diff->sensor_count; i++)
        if (diff->sensors[i].old_asset) {
            fprintf(out, "%s%s: now on asset %s, before on %s\n", any ? "" : "\n", diff->sensors[i].tag, diff->sensors[i].asset,
                    diff->sensors[i].old_asset);
            any = true;
        }
}

static size_t count_changes(const struct diff *diff, size_t counts[DIFF_CHANGES])
{
    size_t sensors = 0;
    for (size_t i = 0; i < diff->asset_count; i++)
        counts[diff->assets[i].change]++;
    for (size_t i = 0; i < diff->sensor_count; i++)
        sensors += diff->sensors[i].far_moved;
    return sensors;
}

void diff_text(const struct diff *diff, FILE *out)
{
    size_t counts[DIFF_CHANGES] = { 0 }, sensors = count_changes(diff, counts);
    assets_text(diff, out);
    sensors_text(diff, out);
    other_assets_text(diff, out);
    names_text("Sensors that are new", diff->tags_added, diff->added_count, out);
    names_text("Tags that are no longer in the tag list", diff->tags_removed, diff->removed_count, out);
    fprintf(out, "\n");
    for (size_t i = 0; i < diff->orphan_count; i++)
        fprintf(out, "! %s: position lost: %s\n", diff->orphans[i].tag, diff->orphans[i].why);
    char unknown[32] = "";
    if (counts[DIFF_UNKNOWN])
        snprintf(unknown, sizeof(unknown), ", %zu unknown", counts[DIFF_UNKNOWN]);
    fprintf(out,
            "%s > %s: %zu assets added, %zu removed, %zu moved, %zu changed, %zu unchanged%s; surface of %zu sensors moved; %zu tags lost "
            "their position\n",
            diff->old_side.path, diff->new_side.path, counts[DIFF_ADDED], counts[DIFF_REMOVED], counts[DIFF_MOVED], counts[DIFF_CHANGED],
            counts[DIFF_SAME], unknown, sensors, diff->orphan_count);
}

/* --- JSON ---------------------------------------------------------------------------------------------------------------------------- */

static json_t *asset_json(const struct diff_asset *asset)
{
    json_t *root = json_pack("{s:s,s:s,s:o?}", "id", asset->id, "change", diff_changes[asset->change], "why",
                             asset->why ? json_of_text(asset->why) : NULL);
    if (asset->triangles[0] && asset->triangles[1])
        json_object_update_new(root, json_pack("{s:f,s:[fff],s:f,s:f,s:f,s:I,s:I}", "moved_m", asset->moved_m, "move_m", asset->move_m[0],
                                               asset->move_m[1], asset->move_m[2], "turned_deg", asset->turned_deg, "apart_m",
                                               asset->apart_m, "tolerance_m", asset->tolerance_m, "triangles_old",
                                               (json_int_t)asset->triangles[0], "triangles_new", (json_int_t)asset->triangles[1]));
    return root;
}

static json_t *known(double number)
{
    return isnan(number) ? json_null() : json_real(number);
}

static json_t *sensor_json(const struct diff_sensor *sensor)
{
    return json_pack("{s:s,s:s,s:s*,s:o,s:o,s:o,s:f,s:f,s:f,s:b}", "tag", sensor->tag, "asset", sensor->asset, "asset_old",
                     sensor->old_asset, "surface_moved_m", known(sensor->moved_m), "place_moved_m", known(sensor->place_moved_m),
                     "surface_distance_old_m", known(sensor->distance_m[0]), "surface_distance_new_m", sensor->distance_m[1], "limit_m",
                     sensor->limit_m, "tolerance_m", sensor->tolerance_m, "moved", sensor->far_moved);
}

static json_t *names_json(const char *const *names, size_t count)
{
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, json_string(names[i]));
    return list;
}

bool diff_json(const struct diff *diff, FILE *out)
{
    json_t *assets = json_array(), *sensors = json_array(), *orphans = json_array(), *all = json_object();
    size_t counts[DIFF_CHANGES] = { 0 };
    count_changes(diff, counts);
    for (int change = 0; change < DIFF_CHANGES; change++)
        json_object_set_new(all, diff_changes[change], json_integer((json_int_t)counts[change]));
    for (size_t i = 0; i < diff->asset_count; i++)
        json_array_append_new(assets, asset_json(&diff->assets[i]));
    for (size_t i = 0; i < diff->sensor_count; i++)
        json_array_append_new(sensors, sensor_json(&diff->sensors[i]));
    for (size_t i = 0; i < diff->orphan_count; i++)
        json_array_append_new(orphans, json_pack("{s:s,s:s,s:o}", "tag", diff->orphans[i].tag, "asset", diff->orphans[i].asset, "why",
                                                 json_of_text(diff->orphans[i].why)));
    json_t *root =
        json_pack("{s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o}", "old", json_of_text(diff->old_side.path), "new", json_of_text(diff->new_side.path),
                  "counts", all, "assets", assets, "sensors", sensors, "tags_added", names_json(diff->tags_added, diff->added_count),
                  "tags_removed", names_json(diff->tags_removed, diff->removed_count), "orphans", orphans);
    char *text = root ? json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) : NULL;
    if (text)
        fprintf(out, "%s\n", text);
    free(text);
    json_decref(root);
    return text != NULL;
}
