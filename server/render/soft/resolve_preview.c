/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colours a rectangle of a preview. The rasterizer has stored in each pixel's mark (soft_impl.h) which material or field value the pixel
   shows. Shadows are looked up only for pixels that show a surface. */
#include <string.h>

#include "render/soft/kernels.h"
#include "render/soft/lookups.h"
#include "render/soft/pixel_lanes.h"
#include "render/soft/pixel_marks.h"
#include "render/soft/section_colors.h"

/* Prefetch distances in pixels: BOUNDS_AHEAD for the depth bounds of shadow map tiles, SHADOWS_AHEAD for the texels of tiles that the
   bounds leave undecided. AIMS: size of the ring buffer of started shadow lookups. */
enum { BOUNDS_AHEAD = 8 * LANES, SHADOWS_AHEAD = 4 * LANES, AIMS = 16 };

/* Computes positions on the sun's shadow map, 0..1, and depths there, of the surfaces that eight pixels show. */
SOFT_INLINE void sun_place(const struct raster *raster, lanes x, float y, lanes depth, lanes place[3])
{
    const float(*m)[4] = raster->sun_from_pixel;
    lanes s[4];
    for (int r = 0; r < 4; r++)
        s[r] = x * m[0][r] + (y * m[1][r] + m[3][r]) + depth * m[2][r];
    lanes over = 1.0f / s[3];
    for (int r = 0; r < 3; r++)
        place[r] = s[r] * over;
}

/* Starts the shadow lookups of eight pixels. Pixels whose surface faces away from the sun are left out. */
SOFT_INLINE void aim_at_sun(const struct raster *raster, int column, int row, struct sun_aim *aim)
{
    size_t place = (size_t)row * (size_t)raster->pitch_px + (size_t)column;
    lanes_int marks = *(const lanes_int *)(raster->marks + place);
    lanes at[3];
    aim->open = ((marks & (int32_t)MARK_KIND) == (int32_t)MARK_CONTEXT) & ((marks & 0xff) != 0);
    aim->lit = (lanes){ 0 };
    if (!lanes_any(aim->open))
        return;
    sun_place(raster, LANES_IOTA + ((float)column + 0.5f), (float)row + 0.5f, *(const lanes *)(raster->depth + place), at);
    sun_aim(raster->light, at, aim->open, aim);
    sun_prefetch_bounds(raster->light, aim);
}

SOFT_INLINE void bound_shadows(const struct raster *raster, struct sun_aim *aim)
{
    if (!lanes_any(aim->open))
        return;
    sun_bound(raster->light, aim);
    if (lanes_any(aim->open))
        sun_prefetch(raster->light, aim);
}

SOFT_INLINE lanes_int context_color(const struct raster *raster, lanes_int marks, const struct sun_aim *aim)
{
    lanes ambient = byte_of(marks, 1) * (1 / 255.0f), facing = byte_of(marks, 0) * (1 / 255.0f);
    lanes sum = lanes_clamp((float)LIGHT_AMBIENT * ambient + (float)LIGHT_SUN * facing * sun_look(raster->light, aim), 0, 1);
    lanes_int step = lanes_whole(sum * (RAMP_STEPS - 1) + 0.5f);
    lanes_int color = gather(raster->ramps, (marks >> 16 & (MOST_RAMPS - 1)) * RAMP_STEPS + step);
    float bright = raster->block.up[3] > 0 ? raster->block.up[3] : 1;
    if (!raster->greys && bright == 1)
        return color;
    lanes blue = bright * byte_of(color, 0), green = bright * byte_of(color, 1), red = bright * byte_of(color, 2);
    if (!raster->greys)
        return lanes_whole(blue + 0.5f) | lanes_whole(green + 0.5f) << 8 | lanes_whole(red + 0.5f) << 16 | (int32_t)0xff000000;
    return lanes_whole((float)GREY_BLUE * blue + (float)GREY_GREEN * green + (float)GREY_RED * red + 0.5f) * 0x010101 | (int32_t)0xff000000;
}

