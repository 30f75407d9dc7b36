/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists the sensors and values that enter the sums of the field. */
#include <string.h>

#include "base/mem.h"
#include "field/field_impl.h"

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
