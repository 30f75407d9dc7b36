/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes cameras that show an asset, a tag or the whole plant, for the messages `camera` and `fit`. */
#include "message/fit_message.h"

#include "message/json_fields.h"
#include "message/json_values.h"
#include "render/overlay/overlay.h"

bool fit_parse(const struct plant *plant, const json_t *o, struct fit_message *out, struct message_error *error)
{
    const json_t *id = json_object_get(o, "id");
    int side = SIDE_NOW;
    bool given;
    char quote[48];
    *out = (struct fit_message){ .projection = PROJECTION_AS_IT_IS };
    if (!framing_find(plant, json_string_value(id), &out->framing) || (id && !json_is_string(id) && !json_is_null(id))) {
        message_refuse_with(error, "bad_field", "id", REFUSAL_NO_ASSET, "name=%s",
                            json_is_string(id) ? quoted(json_string_value(id), quote) : "(not a text)");
        return false;
    }
    if (!may_name(o, "side", names_side, &side, &given, error) ||
        !may_name(o, "projection", names_projection, &out->projection, &given, error))
        return false;
    out->framing.side = (enum side)side;
    return true;
}

void fit_apply(const struct scene *scene, const struct fit_message *fit, const struct view *view, struct camera *camera)
{
    struct view half;
    view_half(view, 0, &half);
    if (fit->projection != PROJECTION_AS_IT_IS)
        camera->height_m = fit->projection == PROJECTION_ORTHOGRAPHIC;
    framing_look(scene, &fit->framing, (double)half.width_px / half.height_px, camera);
}

/* Returns the plant's initial camera as JSON, like a `camera` message. */
static json_t *camera_json(const struct camera *camera)
{
    return json_pack("{s:o,s:o,s:o,s:f}", "eye", vector(camera->eye_m), "target", vector(camera->target_m), "up", vector(camera->up), "fov",
                     camera->fov_deg);
}

static json_t *given_json(const json_t *list, struct message_error *error)
{
    size_t count = json_array_size(list);
    double n[7] = { 0 };
    if (count != 6 && count != 7) {
        message_fail(error, "bad_field", "camera: expected ex,ey,ez,tx,ty,tz or ex,ey,ez,tx,ty,tz,fov");
        return NULL;
    }
    for (size_t i = 0; i < count; i++)
        n[i] = json_number_value(json_array_get(list, i));
    json_t *camera = json_pack("{s:o,s:o}", "eye", vector(n), "target", vector(n + 3));
    if (count == 7)
        json_object_set_new(camera, "fov", json_real(n[6]));
    return camera;
}

/* Sets a view's camera from the members of the JSON object `o`. lens true: also applies the members `projection` and
   `height_m`. Returns false with *error naming the wrong member. */
static bool parse_given(const json_t *o, bool lens, struct view *view, struct message_error *error)
{
    const json_t *list = json_object_get(o, "camera"), *height = json_object_get(o, "height_m");
    json_t *projection = json_object_get(o, "projection"), *camera = list ? given_json(list, error) : camera_json(&view->camera);
    if (!camera)
        return false;
    if (json_object_get(o, "up"))
        json_object_set(camera, "up", json_object_get(o, "up"));
    if (lens && projection)
        json_object_set(camera, "projection", projection);
    if (lens && height)
        json_object_set_new(camera, "height_m", json_real(json_number_value(height)));
    bool good = camera_parse(camera, &view->camera, error);
    json_decref(camera);
    return good;
}

/* Returns true if the JSON object has a member that specifies a camera. */
static bool has_camera(const json_t *o)
{
    return json_object_get(o, "camera") || json_object_get(o, "projection") || json_object_get(o, "height_m");
}

/* Moves the plant's initial camera back, so that each half of a split view, which is narrower, shows as much as the whole view
   would. bare: the picture has no legend and no clock. */
static void keep_whole(const struct scene *scene, bool bare, struct view *view)
{
    struct camera_window window = { 0 };
    struct view half;
    view_half(view, 0, &half);
    if (!bare)
        overlay_window(scene, view, &window);
    framing_keep(scene, (double)half.width_px / half.height_px, &window, &view->camera);
}

bool view_query_camera(const struct scene *scene, const struct plant *plant, const json_t *o, bool bare, struct view *view,
                       struct message_error *error)
{
    json_t *fit_o = json_object();
    struct fit_message fit;
    bool fits = json_object_get(o, "fit") || json_object_get(o, "side") || (!scene->plant->display.view.set && !has_camera(o));
    json_object_set(fit_o, "id", json_object_get(o, "fit"));
    json_object_set(fit_o, "side", json_object_get(o, "side"));
    json_object_set(fit_o, "projection", json_object_get(o, "projection"));
    bool good = fit_parse(plant, fit_o, &fit, error) && parse_given(o, !fits, view, error);
    if (good && fits && !bare)
        overlay_window(scene, view, &fit.framing.window);
    if (good && fits)
        fit_apply(scene, &fit, view, &view->camera);
    if (good && !fits && view->split && !has_camera(o))
        keep_whole(scene, bare, view);
    json_decref(fit_o);
    return good;
}

bool camera_parse(const json_t *o, struct camera *out, struct message_error *error)
{
    int projection = PROJECTION_PERSPECTIVE;
    bool given;
    *out = (struct camera){ .up = { 0, 0, 1 }, .fov_deg = 45 };
    if (!need_vector(o, "eye", out->eye_m, error) || !need_vector(o, "target", out->target_m, error) ||
        !may_vector(o, "up", out->up, NULL, error) || !may_name(o, "projection", names_projection, &projection, &given, error) ||
        !may_number(o, "fov", 1, 120, &out->fov_deg, NULL, error))
        return false;
    if (projection == PROJECTION_ORTHOGRAPHIC && !need_number(o, "height_m", 1e-5, PLANT_MAX_M, &out->height_m, error))
        return false;
    if (!camera_valid(out)) {
        message_fail(error, "bad_field",
                     "eye, target, up: eye must differ from target, and up must not be parallel to the line from eye to target");
        return false;
    }
    return true;
}