/* Darkens the colours of those among eight pixels that an isoline covers, like field_color() in shaders/field.glsl. */
static void draw_lines(const uint32_t marks[LANES], uint32_t colors[LANES])
{
    static const float grey_parts[3] = { (float)GREY_BLUE, (float)GREY_GREEN, (float)GREY_RED };
    static const float dark_rgb[3] = { ISOLINE_DARK_RGB };
    const float light = (float)ISOLINE_LIGHT * 255, most = (float)ISOLINE_MOST / MARK_LINE_WHOLE;
    for (int i = 0; i < LANES; i++) {
        float part = most * (float)(marks[i] >> MARK_LINE & MARK_LINE_WHOLE), grey = 0;
        uint32_t was = colors[i], now = 0;
        if ((marks[i] & MARK_KIND) != MARK_FIELD || part <= 0)
            continue;
        for (int c = 0; c < 3; c++)
            grey += grey_parts[c] * (float)(was >> (8 * c) & 0xff);
        for (int c = 0; c < 3; c++) {
            float from = (float)(was >> (8 * c) & 0xff), to = grey > (float)ISOLINE_BRIGHT * 255 ? dark_rgb[2 - c] * 255 : light;
            now |= (uint32_t)(from + part * (to - from) + 0.5f) << (8 * c);
        }
        colors[i] = now | 0xff000000;
    }
}

SOFT_INLINE lanes_int lined(const uint32_t *marks, lanes_int color)
{
    uint32_t colors[LANES];
    memcpy(colors, &color, sizeof(colors));
    draw_lines(marks, colors);
    memcpy(&color, colors, sizeof(color));
    return color;
}

/* Returns the brightness of the ground with the shadow on it, 0..256. */
SOFT_INLINE lanes_int ground_at(const struct raster *raster, lanes x, float y)
{
    const float(*m)[3] = raster->ground_from_pixel;
    const struct soft_light *light = raster->light;
    float size = (float)light->ground_px;
    lanes u = x * m[0][0] + (y * m[0][1] + m[0][2]), v = x * m[1][0] + (y * m[1][1] + m[1][2]), w = x * m[2][0] + (y * m[2][1] + m[2][2]);
    lanes one = (lanes){ 0 } + 1.0f;
    lanes over = 1.0f / lanes_choose(w > 0.0f, w, one);
    u *= over;
    v *= over;
    lanes_int inside = (w > 0.0f) & (u > 0.0f) & (u < 1.0f) & (v > 0.0f) & (v < 1.0f);
    if (!lanes_any(inside))
        return (lanes_int){ 0 } + 256;
    u = lanes_clamp(u * size - 0.5f, 0, size - 1);
    v = lanes_clamp(v * size - 0.5f, 0, size - 1);
    lanes u0 = whole_part(u), v0 = whole_part(v), u_part = u - u0, v_part = v - v0;
    lanes_int four = gather(light->ground, lanes_whole(v0) * light->ground_px + lanes_whole(u0));
    lanes upper = byte_of(four, 0) + u_part * (byte_of(four, 1) - byte_of(four, 0));
    lanes lower = byte_of(four, 2) + u_part * (byte_of(four, 3) - byte_of(four, 2));
    lanes_int factor = lanes_whole((upper + v_part * (lower - upper)) * (256 / 255.0f) + 0.5f);
    return lanes_choose_int(inside, factor, (lanes_int){ 0 } + 256);
}

SOFT_INLINE lanes_int sky_color(const struct raster *raster, const struct heights *heights, int column, int row)
{
    lanes_int color = backdrop_at(raster, heights, column, row);
    if (!raster->has_ground)
        return color;
    return darkened(color, ground_at(raster, LANES_IOTA + ((float)column + 0.5f), (float)row + 0.5f));
}

