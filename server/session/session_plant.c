/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Moves a session to a reloaded plant: carries its view over by names, and drops what the new plant lacks. */
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "session/reply/reply.h"
#include "session/session_impl.h"

/* Describes the view by names, in the format of the server's `params` message. The extra object `start` lists the assets that
   are not shown at first (hidden, ghosted) according to the plant file. */
char *session_carried_text(const struct session_context *context, const struct view *view)
{
    char *said = reply_params_text(context, view, 0, false);
    json_t *o = json_loads(said, 0, NULL), *start = json_object();
    for (size_t i = 0; i < context->plant->asset_count; i++)
        if (context->plant->assets[i].start != PLANT_START_SHOWN)
            json_object_set_new(start, context->plant->assets[i].id, json_integer(context->plant->assets[i].start));
    json_object_set_new(o, "start", start);
    double low, high;
    field_default_range(context->services->scene, &view->field, &low, &high);
    /* leaves out a range that equals the group's default, because the new plant may have another default */
    if (view->range_min == low && view->range_max == high)
        json_object_del(o, "range");
    char *dumped = json_dumps(o, JSON_COMPACT), *carried = mem_strdup(dumped);
    free(dumped);
    json_decref(o);
    mem_free(said);
    return carried;
}

char *session_carry(struct session *session)
{
    session_time_leave(session);
    session_place_leave(session);
    session_drop_ready(session);
    session_forget_depth(session);
    return session->hello ? session_carried_text(session->context, &session->view) : NULL;
}

/* Converts a text of session_carried_text() into the `params` message of a client that requests the same view. */
static json_t *request_of(const char *carried)
{
    static const char *const said_only[] = { "type", "seq", "baselines", "unit" };
    json_t *o = json_loads(carried, 0, NULL), *baseline = json_object_get(o, "baseline");
    for (size_t i = 0; i < sizeof(said_only) / sizeof(said_only[0]); i++)
        json_object_del(o, said_only[i]);
    json_t *name = json_incref(json_object_get(baseline, "name"));
    if (json_is_string(name))
        json_object_set(o, "baseline", name);
    else
        json_object_del(o, "baseline");
    json_decref(name);
    return o;
}

static bool apply(struct session *session, const json_t *request)
{
    struct message message = { .type = MESSAGE_PARAMS };
    struct message_error error = { 0 };
    return params_parse(session->context->plant, request, &message.params, &error) &&
           split_parse(session->context->plant, request, &message.split, &error) &&
           session_apply_params(session, &message, &session->view, &error);
}

/* Removes assets that no longer exist from the lists of hidden, isolated and ghosted assets. */
static void forget_gone(const struct plant *plant, json_t *o)
{
    static const char *const sets[] = { "hidden", "isolate", "ghost" };
    for (size_t i = 0; i < sizeof(sets) / sizeof(sets[0]); i++) {
        json_t *list = json_object_get(o, sets[i]);
        for (size_t n = json_array_size(list); n-- > 0;)
            if (plant_find_asset(plant, json_string_value(json_array_get(list, n))) < 0)
                json_array_remove(list, n);
    }
}

static size_t place_in(const json_t *list, const char *id)
{
    size_t n = 0;
    while (n < json_array_size(list) && strcmp(json_string_value(json_array_get(list, n)), id) != 0)
        n++;
    return n;
}

/* Applies the plant file's changes of assets' initial states (shown, hidden or ghosted). The new initial state applies to new
   assets, and to assets that are still in their old initial state. */
static void start_anew(const struct plant *plant, json_t *o)
{
    static const char *const sets[] = { [PLANT_START_SHOWN] = "", [PLANT_START_GHOST] = "ghost", [PLANT_START_HIDDEN] = "hidden" };
    json_t *before = json_incref(json_object_get(o, "start"));
    json_object_del(o, "start");
    for (size_t i = 0; i < plant->asset_count && i < PLANT_STARTS; i++) {
        const char *id = plant->assets[i].id;
        enum plant_start was = (enum plant_start)json_integer_value(json_object_get(before, id)), now = plant->assets[i].start;
        bool as_it_was = now != was;
        for (int set = PLANT_START_GHOST; as_it_was && set <= PLANT_START_HIDDEN; set++) {
            const json_t *list = json_object_get(o, sets[set]);
            as_it_was = (place_in(list, id) < json_array_size(list)) == (set == (int)was);
        }
        if (!as_it_was)
            continue;
        if (was != PLANT_START_SHOWN)
            json_array_remove(json_object_get(o, sets[was]), place_in(json_object_get(o, sets[was]), id));
        if (now != PLANT_START_SHOWN)
            json_array_append_new(json_object_get(o, sets[now]), json_string(id));
    }
    json_decref(before);
}

