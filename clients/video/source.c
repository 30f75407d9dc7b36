/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests data from the daemon, one request at a time: its time zone, the saved views, and pictures. */
#include "source.h"

#include <errno.h>
#include <gio/gio.h>
#include <jansson.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/system/http_request.h"
#include "clients/link/png.h"
#include "message/view_address.h"
#include "video_words.h"

/* Timing in microseconds. A picture shows the instant of its request. The next picture is requested a fixed interval later and must
   arrive within SLOWEST_US, so that a shown picture is never older than OLDEST_US. OTHERS_US: time limit of other requests. VIEWS_US:
   interval at which the list of views is requested; LIMITED_US: the same if the token may not read that list. DENIED_US: pause of all
   requests after a token was refused. */
static const gint64 OLDEST_US = 2700000, SLOWEST_US = 1300000, OTHERS_US = 1200000, VIEWS_US = 5000000, LIMITED_US = 600000000,
                    DENIED_US = 8000000;
enum { MAX_BYTES = 128 << 20 }; /* limit of a response */

enum ask { ASK_PLANT, ASK_VIEWS, ASK_PICTURE, ASK_COUNT };

struct video_source {
    const struct video_options *options;
    struct http_request http; /* libcurl handle of the request; while `asking` is true, only the request's thread may use it */
    CURLcode code;            /* result of the request */
    bool asking;
    _Atomic bool ended;
    enum ask asked;
    gint64 asked_us, asked_utc_us, due_us[ASK_COUNT], wait_until_us; /* monotonic, except asked_utc_us */

    GTimeZone *zone;
    /* the saved view to show: view: its text as the daemon stores it; view_query: the same as a query of /snapshot.png;
       view_title: its title. NULL: not known yet, or the video shows no saved view */
    char *view, *view_query, *view_title;
    cairo_surface_t *picture;
    gint64 picture_us, age_ms;
    bool valued; /* true: the picture shows values, so the strip below it shows their age */
    char headline[120], detail[240], said[240];
    gint64 since_us;    /* UTC time since which the text card is shown; 0: a picture is shown */
    gint64 seen_utc_us; /* instant that the newest picture shows, UTC */
    bool barred;        /* true: access or the saved view was withdrawn, so the picture must be hidden immediately */
    bool limited;       /* true: the token may not list the saved views but may show this view, which is then requested by its id */
    guint64 pictures;
};

/* --- errors ------------------------------------------------------------------------------------------------- */

/* Copies a text for the text card or the log to `out`: only the first line of `said`, as valid UTF-8, cut to `size` bytes. Frees `said`. */
static void keep(char *said, char *out, gsize size)
{
    said[strcspn(said, "\n")] = 0;
    char *valid = g_utf8_make_valid(said, -1);
    g_strlcpy(out, valid, size);
    const char *whole; /* end of the last complete character: text cut inside a character cannot be drawn */
    g_utf8_validate(out, -1, &whole);
    out[whole - out] = 0;
    g_free(valid);
    g_free(said);
}

/* Shows a text card with a reason and logs the reason, the card in the chosen language, the log in English. */
static void fail(struct video_source *source, enum video_word headline, enum video_word detail, const char *a, const char *b)
{
    char said[sizeof(source->said)];
    keep(video_say(source->options->words, headline, NULL, NULL), source->headline, sizeof(source->headline));
    keep(video_say(source->options->words, detail, a, b), source->detail, sizeof(source->detail));
    keep(video_say(LANGUAGE_EN, detail, a, b), said, sizeof(said));
    if (strcmp(source->said, said) != 0)
        fprintf(stderr, "plantcast-video: %s: %s\n", source->options->url, said);
    g_strlcpy(source->said, said, sizeof(source->said));
}

/* Deletes the picture and keeps it hidden, so that the text card is shown instead. */
static void bar(struct video_source *source)
{
    source->barred = true;
    g_clear_pointer(&source->picture, cairo_surface_destroy);
}

static void refuse(struct video_source *source, long status)
{
    const struct text *body = &source->http.answer;
    char *words = g_strndup(body->at ? body->at : "", MIN(body->length, 160));
    if (status == 401 || status == 403) {
        fail(source, VIDEO_NOT_LET_IN, VIDEO_TOKEN, words, NULL);
        bar(source);
        source->wait_until_us = source->asked_us + DENIED_US; /* waits before the next request, because the daemon slows down
                                                                 clients that repeatedly send wrong tokens */
    } else if (status == 429) {
        fail(source, VIDEO_NOT_LET_IN, VIDEO_TOKENS, NULL, NULL);
        source->wait_until_us = source->asked_us + DENIED_US;
    } else if (status == 400 || status == 404) {
        fail(source, VIDEO_NO_VIEW, VIDEO_SAID, words, NULL);
        bar(source);
    } else {
        char number[16];
        g_snprintf(number, sizeof(number), "%ld", status);
        fail(source, VIDEO_NO_PICTURE, VIDEO_ANSWERS, number, words);
    }
    g_free(words);
}

