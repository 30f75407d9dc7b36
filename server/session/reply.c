/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JSON that the server sends. */
#include "session/reply.h"

#include <libwebsockets.h>
#include <string.h>

#include "base/json_text.h"
#include "base/mem.h"
#include "field/colormap.h"
#include "message/names.h"
#include "message/json_number.h"
#include "message/visibility.h"
#include "plant/singles.h"
#include "value/alarm.h"
#include "value/quality.h"

enum { VALUE_DIGITS = 7, DIGITS = 9, EXACT_DIGITS = 17 };

static json_t *string(const char *text)
{
    json_t *value = text ? json_string(text) : json_null();
    return value ? value : json_string("(not UTF-8)");
}

static json_t *vector(const double v[3])
{
    return json_pack("[o,o,o]", number(v[0]), number(v[1]), number(v[2]));
}

static json_t *colour(const uint8_t rgb[3])
{
    return json_pack("[i,i,i]", rgb[0], rgb[1], rgb[2]);
}

static json_t *box(const double min_m[3], const double max_m[3])
{
    return json_pack("{s:o,s:o}", "min", vector(min_m), "max", vector(max_m));
}

static json_int_t us(int64_t ns)
{
    return ns / 1000;
}

/* null where it is empty. */
static json_t *number_list(const double *values, int count)
{
    json_t *list = count > 0 ? json_array() : json_null();
    for (int i = 0; i < count; i++)
        json_array_append_new(list, number(values[i]));
    return list;
}

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
    return context->baselines && id && baselines_describe(context->baselines, id, &found) ? baseline(&found) : json_null();
}

static json_t *baselines(const struct session_context *context)
{
    struct baseline list[BASELINES_NAMED];
    json_t *all = json_array();
    size_t count = context->baselines ? baselines_list(context->baselines, list) : 0;
    for (size_t i = 0; i < count; i++)
        json_array_append_new(all, baseline(&list[i]));
    return all;
}

/* What one half shows. */
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
    json_object_set_new(object, "colormap", string(colormap_at((size_t)view->colormap)->name));
    json_object_set_new(object, "ramp_interval", number(view->ramp_interval));
    json_object_set_new(object, "range", json_pack("[o,o]", number(view->range_min), number(view->range_max)));
    json_object_set_new(object, "scale", string(name_of(names_scale, view->color_scale.log)));
    json_object_set_new(object, "breaks", number_list(view->color_scale.breaks, view->color_scale.break_count));
    json_object_set_new(object, "isolines", number_list(view->color_scale.lines, view->color_scale.line_count));
    json_object_set_new(object, "look", string(name_of(names_look, view->look)));
}

static const char *environment_name(const struct plant *plant, int environment)
{
    return environment == 0 ? "sky" : plant->environments[environment - 1].name;
}

static json_t *environments(const struct plant *plant)
{
    json_t *array = json_array();
    for (int i = 0; i <= (int)plant->environment_count; i++)
        json_array_append_new(array, string(environment_name(plant, i)));
    return array;
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
    json_object_set_new(object, "environment", string(environment_name(plant, view->environment)));
    json_object_set_new(object, "backdrop", string(name_of(names_backdrop, view->dark)));
    json_object_set_new(object, "selected", view->selected_asset < 0 ? json_null() : string(plant->assets[view->selected_asset].id));
    visibility_print(plant, &view->visibility, object);
}

/* Names that people gave, and of tags: not for anyone who looks on. */
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

static void set_params_for(json_t *object, const struct session_context *context, const struct view *view, bool open)
{
    set_params(object, context, view);
    if (open)
        hide_names(object);
}

static json_t *limits(const double values[LIMIT_COUNT])
{
    return json_pack("{s:o,s:o,s:o,s:o}", "LL", number(values[LIMIT_LL]), "L", number(values[LIMIT_L]), "H", number(values[LIMIT_H]), "HH",
                     number(values[LIMIT_HH]));
}

