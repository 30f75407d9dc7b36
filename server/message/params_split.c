/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses and applies the member `split` of params: the second set of parameters of a split view. */
#include <string.h>

#include "message/json_fields.h"

/* parameters shared by both halves of a split view, and therefore not allowed inside `split` */
static const char *const common[] = { "light",    "environment", "backdrop", "strip", "language", "arrows",
                                      "selected", "hidden",      "isolate",  "ghost", "clip",     "split" };

bool split_parse(const struct plant *plant, const json_t *o, struct split_change *out, struct message_error *error)
{
    const json_t *value = json_object_get(o, "split");
    memset(out, 0, sizeof(*out));
    if (!value)
        return true;
    out->mode = json_is_null(value) ? SPLIT_OFF : SPLIT_ON;
    if (out->mode == SPLIT_OFF)
        return true;
    if (!json_is_object(value)) {
        message_fail(error, "bad_field", "split: expected parameters of the right half, or null");
        return false;
    }
    for (size_t i = 0; i < sizeof(common) / sizeof(*common); i++)
        if (json_object_get(value, common[i])) {
            message_fail(error, "bad_field", "split: '%s' is not allowed here, because this parameter applies to both halves", common[i]);
            return false;
        }
    if (params_parse(plant, value, &out->right, error))
        return true;
    message_error_within(error, "split");
    return false;
}

bool split_apply(const struct params_context *context, const struct split_change *change, struct view *view, struct message_error *error)
{
    struct view right;
    if (change->mode == SPLIT_OFF) {
        view->split = false;
        memset(&view->right, 0, sizeof(view->right));
    }
    if (change->mode != SPLIT_ON)
        return true;
    if (view->width_px < VIEW_SPLIT_LEAST_PX) {
        message_refuse(error, "bad_field", "split", REFUSAL_NARROW);
        return false;
    }
    view_half(view, 1, &right); /* the view was not split before, so the right half starts as a copy of the left half's parameters */
    if (!params_apply(context, &change->right, &right, error))
        return false;
    view_split(view, &right);
    return true;
}
