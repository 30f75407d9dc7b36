/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses and carries out messages about saved views, and describes the content of control-room walls as JSON. */
#include "message/views_message.h"

#include <stdio.h>
#include <string.h>

#include "base/text/json_text.h"
#include "message/json_fields.h"
#include "message/json_values.h"

static bool parse_id(const json_t *o, struct message *out, struct message_error *error)
{
    struct named_view_edit *edit = &out->view_edit;
    if (!need_seq(o, &out->seq, error) || !need_words(o, "id", true, edit->id, sizeof(edit->id), error))
        return false;
    if (named_view_id_valid(edit->id))
        return true;
    message_fail(error, "bad_field", "id: expected letters, digits, '_', '-' and '.'");
    return false;
}

static bool parse_address(const json_t *o, struct named_view_edit *edit, struct message_error *error)
{
    if (!need_words(o, "view", true, edit->address, sizeof(edit->address), error))
        return false;
    const char *wrong = named_view_address_wrong(edit->address);
    if (wrong)
        message_fail(error, "bad_field", "view: %s", wrong);
    return !wrong;
}

bool save_view_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    struct named_view_edit *edit = &out->view_edit;
    double at = -1;
    (void)plant;
    if (!parse_id(o, out, error) || !need_words(o, "title", true, edit->title, sizeof(edit->title), error) ||
        !parse_address(o, edit, error) || !may_number(o, "at", 0, NAMED_VIEWS, &at, NULL, error))
        return false;
    edit->at = (int)at;
    return true;
}

bool share_view_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    (void)plant;
    return need_seq(o, &out->seq, error) && parse_address(o, &out->view_edit, error);
}

bool remove_view_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    (void)plant;
    return parse_id(o, out, error);
}

char *view_edit_do(struct named_views *views, const struct message *message, const char *who, int64_t time_us)
{
    const struct named_view_edit *edit = &message->view_edit;
    bool saves = message->type == MESSAGE_SAVE_VIEW;
    enum refusal_code why = saves ? named_views_save(views, edit, who, time_us) : named_views_remove(views, edit->id);
    json_t *answer = json_pack("{s:s,s:I,s:s,s:b}", "type", "view_saved", "seq", (json_int_t)message->seq, "id", edit->id, "kept", !why);
    refusal_add(answer, why);
    return json_text(answer, 0);
}

char *share_view_do(struct short_links *links, const struct message *message, int64_t time_us, char added[SHORT_LINK_ID_BYTES])
{
    char id[SHORT_LINK_ID_BYTES];
    bool is_new;
    enum refusal_code why = short_links_share(links, message->view_edit.address, time_us, id, &is_new);
    snprintf(added, SHORT_LINK_ID_BYTES, "%s", is_new ? id : "");
    json_t *answer = json_pack("{s:s,s:I,s:s,s:b}", "type", "view_shared", "seq", (json_int_t)message->seq, "id", id, "kept", !why);
    refusal_add(answer, why);
    return json_text(answer, 0);
}

/* Describes a pane (a part of a wall's display) as JSON. A tour, which shows views in turn, becomes a list of views with their
   durations. */
static json_t *pane_of(const struct plant *plant, const struct wall_pane *pane)
{
    const struct tour *tour = pane->kind == PANE_TOUR ? tour_find(plant, pane->items[0]) : NULL;
    json_t *items = json_array(), *stops = json_array();
    for (size_t i = 0; i < pane->item_count && !tour; i++)
        json_array_append_new(items, json_string(pane->items[i]));
    for (size_t i = 0; tour && i < tour->stop_count; i++) {
        json_array_append_new(items, json_string(tour->stops[i].view));
        json_array_append_new(stops, json_pack("{s:f,s:o}", "dwell_s", tour->stops[i].dwell_s, "text", string(tour->stops[i].text)));
    }
    json_t *said = json_pack("{s:s,s:s,s:o,s:o,s:f,s:f,s:b}", "area", pane->area, "kind", tour ? "views" : pane_kind_names[pane->kind],
                             "title", string(pane->title), "items", items, "every_s", pane->every_s, "hours", pane->hours, "on_alarm",
                             pane->on_alarm);
    if (tour)
        json_object_set(said, "stops", stops);
    json_decref(stops);
    return said;
}

static bool sees(const struct walls_reader *reader, const char *view)
{
    return !reader->sees || reader->sees(reader->arg, view);
}

