/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests data from the daemon, one request at a time: the saved views, and pictures. */
#include "source.h"

#include <errno.h>
#include <gio/gio.h>
#include <jansson.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/system/http_request.h"
#include "clients/link/png.h"
#include "video_words.h"

/* Timing in microseconds. A picture shows the instant of its request. The next picture is requested a fixed interval later and must
   arrive within SLOWEST_US, so that a shown picture is never older than OLDEST_US. OTHERS_US: time limit of other requests. VIEWS_US:
   interval at which the list of views is requested; LIMITED_US: the same if the token may not read that list. DENIED_US: pause of all
   requests after a token was refused. */
static const gint64 OLDEST_US = 2700000, SLOWEST_US = 1300000, OTHERS_US = 1200000, VIEWS_US = 5000000, LIMITED_US = 600000000,
                    DENIED_US = 8000000;
enum { MAX_BYTES = 128 << 20 }; /* limit of a response */

enum ask { ASK_VIEWS, ASK_PICTURE, ASK_COUNT };

struct video_source {
    const struct video_options *options;
    struct http_request http; /* libcurl handle of the request; while `asking` is true, only the request's thread may use it */
    CURLcode code;            /* result of the request */
    bool asking;
    _Atomic bool ended;
    enum ask asked;
    gint64 asked_us, asked_utc_us, due_us[ASK_COUNT], wait_until_us; /* monotonic, except asked_utc_us */

