/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses messages about wall displays, and sends views to panes, which are parts of displays. Messages identify a pane by wall,
   display and area, as in the plant file. */
#include "message/wall_message.h"

#include <string.h>

#include "base/text/json_text.h"
#include "message/json_fields.h"

static bool place_parse(const struct plant *plant, const json_t *o, bool pane, struct message *out, struct message_error *error)
{
    struct wall_place *place = &out->wall.place;
    double display;
    if (!need_words(o, "wall", true, place->wall, sizeof(place->wall), error) ||
        !need_number(o, "display", 1, WALL_DISPLAYS, &display, error) ||
        (pane && !need_words(o, "area", true, place->area, sizeof(place->area), error)))
        return false;
    place->display = (int)display;
    const char *wrong = wall_place_wrong(plant, place);
    if (wrong)
        message_fail(error, "bad_field", "%s", wrong);
    return !wrong;
}

bool tile_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    const json_t *tile = json_object_get(o, "tile");
    struct message place = { 0 };
    if (!tile)
        return true;
    if (!place_parse(plant, tile, false, &place, error))
        return false;
    const struct wall *wall = wall_find(plant, place.wall.place.wall);
    if (place.wall.place.display > wall->tile.columns * wall->tile.rows) {
        message_refuse_with(error, "bad_field", "tile", REFUSAL_TILELESS, "display=%d\nwall=%s", place.wall.place.display, wall->id);
        return false;
    }
    out->hello.tile = place.wall.place;
    return true;
}

bool display_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    return place_parse(plant, o, false, out, error);
}

bool send_to_wall_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    struct named_view_edit *edit = &out->view_edit;
    if (!need_seq(o, &out->seq, error) || !place_parse(plant, o, true, out, error) ||
        !need_words(o, "view", false, edit->address, sizeof(edit->address), error) ||
        !need_words(o, "title", false, edit->title, sizeof(edit->title), error) ||
        !need_words(o, "desk", false, out->wall.desk, sizeof(out->wall.desk), error))
        return false;
    out->wall.held = json_is_true(json_object_get(o, "held"));
    const char *wrong = edit->address[0] ? named_view_address_wrong(edit->address) : NULL;
    if (wrong)
        message_fail(error, "bad_field", "view: %s", wrong);
    return !wrong;
}

bool point_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    return place_parse(plant, o, true, out, error) && need_words(o, "desk", false, out->wall.desk, sizeof(out->wall.desk), error) &&
           may_vector(o, "position", out->wall.position_m, &out->wall.has_position, error);
}

bool pair_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    char *digits = out->pair.digits;
    (void)plant;
    if (!need_seq(o, &out->seq, error) || !need_words(o, "digits", true, digits, sizeof(out->pair.digits), error))
        return false;
    if (strspn(digits, "0123456789") == sizeof(out->pair.digits) - 1)
        return true;
    message_fail(error, "bad_field", "digits: expected the six digits that the display shows");
    return false;
}

bool unpair_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    (void)plant;
    return need_seq(o, &out->seq, error) && need_words(o, "id", true, out->pair.device, sizeof(out->pair.device), error);
}

char *send_to_wall_do(struct wall_remote *remote, const struct message *message, const char *who, int64_t now_us)
{
    const struct wall_order order = { .place = message->wall.place,
                                      .view = message->view_edit.address,
                                      .title = message->view_edit.title,
                                      .held = message->wall.held,
                                      .desk = message->wall.desk };
    enum refusal_code why = wall_remote_order(remote, &order, who, now_us);
    json_t *answer = json_pack("{s:s,s:I,s:b}", "type", "sent_to_wall", "seq", (json_int_t)message->seq, "kept", !why);
    refusal_add(answer, why);
    return json_text(answer, 0);
}
