/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names and values of the page's address, as /snapshot.png has them. */
#include "view_query.h"

#include <libsoup/soup.h>
#include <stdbool.h>
#include <string.h>

static void add(GString *query, const char *name, const char *value)
{
    char *escaped = g_uri_escape_string(value, ",:;=", TRUE);
    g_string_append_printf(query, "&%s=%s", name, escaped);
    g_free(escaped);
}

static guint count_of(const char *list, char separator)
{
    guint count = 1;
    for (; *list; list++)
        count += *list == separator;
    return count;
}

/* eye, target, up, field of view, and the height of an orthographic view; a snapshot has Z up. */
static void add_camera(GString *query, const char *value)
{
    char **n = g_strsplit(value, ",", -1);
    guint count = g_strv_length(n);
    if (count == 10 || count == 11) {
        char *camera = g_strjoin(",", n[0], n[1], n[2], n[3], n[4], n[5], count == 10 ? n[9] : NULL, NULL);
        add(query, "camera", camera);
        g_free(camera);
    }
    if (count == 11) {
        add(query, "projection", "orthographic");
        add(query, "height_m", n[10]);
    }
    g_strfreev(n);
}

static void add_split(GString *query, const char *value)
{
    char *halves = strcmp(value, "same") ? g_strdup(value) : g_strdup("");
    g_strdelimit(halves, ":", '=');
    add(query, "split", halves);
    g_free(halves);
}

static void add_clip(GString *query, const char *value)
{
    bool box = !strchr(value, ';') && count_of(value, ',') == 6;
    add(query, box ? "clip_box" : "clip", value);
}

void view_query_add(GString *query, const char *view)
{
    static const char *const names[][2] = {
        { "group", NULL },    { "interpolation", NULL }, { "distance", NULL },        { "colormap", NULL },    { "look", NULL },
        { "scale", NULL },    { "show", NULL },          { "sensor", NULL },          { "environment", NULL }, { "baseline", NULL },
        { "range", NULL },    { "light", NULL },         { "breaks", NULL },          { "isolines", NULL },    { "ghost", NULL },
        { "hide", "hidden" }, { "only", "isolate" },     { "ramp", "ramp_interval" },
    };
    GHashTable *fields = soup_form_decode(*view == '#' ? view + 1 : view);
    const char *value;
    for (size_t i = 0; i < G_N_ELEMENTS(names); i++)
        if ((value = g_hash_table_lookup(fields, names[i][0])) != NULL)
            add(query, names[i][1] ? names[i][1] : names[i][0], value);
    if ((value = g_hash_table_lookup(fields, "camera")) != NULL)
        add_camera(query, value);
    if ((value = g_hash_table_lookup(fields, "split")) != NULL)
        add_split(query, value);
    if ((value = g_hash_table_lookup(fields, "clip")) != NULL)
        add_clip(query, value);
    g_hash_table_destroy(fields);
}
