/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the field at one point of the surface from the sensors' readings (field_at()). */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "field/drawn_error.h"
#include "field/field_impl.h"
#include "field/update.h"
#include "plant/influence.h"

/* Returns the value at the point, interpolated linearly between the scalars of the triangle's corners, as drawn frames do. */
static void point_drawn(const struct scalars *scalars, const struct field_place *place, struct field_point *out)
{
    double value = 0, no_data = 0, uncertain = 0;
    for (int k = 0; k < 3; k++) {
        const struct scalar *at = &scalars->at[place->corners[k]];
        double part = place->parts[k];
        value += part * (double)at->value;
        no_data += part * at->lacking / 255;
        uncertain += part * at->uncertain / 255;
    }
    *out = (struct field_point){ .value = value, .no_data = no_data > 0.5, .uncertain = uncertain > 0.5 };
}

/* Returns the largest error of the value at a point; 0 if it is below a colour step. Any level of detail may be drawn there, so
   the error is the largest one of the triangles around the three corners. *of_distances receives the part due to errors of
   distances. */
static double error_near(const struct field_state *state, const struct field_place *place, double of_distances)
{
    const struct weights *weights = state->weights;
    const float *errors = weights ? weights->errors : NULL;
    double most = weights && weights->errors_unknown ? 1 : 0;
    if (errors && weights->interpolation_errors)
        errors = weights->interpolation_errors;
    if (errors && weights->prepared)
        errors = weights->prepared_errors;
    for (int k = 0; k < 3 && errors; k++)
        most = fmax(most, fmin((double)errors[place->corners[k]], 1));
    most = most * state->error_scale + of_distances;
    return most > state->error_limit * state->error_scale ? most : 0;
}

static void point_init(struct layout_point *point, const struct field_layout *layout, const struct field_place *place)
{
    layout_point_init(point, layout, place->corners,
                      (const float[3]){ (float)place->parts[0], (float)place->parts[1], (float)place->parts[2] });
}

static void point_distance(const struct field_state *state, const struct layout_point *point, struct field_point *out)
{
    float room;
    size_t i = 0;
    while (i < point->layout.sensor_count && point->layout.sensors[i].tag != state->params.sensor)
        i++;
    if (i == point->layout.sensor_count)
        return;
    double far_m = (double)*layout_distances(&point->layout, state->params.distance, i, 0, 1, &room);
    out->no_data = !isfinite(far_m);
    out->value = out->no_data ? out->value : far_m;
}

/* Returns true if pictures mark a hot spot at this point as uncertain, because a corner of its triangle is marked. */
static bool is_blind_off(const struct field_state *state, const struct layout_point *point)
{
    for (int k = 0; k < 3; k++)
        if (weights_blind_off(state->weights, point->corners[0][k]))
            return true;
    return false;
}

/* Finds out whether there is data at the point, for prepared weights: triangles may show data beyond the reach of the sensors. */
static void point_border(const struct field_state *state, const struct layout_point *point, struct field_point *out)
{
    struct weights *weights = weights_create_border(&point->layout, &state->params, state->usable);
    struct scalar at = { 0 };
    if (!weights)
        return;
    weights_prepare(weights, 0, 1);
    update_flags(state, weights, 0, 0, 0, &at);
    out->no_data |= at.no_data > 0;
    weights_destroy(&weights);
}

/* Sums the sensors' weights at the point, multiplied by the readings from which the scalars were computed, with the same
   arithmetic as at vertices. Returns the largest change of the value due to errors of distances, for these readings. */
static double point_sum(const struct field_state *state, const struct layout_point *point, struct field_point *out)
{
    const size_t sensors = point->layout.sensor_count;
    double deviation = 0;
    uint8_t *usable = mem_array(sensors, 1), *marked = mem_array(sensors, 1);
    double *values = mem_array(sensors, sizeof(*values)), value = 0, total = 0, uncertain = 0;
    uint32_t *members = mem_array(sensors, sizeof(*members));
    for (size_t i = 0; i < sensors; i++)
        usable[i] = state->shown[i].usable;
    struct weights *weights = weights_create(&point->layout, &state->params, state->weights->radius_m, usable, &(struct weights_key){ 0 });
    if (weights) {
        for (uint32_t m = 0; m < weights->member_count; m++) {
            members[m] = m;
            values[m] = state->shown[weights->members[m]].value;
            marked[m] = state->shown[weights->members[m]].uncertain;
        }
        struct kernel_value rule;
        struct scalar at = { 0 };
        update_rule(state, state->shown, &rule);
        weights_prepare(weights, 0, 1);
        weights_add(weights, 0, 1, &(struct weights_terms){ members, values, marked, weights->member_count },
                    &(struct weights_sums){ &value, &total, &uncertain });
        float weight = (float)total, shown;
        kernel_value(&rule, &value, &weight, 1, &shown);
        update_flags(state, weights, 0, total, uncertain, &at);
        out->value = state->params.show == SHOW_BLIND ? (double)update_blind(point->layout.group, weights->near_m[0]) : (double)shown;
        out->no_data = at.no_data;
        out->uncertain = state->params.show == SHOW_BLIND ? is_blind_off(state, point) : at.uncertain > 127;
        const double factor = total > 0 ? drawn_error_of_distances(weights) : 0;
        for (uint32_t m = 0; m < weights->member_count && factor > 0; m++)
            values[m] = fabs(values[m] - value / total);
        if (factor > 0)
            weights_add(weights, 0, 1, &(struct weights_terms){ members, values, marked, weights->member_count },
                        &(struct weights_sums){ &deviation, NULL, NULL });
        deviation = factor > 0 ? factor * deviation / total : 0;
    }
    weights_destroy(&weights);
    mem_free(usable);
    mem_free(marked);
    mem_free(values);
    mem_free(members);
    return deviation;
}

bool field_at(struct field *field, int asset, const struct field_params *params, const struct snapshot *snapshot,
              const struct field_place *place, struct field_point *out)
{
    struct field_params room;
    /* number of vertices that need values; 0 if frames evaluate the field at each pixel, since the value at a point then needs
       no vertices */
    const size_t count = field_vertices(field, asset, params, field->scene->assets[asset].file->view.header->vertex_count);
    const struct scalars *scalars = field_scalars_of(field, asset, params, snapshot, count);
    if (!scalars)
        return false;
    params = field_params_of(field, asset, params, &room);
    const struct field_state *state = field_state(field, asset, params);
    *out = (struct field_point){ .no_data = true };
    if (count > 0)
        point_drawn(scalars, place, out);
    struct layout_point point;
    point_init(&point, state->layout, place);
    if (params->show == SHOW_DISTANCE) {
        point_distance(state, &point, out);
        return true;
    }
    double of_distances = 0;
    if (state->weights->prepared)
        point_border(state, &point, out);
    else
        of_distances = point_sum(state, &point, out);
    out->drawn_error = field_params_cover(params) ? 0 : error_near(state, place, of_distances);
    out->uncertain |= out->drawn_error > 0;
    return true;
}

float *field_distances_at(struct field *field, int asset, const struct field_params *params, const struct field_place *place)
{
    struct field_params room;
    params = field_params_of(field, asset, params, &room);
    const struct field_layout *layout = field_layout(field, asset, params);
    if (!layout)
        return NULL;
    struct layout_point point;
    point_init(&point, layout, place);
    float *distances_m = mem_array(layout->sensor_count, sizeof(*distances_m)), scratch;
    for (size_t i = 0; i < layout->sensor_count; i++)
        distances_m[i] = *layout_distances(&point.layout, field_params_distance(params), i, 0, 1, &scratch);
    return distances_m;
}