static json_t *groups(const struct plant *plant)
{
    json_t *list = json_array();
    for (size_t i = 0; i < plant->group_count; i++) {
        const struct plant_group *g = &plant->groups[i];
        json_array_append_new(list, json_pack("{s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o}", "id", string(g->id), "quantity",
                                              string(g->quantity), "unit", string(g->unit), "min", number(g->min), "max", number(g->max),
                                              "limits", limits(g->limits), "interpolation",
                                              string(name_of(names_interpolation, g->interpolation)), "distance",
                                              string(name_of(names_distance, g->distance)), "fill", string(name_of(names_fill, g->fill)),
                                              "power", number(g->power), "radius_m", number(g->radius_m), "reach_m", number(g->reach_m)));
        json_t *group = json_array_get(list, i);
        json_object_set_new(group, "singles", string(plant_cuts_singles(g) ? "cut" : "whole"));
        json_object_set_new(group, "scale", string(name_of(names_scale, g->log)));
        json_object_set_new(group, "breaks", number_list(g->breaks, g->break_count));
        json_object_set_new(group, "isolines", number_list(g->isolines, g->isoline_count));
    }
    return list;
}

static json_t *colormaps(void)
{
    json_t *list = json_array();
    for (size_t i = 0; i < colormap_count(); i++) {
        const struct colormap *map = colormap_at(i);
        char base64[sizeof(map->rgb) / 3 * 4 + 8]; /* lws wants some room to spare */
        lws_b64_encode_string((const char *)map->rgb, sizeof(map->rgb), base64, sizeof(base64));
        json_array_append_new(list, json_pack("{s:o,s:o,s:o,s:o,s:b}", "name", string(map->name), "rgb", string(base64), "below",
                                              colour(map->below), "above", colour(map->above), "safe", map->safe));
    }
    return list;
}

static json_t *properties(const struct plant_asset *asset)
{
    json_t *list = json_array();
    for (size_t i = 0; i < asset->property_count; i++)
        json_array_append_new(list, json_pack("[o,o]", string(asset->properties[i].name), string(asset->properties[i].text)));
    return list;
}

static json_t *assets(const struct scene *scene, bool open)
{
    json_t *list = json_array();
    for (size_t i = 0; i < scene->asset_count; i++) {
        const struct scene_asset *a = &scene->assets[i];
        const char *description = a->plant->description ? a->plant->description : "", *area = a->plant->area ? a->plant->area : "";
        json_t *asset = json_pack("{s:o,s:o,s:o,s:o,s:o}", "id", string(a->plant->id), "tag", string(a->plant->tag), "description",
                                  string(description), "area", string(area), "bounds", box(a->bounds_min_m, a->bounds_max_m));
        if (a->plant->start != PLANT_START_SHOWN)
            json_object_set_new(asset, "start", string(a->plant->start == PLANT_START_GHOST ? "ghost" : "hidden"));
        if (a->plant->property_count > 0 && !open)
            json_object_set_new(asset, "properties", properties(a->plant));
        if (a->missing && !open)
            json_object_set_new(asset, "missing", string(a->missing));
        json_array_append_new(list, asset);
    }
    return list;
}

static json_t *links(const struct plant *plant)
{
    json_t *list = json_array();
    for (size_t i = 0; i < plant->link_count; i++) {
        const struct plant_link *link = &plant->links[i];
        json_array_append_new(list, json_pack("{s:o,s:s,s:o}", "name", string(link->name), "of", link->of_tags ? "tag" : "asset", "url",
                                              string(link->url)));
    }
    return list;
}

static json_t *tag(const struct plant *plant, const struct plant_tag *t)
{
    return json_pack("{s:o,s:o,s:o,s:o,s:o,s:o,s:o}", "name", string(t->name), "description", string(t->description ? t->description : ""),
                     "unit", string(t->unit ? t->unit : ""), "source", t->source < 0 ? json_null() : string(plant->sources[t->source].id),
                     "group", t->group < 0 ? json_null() : string(plant->groups[t->group].id), "asset",
                     t->asset < 0 ? json_null() : string(plant->assets[t->asset].id), "limits", limits(t->limits));
}

static json_t *tags(const struct session_context *context)
{
    const struct plant *plant = context->plant;
    json_t *list = json_array();
    for (size_t i = 0; i < plant->tag_count; i++) {
        json_t *object = tag(plant, &plant->tags[i]);
        json_object_set_new(object, "position", json_null());
        json_array_append_new(list, object);
    }
    for (size_t a = 0; a < context->scene->asset_count; a++)
        for (size_t s = 0; s < context->scene->assets[a].sensor_count; s++) {
            const struct scene_sensor *sensor = &context->scene->assets[a].sensors[s];
            json_object_set_new(json_array_get(list, (size_t)sensor->tag), "position", vector(sensor->surface_m));
        }
    return list;
}

