/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds the messages that tell a client what its session shows: parameters, the user whose view it follows, the instant, the
   camera. */
#include "session/reply/reply_impl.h"

#include "base/text/json_text.h"
#include "message/json_values.h"
#include "message/names.h"
#include "message/view_named.h"
#include "message/visibility.h"
#include "plant/colormaps.h"
#include "session/session.h"
#include "session/view/session_view.h"
#include "views/named_views.h"

static json_t *tag_name(const struct plant *plant, int tag)
{
    return tag < 0 ? json_null() : string(plant->tags[tag].name);
}

static json_t *overrides(const struct plant *plant, const struct field_params *field)
{
    json_t *all = json_object();
    for (size_t i = 0; i < field->override_count; i++) {
        const struct field_override *o = &field->overrides[i];
        json_t *one = json_object();
        if (o->strength >= 0)
            json_object_set_new(one, "strength", number((double)o->strength));
        if (o->decay >= 0)
            json_object_set_new(one, "decay", number((double)o->decay));
        json_object_set_new(all, plant->tags[o->tag].name, one);
    }
    return all;
}

static json_t *baseline(const struct baseline *b)
{
    return json_pack("{s:o,s:I}", "name", b->name[0] ? string(b->name) : json_null(), "time_us", us(b->taken_utc_ns));
}

static json_t *baseline_of(const struct session_context *context, uint32_t id)
{
    struct baseline found;
    return context->services->baselines && id && baselines_describe(context->services->baselines, id, &found) ? baseline(&found)
                                                                                                              : json_null();
}

static json_t *baselines(const struct session_context *context)
{
    struct baseline list[BASELINES_NAMED];
    json_t *all = json_array();
    size_t count = context->services->baselines ? baselines_list(context->services->baselines, list) : 0;
    for (size_t i = 0; i < count; i++)
        json_array_append_new(all, baseline(&list[i]));
    return all;
}

/* Adds the parameters of the whole view, or of one half of a split view (two pictures side by side). */
static void set_shown(json_t *object, const struct session_context *context, const struct view *view)
{
    const struct plant *plant = context->plant;
    const struct field_params *field = &view->field;
    json_object_set_new(object, "group", string(plant->groups[field->group].id));
    json_object_set_new(object, "show", string(name_of(names_show, (int)field->show)));
    json_object_set_new(object, "sensor", tag_name(plant, field->sensor));
    json_object_set_new(object, "baseline", baseline_of(context, field->baseline));
    json_object_set_new(object, "sensors", overrides(plant, field));
    json_object_set_new(object, "unit", string(view_unit(plant, view)));
    json_object_set_new(object, "interpolation", string(name_of(names_interpolation, field->interpolation)));
    json_object_set_new(object, "distance", string(name_of(names_distance, field->distance)));
    json_object_set_new(object, "fill", string(name_of(names_fill, field->fill)));
    json_object_set_new(object, "strength", number(field->strength));
    json_object_set_new(object, "decay", number(field->decay));
    json_object_set_new(object, "power", number(field->power));
    json_object_set_new(object, "radius_m", number(field->radius_m));
    json_object_set_new(object, "reach_m", number(field->reach_m));
    json_object_set_new(object, "colormap", string(colormap_at(plant, (size_t)view->colormap)->name));
    json_object_set_new(object, "ramp_interval", number(view->ramp_interval));
    json_object_set_new(object, "range", json_pack("[o,o]", number(view->range_min), number(view->range_max)));
    json_object_set_new(object, "scale", string(name_of(names_scale, view->color_scale.log)));
    json_object_set_new(object, "breaks", number_list(view->color_scale.breaks, view->color_scale.break_count));
    json_object_set_new(object, "isolines", number_list(view->color_scale.lines, view->color_scale.line_count));
    json_object_set_new(object, "look", string(name_of(names_look, view->look)));
}

const char *reply_environment_name(const struct plant *plant, int environment)
{
    return environment == 0 ? "sky" : plant->display.environments[environment - 1].name;
}