/* --- responses ------------------------------------------------------------------------------------------- */

static void take_plant(struct video_source *source, const json_t *o)
{
    const char *zone = json_string_value(json_object_get(json_object_get(o, "plant"), "time_zone"));
    GTimeZone *found = zone ? g_time_zone_new_identifier(zone) : NULL;
    if (found) {
        g_time_zone_unref(source->zone);
        source->zone = found;
    }
    const char *name = json_string_value(json_object_get(json_object_get(o, "plant"), "name"));
    if (!source->options->view && name) {
        g_free(source->view_title);
        source->view_title = g_strdup(name);
    }
}

/* Returns a saved view as a query for /snapshot.png (g_free). Leaves out the instant, the selection, and the field settings that need
   the role engineer. Returns NULL, with the reason in *error, if a picture cannot show the view. */
static char *query_of(const char *view, struct message_error *error)
{
    static const char *const left_out[] = {
        "at", "selected", "fill", "strength", "decay", "power", "radius_m", "reach_m", "sensors", NULL
    };
    struct view_address address;
    GString *query = g_string_new("");
    bool good = view_address_read(&address, *view == '#' ? view + 1 : view, error);
    for (size_t i = 0; i < address.count; i++) {
        char **pair = g_strsplit(address.args[i], "=", 2);
        char *value = g_uri_escape_string(pair[1], ",:;=", TRUE);
        if (!g_strv_contains(left_out, pair[0]))
            g_string_append_printf(query, "&%s=%s", pair[0], value);
        g_free(value);
        g_strfreev(pair);
    }
    view_address_finish(&address);
    return g_string_free(query, !good);
}

static void take_view(struct video_source *source, const char *view, const char *title)
{
    struct message_error error = { 0 };
    g_free(source->view_title);
    source->view_title = g_strdup(title);
    if (g_strcmp0(source->view, view) == 0)
        return;
    source->due_us[ASK_PICTURE] = 0;
    g_free(source->view);
    g_free(source->view_query);
    source->view_query = query_of(view, &error);
    source->view = source->view_query ? g_strdup(view) : NULL;
    if (!source->view) {
        fail(source, VIDEO_NO_VIEW, VIDEO_SAID, error.text, NULL);
        bar(source);
    }
}

static void take_views(struct video_source *source, const json_t *o)
{
    const json_t *one;
    size_t i;
    GString *names = g_string_new("");
    bool found = false;
    json_array_foreach(json_object_get(o, "list"), i, one)
    {
        const char *id = json_string_value(json_object_get(one, "id")), *view = json_string_value(json_object_get(one, "view")),
                   *title = json_string_value(json_object_get(one, "title"));
        if (id && view && !strcmp(id, source->options->view)) {
            take_view(source, view, title && *title ? title : id);
            found = true;
        }
        g_string_append_printf(names, "%s%s", i ? ", " : "", id ? id : "");
    }
    if (!found) {
        g_clear_pointer(&source->view, g_free);
        char *none = video_say(source->options->words, VIDEO_NONE, NULL, NULL);
        fail(source, VIDEO_NO_VIEW, VIDEO_VIEWS, source->options->view, names->len ? names->str : none);
        g_free(none);
        bar(source);
    }
    g_string_free(names, TRUE);
}

static guint32 big_endian(const guint8 *at)
{
    return (guint32)at[0] << 24 | (guint32)at[1] << 16 | (guint32)at[2] << 8 | at[3];
}

/* Returns the picture in the response, or NULL if the response is not a PNG file of the requested size. */
static cairo_surface_t *decode(const struct video_options *options, const struct text *body)
{
    const guint8 *at = (const guint8 *)body->at;
    if (body->length < 24 || big_endian(at + 16) != (guint32)options->width_px ||
        big_endian(at + 20) != (guint32)canvas_picture_px(options->height_px))
        return NULL;
    return png_read(at, body->length);
}

