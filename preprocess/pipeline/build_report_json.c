/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts a build report to JSON and back, using a table that maps each number of the report to a JSON name. */
#include "preprocess/pipeline/build_report_json.h"

#include <math.h>
#include <stdio.h>

enum report_value_kind { COUNT32, COUNT, WHOLE, METRES /* a double; JSON null if it is not finite */, SHARE /* float */ };

struct number {
    const char *name;
    size_t at;
    enum report_value_kind kind;
};

#define OF_BUILD(name, field, kind)                                                                                                        \
    {                                                                                                                                      \
        name, offsetof(struct build_report, field), kind                                                                                   \
    }
static const struct number build_numbers[] = {
    OF_BUILD("nodes", nodes, COUNT32),
    OF_BUILD("model_triangles", triangles, COUNT32),
    OF_BUILD("model_vertices", vertices, COUNT32),
    OF_BUILD("primitives", primitives, COUNT32),
    OF_BUILD("materials", materials, COUNT32),
    OF_BUILD("textures", textures, COUNT32),
    OF_BUILD("zero_area_triangles", degenerate_triangles, COUNT32),
    OF_BUILD("repeated_triangles", repeated_triangles, COUNT32),
    OF_BUILD("turned_triangles", turned_triangles, COUNT32),
    OF_BUILD("closed_gaps", closed_gaps, COUNT32),
    OF_BUILD("computed_normals", computed_normals, COUNT32),
    OF_BUILD("skipped_lines", skipped_lines, COUNT32),
    OF_BUILD("skipped_points", skipped_points, COUNT32),
    OF_BUILD("stocked", stocked, COUNT32),
    OF_BUILD("kept_sensors", kept_sensors, COUNT32),
    OF_BUILD("levels_given_up", levels_given_up, COUNT),
    OF_BUILD("split_measured", split_measured, COUNT),
    OF_BUILD("split_kept", split_kept, COUNT),
    { 0 },
};
static const struct number surface_numbers[] = {
    OF_BUILD("tolerance_m", surface.tolerance_m, METRES),
    OF_BUILD("spacing_m", surface.spacing_m, METRES),
    OF_BUILD("time_m2", surface.time_m2, METRES),
    OF_BUILD("triangles", surface.triangles, COUNT),
    OF_BUILD("welded_vertices", surface.welded_vertices, COUNT),
    OF_BUILD("degenerate_triangles", surface.degenerate_triangles, COUNT),
    OF_BUILD("repeated_triangles", surface.repeated_triangles, COUNT),
    OF_BUILD("open_edges_before", surface.border_edges, COUNT),
    OF_BUILD("open_edges_after", surface.border_edges_after, COUNT),
    OF_BUILD("components_before", surface.components, COUNT),
    OF_BUILD("components_after", surface.components_after, COUNT),
    OF_BUILD("bridges", surface.bridges, COUNT),
    OF_BUILD("longest_bridge_m", surface.longest_bridge_m, METRES),
    OF_BUILD("k", surface.k, WHOLE),
    OF_BUILD("samples", surface.samples, COUNT),
    OF_BUILD("hidden_vertices", surface.hidden_vertices, COUNT),
    OF_BUILD("unreachable_vertices", unreachable_vertices, COUNT),
    OF_BUILD("heat_disagreement", surface.heat_disagreement, METRES),
    { 0 },
};
static const struct number second_numbers[] = {
    OF_BUILD("read", read_s, METRES),
    OF_BUILD("surface", surface_s, METRES),
    OF_BUILD("weld", surface.weld_s, METRES),
    OF_BUILD("bridge", surface.bridge_s, METRES),
    OF_BUILD("sample", surface.sample_s, METRES),
    OF_BUILD("laplacian", surface.laplacian_s, METRES),
    OF_BUILD("factor", surface.factor_s, METRES),
    OF_BUILD("check", surface.check_s, METRES),
    OF_BUILD("solve", solve_s, METRES),
    OF_BUILD("levels", levels_s, METRES),
    OF_BUILD("split", split_s, METRES),
    { 0 },
};
static const struct number cloud_numbers[] = {
    OF_BUILD("points", cloud.points, COUNT),
    OF_BUILD("k", cloud.k, WHOLE),
    OF_BUILD("spacing_m", cloud.spacing_m, METRES),
    OF_BUILD("mean_difference", cloud.mean, METRES),
    OF_BUILD("worst_difference", cloud.worst, METRES),
    OF_BUILD("reached_alone", cloud.reached, COUNT),
    OF_BUILD("not_reached", cloud.unreached, COUNT),
    { 0 },
};
static const struct number bend_numbers[] = {
    OF_BUILD("bounded", bend.measured, COUNT),
    OF_BUILD("unbounded", bend.unmeasured, COUNT),
    OF_BUILD("steps", bend.steps, METRES),
    OF_BUILD("over_share", bend.over_share, METRES),
    OF_BUILD("hidden_share", bend.hidden_share, METRES),
    OF_BUILD("unknown_share", bend.unknown_share, METRES),
    { 0 },
};
#define OF_LEVEL(name, field, kind)                                                                                                        \
    {                                                                                                                                      \
        name, offsetof(struct build_level, field), kind                                                                                    \
    }
