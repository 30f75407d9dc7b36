/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast clip`: makes a film of recorded history from pictures drawn by a daemon or by the offline renderer. */
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "clients/cli/picture/offline_renderer.h"
#include "clients/cli/picture/saved_view.h"
#include "clients/link/daemon.h"
#include "commands.h"
#include "message/views_message.h"
#include "signed_film.h"
#include "tour.h"
#include "video.h"

enum { MAX_PICTURES = 1000000, SAY_EACH = 250 };

struct film {
    struct snapshot_options *options;
    struct video *video;
    struct offline_renderer offline; /* renderer for a film that is made without a daemon */
    struct view view;
    struct daemon_url url;
    struct text query;
    const char *said;                   /* text that is drawn into the pictures of the tour's current stop; empty: none */
    long count;                         /* pictures made so far */
    struct film_statements *statements; /* the server's signed statements about the pictures of a signed film; NULL: the film is not
                                           signed */
};

/* Appends a picture. The first picture creates the file and determines the film's size. Returns false on failure. */
static bool add_picture(struct film *film, uint8_t *bgrx, int width_px, int height_px, int stride_bytes)
{
    if (!film->video)
        film->video = video_create(film->options->out, width_px, height_px, film->options->fps, film->options->is_signed);
    if (*film->said)
        tour_draw_text(film->said, bgrx, width_px, height_px, stride_bytes);
    return film->video && video_add(film->video, bgrx, stride_bytes);
}

/* --- pictures ----------------------------------------------------------------------------------------------------------------- */

static bool draw(struct film *film, int64_t at_us)
{
    if (!offline_renderer_seek(&film->offline, at_us, &film->view))
        return false;
    struct frame *frame = offline_renderer_draw(&film->offline, film->options, &film->view);
    bool good = frame && add_picture(film, frame->bgrx, frame->width_px, frame->height_px, frame->stride_bytes);
    frame_unref(&frame);
    return good;
}

static bool add_png(struct film *film, const struct text *body)
{
    png_image image = { .version = PNG_IMAGE_VERSION };
    if (!png_image_begin_read_from_memory(&image, body->at, body->length)) {
        fprintf(stderr, "plantcast: %s: the server's answer is not a PNG file: %s\n", film->options->from, image.message);
        return false;
    }
    image.format = PNG_FORMAT_BGRA;
    int stride = (int)PNG_IMAGE_ROW_STRIDE(image), width_px = (int)image.width, height_px = (int)image.height;
    uint8_t *bgrx = mem_array(image.height, (size_t)stride);
    bool good = png_image_finish_read(&image, NULL, bgrx, stride, NULL) && add_picture(film, bgrx, width_px, height_px, stride);
    mem_free(bgrx);
    return good;
}

static bool take_statement(struct film *film, const struct text *body)
{
    if (film_statements_add(film->statements, (const uint8_t *)body->at, body->length))
        return true;
    fprintf(stderr, "plantcast: %s: a frame has no signature: start plantcastd with --signing-key, and make --size at least 256x256\n",
            film->options->from);
    return false;
}

static bool download(struct film *film, int64_t at_us)
{
    struct text body = { 0 };
    char *path = mem_printf("/snapshot.png?at=%lld.%06lld%s", (long long)(at_us / 1000000), (long long)(at_us % 1000000),
                            film->query.at ? film->query.at : "");
    int status = daemon_get(&film->url, path, &body);
    if (status && status != 200)
        fprintf(stderr, "plantcast: %s: the daemon answered with HTTP status %d: "
                        "%s\n", film->options->from, status, body.at ? body.at : "");
    bool good = status == 200 && (!film->options->is_signed || take_statement(film, &body)) && add_png(film, &body);
    text_finish(&body);
    mem_free(path);
    return good;
}

/* --- the film ------------------------------------------------------------------------------------------------------------------ */

typedef bool picture_fn(struct film *film, int64_t at_us);

/* Makes the next `count` pictures with one call of `picture` each. all: number of pictures in the whole film, for progress reports. */
static bool shoot(struct film *film, picture_fn *picture, long count, double all)
{
    const struct snapshot_options *options = film->options;
    double step_us = options->speed / options->fps * 1e6;
    bool good = true;
    for (long i = 0; i < count && good; i++) {
        good = picture(film, options->from_us + (int64_t)((double)film->count * step_us));
        if (good && ++film->count % SAY_EACH == 0)
            fprintf(stderr, "plantcast: %ld of %.0f frames\n", film->count, all);
    }
    return good;
}

/* Switches to the view of a stop (one view of a tour). Returns false on failure. */
static bool turn(struct film *film, const json_t *stop)
{
    struct snapshot_options *options = film->options;
    size_t own = options->arg_count;
    bool offline = film->offline.plant, good = tour_add_view(stop, offline, options);
    film->query.length = 0;
    good = good &&
           (offline ? offline_renderer_take_view(&film->offline, options, &film->view) : snapshot_query(options, &film->query));
    while (options->arg_count > own)
        mem_free(options->args[--options->arg_count]);
    film->said = options->is_signed ? "" : tour_text(stop); /* a signed film has no text in its pictures, because that would
                                                               invalidate their signatures */
    return good;
}

static long pictures_of(const struct film *film, const json_t *stop)
{
    return lround(fmax(1, tour_dwell_s(stop) * film->options->fps));
}

/* Writes the texts of a signed film's tour as subtitles to a file next to the film. */
static bool write_texts(const struct film *film, const json_t *stops)
{
    double *from_s = mem_array(json_array_size(stops) + 1, sizeof(*from_s));
    const json_t *stop;
    size_t i;
    json_array_foreach(stops, i, stop) from_s[i + 1] = from_s[i] + (double)pictures_of(film, stop) / film->options->fps;
    bool good = tour_write_subtitles(stops, from_s, film->options->out);
    mem_free(from_s);
    return good;
}

/* Makes the film. stops: the views of a tour; NULL: one view from one instant to another. */
static bool make(struct film *film, picture_fn *picture, const json_t *stops)
{
    const struct snapshot_options *options = film->options;
    double count = stops ? 0 : floor((double)(options->to_us - options->from_us) / (options->speed / options->fps * 1e6)) + 1;
    json_t *stop;
    size_t i;
    json_array_foreach(stops, i, stop) count += (double)pictures_of(film, stop);
    bool good = count <= MAX_PICTURES;
    if (!good)
        fprintf(stderr, "plantcast: the clip would have %.0f frames; at most %d are possible: use a higher --speed or a shorter period\n",
                count, MAX_PICTURES);
    if (good && !stops)
        good = shoot(film, picture, (long)count, count);
    for (i = 0; i < json_array_size(stops) && good; i++) {
        stop = json_array_get(stops, i);
        good = turn(film, stop) && shoot(film, picture, pictures_of(film, stop), count);
    }
    if (good && options->is_signed)
        good = film_statements_put(film->statements, film->video) && (!stops || write_texts(film, stops));
    good = video_finish(&film->video, good);
    if (good)
        printf("%s: %.0f frames, %.1f s\n", options->out, count, count / options->fps);
    return good;
}

/* Makes the film. answer: a daemon's response with its tours as JSON, needed if the options name a tour; freed here. */
static bool make_of(struct film *film, picture_fn *picture, char *answer)
{
    const struct snapshot_options *options = film->options;
    json_t *stops = options->tour ? tour_stops(answer ? answer : "", options->from, options->tour) : NULL;
    bool good = (stops || !options->tour) && make(film, picture, stops);
    json_decref(stops);
    mem_free(answer);
    return good;
}

static int from_plant(struct film *film)
{
    int code = offline_renderer_open(&film->offline, film->options, &film->view);
    if (code == 0 &&
        !(offline_renderer_open_history(&film->offline, film->options) && offline_renderer_open_gl(&film->offline, film->options)))
        code = 1;
    if (code == 0)
        code = make_of(film, draw, film->options->tour ? walls_text(film->offline.plant, NULL) : NULL) ? 0 : 1;
    offline_renderer_close(&film->offline);
    return code;
}

/* Requests the daemon's walls and tours. Returns them as JSON, or NULL with the reason printed. */
static char *ask_tours(struct film *film)
{
    struct text body = { 0 };
    int status = daemon_get(&film->url, "/api/v1/walls", &body);
    if (status && status != 200)
        fprintf(stderr, "plantcast: %s: the daemon answered with HTTP status %d: "
                        "%s\n", film->options->from, status, body.at ? body.at : "");
    char *answer = status == 200 && body.at ? mem_strdup(body.at) : NULL;
    text_finish(&body);
    return answer;
}

static int from_daemon(struct film *film)
{
    int code = 2;
    film->statements = film->options->is_signed ? film_statements_create() : NULL;
    if (film->options->view && !saved_view_add_from_daemon(film->options, false))
        code = 1;
    else if (daemon_url_parse(film->options->from, film->options->access, &film->url) && snapshot_query(film->options, &film->query)) {
        char *answer = film->options->tour ? ask_tours(film) : NULL;
        code = (answer || !film->options->tour) && make_of(film, download, answer) ? 0 : 1;
    }
    text_finish(&film->query);
    film_statements_destroy(&film->statements);
    return code;
}

int command_clip(const struct daemon_access *access, int argc, char **argv)
{
    struct snapshot_options options;
    int code = snapshot_parse(argc, argv, true, &options);
    options.access = access;
    struct film film = { .options = &options, .said = "" };
    bool daemon = code < 0 && strstr(options.from, "://");
    if (code < 0 && options.is_signed && !daemon) {
        fputs("plantcast: --signed needs the URL of a daemon with --signing-key instead of a plant file\n", stderr);
        code = 2;
    }
    if (code < 0)
        code = daemon ? from_daemon(&film) : from_plant(&film);
    snapshot_options_finish(&options);
    return code;
}