static void take_picture(struct video_source *source)
{
    struct curl_header *header = NULL;
    CURLHcode found = curl_easy_header(source->http.handle, "Plantcast-Frame", 0, CURLH_HEADER, -1, &header);
    const char *age = found == CURLHE_OK ? strstr(header->value, "oldest_age_ms=") : NULL;
    gint64 took_us = g_get_monotonic_time() - source->asked_us;
    cairo_surface_t *picture = NULL;
    char number[32], other[32];
    if (took_us > SLOWEST_US) {
        g_snprintf(number, sizeof(number), "%.1f", (double)took_us / 1e6);
        g_snprintf(other, sizeof(other), "%.1f", (double)SLOWEST_US / 1e6);
        fail(source, VIDEO_TOO_SLOW, VIDEO_TOOK, number, other);
    } else if (!age) {
        fail(source, VIDEO_NO_PICTURE, VIDEO_EARLIER, NULL, NULL);
    } else if (!(picture = decode(source->options, &source->http.answer))) {
        g_snprintf(number, sizeof(number), "%d", source->options->width_px);
        g_snprintf(other, sizeof(other), "%d", canvas_picture_px(source->options->height_px));
        fail(source, VIDEO_NO_PICTURE, VIDEO_NO_PNG, number, other);
    }
    if (!picture)
        return;
    g_clear_pointer(&source->picture, cairo_surface_destroy);
    source->picture = picture;
    source->picture_us = source->asked_us;
    source->seen_utc_us = source->asked_utc_us;
    source->age_ms = strncmp(age + 14, "none", 4) ? g_ascii_strtoll(age + 14, NULL, 10) : -1;
    source->barred = false;
    source->pictures++;
}

static void on_answer(struct video_source *source)
{
    long status = 0;
    curl_easy_getinfo(source->http.handle, CURLINFO_RESPONSE_CODE, &status);
    if (source->code == CURLE_OPERATION_TIMEDOUT) {
        fail(source, VIDEO_SILENT, VIDEO_NO_ANSWER, NULL, NULL);
        return;
    }
    if (source->code != CURLE_OK) {
        fail(source, VIDEO_NO_CONNECTION, VIDEO_SAID, http_request_why(&source->http, source->code), NULL);
        return;
    }
    if (source->asked == ASK_VIEWS && (status == 403 || status == 200))
        source->limited = status == 403;
    /* A token may allow pictures of the view but not the list of views, so status 403 is not final: the picture request
       decides. The list is requested again only after LIMITED_US, because the daemon writes each refusal to its audit trail. */
    if (source->asked == ASK_VIEWS && status == 403) {
        source->due_us[ASK_VIEWS] = source->asked_us + LIMITED_US;
        return;
    }
    if (status != 200) {
        /* errors of this request do not hide the picture, unless the daemon refused the token (401, 403) */
        if (source->asked == ASK_PLANT && status != 401 && status != 403)
            return;
        refuse(source, status);
        return;
    }
    if (source->asked == ASK_PICTURE) {
        take_picture(source);
        return;
    }
    json_t *o = json_loadb(source->http.answer.at ? source->http.answer.at : "", source->http.answer.length, 0, NULL);
    if (source->asked == ASK_PLANT)
        take_plant(source, o);
    else
        take_views(source, o);
    json_decref(o);
}

/* --- requests ---------------------------------------------------------------------------------------- */

/* Thread function: performs the request while the main loop keeps drawing frames. */
static void perform(GTask *task, gpointer object, gpointer data, GCancellable *cancel)
{
    struct video_source *source = data;
    (void)object;
    (void)cancel;
    source->code = curl_easy_perform(source->http.handle);
    g_task_return_boolean(task, TRUE);
}

static void on_performed(GObject *object, GAsyncResult *result, gpointer data)
{
    struct video_source *source = data;
    (void)object;
    (void)result;
    source->asking = false;
    if (!source->ended)
        on_answer(source);
    text_finish(&source->http.answer);
}

static char *url_of(const struct video_source *source, enum ask ask)
{
    const struct video_options *options = source->options;
    if (ask != ASK_PICTURE)
        return g_strconcat(options->url, ask == ASK_PLANT ? "api/v1/plant" : "api/v1/views", NULL);
    GString *url = g_string_new(options->url);
    g_string_append_printf(url, "snapshot.png?width=%d&height=%d", options->width_px, canvas_picture_px(options->height_px));
    if (!options->query || !strstr(options->query, "language="))
        g_string_append_printf(url, "&language=%s", options->language);
    if (options->query)
        g_string_append_printf(url, "&%s", options->query);
    char *id = source->limited ? g_uri_escape_string(source->options->view, NULL, FALSE) : NULL;
    if (id)
        g_string_append_printf(url, "&view=%s", id);
    else if (source->view)
        g_string_append(url, source->view_query);
    g_free(id);
    return g_string_free(url, FALSE);
}