    GTimeZone *zone;
    char *zone_name; /* IANA name of `zone`; NULL: `zone` is this machine's, because the plant's is not known yet */
    char *view;      /* the saved view to show, as the daemon stores it; NULL: not known yet, or the video shows no saved view */
    char *title;     /* title of the saved view, else the plant's name; NULL: not known */
    cairo_surface_t *picture;
    gint64 picture_us, age_ms;
    bool valued; /* true: the picture shows readings, so without any usable reading a text card takes its place */
    char headline[120], detail[240], said[240];
    gint64 since_us;    /* UTC time since which the text card is shown; 0: a picture is shown */
    gint64 seen_utc_us; /* instant that the newest picture shows, UTC */
    bool barred;        /* true: access or the saved view was withdrawn, so the picture must be hidden immediately */
    bool limited;       /* true: the token may not list the saved views but may show this view */
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

static void take_view(struct video_source *source, const char *view, const char *title)
{
    g_free(source->title);
    source->title = g_strdup(title);
    if (g_strcmp0(source->view, view) == 0)
        return;
    source->due_us[ASK_PICTURE] = 0;
    g_free(source->view);
    source->view = g_strdup(view);
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

/* Returns the value of a part of the header Plantcast-Frame, decoded (g_free). Returns NULL if the header does not have the part. name:
   the part's name with an equals sign. */
static char *part_of(const char *header, const char *name)
{
    char **parts = g_strsplit(header, ", ", -1), *value = NULL;
    for (char **part = parts; *part && !value; part++)
        if (g_str_has_prefix(*part, name))
            value = g_uri_unescape_string(*part + strlen(name), NULL);
    g_strfreev(parts);
    return value;
}

static bool says(const char *header, const char *name, const char *expected)
{
    char *value = part_of(header, name);
    bool same = g_strcmp0(value, expected) == 0;
    g_free(value);
    return same;
}

/* Reads the plant's time zone and, if the video shows no saved view, the plant's name. */
static void take_plant(struct video_source *source, const char *header)
{
    char *zone_name = part_of(header, "time_zone="), *name = source->options->view ? NULL : part_of(header, "plant=");
    GTimeZone *zone = zone_name && g_strcmp0(zone_name, source->zone_name) != 0 ? g_time_zone_new_identifier(zone_name) : NULL;
    if (zone) {
        g_time_zone_unref(source->zone);
        source->zone = zone;
        g_free(source->zone_name);
        source->zone_name = g_steal_pointer(&zone_name);
    }
    if (name) {
        g_free(source->title);
        source->title = g_steal_pointer(&name);
    }
    g_free(zone_name);
    g_free(name);
}

static void take_picture(struct video_source *source)
{
    struct curl_header *header = NULL;
    CURLHcode found = curl_easy_header(source->http.handle, "Plantcast-Frame", 0, CURLH_HEADER, -1, &header);
    char *age = found == CURLHE_OK ? part_of(header->value, "oldest_age_ms=") : NULL;
    bool past = age && says(header->value, "past=", "yes");
    gint64 took_us = g_get_monotonic_time() - source->asked_us;
    cairo_surface_t *picture = NULL;
    char number[32], other[32];
    if (took_us > SLOWEST_US) {
        g_snprintf(number, sizeof(number), "%.1f", (double)took_us / 1e6);
        g_snprintf(other, sizeof(other), "%.1f", (double)SLOWEST_US / 1e6);
        fail(source, VIDEO_TOO_SLOW, VIDEO_TOOK, number, other);
    } else if (!age) {
        fail(source, VIDEO_NO_PICTURE, VIDEO_EARLIER, NULL, NULL);
    } else if (past) {
        fail(source, VIDEO_NO_PICTURE, VIDEO_PAST, NULL, NULL);
        bar(source);
        source->wait_until_us = source->asked_us + DENIED_US;
    } else if (!(picture = decode(source->options, &source->http.answer))) {
        g_snprintf(number, sizeof(number), "%d", source->options->width_px);
        g_snprintf(other, sizeof(other), "%d", canvas_picture_px(source->options->height_px));
        fail(source, VIDEO_NO_PICTURE, VIDEO_NO_PNG, number, other);
    }
    if (picture) {
        source->age_ms = strcmp(age, "none") != 0 ? g_ascii_strtoll(age, NULL, 10) : -1;
        source->valued = !says(header->value, "shows_readings=", "no");
        take_plant(source, header->value);
    }
    g_free(age);
    if (!picture)
        return;
    g_clear_pointer(&source->picture, cairo_surface_destroy);
    source->picture = picture;
    source->picture_us = source->asked_us;
    source->seen_utc_us = source->asked_utc_us;
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
        refuse(source, status);
        return;
    }
    if (source->asked == ASK_PICTURE) {
        take_picture(source);
        return;
    }
    json_t *o = json_loadb(source->http.answer.at ? source->http.answer.at : "", source->http.answer.length, 0, NULL);
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
        return g_strconcat(options->url, "api/v1/views", NULL);
    GString *url = g_string_new(options->url);
    g_string_append_printf(url, "snapshot.png?width=%d&height=%d", options->width_px, canvas_picture_px(options->height_px));
    if (!options->query || !strstr(options->query, "language="))
        g_string_append_printf(url, "&language=%s", options->language);
    if (options->query)
        g_string_append_printf(url, "&%s", options->query);
    /* The view is requested by its id, because it may have parameters that the token's role may not send. A token for some views may not
       send `at`. */
    char *id = options->view ? g_uri_escape_string(options->view, NULL, FALSE) : NULL;
    if (id)
        g_string_append_printf(url, "&view=%s%s", id, source->limited ? "" : "&at=now");
    g_free(id);
    return g_string_free(url, FALSE);
}

static void ask(struct video_source *source, enum ask what, gint64 now_us)
{
    char *url = url_of(source, what);
    source->asked = what;
    source->asked_us = now_us;
    source->asked_utc_us = g_get_real_time();
    source->due_us[what] = now_us + (what == ASK_PICTURE ? source->options->every_ms * 1000 : VIEWS_US);
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
}

/* --- decides what a frame shows: the newest picture, or a text card with the reason why there is none ----------- */

void source_look(struct video_source *source, struct shown *out)
{
    gint64 now_us = g_get_monotonic_time();
    go_on(source, now_us);
    bool young = source->picture && !source->barred && now_us - source->picture_us < OLDEST_US;
    bool frozen = young && source->age_ms < 0 && source->valued;
    const char *title = source->title ? source->title : source->limited ? source->options->view : "";
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
    g_free(source->zone_name);
    g_free(source->title);
    g_free(source);
}
