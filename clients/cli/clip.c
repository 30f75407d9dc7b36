/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast clip`: a film of the past, picture by picture from a daemon or drawn here. */
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "commands.h"

#ifndef PLANTCAST_H264
int cmd_clip(int argc, char **argv)
{
    (void)argc;
    (void)argv;
    fputs("plantcast: clip: this program was built without H.264 (CODECS=jpeg), and so without films\n", stderr);
    return 1;
}
#else
#include "clients/link/daemon.h"
#include "offline_renderer.h"
#include "video.h"

enum { MOST_PICTURES = 1000000, SAY_EACH = 250 };

struct film {
    struct snapshot_options *options;
    struct video *video;
    struct offline_renderer offline; /* without a daemon */
    struct view view;
    struct daemon_url url;
    struct text query;
};

/* The file is made with the first picture, whose size tells its own. */
static bool add(struct film *film, const uint8_t *bgrx, int width_px, int height_px, int stride_bytes)
{
    if (!film->video)
        film->video = video_create(film->options->out, width_px, height_px, film->options->fps);
    return film->video && video_add(film->video, bgrx, stride_bytes);
}

/* --- pictures ----------------------------------------------------------------------------------------------------------------- */

static bool draw(struct film *film, int64_t at_us)
{
    if (!offline_renderer_seek(&film->offline, at_us, &film->view))
        return false;
    struct frame *frame = offline_renderer_draw(&film->offline, film->options, &film->view);
    bool good = frame && add(film, frame->bgrx, frame->width_px, frame->height_px, frame->stride_bytes);
    frame_unref(&frame);
    return good;
}

static bool add_png(struct film *film, const struct text *body)
{
    png_image image = { .version = PNG_IMAGE_VERSION };
    if (!png_image_begin_read_from_memory(&image, body->at, body->length)) {
        fprintf(stderr, "plantcast: %s: what the daemon sent is no PNG: %s\n", film->options->from, image.message);
        return false;
    }
    image.format = PNG_FORMAT_BGRA;
    int stride = (int)PNG_IMAGE_ROW_STRIDE(image), width_px = (int)image.width, height_px = (int)image.height;
    uint8_t *bgrx = mem_array(image.height, (size_t)stride);
    bool good = png_image_finish_read(&image, NULL, bgrx, stride, NULL) && add(film, bgrx, width_px, height_px, stride);
    mem_free(bgrx);
    return good;
}

static bool download(struct film *film, int64_t at_us)
{
    struct text body = { 0 };
    char *path = mem_printf("/snapshot.png?at=%lld.%06lld%s", (long long)(at_us / 1000000), (long long)(at_us % 1000000),
                            film->query.at ? film->query.at : "");
    int status = daemon_get(&film->url, path, &body);
    if (status && status != 200)
        fprintf(stderr, "plantcast: %s: the daemon answers %d: %s\n", film->options->from, status, body.at ? body.at : "");
    bool good = status == 200 && add_png(film, &body);
    text_finish(&body);
    mem_free(path);
    return good;
}

/* --- the film ------------------------------------------------------------------------------------------------------------------ */

static bool make(struct film *film, bool (*picture)(struct film *film, int64_t at_us))
{
    const struct snapshot_options *options = film->options;
    double step_us = options->speed / options->fps * 1e6, count = floor((double)(options->to_us - options->from_us) / step_us) + 1;
    bool good = count <= MOST_PICTURES;
    if (!good)
        fprintf(stderr, "plantcast: %.0f pictures would be made, and at most %d are; a greater --speed, or less time\n", count,
                MOST_PICTURES);
    for (long i = 0; i < (long)count && good; i++) {
        good = picture(film, options->from_us + (int64_t)((double)i * step_us));
        if (good && (i + 1) % SAY_EACH == 0)
            fprintf(stderr, "plantcast: %ld of %.0f pictures\n", i + 1, count);
    }
    good = video_finish(&film->video, good);
    if (good)
        printf("%s: %.0f pictures, %.1f s\n", options->out, count, count / options->fps);
    return good;
}

static int from_plant(struct film *film)
{
    int code = offline_renderer_open(&film->offline, film->options, &film->view);
    if (code == 0 &&
        !(offline_renderer_open_history(&film->offline, film->options) && offline_renderer_open_gl(&film->offline, film->options)))
        code = 1;
    if (code == 0)
        code = make(film, draw) ? 0 : 1;
    offline_renderer_close(&film->offline);
    return code;
}

static int from_daemon(struct film *film)
{
    int code = 2;
    if (daemon_url_parse(film->options->from, &film->url) && snapshot_query(film->options, &film->query))
        code = make(film, download) ? 0 : 1;
    text_finish(&film->query);
    return code;
}

int cmd_clip(int argc, char **argv)
{
    struct snapshot_options options;
    int code = snapshot_parse(argc, argv, true, &options);
    struct film film = { .options = &options };
    if (code < 0)
        code = strstr(options.from, "://") ? from_daemon(&film) : from_plant(&film);
    snapshot_options_finish(&options);
    return code;
}
#endif