static void ask(struct video_source *source, enum ask what, gint64 now_us)
{
    static const gint64 again_us[ASK_COUNT] = { [ASK_PLANT] = 600 * G_USEC_PER_SEC, [ASK_VIEWS] = VIEWS_US };
    char *url = url_of(source, what);
    source->asked = what;
    source->asked_us = now_us;
    source->asked_utc_us = g_get_real_time();
    source->due_us[what] = now_us + (what == ASK_PICTURE ? source->options->every_ms * 1000 : again_us[what]);
    if (what == ASK_PICTURE)
        source->valued = strstr(url, "&split=") || (!strstr(url, "&look=materials") && !strstr(url, "&show=distance"));
    gint64 most_us = what == ASK_PICTURE ? OLDEST_US : OTHERS_US;
    CURLcode good = curl_easy_setopt(source->http.handle, CURLOPT_URL, url); /* curl copies it */
    curl_easy_setopt(source->http.handle, CURLOPT_TIMEOUT_MS, (long)(most_us / 1000));
    g_free(url);
    if (good != CURLE_OK) {
        fail(source, VIDEO_NO_VIEW, VIDEO_NO_URL, NULL, NULL);
        return;
    }
    source->http.error[0] = 0;
    source->asking = true;
    GTask *task = g_task_new(NULL, NULL, on_performed, source);
    g_task_set_task_data(task, source, NULL);
    g_task_run_in_thread(task, perform);
    g_object_unref(task);
}

/* Starts the next request that is due. Pictures come first, except that a saved view must be known before its first picture. */
static void go_on(struct video_source *source, gint64 now_us)
{
    if (source->asking || now_us < source->wait_until_us)
        return;
    bool nameless = source->options->view && !source->view && !source->limited;
    if (nameless && now_us >= MIN(source->due_us[ASK_VIEWS], source->asked_us + G_USEC_PER_SEC))
        ask(source, ASK_VIEWS, now_us);
    else if (!nameless && now_us >= source->due_us[ASK_PICTURE])
        ask(source, ASK_PICTURE, now_us);
    else if (!nameless && source->options->view && now_us >= source->due_us[ASK_VIEWS])
        ask(source, ASK_VIEWS, now_us);
    else if (source->pictures > 0 && now_us >= source->due_us[ASK_PLANT])
        ask(source, ASK_PLANT, now_us);
}

/* --- decides what a frame shows: the newest picture, or a text card with the reason why there is none ----------- */

void source_look(struct video_source *source, struct shown *out)
{
    gint64 now_us = g_get_monotonic_time();
    go_on(source, now_us);
    bool young = source->picture && !source->barred && now_us - source->picture_us < OLDEST_US;
    bool frozen = young && source->age_ms < 0 && source->valued;
    const char *title = source->view_title ? source->view_title : source->limited ? source->options->view : "";
    *out = (struct shown){ .title = title, .zone = source->zone, .words = source->options->words, .age_ms = -1 };
    out->headline = source->headline;
    out->detail = source->detail;
    if (young && !frozen) {
        if (source->since_us)
            fprintf(stderr, "plantcast-video: %s: pictures arrive again\n", source->options->url);
        source->since_us = 0;
        source->said[0] = 0;
        out->picture = source->picture;
        out->age_ms = source->age_ms < 0 ? -1 : source->age_ms + (now_us - source->picture_us) / 1000;
        return;
    }
    if (frozen)
        fail(source, VIDEO_NO_VALUES, VIDEO_NO_VALUE, NULL, NULL);
    else if (source->picture && !source->barred && !source->said[0])
        fail(source, VIDEO_SILENT, VIDEO_NO_ANSWER, NULL, NULL);
    if (!source->since_us)
        source->since_us = source->seen_utc_us && !frozen ? source->seen_utc_us : g_get_real_time();
    out->since_us = source->since_us;
}

guint64 source_pictures(const struct video_source *source)
{
    return source->pictures;
}

/* --- creating and destroying ----------------------------------------------------------------------- */

struct video_source *source_create(const struct video_options *options)
{
    if (options->ca_path && access(options->ca_path, R_OK) != 0) {
        fprintf(stderr, "plantcast-video: %s: %s\n", options->ca_path, g_strerror(errno));
        return NULL;
    }
    struct video_source *source = g_new0(struct video_source, 1);
    source->options = options;
    source->zone = g_time_zone_new_local();
    source->http = (struct http_request){ .most_bytes = MAX_BYTES, .stop = &source->ended };
    if (!http_request_make(&source->http, "plantcast-video", options->ca_path)) {
        source_destroy(&source);
        return NULL;
    }
    if (options->token)
        http_request_authorize(&source->http, "Bearer ", options->token);
    keep(video_say(source->options->words, VIDEO_STARTING, NULL, NULL), source->headline, sizeof(source->headline));
    keep(video_say(source->options->words, VIDEO_NOTHING_YET, NULL, NULL), source->detail, sizeof(source->detail));
    return source;
}

void source_destroy(struct video_source **pointer)
{
    struct video_source *source = *pointer;
    if (!source)
        return;
    *pointer = NULL;
    source->ended = true;
    while (source->asking)
        g_main_context_iteration(NULL, TRUE);
    g_clear_pointer(&source->picture, cairo_surface_destroy);
    http_request_finish(&source->http);
    g_time_zone_unref(source->zone);
    g_free(source->view);
    g_free(source->view_query);
    g_free(source->view_title);
    g_free(source);
}