static bool sees_tour(const struct walls_reader *reader, const struct tour *tour)
{
    for (size_t i = 0; i < tour->stop_count; i++)
        if (!sees(reader, tour->stops[i].view))
            return false;
    return true;
}

static bool sees_pane(const struct plant *plant, const struct walls_reader *reader, const struct wall_pane *pane)
{
    if (!reader->sees)
        return true;
    if (pane->kind == PANE_TOUR)
        return sees_tour(reader, tour_find(plant, pane->items[0]));
    for (size_t i = 0; i < pane->item_count && pane->kind == PANE_VIEWS; i++)
        if (!sees(reader, pane->items[i]))
            return false;
    return pane->kind == PANE_VIEWS || pane->kind == PANE_CLOCK || pane->kind == PANE_TEXT;
}

static bool is_told(const struct plant *plant, const struct walls_reader *reader, const struct tour *tour)
{
    if (!reader->wall)
        return sees_tour(reader, tour);
    return wall_display_has(wall_display_find(plant, reader->wall, reader->display), PANE_TOUR, tour->id);
}

static json_t *tours_of(const struct plant *plant, const struct walls_reader *reader)
{
    json_t *tours = json_array();
    for (size_t t = 0; t < plant->screens.tour_count; t++) {
        const struct tour *tour = &plant->screens.tours[t];
        if (!is_told(plant, reader, tour))
            continue;
        json_t *stops = json_array();
        for (size_t s = 0; s < tour->stop_count; s++) {
            const struct tour_stop *stop = &tour->stops[s];
            const char *address = named_view_find(plant, stop->view)->address;
            json_array_append_new(stops, json_pack("{s:s,s:s,s:f,s:o}", "id", stop->view, "view", address, "dwell_s", stop->dwell_s, "text",
                                                   string(stop->text)));
        }
        json_array_append_new(tours, json_pack("{s:s,s:o}", "id", tour->id, "stops", stops));
    }
    return tours;
}

static json_t *display_of(const struct plant *plant, const struct walls_reader *reader, const struct wall *wall, size_t number)
{
    const struct wall_display *display = &wall->displays[number];
    json_t *rows = json_array(), *panes = json_array();
    for (size_t i = 0; i < display->row_count; i++)
        json_array_append_new(rows, json_string(display->rows[i]));
    for (size_t i = 0; i < display->pane_count; i++)
        if (sees_pane(plant, reader, &display->panes[i]))
            json_array_append_new(panes, pane_of(plant, &display->panes[i]));
    if (number < (size_t)(wall->tile.columns * wall->tile.rows) && json_array_size(panes) > 0)
        json_object_set_new(json_array_get(panes, 0), "tile", json_pack("{s:i,s:i,s:I}", "columns", wall->tile.columns, "rows",
                                                                        wall->tile.rows, "number", (json_int_t)number + 1));
    return json_pack("{s:o,s:o}", "grid", rows, "panes", panes);
}

/* Lists the displays of a wall as JSON. A display that the client (reader) may not see is listed without content, so that the
   numbers of the others stay the same. */
static json_t *displays_of(const struct plant *plant, const struct walls_reader *reader, const struct wall *wall)
{
    json_t *displays = json_array();
    for (size_t d = 0; d < wall->display_count; d++)
        json_array_append_new(displays, !reader->wall || (int)d + 1 == reader->display ? display_of(plant, reader, wall, d)
                                                                                       : json_pack("{s:[],s:[]}", "grid", "panes"));
    return displays;
}

char *walls_text(const struct plant *plant, const struct walls_reader *reader)
{
    static const struct walls_reader anyone;
    reader = reader ? reader : &anyone;
    json_t *walls = json_array();
    for (size_t i = 0; i < plant->screens.wall_count; i++) {
        const struct wall *wall = &plant->screens.walls[i];
        if (reader->wall && strcmp(wall->id, reader->wall) != 0)
            continue;
        json_t *said = json_pack("{s:s,s:f,s:f,s:o}", "id", wall->id, "inches", wall->inches, "distance_m", wall->metres, "displays",
                                 displays_of(plant, reader, wall));
        if (wall->dim.from_min != wall->dim.to_min)
            json_object_set_new(said, "dim", json_pack("{s:i,s:i,s:f}", "from_min", wall->dim.from_min, "to_min", wall->dim.to_min,
                                                       "percent", wall->dim_percent));
        json_array_append_new(walls, said);
    }
    return json_text(json_pack("{s:o,s:o}", "walls", walls, "tours", tours_of(plant, reader)), 9);
}
