/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Questions about the field: one vertex, and the distances from one sensor. */
#include <float.h>
#include <string.h>

#include "base/mem.h"
#include "field/field_impl.h"
#include "field/kernels.h"

/* Takes one more sensor into the list, which is in order of distance. */
static void insert_nearest(struct probe *probe, int tag, double distance_m)
{
    int at = PROBE_NEAREST;
    while (at > 0 && (probe->nearest_tag[at - 1] < 0 || distance_m < probe->nearest_m[at - 1]))
        at--;
    for (int i = PROBE_NEAREST - 1; i > at; i--) {
        probe->nearest_tag[i] = probe->nearest_tag[i - 1];
        probe->nearest_m[i] = probe->nearest_m[i - 1];
    }
    if (at < PROBE_NEAREST) {
        probe->nearest_tag[at] = tag;
        probe->nearest_m[at] = distance_m;
    }
}

void field_probe(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot, unsigned vertex,
                 struct probe *out)
{
    *out = (struct probe){ .kind = PROBE_NO_DATA, .nearest_tag = { -1, -1, -1, -1 } };
    const struct scalars *scalars = field_scalars(field, asset, params, snapshot);
    if (!scalars || vertex >= scalars->count)
        return;
    const struct layout *layout = field_layout(field, asset, params->group);
    const struct state *state = field_state(field, asset, params);
    bool at_sensor = false;
    for (size_t i = 0; i < layout->sensor_count; i++) {
        const struct layout_sensor *sensor = &layout->sensors[i];
        float scratch[1], distance_m = *layout_distances(layout, params->distance, i, vertex, 1, scratch);
        if (!state->usable[i] || !(distance_m <= params->reach_m) || distance_m > 1e30f)
            continue;
        insert_nearest(out, sensor->tag, (double)distance_m);
        at_sensor |= distance_m == 0 || layout->file->view.sensors[sensor->column].nearest_vertex == vertex;
    }
    const struct scalar *at = &scalars->at[vertex];
    out->value = (double)at->value;
    out->uncertain = at->uncertain;
    if (!at->no_data)
        out->kind = at_sensor && params->interpolation == INTERPOLATION_SHEPARD ? PROBE_MEASURED : PROBE_BETWEEN;
}

/* The sensor of that tag in its asset's file. */
static bool find_column(const struct scene *scene, int tag, int *asset, size_t *column)
{
    for (size_t a = 0; a < scene->asset_count; a++)
        for (size_t i = 0; i < scene->assets[a].sensor_count; i++)
            if (scene->assets[a].sensors[i].tag == tag) {
                *asset = (int)a;
                *column = scene->assets[a].sensors[i].column;
                return true;
            }
    return false;
}

static void distances_of(const struct asset_view *view, size_t column, enum distance_mode mode, float *out_m)
{
    size_t count = view->header->vertex_count;
    if (mode == DISTANCE_GEODESIC)
        memcpy(out_m, view->geodesic_m + column * count, count * sizeof(*out_m));
    else
        kernel_euclidean(view->positions_m, count, view->sensors[column].surface_m, out_m);
}

struct scalars *field_distance(struct field *field, int tag, enum distance_mode mode)
{
    int asset;
    size_t column;
    if (!find_column(field->scene, tag, &asset, &column))
        return NULL;
    const struct asset_view *view = &field->scene->assets[asset].file->view;
    size_t count = view->header->vertex_count;
    struct scalars *distance = mem_new(sizeof(*distance));
    struct scalar *at = mem_try_array(count, sizeof(*at));
    float *distance_m = mem_try_array(count, sizeof(*distance_m));
    if (!at || !distance_m)
        goto error;
    distances_of(view, column, mode, distance_m);
    float most_m = kernel_largest(distance_m, count, 0);
    for (size_t j = 0; j < count; j++)
        at[j] = distance_m[j] <= FLT_MAX ? (struct scalar){ .value = distance_m[j] } : (struct scalar){ .value = most_m, .no_data = 255 };
    mem_free(distance_m);
    *distance = (struct scalars){ .asset = asset, .version = ++field->versions, .count = count, .at = at, .oldest_age_ns = INT64_MAX };
    distance->flags_version = distance->version;
    return distance;
error:
    mem_free(at);
    mem_free(distance_m);
    mem_free(distance);
    return NULL;
}

void field_distance_destroy(struct scalars **distance)
{
    if (!*distance)
        return;
    mem_free((void *)(*distance)->at);
    mem_free(*distance);
    *distance = NULL;
}