/* Returns the colours of eight pixels that show section caps (cut faces of closed bodies) or inner sides of cut surfaces. */
SOFT_INLINE lanes_int section_color(const struct raster *raster, lanes_int marks, lanes x, float y)
{
    const float(*m)[3] = raster->ray_from_pixel;
    lanes v[3], n[3], square = { 0 };
    for (int r = 0; r < 3; r++) {
        v[r] = -(x * m[0][r] + (y * m[1][r] + m[2][r]));
        square += v[r] * v[r];
    }
    lanes over = 1.0f / lanes_root(square);
    for (int r = 0; r < 3; r++)
        v[r] *= over;
    inside_normal(marks, n);
    lanes_int is_cap = (marks & (int32_t)MARK_CAP) == (int32_t)MARK_CAP;
    return lanes_choose_int(is_cap, cap_color(x, y, raster->block.scale[3]), inside_color(v, n, raster->block.up)) | (int32_t)0xff000000;
}

/* Returns the colours of eight pixels. Has fast paths for the two most frequent cases: all eight show the field, or all are empty. */
SOFT_INLINE lanes_int color_at(const struct raster *raster, const struct heights *heights, const struct sun_aim *aim, int column, int row)
{
    size_t place = (size_t)row * (size_t)raster->pitch_px + (size_t)column;
    const uint32_t *mark = raster->marks + place;
    lanes_int marks = *(const lanes_int *)mark, color;
    if (!lanes_any((~marks & (int32_t)MARK_FIELD) | (marks & (int32_t)MARK_CONTEXT))) {
        color = gather(raster->colormap, marks & (int32_t)MARK_PLACE);
        if (lanes_any(marks & MARK_LINE_WHOLE << MARK_LINE))
            color = lined(mark, color);
        return color;
    }
    if (!lanes_any(marks))
        return sky_color(raster, heights, column, row);
    lanes_int kinds = marks & (int32_t)MARK_KIND, is_field = kinds == (int32_t)MARK_FIELD, is_sky = marks == 0;
    lanes_int is_context = kinds == (int32_t)MARK_CONTEXT, is_section = kinds == (int32_t)MARK_SECTION;
    color = gather(raster->colormap, marks & is_field & (int32_t)MARK_PLACE);
    if (lanes_any(marks & is_field & MARK_LINE_WHOLE << MARK_LINE))
        color = lined(mark, color);
    lanes x = LANES_IOTA + ((float)column + 0.5f);
    if (lanes_any(is_section))
        color = lanes_choose_int(is_section, section_color(raster, marks, x, (float)row + 0.5f), color);
    if (lanes_any(is_context))
        color = lanes_choose_int(is_context, context_color(raster, marks & is_context, aim), color);
    if (lanes_any(is_sky))
        color = lanes_choose_int(is_sky, sky_color(raster, heights, column, row), color);
    return color;
}

/* --- fields that are evaluated at the pixel ----------------------------------------------------------------------------------- */

struct pixel_row { /* eight pixels of one field */
    const struct raster *raster;
    const struct soft_pixels *pixels;
    const struct pixel_list *list;
    const struct mark_ink *ink;
};

SOFT_INLINE void places_at(const struct soft_pixels *pixels, lanes x, lanes y, lanes depth, lanes at[4])
{
    const float(*m)[4] = pixels->place_from_pixel;
    for (int r = 0; r < 4; r++)
        at[r] = x * m[0][r] + (y * m[1][r] + m[3][r]) + depth * m[2][r];
    lanes over = 1.0f / at[3];
    for (int r = 0; r < 3; r++)
        at[r] *= over;
}

SOFT_INLINE void values_at(const struct pixel_row *row, lanes x, lanes y, lanes depth, struct eight_values *out)
{
    lanes at[4];
    places_at(row->pixels, x, y, depth, at);
    pixel_lanes_at(&row->pixels->field, row->list, at, out);
}

/* Converts field values to colour map columns, as needed for marks (colour codes); on a logarithmic scale the values stay unchanged. */
SOFT_INLINE lanes carried_of(const struct pixel_row *row, lanes value)
{
    const float slack = 1e-5f, columns = COLORMAP_PLACES / (1 + 2 * slack), farthest = 1e6f, *scale = row->raster->block.scale;
    return row->ink->log ? value : lanes_clamp((value - scale[0]) * scale[1] * columns + (1 + slack * columns), -farthest, farthest);
}

