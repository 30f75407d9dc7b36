/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides what a narrowed token lets a session see and send: only certain views of the plant file or, for a paired device, only
   what its display shows. */
#include <jansson.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "message/json_fields.h"
#include "message/json_values.h"
#include "message/view_named.h"
#include "plant/plant.h"
#include "session/reply/reply.h"
#include "session/session_impl.h"

enum { LEAST_PX = 16 };

/* --- views of the plant file ------------------------------------------------------------------------------------------------ */

const char *session_scope_find_view(const struct plant_services *services, enum role role, const struct token_holder *holder,
                                    const char *id, const char *about, struct message_error *error)
{
    bool sees_saved = role >= ROLE_VIEWER && !holder->views[0] && !holder->display && services->named_views;
    char name[48];
    if (!tokens_may_see(holder, id)) {
        message_refuse_with(error, "not_allowed", about, REFUSAL_TOKEN_VIEWS, "name=%s\nviews=%.150s", quoted(id, name), holder->views);
        return NULL;
    }
    const struct named_view *fixed = named_view_find(services->scene->plant, id);
    const char *address = fixed ? fixed->address : sees_saved ? named_views_address(services->named_views, id) : NULL;
    if (!address)
        message_refuse_with(error, "bad_field", about, REFUSAL_NO_VIEW, "name=%s", quoted(id, name));
    return address;
}

/* Replaces the contents of a view. Keeps its size, backdrop, sequence numbers and trial, and the past instant that the session shows. */
static void replace_view(struct view *view, const struct view *by)
{
    const struct view before = *view;
    *view = *by;
    view->width_px = before.width_px;
    view->height_px = before.height_px;
    view->pixel_ratio = before.pixel_ratio;
    view->camera_seq = before.camera_seq;
    view->params_seq = before.params_seq;
    view->tier = before.tier;
    view->dark = before.dark;
    view_set_instant(view, before.at_us, before.field.slot);
    view_set_trial(view, before.field.trial);
}

/* Sets *view to a saved view, even one that the session may not see, but keeps the size of `view`. Returns false with *error if
   the view cannot be shown live. */
static bool read_view(const struct session *session, const char *id, struct view *view, struct message_error *error)
{
    const struct session_context *context = session->context;
    /* bare: the saved view is parsed without the present readings. With them, parsing could save a baseline (stored readings),
       which requires the role operator */
    const struct params_context params = { .scene = context->services->scene, .baselines = context->services->baselines, .bare = true };
    struct view read;
    const char *address = session_scope_find_view(context->services, session->identity.role, &session->identity.holder, id, "named", error);
    if (!address || !view_named_read(&params, address, view->width_px, view->height_px, &read, error))
        return false;
    if (read.at_us) {
        message_fail(error, "bad_field", "named: view '%.48s' shows a past time, but a stream shows only the present", id);
        return false;
    }
    replace_view(view, &read);
    return true;
}

bool session_look(struct session *session, const char *id, struct view *view, struct message_error *error)
{
    if (!read_view(session, id, view, error))
        return false;
    snprintf(session->scope.named, sizeof(session->scope.named), "%s", id);
    return true;
}

void session_look_new(const struct session *session, struct view *view)
{
    struct view fresh;
    view_default(session->context->services->scene, view->width_px, view->height_px, &fresh);
    replace_view(view, &fresh);
}

/* Returns the id of the plant file's first view that the token allows; NULL: none. */
static const char *first_view(const struct session *session)
{
    const struct plant *plant = session->context->plant;
    for (size_t i = 0; i < plant->screens.view_count; i++)
        if (tokens_may_see(&session->identity.holder, plant->screens.views[i].id))
            return plant->screens.views[i].id;
    return NULL;
}

bool session_scope_view(struct session *session, const char *id, struct view *view, struct message_error *error)
{
    const char *first = id[0] ? id : first_view(session);
    if (first && session_look(session, first, view, error))
        return true;
    if (!first)
        message_fail(error, "not_allowed", "this token is for the views %.150s, but the plant file has none of them",
                     session->identity.holder.views);
    session_close(session, 1008, "this token is not valid for this view");
    return false;
}

json_t *session_scope_views(const struct session *session)
{
    const struct plant *plant = session->context->plant;
    json_t *list = json_array();
    for (size_t i = 0; i < plant->screens.view_count; i++) {
        const struct named_view *view = &plant->screens.views[i];
        if (!tokens_may_see(&session->identity.holder, view->id))
            continue;
        json_t *o = json_pack("{s:s,s:s}", "id", view->id, "title", view->title ? view->title : view->id);
        reply_add_wrong(session->context, o, view->address);
        json_array_append_new(list, o);
    }
    return list;
}

/* --- a paired display ------------------------------------------------------------------------------------------------------- */

static const struct wall_display *display_of(const struct session *session)
{
    return wall_display_find(session->context->plant, session->identity.holder.wall, session->identity.holder.display);
}

void session_scope_begin(struct session *session)
{
    const struct plant *plant = session->context->plant;
    const struct token_holder *holder = &session->identity.holder;
    mem_free(session->scope.tags);
    session->scope.tags = NULL;
    if (!holder->display)
        return;
    const struct wall_display *display = display_of(session);
    session->display = (struct wall_place){ .display = holder->display };
    snprintf(session->display.wall, sizeof(session->display.wall), "%s", holder->wall);
    if (wall_display_has_pictures(display))
        return;
    session->scope.tags = mem_array(plant->tag_count + 1, sizeof(*session->scope.tags));
    for (size_t i = 0; i < plant->tag_count; i++)
        session->scope.tags[i] = wall_display_shows_tag(display, plant->tags[i].name);
}

