/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds the JSON lists that stay the same while the plant is loaded, such as its groups, assets and tags. */
#include "session/reply/reply_impl.h"

#include <libwebsockets.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "message/json_values.h"
#include "message/names.h"
#include "plant/colormaps.h"
#include "plant/influence.h"
#include "plant/singles.h"
#include "session/session.h"
#include "session/view/resume.h"
#include "session/view/view_token.h"

static json_t *colour(const uint8_t rgb[3])
{
    return json_pack("[i,i,i]", rgb[0], rgb[1], rgb[2]);
}

static json_t *box(const double min_m[3], const double max_m[3])
{
    return json_pack("{s:o,s:o}", "min", vector(min_m), "max", vector(max_m));
}

static json_t *environments(const struct plant *plant)
{
    json_t *array = json_array();
    for (int i = 0; i <= (int)plant->display.environment_count; i++)
        json_array_append_new(array, string(reply_environment_name(plant, i)));
    return array;
}

static json_t *limits(const double values[LIMIT_COUNT])
{
    return json_pack("{s:o,s:o,s:o,s:o}", "LL", number(values[LIMIT_LL]), "L", number(values[LIMIT_L]), "H", number(values[LIMIT_H]), "HH",
                     number(values[LIMIT_HH]));
}

static json_t *prepared(const struct plant_group *group)
{
    json_t *list = json_array();
    for (int i = INTERPOLATION_HARMONIC; i < INTERPOLATIONS; i++)
        if (plant_prepares(group, (enum interpolation)i))
            json_array_append_new(list, string(name_of(names_interpolation, i)));
    if (group->heat)
        json_array_append_new(list, string("heat"));
    return list;
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
        json_object_set_new(group, "prepared", prepared(g));
        json_object_set_new(group, "hot_spot_m", number(g->hot_spot_m));
        if (g->directed)
            json_object_set_new(group, "directed", json_true());
        json_object_set_new(group, "scale", string(name_of(names_scale, g->log)));
        json_object_set_new(group, "breaks", number_list(g->breaks, g->break_count));
        json_object_set_new(group, "isolines", number_list(g->isolines, g->isoline_count));
    }
    return list;
}

