/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds a named view by id or title in a daemon's or a plant's list of views, and adds its parameters to those on the command line. */
#include "saved_view.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "clients/link/daemon.h"
#include "message/view_address.h"
#include "views/named_views.h"

const char *saved_view_text(const json_t *view, const char *name)
{
    const char *text = json_string_value(json_object_get(view, name));
    return text ? text : "";
}

/* Returns true if one of the first `count` arguments, which come from the command line, overrides this argument of a view. */
static bool is_replaced(const struct snapshot_options *options, size_t count, const char *arg)
{
    bool replaced = options->baseline && view_address_replaces("baseline", arg);
    for (size_t i = 0; i < count && !replaced; i++)
        replaced = view_address_replaces(options->args[i], arg);
    return replaced;
}

bool saved_view_add_address(struct snapshot_options *options, const char *id, const char *text)
{
    struct view_address address = { 0 };
    struct message_error error;
    size_t given = options->arg_count;
    bool good = view_address_read(&address, text, &error);
    if (!good)
        fprintf(stderr, "plantcast: view '%s': %s\n", id, error.text);
    for (size_t i = 0; i < address.count && good; i++) {
        char *equals = strchr(address.args[i], '=');
        if (view_address_replaces("at", address.args[i]) || is_replaced(options, given, address.args[i]))
            continue;
        *equals = 0;
        good = snapshot_add_arg(options, address.args[i], equals + 1);
        if (!good)
            fprintf(stderr, "plantcast: view '%s' and the command line together have more than %d parameters\n", id, SNAPSHOT_MAX);
    }
    view_address_finish(&address);
    return good;
}

/* Returns the view with this id, else the only view with this title; NULL: none. The list owns the view. */
static const json_t *find(const json_t *list, const char *name)
{
    const json_t *view, *titled = NULL;
    size_t i, count = 0;
    json_array_foreach(list, i, view) {
        if (!strcmp(saved_view_text(view, "id"), name))
            return view;
        if (!strcmp(saved_view_text(view, "title"), name)) {
            titled = view;
            count++;
        }
    }
    return count == 1 ? titled : NULL;
}

static void print_unknown(const json_t *list, const char *from, const char *name)
{
    const json_t *view;
    size_t i;
    fprintf(stderr, "plantcast: %s: '%s' is neither the id of a view nor the title of exactly one view; %s\n", from, name,
            json_array_size(list) ? "ids and titles of the views:" : "there are no views");
    json_array_foreach(list, i, view) fprintf(stderr, "  %-24s %s\n", saved_view_text(view, "id"), saved_view_text(view, "title"));
}

/* Finds the view in `list` that the command line names. list: JSON array of views; NULL: no views. Returns NULL, with the
   reason printed, if it is missing. */
static const json_t *find_or_print(const struct snapshot_options *options, const json_t *list)
{
    const json_t *view = find(list, options->view);
    if (!view)
        print_unknown(list, options->from, options->view);
    return view;
}

bool saved_view_add_from_daemon(struct snapshot_options *options, bool present)
{
    struct daemon_url url;
    struct text body = { 0 };
    int status = daemon_url_parse(options->from, options->access, &url) ? daemon_get(&url, "/api/v1/views", &body) : 0;
    const char *answer = body.at ? body.at : "";
    bool good = status == 200;
    if (good) {
        /* looks the view up in the daemon's list but sends back only its id: the daemon adds the view's parameters, because the
           user's role may not permit them in a query */
        json_t *message = json_loads(answer, 0, NULL);
        const json_t *view = find_or_print(options, json_object_get(message, "list"));
        good = view && snapshot_add_arg(options, "view", saved_view_text(view, "id")) &&
               (!present || snapshot_add_arg(options, "at", "now"));
        json_decref(message);
    } else if (status == 403) {
        /* the token permits only pictures of certain views, not the list of views: sends the id and lets the daemon decide */
        good = snapshot_add_arg(options, "view", options->view);
    } else if (status) {
        fprintf(stderr, "plantcast: %s: the daemon answered with HTTP status %d: %s\n", options->from, status, answer);
    }
    text_finish(&body);
    return good;
}

bool saved_view_add_from_plant(struct snapshot_options *options, struct log *log, const struct plant *plant)
{
    char *folder = snapshot_options_folder(options, plant);
    struct named_views *views = named_views_open(log, plant, folder, NULL);
    json_t *message = named_views_message(views, NULL);
    const json_t *view = find_or_print(options, json_object_get(message, "list"));
    bool good = view && saved_view_add_address(options, saved_view_text(view, "id"), saved_view_text(view, "view"));
    json_decref(message);
    named_views_close(&views);
    mem_free(folder);
    return good;
}
