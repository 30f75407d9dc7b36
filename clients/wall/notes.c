/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clients/web/core/notes.js says the same of where they are, and until when; clients/web/app/notes/notes.css of how they look. */
#include "notes.h"

#include <math.h>
#include <string.h>

#include "brush.h"

static const double LETTERS = 12.5, HIGH = 17, WIDEST = 230, PAD = 8, STEM = 9; /* units */

static bool is_in_force(const struct model *model, const json_t *note)
{
    int64_t until_us = json_integer_value(json_object_get(note, "until_us"));
    return until_us == 0 || until_us > model_now_us(model);
}

/* False: what it is at is not in this plant. */
static bool place_of(const struct model *model, const json_t *note, double place_m[3])
{
    const json_t *position = json_object_get(note, "position");
    const char *tag_name = json_string_value(json_object_get(note, "tag")), *asset_id = json_string_value(json_object_get(note, "asset"));
    int tag = tag_name ? plant_find_tag(&model->plant, tag_name) : -1, asset = asset_id ? plant_find_asset(&model->plant, asset_id) : -1;
    for (size_t i = 0; i < 3 && json_array_size(position) == 3; i++)
        place_m[i] = json_number_value(json_array_get(position, i));
    if (json_array_size(position) == 3)
        return true;
    if (tag_name) {
        if (tag < 0 || !model->plant.tags[tag].has_position)
            return false;
        memcpy(place_m, model->plant.tags[tag].position_m, 3 * sizeof(*place_m));
        return true;
    }
    if (asset < 0)
        return false;
    const struct scene_asset *at = &model->scene.assets[asset];
    for (int i = 0; i < 3; i++)
        place_m[i] = i < 2 ? 0.5 * (at->bounds_min_m[i] + at->bounds_max_m[i]) : at->bounds_max_m[i];
    return true;
}

void notes_say(const struct model *model, struct text *said)
{
    for (size_t i = 0; i < json_array_size(model->notes); i++) {
        const json_t *note = json_array_get(model->notes, i);
        const char *id = json_string_value(json_object_get(note, "id"));
        if (is_in_force(model, note))
            text_add(said, " %s", id ? id : "?");
    }
}

struct pin_look {
    uint32_t paper, edge, ink;
    bool bold;
};

static void draw_pin(cairo_t *cairo, double x, double y, double unit, const struct pin_look *look, const char *text)
{
    double wide = fmin(WIDEST * unit, brush_measure(cairo, LETTERS * unit, look->bold, text).width + 2 * PAD * unit + 2);
    double line = fmax(1, unit);
    struct box box = { round(x), round(y - (HIGH + 3 + STEM) * unit), wide, (HIGH + 3) * unit };
    brush_fill(cairo, &(struct box){ box.x - line, box.y - line, box.width + 2 * line, box.height + 2 * line }, look->edge);
    brush_fill(cairo, &box, look->paper);
    brush_fill(cairo, &(struct box){ box.x - line, box.y + box.height, 1.5 * line, STEM * unit }, look->edge);
    struct box inner = { box.x + PAD * unit, box.y + unit, box.width - 2 * PAD * unit, box.height };
    brush_text(cairo, &inner, LETTERS * unit, look->bold, look->ink, ALIGN_LEFT, false, text);
}

/* Of a tile also what stands on one beside it, and reaches over. */
void notes_draw(const struct view_pane *pane, const struct model *model, cairo_t *cairo, double x, double y)
{
    static const struct pin_look look = { 0xfff7d6, 0x8a7a3c, INK, false };
    for (size_t i = 0; i < json_array_size(model->notes); i++) {
        const json_t *note = json_array_get(model->notes, i);
        const char *text = json_string_value(json_object_get(note, "text"));
        double place_m[3], at_x, at_y;
        if (text && is_in_force(model, note) && place_of(model, note, place_m) && view_pane_project(pane, place_m, &at_x, &at_y))
            draw_pin(cairo, x + at_x, y + at_y, pane->unit, &look, text);
    }
}

void notes_draw_pointer(const struct view_pane *pane, cairo_t *cairo, double x, double y, const double place_m[3], const char *by)
{
    static const struct pin_look look = { INK, WHITE, WHITE, true };
    double at_x, at_y, radius = 22 * pane->unit;
    if (!view_pane_project(pane, place_m, &at_x, &at_y))
        return;
    for (int pass = 0; pass < 2; pass++) {
        cairo_new_path(cairo);
        cairo_arc(cairo, x + at_x, y + at_y, radius, 0, 2 * M_PI);
        cairo_set_line_width(cairo, (pass ? 3 : 7) * pane->unit);
        brush_colour(cairo, pass ? 0xc70d99 : WHITE);
        cairo_stroke(cairo);
    }
    draw_pin(cairo, x + at_x, y + at_y, pane->unit, &look, by);
}