/* Returns the change of depth from a pixel to the next one. Of the differences to the next and to the previous pixel, returns the smaller:
   the larger one may lead to another surface. step: distance between the pixels in the array. before, after: whether the previous and the
   next pixel exist. */
static float depth_step(const float *at, ptrdiff_t step, bool before, bool after)
{
    float ahead = after ? at[step] - at[0] : 1, behind = before ? at[0] - at[-step] : 1;
    return fabsf(ahead) < fabsf(behind) ? ahead : behind;
}

/* Writes the change of the values of eight pixels from pixel to pixel, in x and y. Values are colour map columns or, on a
   logarithmic scale, field values. rect: the thread's own pixels; depth outside is not read, because other threads may write
   there. */
SOFT_INLINE void carried_steps(const struct pixel_row *pixels, const struct soft_rect *rect, int column, int row, lanes carried,
                               lanes *by_x, lanes *by_y)
{
    const struct raster *raster = pixels->raster;
    const float *depth = raster->depth + (size_t)row * (size_t)raster->pitch_px + (size_t)column;
    lanes x = LANES_IOTA + ((float)column + 0.5f), y = (lanes){ 0 } + ((float)row + 0.5f), here = *(const lanes *)depth;
    lanes right = { 0 }, below = { 0 };
    struct eight_values values;
    for (int i = 0; i < LANES; i++) {
        right[i] = depth_step(depth + i, 1, column + i > rect->left, column + i < rect->right);
        below[i] = depth_step(depth + i, raster->pitch_px, row > rect->top, row < rect->bottom);
    }
    values_at(pixels, x + 1.0f, y, here + right, &values);
    *by_x = carried_of(pixels, values.value) - carried;
    values_at(pixels, x, y + 1.0f, here + below, &values);
    *by_y = carried_of(pixels, values.value) - carried;
}

/* Computes the marks (contents of pixels) of eight pixels as if all eight showed the field `pixels`. The caller ignores the
   results for other pixels. */
SOFT_INLINE lanes_int marks_of_field(const struct pixel_row *pixels, const struct soft_rect *rect, lanes_int marks, int column, int row)
{
    const struct raster *raster = pixels->raster;
    const struct mark_ink *ink = pixels->ink;
    lanes x = LANES_IOTA + ((float)column + 0.5f), y = (lanes){ 0 } + ((float)row + 0.5f), by_x = { 0 }, by_y = { 0 };
    lanes light = __builtin_convertvector((marks & 0xff) - raster->row_bias, lanes);
    struct eight_values values;
    values_at(pixels, x, y, *(const lanes *)(raster->depth + (size_t)row * (size_t)raster->pitch_px + (size_t)column), &values);
    lanes carried = carried_of(pixels, values.value);
    if (ink->line_px > 0)
        carried_steps(pixels, rect, column, row, carried, &by_x, &by_y);
    marks = ink->rich ? rich_mark(carried, by_x, by_y, light, ink) : field_mark(carried, light, ink->last_row);
    struct eight_patterns patterns = { values.no_data, values.uncertain, values.no_limits & -(int32_t)ink->rich };
    if (!lanes_any(patterns.no_data | patterns.uncertain | patterns.no_limits))
        return marks;
    return pattern_marks(marks, &patterns, light, x, (float)row + 0.5f, ink);
}

/* Finds those of eight pixels whose mark (colour code) is MARK_PIXELS, which means that the field must be evaluated at the
   pixel. Replaces the mark by MARK_FIELD with the evaluated colour. Pixels that show the same field are evaluated together. */
SOFT_INLINE void evaluate_eight(const struct raster *raster, const struct soft_rect *rect, const struct mark_ink *ink, int column, int row)
{
    lanes_int *at = (lanes_int *)(raster->marks + (size_t)row * (size_t)raster->pitch_px + (size_t)column), marks = *at, out = marks;
    uint32_t waiting = lanes_bits(((marks & (int32_t)MARK_KIND) == 0) & (marks != 0));
    while (waiting) {
        uint32_t first = (uint32_t)marks[__builtin_ctz(waiting)];
        const struct soft_pixels *of = &raster->pixels[(first & ~MARK_PIXELS) >> 16 << 8 | (first >> 8 & 0xff)];
        struct pixel_row pixels = { raster, of, &of->every, ink };
        lanes_int same = (marks & ~0xff) == (int32_t)(first & ~0xffu);
        out = lanes_choose_int(same, marks_of_field(&pixels, rect, marks, column, row), out);
        waiting &= ~lanes_bits(same);
    }
    *at = out;
}