void session_scope_end(struct session *session)
{
    mem_free(session->scope.tags);
    session->scope.tags = NULL;
}

void session_scope_fit(const struct session *session, struct view *view)
{
    if (session->scope.tags)
        view->width_px = view->height_px = LEAST_PX;
}

static bool shows_row(const struct session *session, const json_t *row)
{
    const json_t *tag = json_array_get(row, 0);
    return json_is_integer(tag) && json_integer_value(tag) >= 0 && session->scope.tags[json_integer_value(tag)];
}

static bool shows_alarm(const struct session *session, const json_t *row)
{
    return wall_display_has(display_of(session), PANE_ALARMS, NULL) || shows_row(session, row);
}

static bool is_own(const struct session *session, const json_t *item)
{
    const char *wall = json_string_value(json_object_get(item, "wall"));
    return wall && !strcmp(wall, session->identity.holder.wall) &&
           json_integer_value(json_object_get(item, "display")) == session->identity.holder.display;
}

/* Returns whether an item of a JSON list (`item`) is for the display of this session. Items for a picture across many displays
   are listed under the first of these displays. */
static bool is_ours(const struct session *session, const json_t *item)
{
    const char *id = json_string_value(json_object_get(item, "wall"));
    const struct wall *wall = wall_find(session->context->plant, session->identity.holder.wall);
    bool is_tile = wall && session->identity.holder.display <= wall->tile.columns * wall->tile.rows;
    return is_own(session, item) || (is_tile && id && !strcmp(id, wall->id) && json_integer_value(json_object_get(item, "display")) == 1);
}

static bool shows_view(const struct session *session, const json_t *item)
{
    const char *id = json_string_value(json_object_get(item, "id"));
    return id && wall_display_shows_view(session->context->plant, display_of(session), id);
}

static bool shows_note(const struct session *session, const json_t *item)
{
    (void)item;
    return !session->scope.tags;
}

/* Lists in messages that are filtered for a narrowed token: type of the message, name of the list in it, and a test for its
   items. Items that fail the test are not sent. */
static const struct {
    const char *type, *list;
    bool (*keeps)(const struct session *session, const json_t *item);
    bool of_tags; /* true: the list is filtered only for a display without pictures, which gets the entries for the tags that it shows */
} filters[] = {
    { "tags", "values", shows_row, true },  { "alarms", "alarms", shows_alarm, true }, { "views", "list", shows_view, false },
    { "notes", "list", shows_note, false }, { "walls", "list", is_ours, false },       { "walls", "displays", is_own, false },
    { "pointed", "list", is_ours, false },
};

static void filter(const struct session *session, json_t *message, size_t i)
{
    json_t *list = json_object_get(message, filters[i].list);
    for (size_t n = json_array_size(list); n-- > 0;)
        if (!filters[i].keeps(session, json_array_get(list, n)))
            json_array_remove(list, n);
}

char *session_scope_text(const struct session *session, char *text)
{
    if (!session->identity.holder.display)
        return text;
    json_t *message = json_loads(text, 0, NULL);
    const char *type = json_string_value(json_object_get(message, "type"));
    bool filtered = false;
    for (size_t i = 0; type && i < sizeof(filters) / sizeof(filters[0]); i++)
        if (!strcmp(type, filters[i].type) && !(filters[i].of_tags && !session->scope.tags)) {
            filter(session, message, i);
            filtered = true;
        }
    if (!filtered) {
        json_decref(message);
        return text;
    }
    mem_free(text);
    return json_text(message, READING_DIGITS);
}

/* --- which messages may be sent --------------------------------------------------------------------------------------------- */

static bool is_in(enum message_type type, const enum message_type *list, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (list[i] == type)
            return true;
    return false;
}

bool session_scope_allows(const struct session *session, const struct message *message, struct message_error *error)
{
    static const enum message_type views[] = { MESSAGE_HELLO,  MESSAGE_LOOK,    MESSAGE_RESIZE,    MESSAGE_ACK,
                                               MESSAGE_CODECS, MESSAGE_VISIBLE, MESSAGE_KEY_FRAME, MESSAGE_PING };
    static const enum message_type displays[] = { MESSAGE_HELLO,   MESSAGE_LOOK,      MESSAGE_CAMERA, MESSAGE_PARAMS,
                                                  MESSAGE_FIT,     MESSAGE_RESIZE,    MESSAGE_ACK,    MESSAGE_CODECS,
                                                  MESSAGE_VISIBLE, MESSAGE_KEY_FRAME, MESSAGE_PING,   MESSAGE_DISPLAY };
    const struct token_holder *holder = &session->identity.holder;
    if (holder->views[0] && !is_in(message->type, views, sizeof(views) / sizeof(views[0])))
        message_fail(error, "not_allowed",
                     "this token permits only pictures of the views %.150s: send only hello, look, resize, ack, codecs, visible, "
                     "key_frame and ping",
                     holder->views);
    else if (holder->display && !is_in(message->type, displays, sizeof(displays) / sizeof(displays[0])) &&
             /* lets a display that shows pictures (not only trends of tags) send picks: its page uses them to find a free side
                for an alarm's label */
             (message->type != MESSAGE_PICK || session->scope.tags))
        message_fail(error, "not_allowed",
                     "this token belongs to display %d of wall %s, and permits only the messages that a display sends", holder->display,
                     holder->wall);
    else
        return true;
    return false;
}
