/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was done, for people and for programs. */
#include "preprocess/report.h"

#include <jansson.h>
#include <stdlib.h>

#include "base/mem.h"
#include "preprocess/folder.h"

static const char *const state_names[] = { "failed", "unchanged", "shared", "built" };

/* E-101: levels (error, triangles, after splitting, field error): 0 m 62653 70112 0.39 %, 0.004 m 20100 24000 0.39 %, ... */
static void levels_text(const struct prepare_asset *asset, FILE *out)
{
    if (asset->report.level_count)
        fprintf(out, "%s: levels (error, triangles, after splitting, field error):", asset->plant->id);
    for (size_t i = 0; i < asset->report.level_count; i++) {
        const struct build_level *level = &asset->report.levels[i];
        fprintf(out, "%s %.3g m %u %u %.2f %%", i ? "," : "", (double)level->error_m, level->triangles, level->split_triangles,
                100 * (double)level->field_error);
    }
    if (asset->report.level_count)
        fprintf(out, "\n");
}

static json_t *levels_json(const struct build_report *report)
{
    json_t *levels = json_array();
    for (size_t i = 0; i < report->level_count; i++) {
        const struct build_level *level = &report->levels[i];
        json_array_append_new(levels, json_pack("{s:f,s:f,s:i,s:i,s:i}", "error_m", (double)level->error_m, "field_error",
                                                (double)level->field_error, "triangles_before", (int)level->triangles, "triangles",
                                                (int)level->split_triangles, "vertices", (int)level->vertices));
    }
    return levels;
}

void report_text(const struct prepare *prepare, FILE *out)
{
    size_t counts[4] = { 0 }, sensors = 0;
    unsigned long long triangles = 0;
    for (size_t i = 0; i < prepare->asset_count; i++) {
        const struct prepare_asset *asset = &prepare->assets[i];
        counts[asset->state]++;
        triangles += asset->triangles;
        sensors += asset->sensor_count;
        const struct surface_report *s = &asset->report.surface;
        levels_text(asset, out);
        if (asset->state != PREPARE_BUILT || asset->sensor_count == 0)
            continue;
        fprintf(out,
                "%s: %zu samples added (longest edge %.3f m), pieces %zu -> %zu with %zu bridges (longest %.2g m, tolerance %.2g m), open "
                "edges %zu -> %zu, "
                "hidden vertices %zu, unreachable %zu, repeated faces %zu; methods differ by %.2f %%\n",
                asset->plant->id, s->samples, s->spacing_m, s->components, s->components_after, s->bridges, s->longest_bridge_m,
                s->tolerance_m, s->border_edges, s->border_edges_after, s->hidden_vertices, asset->report.unreachable_vertices,
                s->repeated_triangles, 100 * s->heat_disagreement);
    }
    fprintf(out,
            "%zu assets, %llu triangles, %zu sensors: %zu built, %zu unchanged, %zu shared, %zu failed; %zu old files removed; %.1f s\n",
            prepare->asset_count, triangles, sensors, counts[PREPARE_BUILT], counts[PREPARE_UNCHANGED], counts[PREPARE_SHARED],
            counts[PREPARE_FAILED], prepare->removed, prepare->seconds);
}

static json_t *surface_json(const struct build_report *report)
{
    const struct surface_report *s = &report->surface;
    json_t *counts =
        json_pack("{s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:i,s:I,s:I,s:I}", "welded_vertices", (json_int_t)s->welded_vertices,
                  "degenerate_triangles", (json_int_t)s->degenerate_triangles, "repeated_triangles", (json_int_t)s->repeated_triangles,
                  "open_edges_before", (json_int_t)s->border_edges, "open_edges_after", (json_int_t)s->border_edges_after,
                  "components_before", (json_int_t)s->components, "components_after", (json_int_t)s->components_after, "bridges",
                  (json_int_t)s->bridges, "k", s->k, "samples", (json_int_t)s->samples, "hidden_vertices", (json_int_t)s->hidden_vertices,
                  "unreachable_vertices", (json_int_t)report->unreachable_vertices);
    json_t *lengths = json_pack("{s:f,s:f,s:f,s:f,s:f}", "tolerance_m", s->tolerance_m, "spacing_m", s->spacing_m, "longest_bridge_m",
                                s->longest_bridge_m, "time_m2", s->time_m2, "heat_disagreement", s->heat_disagreement);
    json_t *seconds = json_pack("{s:f,s:f,s:f,s:f,s:f,s:f,s:f,s:f,s:f}", "levels", report->levels_s, "split", report->split_s, "read",
                                report->read_s, "weld", s->weld_s, "bridge", s->bridge_s, "sample", s->sample_s, "laplacian",
                                s->laplacian_s, "factor", s->factor_s, "solve", report->solve_s);
    json_object_update(counts, lengths);
    json_decref(lengths);
    json_object_set_new(counts, "seconds", seconds);
    return counts;
}

static json_t *asset_json(const struct prepare *prepare, const struct prepare_asset *asset)
{
    char *file = folder_file_name(asset->key);
    json_t *sensors = json_array();
    json_t *root = json_pack("{s:s,s:s,s:s,s:i,s:i,s:f,s:s?,s:o}", "id", asset->plant->id, "state", state_names[asset->state], "file", file,
                             "triangles", (int)asset->triangles, "vertices", (int)asset->vertices, "seconds", asset->seconds,
                             "rebuilt_because", asset->rebuilt_because, "sensors", sensors);
    for (size_t s = 0; asset->surface_distances_m && s < asset->sensor_count; s++)
        json_array_append_new(sensors, json_pack("{s:s,s:f}", "tag", prepare->plant->tags[asset->sensors[s].tag].name, "surface_distance_m",
                                                 (double)asset->surface_distances_m[s]));
    if (asset->state == PREPARE_BUILT)
        json_object_update_new(root, json_pack("{s:i,s:i,s:i,s:i,s:i,s:i,s:i,s:i}", "nodes", (int)asset->report.nodes, "primitives",
                                               (int)asset->report.primitives, "materials", (int)asset->report.materials, "textures",
                                               (int)asset->report.textures, "zero_area_triangles", (int)asset->report.degenerate_triangles,
                                               "computed_normals", (int)asset->report.computed_normals, "skipped_lines",
                                               (int)asset->report.skipped_lines, "skipped_points", (int)asset->report.skipped_points));
    if (asset->state == PREPARE_BUILT)
        json_object_set_new(root, "levels", levels_json(&asset->report));
    if (asset->state == PREPARE_BUILT && asset->sensor_count)
        json_object_set_new(root, "surface", surface_json(&asset->report));
    mem_free(file);
    return root;
}

bool report_json(const struct prepare *prepare, FILE *out)
{
    json_t *assets = json_array();
    json_t *root = json_pack("{s:s,s:f,s:I,s:o}", "plant", prepare->plant->name, "seconds", prepare->seconds, "removed",
                             (json_int_t)prepare->removed, "assets", assets);
    for (size_t i = 0; i < prepare->asset_count; i++)
        json_array_append_new(assets, asset_json(prepare, &prepare->assets[i]));
    char *text = root ? json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) : NULL;
    if (text)
        fprintf(out, "%s\n", text);
    free(text);
    json_decref(root);
    return text != NULL;
}
