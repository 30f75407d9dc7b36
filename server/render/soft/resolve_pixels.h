/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Evaluates fields at pixels (field/pixel_field.h) while a visibility buffer is coloured. Private to soft/. */
#ifndef RENDER_SOFT_RESOLVE_PIXELS_H
#define RENDER_SOFT_RESOLVE_PIXELS_H
#include "render/soft/pixel_lanes.h"
#include "render/soft/visibility_buffer_impl.h"

struct band_lists { /* sensor lists of one band of pixel rows, for meshes whose fields have more than PIXEL_FEW sensors */
    struct pixel_lists lists;
    uint32_t *of_cells; /* by cell (square of pixels) of the band: 1 + index of the cell's first list in `lists`; 0: the cell has none */
    int columns;        /* number of cells (squares of pixels) in a row of the band */
};

/* eight points on triangles. at: position of the point in metres; second, third: vectors from the triangle's first corner to its second and
   third */
struct eight_places {
    lanes at[3], second[3], third[3];
    lanes_int meshes; /* index of the triangle's mesh in the visibility buffer; -1: the field there is interpolated between vertices */
};

SOFT_INLINE void places_of(const struct visibility_band *band, lanes_int triangles, lanes w1, lanes w2, struct eight_places *out)
{
    for (int i = 0; i < LANES; i++) {
        const struct visibility_place *place = &band->places[triangles[i]];
        for (int c = 0; c < 3; c++) {
            out->at[c][i] = place->first[c];
            out->second[c][i] = place->second[c];
            out->third[c][i] = place->third[c];
        }
        out->meshes[i] = (int32_t)band->corners[triangles[i]][3] - 1;
    }
    for (int c = 0; c < 3; c++)
        out->at[c] += w1 * out->second[c] + w2 * out->third[c];
}

SOFT_INLINE const struct pixel_list *list_of(const struct band_lists *lists, const struct visibility_mesh *mesh, uint32_t number,
                                             int32_t cell)
{
    if (mesh->pixels.count <= PIXEL_FEW)
        return &mesh->every;
    for (uint32_t i = lists->of_cells ? lists->of_cells[cell] : 0; i > 0; i = lists->lists.lists[i - 1].next)
        if (lists->lists.lists[i - 1].mesh == number)
            return &lists->lists.lists[i - 1];
    return &mesh->every;
}

/* Evaluates the field at the points whose mesh is not -1, with the sensor list of the point's mesh and square of pixels (cell).
   Results for other points are 0. cells: index of each point's cell in the band. */
SOFT_INLINE void evaluate_places(const struct visibility_buffer *buffer, const struct band_lists *lists, const struct eight_places *places,
                                 const lanes at[3], lanes_int cells, struct eight_values *out)
{
    *out = (struct eight_values){ { 0 }, { 0 }, { 0 }, { 0 } };
    uint32_t waiting = lanes_bits(places->meshes >= 0);
    while (waiting) {
        int first = __builtin_ctz(waiting), mesh = places->meshes[first], cell = cells[first];
        struct eight_values values;
        lanes_int same = places->meshes == mesh;
        const struct visibility_mesh *of = &buffer->meshes[mesh];
        if (of->pixels.count > PIXEL_FEW)
            same &= cells == cell;
        pixel_lanes_at(&of->pixels, list_of(lists, of, (uint32_t)mesh, cell), at, &values);
        out->value = lanes_choose(same, values.value, out->value);
        out->no_data |= values.no_data & same;
        out->uncertain |= values.uncertain & same;
        out->no_limits |= values.no_limits & same;
        waiting &= ~lanes_bits(same);
    }
}

/* Converts field values to colour map columns, which determine the pixels' colours; on a logarithmic scale the values stay unchanged. */
SOFT_INLINE lanes carried_of_values(const float *scale, lanes values)
{
    const float farthest = 1e6f;
    if (is_log(scale))
        return values;
    return lanes_clamp((values - scale[0]) * scale[1] * COLUMNS_OF_RANGE + (1 + SLACK * COLUMNS_OF_RANGE), -farthest, farthest);
}

/* Returns the change of the field's values when the weights of the triangle's second and third corner grow by w1 and w2 at each
   point. Values are colour map columns or, on a logarithmic scale, field values. carried: values at the points. */
SOFT_INLINE lanes carried_change(const struct visibility_buffer *buffer, const struct band_lists *lists, const struct eight_places *places,
                                 lanes w1, lanes w2, lanes_int cells, lanes carried)
{
    lanes at[3];
    struct eight_values values;
    for (int c = 0; c < 3; c++)
        at[c] = places->at[c] + w1 * places->second[c] + w2 * places->third[c];
    evaluate_places(buffer, lists, places, at, cells, &values);
    return carried_of_values(buffer->scale, values.value) - carried;
}

#endif