static json_t *colormaps(const struct plant *plant)
{
    json_t *list = json_array();
    for (size_t i = 0; i < colormap_count(plant); i++) {
        const struct colormap *map = colormap_at(plant, i);
        /* the 8 extra bytes are needed because lws_b64_encode_string() writes a few bytes beyond the text */
        char base64[sizeof(map->rgb) / 3 * 4 + 8];
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
    for (size_t i = 0; i < plant->display.link_count; i++) {
        const struct plant_link *link = &plant->display.links[i];
        json_array_append_new(list, json_pack("{s:o,s:s,s:o}", "name", string(link->name), "of", link->of_tags ? "tag" : "asset", "url",
                                              string(link->url)));
    }
    return list;
}

json_t *reply_tag(const struct plant *plant, const struct plant_tag *t)
{
    json_t *object =
        json_pack("{s:o,s:o,s:o,s:o,s:o,s:o,s:o}", "name", string(t->name), "description", string(t->description ? t->description : ""),
                  "unit", string(t->unit ? t->unit : ""), "source", t->source < 0 ? json_null() : string(plant->sources[t->source].id),
                  "group", t->group < 0 ? json_null() : string(plant->groups[t->group].id), "asset",
                  t->asset < 0 ? json_null() : string(plant->assets[t->asset].id), "limits", limits(t->alarms.limits));
    if (t->place.assumed)
        json_object_set_new(object, "place", json_string("equipment"));
    return object;
}

static json_t *tags(const struct session_context *context)
{
    const struct scene *scene = context->services->scene;
    const struct plant *plant = context->plant;
    json_t *list = json_array();
    for (size_t i = 0; i < plant->tag_count; i++) {
        json_t *object = reply_tag(plant, &plant->tags[i]);
        json_object_set_new(object, "position", json_null());
        json_array_append_new(list, object);
    }
    for (size_t a = 0; a < scene->asset_count; a++)
        for (size_t s = 0; s < scene->assets[a].sensor_count; s++) {
            const struct scene_sensor *sensor = &scene->assets[a].sensors[s];
            json_object_set_new(json_array_get(list, (size_t)sensor->tag), "position", vector(sensor->surface_m));
        }
    return list;
}

static json_t *plant_object(const struct session_context *context, const struct camera *home)
{
    const struct scene *scene = context->services->scene;
    json_t *object = json_pack("{s:o,s:o,s:o}", "name", string(context->plant->name), "time_zone", string(context->plant->time_zone),
                               "bounds", box(scene->bounds_min_m, scene->bounds_max_m));
    bool y_up = context->plant->up == AXIS_Y;
    json_object_set_new(object, "up", vector((double[3]){ 0, y_up, !y_up }));
    if (context->plant->display.show == PLANT_SHOW_OPERATOR)
        json_object_set_new(object, "show", json_string("operator"));
    json_object_set_new(object, "configuration", string(context->plant->files.hash));
    if (context->node)
        json_object_set_new(object, "node", string(context->node));
    json_object_set_new(object, "home",
                        json_pack("{s:o,s:o,s:o,s:o}", "eye", vector(home->eye_m), "target", vector(home->target_m), "up", vector(home->up),
                                  "fov", number(home->fov_deg)));
    if (context->plant->display.view.set)
        json_object_set_new(json_object_get(object, "home"), "given", json_true());
    json_t *outline = json_array();
    for (size_t i = 0; i < scene->extreme_count; i++)
        json_array_append_new(outline, vector(scene->extremes_m[i]));
    json_object_set_new(object, "outline", outline);
    if (scene->outside.triangles > 0)
        json_object_set_new(object, "outside",
                            json_pack("{s:I,s:i,s:o}", "triangles", (json_int_t)scene->outside.triangles, "assets", scene->outside.assets,
                                      "away_m", number(scene->outside.away_m)));
    return object;
}

static void set_home(json_t *object, const struct session_context *context, int width_px, int height_px)
{
    struct view home;
    view_default(context->services->scene, width_px, height_px, &home);
    json_object_set_new(object, "server", string(context->version));
    json_object_set_new(object, "plant", plant_object(context, &home.camera));
}

/* Adds the lists of the plant's groups, colour maps, assets, tags and so on, which are the same for all clients with the same
   rights. open: true: for clients without a token; omits the names of people and tags. */
static void set_lists(json_t *object, const struct session_context *context, bool open)
{
    json_object_set_new(object, "groups", groups(context->plant));
    json_object_set_new(object, "colormaps", colormaps(context->plant));
    json_object_set_new(object, "environments", environments(context->plant));
    json_object_set_new(object, "links", open ? json_array() : links(context->plant));
    json_object_set_new(object, "assets", assets(context->services->scene, open));
    json_object_set_new(object, "tags", open ? json_array() : tags(context));
}

static json_t *quotas_json(const struct quotas *quotas)
{
    return json_pack("{s:I,s:I,s:I}", "message_bytes", (json_int_t)quotas->at[QUOTA_MESSAGE_BYTES], "messages_per_s",
                     (json_int_t)quotas->at[QUOTA_MESSAGES], "pixels", (json_int_t)quotas->at[QUOTA_SESSION_PIXELS]);
}

static char *lists_text(const struct session_context *context, enum audience_lists kind)
{
    bool open = kind != LISTS_NAMED;
    json_t *object = json_object();
    set_lists(object, context, open);
    if (kind == LISTS_VIEWS) /* a token narrowed to views must not disclose assets outside of its views */
        json_object_set_new(object, "assets", json_array());
    return json_text(object, DIGITS);
}

/* Joins two JSON objects into one text; frees both. */
static char *join(char *first, char *second)
{
    char *both = mem_printf("%.*s,%s", (int)strlen(first) - 1, first, second + 1);
    mem_free(first);
    mem_free(second);
    return both;
}

/* Returns the cached JSON lists of groups, assets, tags and so on for clients with the same rights (enum audience_lists).
   Builds the lists on first use; the caller frees the text with mem_free. */
static char *lists_said(const struct session_context *context, enum audience_lists kind)
{
    if (!context->caches.lists_said)
        return lists_text(context, kind);
    if (!context->caches.lists_said[kind])
        context->caches.lists_said[kind] = lists_text(context, kind);
    return mem_strdup(context->caches.lists_said[kind]);
}

char *reply_welcome_text(const struct session *session, int64_t now_utc_ns)
{
    const struct view *view = &session->view;
    json_t *object =
        json_pack("{s:s,s:s,s:I,s:o,s:I}", "type", "welcome", "protocol", WIRE_SUBPROTOCOL, "session", (json_int_t)session->identity.number,
                  "codec", string(name_of(names_codec, (int)session->codec.current)), "time_us", us(now_utc_ns));
    json_t *params = json_object();
    char *token = view_token_make(session->context->sign_in.token_keys, session, now_utc_ns);
    const char *resume = token ? token : session->identity.resume_secret;
    json_object_update_new(object, json_pack("{s:s,s:s,s:I,s:b,s:o}", "role", name_of(names_role, (int)session->identity.role), "resume",
                                             resume, "resume_s", (json_int_t)(RESUME_KEPT_NS / 1000000000), "resumed",
                                             session->identity.resumed, "limits", quotas_json(session->context->quotas)));
    mem_free(token);
    if (session->context->imports && session->identity.role == ROLE_ENGINEER)
        json_object_set_new(object, "imports", json_true());
    if (session->context->signing_key)
        json_object_set_new(object, "signing_key", json_string(session->context->signing_key));
    if (session_gets_depth(session))
        json_object_set_new(object, "reprojection", json_true());
    set_home(object, session->context, view->width_px, view->height_px);
    bool narrowed = session->identity.holder.views[0];
    if (narrowed)
        json_object_set_new(json_object_get(object, "plant"), "only", session_scope_views(session));
    reply_set_params(params, session->context, view, session_is_open(session));
    json_object_set_new(object, "view", params);
    enum audience_lists kind = narrowed ? LISTS_VIEWS : session_is_open(session) ? LISTS_OPEN : LISTS_NAMED;
    return join(json_text(object, DIGITS), lists_said(session->context, kind));
}

char *reply_api_plant_text(const struct session_context *context)
{
    json_t *object = json_object();
    set_home(object, context, 1920, 1080);
    return join(json_text(object, DIGITS), lists_said(context, LISTS_NAMED));
}