static json_t *plant_object(const struct session_context *context, const struct camera *home)
{
    json_t *object = json_pack("{s:o,s:o,s:o}", "name", string(context->plant->name), "time_zone", string(context->plant->time_zone),
                               "bounds", box(context->scene->bounds_min_m, context->scene->bounds_max_m));
    json_object_set_new(object, "configuration", string(context->plant->hash));
    json_object_set_new(object, "home",
                        json_pack("{s:o,s:o,s:o,s:o}", "eye", vector(home->eye_m), "target", vector(home->target_m), "up", vector(home->up),
                                  "fov", number(home->fov_deg)));
    if (context->plant->view.set)
        json_object_set_new(json_object_get(object, "home"), "given", json_true());
    json_t *outline = json_array();
    for (size_t i = 0; i < context->scene->extreme_count; i++)
        json_array_append_new(outline, vector(context->scene->extremes_m[i]));
    json_object_set_new(object, "outline", outline);
    return object;
}

static void set_home(json_t *object, const struct session_context *context, int width_px, int height_px)
{
    struct view home;
    view_default(context->scene, width_px, height_px, &home);
    json_object_set_new(object, "server", string(context->version));
    json_object_set_new(object, "plant", plant_object(context, &home.camera));
}

/* Long, and the same for everybody who has a role; open: for anyone who looks on, without what people and tags are called. */
static void set_lists(json_t *object, const struct session_context *context, bool open)
{
    json_object_set_new(object, "groups", groups(context->plant));
    json_object_set_new(object, "colormaps", colormaps());
    json_object_set_new(object, "environments", environments(context->plant));
    json_object_set_new(object, "links", open ? json_array() : links(context->plant));
    json_object_set_new(object, "assets", assets(context->scene, open));
    json_object_set_new(object, "tags", open ? json_array() : tags(context));
}

static json_t *quotas_json(const struct quotas *quotas)
{
    return json_pack("{s:I,s:I,s:I}", "message_bytes", (json_int_t)quotas->at[QUOTA_MESSAGE_BYTES], "messages_per_s",
                     (json_int_t)quotas->at[QUOTA_MESSAGES], "pixels", (json_int_t)quotas->at[QUOTA_SESSION_PIXELS]);
}

static char *lists_text(const struct session_context *context, bool open)
{
    json_t *object = json_object();
    set_lists(object, context, open);
    return json_text(object, DIGITS);
}

/* One object of both; takes them. */
static char *join(char *first, char *second)
{
    char *both = mem_printf("%.*s,%s", (int)strlen(first) - 1, first, second + 1);
    mem_free(first);
    mem_free(second);
    return both;
}

/* Kept for the next who comes. mem_free. */
static char *lists_said(const struct session_context *context, bool open)
{
    if (!context->lists_said)
        return lists_text(context, open);
    if (!context->lists_said[open])
        context->lists_said[open] = lists_text(context, open);
    return mem_strdup(context->lists_said[open]);
}

char *reply_welcome_text(const struct session *session, int64_t now_utc_ns)
{
    const struct view *view = &session->view;
    json_t *object =
        json_pack("{s:s,s:s,s:I,s:o,s:I}", "type", "welcome", "protocol", WIRE_SUBPROTOCOL, "session", (json_int_t)session->identity.number,
                  "codec", string(name_of(names_codec, (int)session->codec.current)), "time_us", us(now_utc_ns));
    json_t *params = json_object();
    json_object_update_new(object, json_pack("{s:s,s:s,s:I,s:b,s:o}", "role", name_of(names_role, (int)session->identity.role), "resume",
                                             session->identity.resume_secret, "resume_s", (json_int_t)(RESUME_KEPT_NS / 1000000000),
                                             "resumed", session->identity.resumed, "limits", quotas_json(session->context->quotas)));
    set_home(object, session->context, view->width_px, view->height_px);
    set_params_for(params, session->context, view, session_is_open(session));
    json_object_set_new(object, "view", params);
    return join(json_text(object, DIGITS), lists_said(session->context, session_is_open(session)));
}

char *reply_params_text(const struct session_context *context, const struct view *view, uint32_t seq, bool open)
{
    json_t *object = json_pack("{s:s,s:I}", "type", "params", "seq", (json_int_t)seq);
    set_params_for(object, context, view, open);
    return json_text(object, DIGITS);
}