static const struct number level_numbers[] = {
    OF_LEVEL("error_m", error_m, SHARE),
    OF_LEVEL("limited_by_triangles", left[LEVEL_LIMIT_TRIANGLES].edges, COUNT32),
    OF_LEVEL("limited_by_length", left[LEVEL_LIMIT_LENGTH].edges, COUNT32),
    OF_LEVEL("limited_by_jumps", left[LEVEL_LIMIT_JUMP].edges, COUNT32),
    OF_LEVEL("steps_by_triangles", left[LEVEL_LIMIT_TRIANGLES].steps, SHARE),
    OF_LEVEL("steps_by_length", left[LEVEL_LIMIT_LENGTH].steps, SHARE),
    OF_LEVEL("steps_by_jumps", left[LEVEL_LIMIT_JUMP].steps, SHARE),
    OF_LEVEL("triangles_before", triangles, COUNT32),
    OF_LEVEL("triangles", split_triangles, COUNT32),
    OF_LEVEL("vertices", vertices, COUNT32),
    { 0 },
};

static json_t *to_json(const struct number *number, const void *object)
{
    const char *at = (const char *)object + number->at;
    switch (number->kind) {
    case COUNT32: return json_integer(*(const uint32_t *)at);
    case COUNT: return json_integer((json_int_t) * (const size_t *)at);
    case WHOLE: return json_integer(*(const int *)at);
    case SHARE: return json_real(isfinite(*(const float *)at) ? (double)*(const float *)at : -1);
    default: return isnan(*(const double *)at) ? json_null() : json_real(isfinite(*(const double *)at) ? *(const double *)at : -1);
    }
}

static json_t *all_to_json(const struct number *numbers, const void *object)
{
    json_t *out = json_object();
    for (; numbers->name; numbers++)
        json_object_set_new(out, numbers->name, to_json(numbers, object));
    return out;
}

static bool all_from_json(const struct number *numbers, const json_t *from, void *object)
{
    for (; numbers->name; numbers++) {
        const json_t *value = json_object_get(from, numbers->name);
        char *at = (char *)object + numbers->at;
        bool is_null = numbers->kind == METRES && json_is_null(value);
        if ((!json_is_number(value) && !is_null) || (numbers->kind != SHARE && numbers->kind != METRES && json_integer_value(value) < 0))
            return false;
        switch (numbers->kind) {
        case COUNT32: *(uint32_t *)at = (uint32_t)json_integer_value(value); break;
        case COUNT: *(size_t *)at = (size_t)json_integer_value(value); break;
        case WHOLE: *(int *)at = (int)json_integer_value(value); break;
        case SHARE: *(float *)at = (float)json_number_value(value); break;
        default: *(double *)at = is_null ? (double)NAN : json_number_value(value); break;
        }
    }
    return true;
}

json_t *build_report_to_json(const struct build_report *report)
{
    json_t *out = all_to_json(build_numbers, report), *levels = json_array();
    for (size_t i = 0; i < report->level_count; i++)
        json_array_append_new(levels, all_to_json(level_numbers, &report->levels[i]));
    json_object_set_new(out, "levels", levels);
    if (report->stray[0])
        json_object_set_new(out, "stray", json_string(report->stray));
    if (report->bend.measured + report->bend.unmeasured > 0)
        json_object_set_new(out, "between_corners", all_to_json(bend_numbers, report));
    if (report->cloud.points > 0)
        json_object_set_new(out, "cloud", all_to_json(cloud_numbers, report));
    json_object_set_new(out, "surface", report->surface.triangles ? all_to_json(surface_numbers, report) : json_null());
    json_object_set_new(out, "stage_seconds", all_to_json(second_numbers, report));
    return out;
}

bool build_report_from_json(const json_t *numbers, struct build_report *report)
{
    const json_t *levels = json_object_get(numbers, "levels"), *surface = json_object_get(numbers, "surface");
    *report = (struct build_report){ .level_count = json_array_size(levels) };
    const char *stray = json_string_value(json_object_get(numbers, "stray"));
    snprintf(report->stray, sizeof(report->stray), "%s", stray ? stray : "");
    if (report->level_count > LEVELS_MAX || !all_from_json(build_numbers, numbers, report) ||
        !all_from_json(second_numbers, json_object_get(numbers, "stage_seconds"), report))
        return false;
    for (size_t i = 0; i < report->level_count; i++)
        if (!all_from_json(level_numbers, json_array_get(levels, i), &report->levels[i]))
            return false;
    /* the member "cloud" may be missing: a report has it only if a group requests distances by heat */
    const json_t *cloud = json_object_get(numbers, "cloud");
    if (cloud && !all_from_json(cloud_numbers, cloud, report))
        return false;
    const json_t *bend = json_object_get(numbers, "between_corners");
    if (bend && !all_from_json(bend_numbers, bend, report))
        return false;
    return json_is_null(surface) || all_from_json(surface_numbers, surface, report);
}
