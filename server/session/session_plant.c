/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Moves a session to a reloaded plant: carries its view over by names, and drops what the new plant lacks. */
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "plant/colormaps.h"
#include "session/reply/reply.h"
#include "session/session_impl.h"

/* Converts the server's description of a view or of half a split view into the members of a client's `params` message. */
static void make_request(json_t *o)
{
    static const char *const said_only[] = { "type", "seq", "baselines", "unit" };
    for (size_t i = 0; i < sizeof(said_only) / sizeof(said_only[0]); i++)
        json_object_del(o, said_only[i]);
    json_t *baseline = json_object_get(o, "baseline"), *split = json_object_get(o, "split");
    if (json_is_string(json_object_get(baseline, "name")))
        json_object_set(o, "baseline", json_object_get(baseline, "name"));
    else if (!json_is_string(baseline))
        json_object_del(o, "baseline");
    if (json_is_object(split))
        make_request(split);
}

static bool apply(struct session *session, const json_t *request)
{
    struct message message = { .type = MESSAGE_PARAMS };
    struct message_error error = { 0 };
    return params_parse(session->context->plant, request, &message.params, &error) &&
           split_parse(session->context->plant, request, &message.split, &error) &&
           session_apply_params(session, &message, &session->view, &error);
}

/* Returns the parameters of a view, as members of a `params` message. */
static json_t *members_of(const struct session_context *context, const struct view *view)
{
    char *text = reply_params_text(context, view, 0, false);
    json_t *o = json_loads(text, 0, NULL);
    make_request(o);
    mem_free(text);
    return o;
}

/* Returns the parameters that a new view of the same group, `show`, sensor and baseline as `shown` has by default. The range is the default
   for the kind of distance that `shown` has. */
static json_t *defaults_of(const struct session_context *context, const struct view *shown)
{
    const struct scene *scene = context->services->scene;
    struct view view;
    view_default(scene, shown->width_px, shown->height_px, &view);
    field_params_default(context->plant, shown->field.group, &view.field);
    field_params_set_show(context->plant, &view.field, shown->field.show);
    view.field.sensor = shown->field.sensor;
    view.field.baseline = shown->field.baseline;
    view_default_scale(scene, &view);
    field_default_range(scene, &shown->field, &view.range_min, &view.range_max);
    view.colormap = view_default_colormap(context->plant, view.field.show);
    return members_of(context, &view);
}

/* Returns the parameters that the right half of a split view has by default next to the left half `o`. If these cannot be determined,
   because the server now refuses the view's baseline, returns those of a new view. */
static json_t *right_defaults(const struct session_context *context, const struct view *view, const json_t *o)
{
    static const char *const keys[] = { "group", "show", "sensor", "baseline" };
    json_t *request = json_copy((json_t *)o), *chosen = json_object(), *all = NULL;
    for (size_t i = 0; i < sizeof(keys) / sizeof(keys[0]); i++)
        if (json_object_get(json_object_get(o, "split"), keys[i]))
            json_object_set(chosen, keys[i], json_object_get(json_object_get(o, "split"), keys[i]));
    json_object_set_new(request, "split", chosen);
    struct session *other = session_create(context, 0, 0);
    view_default(context->services->scene, view->width_px, view->height_px, &other->view);
    if (apply(other, request))
        all = members_of(context, &other->view);
    session_destroy(&other);
    json_decref(request);
    struct view right;
    view_half(view, 1, &right);
    json_t *own = defaults_of(context, &right), *defaults = json_incref(json_object_get(all, "split"));
    json_decref(all);
    if (!json_is_object(defaults)) {
        json_decref(defaults);
        return own;
    }
    /* the range of distances depends on their kind, which the right half may have changed */
    json_t *distance = json_object_get(json_object_get(o, "split"), "distance");
    if (right.field.show == SHOW_DISTANCE && !json_equal(distance, json_object_get(defaults, "distance")))
        json_object_set(defaults, "range", json_object_get(own, "range"));
    json_decref(own);
    return defaults;
}

/* Deletes the members that equal `defaults`, except those that say what the view shows. */
static void drop_equal(json_t *o, const json_t *defaults)
{
    static const char *const kept[] = { "group", "show", "sensor", "baseline", "split", "selected", "hidden", "isolate", "ghost", "clip" };
    const char *key;
    json_t *value;
    void *next;
    json_object_foreach_safe(o, next, key, value)
    {
        bool keeps = false;
        for (size_t i = 0; i < sizeof(kept) / sizeof(kept[0]); i++)
            keeps |= !strcmp(key, kept[i]);
        if (!keeps && json_equal(value, json_object_get(defaults, key)))
            json_object_del(o, key);
    }
}

/* Deletes the members that equal the defaults of a view with the same group, show, sensor and baseline, because a reloaded plant may have
   other defaults. */
static void drop_defaults(const struct session_context *context, const struct view *view, json_t *o)
{
    json_t *defaults = defaults_of(context, view), *split = json_object_get(o, "split");
    drop_equal(o, defaults);
    json_decref(defaults);
    if (!json_is_object(split))
        return;
    defaults = right_defaults(context, view, o);
    drop_equal(split, defaults);
    json_decref(defaults);
}

/* Describes a view by names, as members of a `params` message without defaults. The extra object `start` lists the assets that are not
   shown at first (hidden, ghosted) according to the plant file. */
char *session_carried_text(const struct session_context *context, const struct view *view)
{
    json_t *o = members_of(context, view), *start = json_object();
    drop_defaults(context, view, o);
    for (size_t i = 0; i < context->plant->asset_count; i++)
        if (context->plant->assets[i].start != PLANT_START_SHOWN)
            json_object_set_new(start, context->plant->assets[i].id, json_integer(context->plant->assets[i].start));
    json_object_set_new(o, "start", start);
    char *dumped = json_dumps(o, JSON_COMPACT), *carried = mem_strdup(dumped);
    free(dumped);
    json_decref(o);
    return carried;
}

char *session_carry(struct session *session)
{
    if (session->following.left) {
        session_come_to_own(session);
        session->owed.following = true;
    }
    session_time_leave(session);
    session_place_leave(session);
    session_drop_ready(session);
    session_forget_depth(session);
    return session->hello ? session_carried_text(session->context, &session->view) : NULL;
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
    json_t *o = json_loads(carried, 0, NULL), *value;
    const char *key;
    make_request(o); /* texts that a daemon of an earlier version has written have the members of its own message */
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
