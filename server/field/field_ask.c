/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Questions about the field: one vertex, and what goes into the sums. */
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
    struct field_params room;
    params = field_params_of(field, asset, params, &room);
    const struct layout *layout = field_layout(field, asset, params);
    const struct state *state = field_state(field, asset, params);
    bool at_sensor = false;
    for (size_t i = 0; i < layout->sensor_count; i++) {
        const struct layout_sensor *sensor = &layout->sensors[i];
        float scratch[1], distance_m = *layout_distances(layout, params->distance, i, vertex, 1, scratch);
        if (state->usable[i] != SENSOR_USED || !(distance_m <= params->reach_m) || distance_m > 1e30f)
            continue;
        insert_nearest(out, sensor->tag, (double)distance_m);
        at_sensor |= distance_m == 0 || sensor->vertex == vertex;
    }
    const struct scalar *at = &scalars->at[vertex];
    out->value = (double)at->value;
    out->uncertain = at->uncertain > 127;
    if (!at->no_data && !at->no_limits)
        out->kind =
            at_sensor && params->interpolation == INTERPOLATION_SHEPARD && params->show != SHOW_DISTANCE ? PROBE_MEASURED : PROBE_BETWEEN;
}

size_t field_sensors(struct field *field, int asset, const struct field_params *params, struct field_sensor **out, float *radius_m)
{
    struct field_params room;
    params = field_params_of(field, asset, params, &room);
    const struct state *state = field_layout(field, asset, params) ? field_state(field, asset, params) : NULL;
    if (!state || (!state->weights && params->show != SHOW_DISTANCE))
        return 0;
    const struct layout *layout = state->layout;
    const struct weights *weights = state->weights;
    struct field_sensor *sensors = mem_array(layout->sensor_count, sizeof(*sensors));
    for (size_t i = 0; i < layout->sensor_count; i++) {
        const struct layout_sensor *from = &layout->sensors[i];
        struct field_sensor *to = &sensors[i];
        bool sum = weights != NULL;
        *to = (struct field_sensor){
            .tag = from->tag,
            .column = from->column,
            .along_m = from->along_m,
            .strength = sum ? weights->strength[i] : 1,
            .decay = sum ? weights->decay[i] : 1,
            .value = (float)state->shown[i].value,
            .configured = sum ? weights->configured[i] == SENSOR_USED : from->tag == params->sensor,
            .usable = sum ? weights->configured[i] == SENSOR_USED && state->shown[i].usable == SENSOR_USED : from->tag == params->sensor,
            .uncertain = sum && state->shown[i].uncertain,
        };
        memcpy(to->surface_m, from->surface_m, sizeof(to->surface_m));
    }
    *out = sensors;
    *radius_m = weights ? weights->radius_m : 1;
    return layout->sensor_count;
}