char *reply_following_text(const struct session *session)
{
    const struct view *view = session_view(session);
    uint64_t called = session->following.leader ? session->following.leader->identity.number : session->following.left;
    json_t *leader = called ? json_integer((json_int_t)called) : json_null();
    json_t *object =
        json_pack("{s:s,s:o,s:i,s:i}", "type", "following", "session", leader, "width", view->width_px, "height", view->height_px);
    if (session->following.left)
        json_object_set_new(object, "gone", json_true());
    set_params_for(object, session->context, view, session_is_open(session));
    return json_text(object, DIGITS);
}

char *reply_followers_text(const uint64_t *sessions, size_t count)
{
    json_t *list = json_array();
    for (size_t i = 0; i < count && i < REPLY_FOLLOWERS; i++)
        json_array_append_new(list, json_integer((json_int_t)sessions[i]));
    return json_text(json_pack("{s:s,s:I,s:o}", "type", "followers", "count", (json_int_t)count, "sessions", list), DIGITS);
}

static json_t *age_ms(const struct reading *reading)
{
    return reading->age_ns == INT64_MAX ? json_null() : json_integer(reading->age_ns / 1000000);
}

static json_t *value_of(const struct reading *reading)
{
    return quality_is_bad(reading->quality) ? json_null() : number(reading->value);
}

static json_t *alarm_of(const struct reading *reading)
{
    return string(alarm_kind_name((enum alarm_kind)reading->alarm));
}

/* Nothing to be said but its value. */
static bool is_plain(const struct reading *reading)
{
    return reading->quality == QUALITY_GOOD && !reading->alarm;
}

static void add_alarm(const struct plant *plant, size_t tag, const struct reading *reading, json_t *row)
{
    if (!reading->alarm)
        return;
    json_array_append_new(row, json_integer(alarm_priority(&plant->tags[tag], (enum alarm_kind)reading->alarm)));
    json_array_append_new(row, string(alarm_status_name((enum alarm_status)reading->alarm_status)));
}

char *reply_tags_text(const struct plant *plant, const struct snapshot *snapshot, uint32_t *sent, bool all)
{
    json_t *values = json_array();
    int64_t oldest_ns = 0; /* of those whose row is short */
    for (size_t i = 0; i < snapshot->count; i++) {
        const struct reading *r = &snapshot->readings[i];
        if (!all && sent[i] == r->changes)
            continue;
        sent[i] = r->changes;
        if (is_plain(r)) {
            oldest_ns = r->age_ns > oldest_ns ? r->age_ns : oldest_ns;
            json_array_append_new(values, json_pack("[I,o]", (json_int_t)i, value_of(r)));
        } else {
            json_t *row = json_pack("[I,o,o,o,o,o]", (json_int_t)i, value_of(r), string(quality_class(r->quality)),
                                    string(quality_name(r->quality)), age_ms(r), alarm_of(r));
            add_alarm(plant, i, r, row);
            json_array_append_new(values, row);
        }
    }
    json_t *object = json_pack("{s:s,s:I,s:I,s:o}", "type", "tags", "time_us", us(snapshot->taken_utc_ns), "age_ms",
                               (json_int_t)(oldest_ns / 1000000), "values", values);
    return json_text(object, VALUE_DIGITS);
}

char *reply_status_text(const struct session_context *context, int64_t now_utc_ns)
{
    json_t *links = json_array();
    for (size_t i = 0; i < context->plant->source_count; i++) {
        const struct plant_source *source = &context->plant->sources[i];
        json_t *link = json_pack("{s:o,s:b}", "source", string(source->id), "up", context->links_up[i]);
        if (source->simulated)
            json_object_set_new(link, "simulated", json_true());
        json_array_append_new(links, link);
    }
    return json_text(json_pack("{s:s,s:o,s:I,s:b,s:b}", "type", "status", "links", links, "time_us", us(now_utc_ns), "live", context->live,
                               "clock_set", context->clock_is_set),
                     DIGITS);
}

/* Of the readings that are not bad; null: all are. */
static json_t *oldest_age_ms(const struct snapshot *snapshot)
{
    const struct reading *oldest = NULL;
    for (size_t i = 0; i < snapshot->count; i++) {
        const struct reading *reading = &snapshot->readings[i];
        if (!quality_is_bad(reading->quality) && (!oldest || reading->age_ns > oldest->age_ns))
            oldest = reading;
    }
    return oldest ? age_ms(oldest) : json_null();
}