static void set_params(json_t *object, const struct session_context *context, const struct view *view)
{
    const struct plant *plant = context->plant;
    struct view right;
    set_shown(object, context, view);
    json_object_set_new(object, "baselines", baselines(context));
    json_object_set_new(object, "split", view->split ? json_object() : json_null());
    view_half(view, 1, &right);
    if (view->split)
        set_shown(json_object_get(object, "split"), context, &right);
    json_object_set_new(object, "light", vector(view->light_dir));
    json_object_set_new(object, "environment", string(reply_environment_name(plant, view->environment)));
    json_object_set_new(object, "backdrop", string(name_of(names_backdrop, view->dark)));
    json_object_set_new(object, "arrows", string(name_of(names_arrows, view->directions)));
    json_object_set_new(object, "selected", view->selected_asset < 0 ? json_null() : string(plant->assets[view->selected_asset].id));
    visibility_print(plant, &view->visibility, object);
}

/* Removes the names of tags and of baselines, for clients without a token. */
static void hide_names(json_t *object)
{
    json_t *split = json_object_get(object, "split");
    json_object_set_new(object, "sensor", json_null());
    json_object_set_new(object, "sensors", json_object());
    if (json_is_object(json_object_get(object, "baseline")))
        json_object_set_new(json_object_get(object, "baseline"), "name", json_null());
    if (json_object_get(object, "baselines"))
        json_object_set_new(object, "baselines", json_array());
    if (json_is_object(split))
        hide_names(split);
}

void reply_set_params(json_t *object, const struct session_context *context, const struct view *view, bool open)
{
    set_params(object, context, view);
    if (open)
        hide_names(object);
}

char *reply_params_text(const struct session_context *context, const struct view *view, uint32_t seq, bool open)
{
    json_t *object = json_pack("{s:s,s:I}", "type", "params", "seq", (json_int_t)seq);
    reply_set_params(object, context, view, open);
    return json_text(object, DIGITS);
}

char *reply_following_text(const struct session *session)
{
    const struct view *view = session_view(session);
    uint64_t called = session->following.leader ? session->following.leader->identity.number : session->following.left;
    json_t *leader = called ? json_integer((json_int_t)called) : json_null();
    json_t *object =
        json_pack("{s:s,s:o,s:i,s:i}", "type", "following", "session", leader, "width", view->width_px, "height", view->height_px);
    if (session->following.leader && session->following.leader->identity.holder.name[0] && !session_is_open(session))
        json_object_set_new(object, "who", string(session->following.leader->identity.holder.name));
    if (session->following.left)
        json_object_set_new(object, "gone", json_true());
    json_object_set_new(object, "params_seq", json_integer(view->params_seq));
    reply_set_params(object, session->context, view, session_is_open(session));
    return json_text(object, DIGITS);
}

static json_t *instant(int64_t at_us)
{
    return at_us ? json_integer(at_us) : json_null();
}

char *reply_time_text(const struct session *session)
{
    const struct travel *travel = session->following.leader ? &session->following.leader->travel : &session->travel;
    return json_text(json_pack("{s:s,s:o,s:f,s:o}", "type", "time", "at_us", instant(session_view(session)->at_us), "speed", travel->speed,
                               "from_us", instant(session->context->readings.history_first_us)),
                     DIGITS);
}

char *reply_camera_text(const struct camera *camera, uint32_t seq)
{
    json_t *object = json_pack("{s:s,s:I,s:o,s:o,s:o}", "type", "camera", "seq", (json_int_t)seq, "eye", vector(camera->eye_m), "target",
                               vector(camera->target_m), "up", vector(camera->up));
    if (camera->height_m > 0) {
        json_object_set_new(object, "projection", string(name_of(names_projection, PROJECTION_ORTHOGRAPHIC)));
        json_object_set_new(object, "height_m", number(camera->height_m));
    } else {
        json_object_set_new(object, "fov", number(camera->fov_deg));
    }
    return json_text(object, DIGITS);
}

/* --- named views --------------------------------------------------------------------------------------------------------------- */

void reply_add_wrong(const struct session_context *context, json_t *view, const char *address)
{
    struct message_error error = { 0 };
    if (view_named_check(context->services->scene, address, &error))
        return;
    json_object_set_new(view, "wrong", string(error.text));
    if (error.refusal.code)
        json_object_set_new(view, "refusal", refusal_json(&error.refusal));
}

char *reply_views_text(const struct session_context *context, const char *id)
{
    json_t *message = named_views_message(context->services->named_views, id), *list = json_object_get(message, "list");
    for (size_t i = 0; i < json_array_size(list); i++) {
        json_t *view = json_array_get(list, i);
        reply_add_wrong(context, view, json_string_value(json_object_get(view, "view")));
    }
    return json_text(message, 0);
}