/* Applies the carried view as a whole; if that fails, applies each member separately and skips the invalid ones. */
static void apply_carried(struct session *session, const char *carried)
{
    json_t *o = request_of(carried), *value;
    const char *key;
    forget_gone(session->context->plant, o);
    start_anew(session->context->plant, o);
    if (o && !apply(session, o)) {
        json_t *group = json_pack("{s:O}", "group", json_object_get(o, "group"));
        apply(session, group);
        json_decref(group);
        json_object_del(o, "group");
        json_object_foreach(o, key, value)
        {
            json_t *one = json_pack("{s:O}", key, value);
            apply(session, one);
            json_decref(one);
        }
    }
    json_decref(o);
}

void session_look_again(struct session *session, const struct view *before, const char *carried)
{
    view_default(session->context->services->scene, before->width_px, before->height_px, &session->view);
    session->view.camera = before->camera;
    session->view.camera_seq = before->camera_seq;
    session->view.params_seq = before->params_seq;
    apply_carried(session, carried);
}

void session_view_in(const struct session *session, const struct session_context *context, struct view *out)
{
    const struct view *view = session_view(session);
    struct session *other = session_create(context, session->id, 0);
    char *carried = session_carried_text(session->context, view);
    session_look_again(other, view, carried);
    *out = other->view;
    mem_free(carried);
    session_destroy(&other);
}

void session_take_plant(struct session *session, const char *carried)
{
    const struct view before = session->view;
    mem_free(session->owed.tag_changes);
    session->owed.tag_changes = mem_array(session->context->plant->tag_count, sizeof(*session->owed.tag_changes));
    session->delivery.newest_number = 0;
    session->pick.pending = false;
    session->owed.alarms_sent = false;
    session->owed.alarms_number = 0;
    session->owed.loop_checks_sent = 0;
    session->owed.views_sent = session->owed.notes_sent = session->owed.walls_sent = session->owed.pointers_sent = 0;
    session->demand.refined = REFINED_NOT;
    /* counts the outstanding frame requests as dropped, because the old plant's render service no longer answers them */
    while (session->delivery.pacer.asked > 0)
        pacer_dropped(&session->delivery.pacer, session->delivery.pacer.previews > 0);
    if (!session->hello)
        return;
    session->owed.following |= session->following.left != 0;
    /* a follower whose leader has gone still showed the leader's last view; that view belongs to the old plant, so the follower
       now returns to its own view */
    session->following.left = 0;
    session_look_again(session, &before, carried);
    const bool had_pictures = !session->scope.tags;
    session_scope_begin(session);
    if (had_pictures != !session->scope.tags)
        /* in the new plant, the display shows pictures and did not before, or the reverse. Closes the session, so that the
           client connects again and gets the right picture size */
        session_close(session, 1012, "the plant file has changed what this display shows: connect again");
    struct message_error error = { 0 };
    if (session->identity.holder.views[0] && !session_scope_view(session, session->scope.named, &session->view, &error))
        session_reply_error(session, &error);
    if (session_is_tile(session)) {
        struct tile_layout *layout = &session->tile.layout;
        mem_free(session->tile.told);
        session->tile.told = NULL;
        if (!session_tile_fit(session, &session->tile.place, layout->display_px[0], layout->display_px[1], &session->view, layout))
            session_close(session, 1012, "the changed plant file no longer has a tile for this display");
    }
    session->owed.welcome = session->owed.tags_all = session->owed.status = session->demand.any = true;
    session->owed.params = false;
    session->owed.loop_checks = true;
}