char *reply_pong_text(const struct snapshot *snapshot, double t, int64_t now_utc_ns)
{
    return json_text(json_pack("{s:s,s:f,s:I,s:o}", "type", "pong", "t", t, "time_us", us(now_utc_ns), "oldest_age_ms",
                               oldest_age_ms(snapshot)),
                     EXACT_DIGITS);
}

static json_t *instant(int64_t at_us)
{
    return at_us ? json_integer(at_us) : json_null();
}

char *reply_time_text(const struct session *session)
{
    const struct travel *travel = session->following.leader ? &session->following.leader->travel : &session->travel;
    return json_text(json_pack("{s:s,s:o,s:f,s:o}", "type", "time", "at_us", instant(session_view(session)->at_us), "speed", travel->speed,
                               "from_us", instant(session->context->history_first_us)),
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

static json_t *nearest(const struct plant *plant, const struct pick *pick)
{
    json_t *list = json_array();
    for (int i = 0; i < pick->nearest_count; i++) {
        const struct pick_sensor *at = &pick->nearest[i];
        json_array_append_new(list,
                              json_pack("{s:o,s:o,s:o,s:o}", "tag", string(plant->tags[at->tag].name), "distance_m", number(at->distance_m),
                                        "value", number(at->value), "quality", string(quality_class(at->quality))));
    }
    return list;
}

char *reply_picked_text(const struct plant *plant, const struct pick_answer *answer)
{
    const struct pick *pick = &answer->pick;
    bool found = pick->asset >= 0, told = pick->state == PICK_BETWEEN || pick->state == PICK_MEASURED;
    struct view half;
    view_half(&answer->query.view, answer->query.view.split && answer->query.x_px >= view_left_px(&answer->query.view), &half);
    json_t *object =
        json_pack("{s:s,s:I,s:o,s:o,s:o,s:s}", "type", "picked", "time_us", us(pick->data_utc_ns), "asset",
                  found ? string(plant->assets[pick->asset].id) : json_null(), "position", found ? vector(pick->position_m) : json_null(),
                  "normal", found ? vector(pick->normal) : json_null(), "state", name_of(names_pick, (int)pick->state));
    if (answer->query.seq)
        json_object_set_new(object, "seq", json_integer(answer->query.seq));
    json_object_set_new(object, "value", told ? number(pick->value) : json_null());
    json_object_set_new(object, "unit", string(view_unit(plant, &half)));
    json_object_set_new(object, "uncertain", json_boolean(told && pick->uncertain));
    json_object_set_new(object, "inside", json_boolean(found && pick->inside));
    json_object_set_new(object, "nearest", nearest(plant, pick));
    json_object_set_new(object, "sensor", pick->sensor < 0 ? json_null() : string(plant->tags[pick->sensor].name));
    json_object_set_new(object, "occluded", json_boolean(pick->sensor >= 0 && pick->sensor_occluded));
    return json_text(object, DIGITS);
}

char *reply_error_text(const struct message_error *error)
{
    json_t *object = json_pack("{s:s,s:s,s:o,s:o}", "type", "error", "code", error->code, "text", string(error->text), "about",
                               error->about[0] ? string(error->about) : json_null());
    if (error->retry_after_s > 0)
        json_object_set_new(object, "retry_after_s", json_integer(error->retry_after_s));
    return json_text(object, DIGITS);
}

char *reply_api_plant_text(const struct session_context *context)
{
    json_t *object = json_object();
    set_home(object, context, 1920, 1080);
    return join(json_text(object, DIGITS), lists_said(context, false));
}

char *reply_api_tags_text(const struct session_context *context, size_t first, size_t count)
{
    const struct plant *plant = context->plant;
    json_t *list = json_array();
    for (size_t i = first; i < plant->tag_count && i - first < count; i++) {
        const struct reading *r = &context->snapshot->readings[i];
        json_t *object = tag(plant, &plant->tags[i]);
        json_object_set_new(object, "value", value_of(r));
        json_object_set_new(object, "quality", string(quality_class(r->quality)));
        json_object_set_new(object, "quality_name", string(quality_name(r->quality)));
        json_object_set_new(object, "age_ms", age_ms(r));
        if (plant_tag_simulated(plant, (int)i))
            json_object_set_new(object, "simulated", json_true());
        json_array_append_new(list, object);
    }
    json_t *page = json_pack("{s:I,s:I,s:I,s:o}", "time_us", us(context->snapshot->taken_utc_ns), "total", (json_int_t)plant->tag_count,
                             "first", (json_int_t)first, "tags", list);
    return json_text(page, DIGITS);
}