/* --- fields of many sensors, evaluated with sensor lists for squares of pixels ------------------------------------------------- */

struct many { /* the pixels in one square of the frame that show the same field; the field has many sensors */
    const struct raster *raster;
    const struct soft_pixels *pixels;
    const struct soft_rect *rect;
    int left, top;
    uint32_t mark; /* mark (colour code) of the pixels that show the field, without its low byte, which is the row of the colour map */
};

SOFT_INLINE lanes_int *marks_of_many(const struct many *many, int column, int row)
{
    return (lanes_int *)(many->raster->marks + (size_t)row * (size_t)many->raster->pitch_px + (size_t)column);
}

SOFT_INLINE lanes_int is_of_many(const struct many *many, lanes_int marks)
{
    return (marks & ~0xff) == (int32_t)many->mark;
}

/* Sets the box of *cell (a square of pixels) so that it encloses the surface points of all its pixels that show the field. Returns false if
   no pixel of the cell shows the field. */
SOFT_INLINE bool bound_cell(const struct many *many, int column, int top, struct pixel_cell *cell)
{
    const struct raster *raster = many->raster;
    lanes low[3], high[3], at[4];
    bool any = false;
    for (int c = 0; c < 3; c++) {
        low[c] = (lanes){ 0 } + INFINITY;
        high[c] = -low[c];
    }
    for (int i = 0; i < CELL_PX * CELL_PX / LANES; i++) {
        int x = column + i % (CELL_PX / LANES) * LANES, y = top + i / (CELL_PX / LANES);
        if (x > many->rect->right || y > many->rect->bottom)
            continue;
        lanes_int same = is_of_many(many, *marks_of_many(many, x, y));
        if (!lanes_any(same))
            continue;
        any = true;
        lanes depth = *(const lanes *)(raster->depth + (size_t)y * (size_t)raster->pitch_px + (size_t)x);
        places_at(many->pixels, LANES_IOTA + ((float)x + 0.5f), (lanes){ 0 } + ((float)y + 0.5f), depth, at);
        for (int c = 0; c < 3; c++) {
            low[c] = lanes_choose(same, lanes_least(at[c], low[c]), low[c]);
            high[c] = lanes_choose(same, lanes_most(at[c], high[c]), high[c]);
        }
    }
    for (int c = 0; c < 3 && any; c++) {
        cell->low[c] = low[c][0];
        cell->high[c] = high[c][0];
        for (int i = 1; i < LANES; i++) {
            cell->low[c] = low[c][i] < cell->low[c] ? low[c][i] : cell->low[c];
            cell->high[c] = high[c][i] > cell->high[c] ? high[c][i] : cell->high[c];
        }
    }
    return any;
}

SOFT_INLINE void evaluate_cell(const struct many *many, const struct mark_ink *ink, const struct pixel_list *list)
{
    int column = many->left + CELL_PX * (int)list->column, top = many->top + CELL_PX * (int)list->row;
    struct pixel_row pixels = { many->raster, many->pixels, list, ink };
    for (int i = 0; i < CELL_PX * CELL_PX / LANES; i++) {
        int x = column + i % (CELL_PX / LANES) * LANES, y = top + i / (CELL_PX / LANES);
        if (x > many->rect->right || y > many->rect->bottom)
            continue;
        lanes_int *at = marks_of_many(many, x, y), marks = *at, same = is_of_many(many, marks);
        if (lanes_any(same))
            *at = lanes_choose_int(same, marks_of_field(&pixels, many->rect, marks, x, y), marks);
    }
}

