/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "message/view_named.h"

#include <stdio.h>
#include <string.h>

#include "message/view_address.h"
#include "message/view_query.h"

/* picture size and time for checking the address of a named view. Any size will do, because the address does not depend on it;
   the time must only be later than any instant in the address. */
enum { CHECKED_WIDTH_PX = 1280, CHECKED_HEIGHT_PX = 720 };
static const int64_t CHECKED_US = INT64_C(4000000000000000); /* an instant in the year 2096, microseconds UTC */

bool view_named_read(const struct params_context *context, const char *address, int width_px, int height_px, struct view *view,
                     struct message_error *error)
{
    struct view_address fields;
    char width[16], height[16];
    snprintf(width, sizeof(width), "%d", width_px);
    snprintf(height, sizeof(height), "%d", height_px);
    bool good = view_address_read(&fields, address, error);
    if (good && !(view_address_add(&fields, "width", width) && view_address_add(&fields, "height", height))) {
        message_fail(error, "bad_field", "the view address has too many fields: at most %d are allowed", VIEW_ADDRESS_ARGS);
        good = false;
    }
    good = good && view_query_parse(context, ROLE_ENGINEER, (const char *const *)fields.args, fields.count, view, NULL, error);
    view_address_finish(&fields);
    return good;
}

bool view_named_check(const struct scene *scene, const char *address, struct message_error *error)
{
    const struct params_context context = { .scene = scene, .now_us = CHECKED_US, .bare = true };
    struct view view;
    if (strstr(address, "show=difference") || strstr(address, "show:difference"))
        return true;
    return view_named_read(&context, address, CHECKED_WIDTH_PX, CHECKED_HEIGHT_PX, &view, error);
}

void view_named_check_all(const struct scene *scene, view_named_say *say, void *arg)
{
    for (size_t i = 0; i < scene->plant->screens.view_count; i++) {
        const struct named_view *view = &scene->plant->screens.views[i];
        struct message_error error = { 0 };
        if (!view_named_check(scene, view->address, &error))
            say(arg, view, error.text);
    }
}
