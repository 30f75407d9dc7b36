/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shades field surfaces, sky and ground of refined frames, eight pixels at a time; a C version of shaders/refined.frag, shadow.glsl,
   sky.frag and ground.frag. */
#include "render/soft/kernels.h"
#include "render/soft/surface_points.h"

/* --- the field --------------------------------------------------------------------------------------------------------------- */

void refined_shade_field(const struct refined *refined, struct visibility_band *band, const struct refined_item *items, size_t count,
                         const struct shaded_items *out)
{
    const float *shade = refined->raster.block.shade;
    for (size_t first = 0; first < count; first += LANES) {
        struct eight_points spot;
        size_t some = count - first < LANES ? count - first : LANES;
        look(refined, items + first, some, false, &spot);
        vec n = facing(&spot, view_of(refined, &spot));
        lanes sun = most_of(dot(n, towards_sun(refined)), all(0));
        if (lanes_any(sun > 0.0f))
            sun *= sun_at(refined, &spot, n);
        lanes light = lanes_clamp((float)LIGHT_AMBIENT * spot.attributes[AMBIENT] + (float)LIGHT_SUN * sun, 0, 1);
        lanes_int row = lanes_whole(lanes_clamp(light * shade[0] + shade[1], 0, shade[2]));
        for (size_t i = 0; i < some; i++) {
            refined_keep_place(refined, band, &items[first + i], spot.weights[1][i], spot.weights[2][i], out, first + i);
            out->rows[first + i] = (uint8_t)row[i];
        }
    }
}

/* --- sky and ground ---------------------------------------------------------------------------------------------------------- */

SOFT_INLINE lanes margin(lanes at)
{
    lanes away = most_of(at - 0.5f, 0.5f - at), t = lanes_clamp((away - 0.5f) * (1 / (0.3f - 0.5f)), 0, 1);
    return t * t * (3.0f - 2.0f * t);
}

SOFT_INLINE lanes open_at(const struct refined *refined, lanes u, lanes v)
{
    const uint8_t *open = refined->raster.light->open;
    int side = refined->raster.light->ground_px;
    float last = (float)side - 1;
    lanes x = lanes_clamp(u * (float)side - 0.5f, 0, last), y = lanes_clamp(v * (float)side - 0.5f, 0, last), out;
    for (int i = 0; i < LANES; i++) {
        int x0 = (int)x[i], y0 = (int)y[i], right = x0 + 1 < side ? 1 : 0, below = y0 + 1 < side ? side : 0;
        const uint8_t *at = open + y0 * side + x0;
        float a = x[i] - (float)x0, upper = at[0] + a * (float)(at[right] - at[0]);
        float lower = at[below] + a * (float)(at[below + right] - at[below]);
        out[i] = upper + (y[i] - (float)y0) * (lower - upper);
    }
    return out * (1 / 255.0f);
}

/* Returns the brightness of the ground with the shadow on it, 0..256; a C version of shaders/ground.frag. */
SOFT_INLINE lanes_int ground_at(const struct refined *refined, lanes x, float y)
{
    const float(*g)[3] = refined->raster.ground_from_pixel;
    const float(*m)[4] = refined->sun_from_ground;
    lanes u = x * g[0][0] + (y * g[0][1] + g[0][2]), v = x * g[1][0] + (y * g[1][1] + g[1][2]);
    lanes w = x * g[2][0] + (y * g[2][1] + g[2][2]);
    lanes over = 1.0f / lanes_choose(w > 0.0f, w, all(1)), place[3];
    u *= over;
    v *= over;
    lanes_int inside = (w > 0.0f) & (u > 0.0f) & (u < 1.0f) & (v > 0.0f) & (v < 1.0f), whole = (lanes_int){ 0 } + 256;
    if (!lanes_any(inside))
        return whole;
    for (int r = 0; r < 3; r++)
        place[r] = u * m[0][r] + v * m[1][r] + (m[3][r] + refined->ground_step[r]);
    lanes sun = sun_visible(refined->raster.light, place[0], place[1], place[2]);
    lanes dark = least_of((float)GROUND_SUN * (1.0f - sun) + (float)GROUND_SKY * (1.0f - open_at(refined, u, v)), all((float)GROUND_MOST));
    return lanes_choose_int(inside, lanes_whole((1.0f - margin(u) * margin(v) * dark) * 256.0f + 0.5f), whole);
}

void refined_shade_sky(const struct refined *refined, int row, const uint8_t *wanted, uint32_t *colors)
{
    const struct raster *raster = &refined->raster;
    struct heights heights = { 0 };
    for (int column = 0; column < raster->width_px; column += LANES) {
        uint64_t any;
        memcpy(&any, wanted + column, sizeof(any));
        if ((column & (raster->stretch_px - 1)) == 0)
            heights = heights_from(raster, column, row);
        if (!any)
            continue;
        lanes_int color = backdrop_at(raster, &heights, column, row);
        if (raster->has_ground)
            color = darkened(color, ground_at(refined, LANES_IOTA + ((float)column + 0.5f), (float)row + 0.5f));
        color &= 0xffffff;
        memcpy(colors + column, &color, sizeof(color));
    }
}