SOFT_INLINE void evaluate_square(const struct many *many, const struct mark_ink *ink, float step, struct pixel_lists *lists)
{
    struct pixel_cell cells[SQUARE_CELLS * SQUARE_CELLS];
    size_t count = 0;
    for (uint32_t i = 0; i < SQUARE_CELLS * SQUARE_CELLS; i++) {
        uint32_t across, down;
        pixel_cell_from_order(i, &across, &down);
        int column = many->left + CELL_PX * (int)across, row = many->top + CELL_PX * (int)down;
        cells[count].column = (uint16_t)across;
        cells[count].row = (uint16_t)down;
        if (column <= many->rect->right && row <= many->rect->bottom && bound_cell(many, column, row, &cells[count]))
            count++;
    }
    lists->count = lists->sensor_count = 0;
    if (count == 0)
        return;
    pixel_lists_add(lists, &many->pixels->field, step, cells, count);
    pixel_lists_settle(lists);
    for (size_t i = 0; i < lists->count; i++)
        evaluate_cell(many, ink, &lists->lists[i]);
}

SOFT_INLINE void evaluate_many(const struct raster *raster, const struct soft_rect *rect, const struct mark_ink *ink, size_t number)
{
    const struct soft_rect *found = &raster->found[raster->pixels[number].mesh].rect;
    const float step = pixel_lists_step(raster->block.scale);
    const int size = SQUARE_CELLS * CELL_PX;
    struct pixel_lists lists = { 0 };
    struct many many = { raster, &raster->pixels[number], rect, 0, 0, MARK_PIXELS | (uint32_t)number >> 8 << 16 | (number & 0xff) << 8 };
    for (many.top = rect->top; many.top <= rect->bottom; many.top += size)
        for (many.left = rect->left; many.left <= rect->right; many.left += size)
            if (many.top <= found->bottom && many.top + size > found->top && many.left <= found->right && many.left + size > found->left)
                evaluate_square(&many, ink, step, &lists);
    pixel_lists_finish(&lists);
}

SOFT_INLINE void evaluate_fields(const struct raster *raster, const struct soft_rect *rect)
{
    struct mark_ink ink = ink_of(raster);
    for (size_t i = 0; i < raster->pixels_count; i++)
        if (raster->pixels[i].field.count > PIXEL_FEW)
            evaluate_many(raster, rect, &ink, i);
    for (int row = rect->top; row <= rect->bottom && raster->pixels_count > 0; row++)
        for (int column = rect->left; column <= rect->right; column += LANES)
            evaluate_eight(raster, rect, &ink, column, row);
}

/* Writes the colours of the pixels in columns left to right of a row of the preview. out: address of the pixel at column 0 of
   the row. */
SOFT_INLINE void color_row(const struct raster *raster, int left, int right, int row, uint8_t *out)
{
    struct heights heights = { 0 };
    struct sun_aim aims[AIMS]; /* ring buffer of shadow lookups that are started but not finished; index: column / LANES, modulo AIMS */
    for (int column = left - BOUNDS_AHEAD; column <= right; column += LANES) {
        int aimed = column + BOUNDS_AHEAD, bounded = column + SHADOWS_AHEAD;
        if (aimed <= right)
            aim_at_sun(raster, aimed, row, &aims[aimed / LANES % AIMS]);
        if (bounded >= left && bounded <= right)
            bound_shadows(raster, &aims[bounded / LANES % AIMS]);
        if (column < left)
            continue;
        if ((column & (raster->stretch_px - 1)) == 0)
            heights = heights_from(raster, column, row);
        lanes_int color = color_at(raster, &heights, &aims[column / LANES % AIMS], column, row);
        int count = raster->width_px - column;
        memcpy(out + 4 * column, &color, count < LANES ? 4 * (size_t)count : sizeof(color));
    }
}

void raster_color(const struct raster *raster, const struct soft_rect *rect)
{
    evaluate_fields(raster, rect);
    for (int row = rect->top; row <= rect->bottom; row++)
        color_row(raster, rect->left, rect->right, row, raster->out + (size_t)row * raster->out_stride_bytes);
}
