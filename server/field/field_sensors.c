/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists the sensors and values from which an asset's field is computed, for callers that evaluate the field themselves. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "field/field_impl.h"
#include "field/update.h"

size_t field_sensors(struct field *field, int asset, const struct field_params *params, struct field_sensor **out, float *radius_m)
{
    struct field_params room;
    params = field_params_of(field, asset, params, &room);
    const struct field_state *state = field_layout(field, asset, params) ? field_state(field, asset, params) : NULL;
    if (!state || (!state->weights && params->show != SHOW_DISTANCE))
        return 0;
    const struct field_layout *layout = state->layout;
    const struct weights *weights = state->weights;
    struct field_sensor *sensors = mem_array(layout->sensor_count, sizeof(*sensors));
    for (size_t i = 0; i < layout->sensor_count; i++) {
        const struct layout_sensor *from = &layout->sensors[i];
        struct field_sensor *to = &sensors[i];
        bool sum = weights != NULL;
        *to = (struct field_sensor){
            .tag = from->tag,
            .column = from->column,
            .in_file = layout_is_in_file(from, params->distance),
            .along_m = layout_along(from, params->distance),
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

/* --- sensors for renderers, which evaluate the field at each pixel ------------------------------------------------------------- */

static void add_pixel_sensor(const struct field_state *state, size_t sensor, uint32_t bits, struct pixel_field *out)
{
    const struct layout_sensor *from = &state->layout->sensors[sensor];
    const struct weights *weights = state->weights;
    struct pixel_sensor *to = &out->sensors[out->count++];
    *to = (struct pixel_sensor){ .value = (float)state->shown[sensor].value,
                                 .strength = weights ? weights->strength[sensor] : 1,
                                 .decay = weights ? weights->decay[sensor] : 1,
                                 .state = bits };
    memcpy(to->place_m, from->surface_m, sizeof(to->place_m));
}

/* Fills *out so that each pixel shows its distance from one sensor of the layout. */
static void fill_distance(const struct field_state *state, struct pixel_field *out)
{
    out->show = PIXEL_DISTANCE;
    out->reach_m = INFINITY;
    out->sensors = mem_array(1, sizeof(*out->sensors));
    for (size_t i = 0; i < state->layout->sensor_count && out->count == 0; i++)
        if (state->layout->sensors[i].tag == state->params.sensor)
            add_pixel_sensor(state, i, PIXEL_CONFIGURED | PIXEL_USABLE, out);
}

static void fill_rule(const struct field_state *state, struct pixel_field *out)
{
    const struct plant_group *group = state->layout->group;
    const struct weights *weights = state->weights;
    struct kernel_value rule;
    update_rule(state, state->shown, &rule);
    out->paper = weights->interpolation == INTERPOLATION_PAPER;
    out->show = state->params.show == SHOW_BLIND ? PIXEL_BLIND : PIXEL_SUM;
    out->fill = out->show == PIXEL_BLIND || state->params.fill == FILL_NEIGHBOURS;
    out->power = weights->power;
    out->reach_m = weights->reach_m;
    out->radius_m = weights->radius_m;
    out->scale = rule.scale;
    out->offset = rule.offset;
    out->low = rule.low;
    out->high = rule.high;
    out->empty = rule.empty;
    out->hot_spot_m = (float)group->hot_spot_m;
    out->seen = update_blind(group, 0);
    out->most = update_blind(group, INFINITY);
}

static void fill_sum(const struct field_state *state, struct pixel_field *out)
{
    const struct weights *weights = state->weights;
    fill_rule(state, out);
    out->sensors = mem_array(state->layout->sensor_count, sizeof(*out->sensors));
    for (size_t i = 0; i < state->layout->sensor_count; i++) {
        uint32_t bits = PIXEL_CONFIGURED | (weights->takes_part[i] ? PIXEL_USABLE : 0);
        bits |= weights->configured[i] == SENSOR_NO_LIMITS ? PIXEL_NO_LIMITS : 0;
        bits |= state->shown[i].uncertain ? PIXEL_UNCERTAIN : 0;
        if (weights->configured[i])
            add_pixel_sensor(state, i, bits, out);
    }
    bool is_even = out->count == 1 && !out->paper && out->show == PIXEL_SUM && out->reach_m == INFINITY;
    if (is_even || out->count == 0)
        pixel_field_finish(out);
}

void field_pixels(struct field *field, int asset, const struct field_params *params, struct pixel_field *out)
{
    struct field_params room;
    memset(out, 0, sizeof(*out));
    params = field_params_of(field, asset, params, &room);
    const struct field_layout *layout = field_layout(field, asset, params);
    if (!layout || layout->assumed)
        return;
    const struct field_state *state = field_state(field, asset, params);
    if (state && params->show == SHOW_DISTANCE && params->distance == DISTANCE_EUCLIDEAN)
        fill_distance(state, out);
    else if (state && state->weights && layout_is_exact(layout, params->interpolation, params->distance))
        fill_sum(state, out);
}

size_t field_vertices(struct field *field, int asset, const struct field_params *params, size_t count)
{
    struct field_params room;
    params = field_params_of(field, asset, params, &room);
    const struct field_layout *layout = field_layout(field, asset, params);
    bool evaluated = layout && params->show != SHOW_DISTANCE && layout_is_exact(layout, params->interpolation, params->distance);
    return evaluated ? 0 : count;
}
