/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures making depth grids (coarse depths sent with a picture, from which the page draws it for another camera) at
   1920x1080: processor time and bytes, one JSON line per quantity. With a folder as argument, writes pairs of pictures of the
   demo plant from two cameras, with the first camera's depth grid, for reprojection.mjs. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/math/search.h"
#include "encode/encoder.h"
#include "plant/colormaps.h"
#include "render/renderer_impl.h"
#include "render/soft/depth_cells.h"
#include "render/soft/kernels.h"
#include "render/soft/soft_impl.h"
#include "render/split_view.h"
#include "tests/support/demo_scene.h"
#include "tests/support/measure.h"
#include "value/quality.h"

enum { ROUNDS = 30, PREVIEW_QUALITY = 80 };
static const double NEARER = 0.4; /* distance of the camera from its target, as a share of that distance in the plant's initial view */

struct pair_case { /* how the second camera of a pair of pictures differs from the first */
    const char *name;
    /* orbit_deg: turn about the vertical through the target; nearer: fraction of the distance to the target by which the camera
       approaches it */
    double orbit_deg, nearer;
};
static const struct pair_case pairs[] = { { "orbit_1", 1, 0 },    { "orbit_3", 3, 0 },    { "orbit_6", 6, 0 },
                                          { "nearer_5", 0, 0.05 }, { "nearer_10", 0, 0.1 }, { "nearer_20", 0, 0.2 } };

static void print_row(const char *name, double *values, int count, const char *unit, double goal)
{
    qsort(values, (size_t)count, sizeof(*values), compare_doubles);
    printf("{\"name\": \"%s\", \"value\": %.3f, \"p95\": %.3f, \"unit\": \"%s\"", name, values[count / 2], values[count * 95 / 100], unit);
    if (goal > 0)
        printf(", \"goal\": [\"<=\", %g]", goal);
    printf("}\n");
    fflush(stdout);
}

/* Sets readings that differ little between neighbouring sensors, as in a plant. Strong differences would be drawn as dots,
   which stay at their place on the screen and so would differ between any two cameras. */
static void fill(struct snapshot *snapshot, const struct plant *plant)
{
    snapshot->taken_mono_ns = clock_mono_ns();
    snapshot->taken_utc_ns = clock_utc_ns();
    for (size_t i = 0; i < plant->tag_count; i++) {
        const struct plant_tag *tag = &plant->tags[i];
        const struct plant_group *group = tag->group < 0 ? NULL : &plant->groups[tag->group];
        double part = 0.3 + 0.03 * (double)(i % 7);
        if (group)
            snapshot->readings[i] = (struct reading){ .value = group->min + part * (group->max - group->min), .quality = QUALITY_GOOD };
    }
}

static void move(struct view *view, const struct pair_case *by)
{
    double turn = by->orbit_deg * M_PI / 180, *eye = view->camera.eye_m, from[3];
    for (int c = 0; c < 3; c++)
        from[c] = (eye[c] - view->camera.target_m[c]) * (1 - by->nearer);
    eye[0] = view->camera.target_m[0] + cos(turn) * from[0] - sin(turn) * from[1];
    eye[1] = view->camera.target_m[1] + sin(turn) * from[0] + cos(turn) * from[1];
    eye[2] = view->camera.target_m[2] + from[2];
}

static struct frame *draw(struct demo_scene *bench, const struct view *view)
{
    struct frame *frame = split_view_draw_now(bench->renderer, view, bench->snapshot);
    if (!frame)
        abort();
    return frame;
}

static double encoded_bytes(struct demo_scene *bench, struct frame *frame)
{
    struct encoder *encoder = encoder_create(bench->log, "jpeg", NULL);
    struct encoder_params params = { .quality = PREVIEW_QUALITY };
    struct packet *packet = NULL;
    if (encoder_send(encoder, frame, &params) || encoder_receive(encoder, &packet))
        abort();
    double bytes = (double)packet->count;
    packet_unref(&packet);
    encoder_destroy(&encoder);
    return bytes;
}

/* Returns the processor time of finding a frame's cells. The renderer finds the cells of a tile right after drawing it, when its
   depths are in the processor's cache. Therefore this function reads a band of cells once before it measures that band. */
static double find_cells_ms(const struct soft_kernels *kernels, const struct depth_source *source, struct depth_cell *cells)
{
    enum { CELL_ROWS = 4 };
    int rows = depth_cells_along(source->height_px), columns = depth_cells_along(source->width_px);
    double sum_ms = 0;
    for (int row = 0; row < rows; row += CELL_ROWS) {
        int end_row = row + CELL_ROWS < rows ? row + CELL_ROWS : rows;
        volatile float read;
        for (int y = row * DEPTH_CELL_PX; y < end_row * DEPTH_CELL_PX && y < source->height_px; y++)
            for (int x = 0; x < source->width_px; x++)
                read = source->depth[(size_t)y * source->pitch_px + (size_t)x];
        (void)read;
        double began_ms = measure_ms(CLOCK_THREAD_CPUTIME_ID);
        kernels->find_cells(source, row, end_row, 0, columns, cells);
        sum_ms += measure_ms(CLOCK_THREAD_CPUTIME_ID) - began_ms;
    }
    return sum_ms;
}

/* Measures the two steps of making a depth grid on one thread, computing its cells and coding them, from the depth buffer of
   the last preview frame. */
static void measure(struct demo_scene *bench, double nearer)
{
    double cells_ms[ROUNDS], codes_ms[ROUNDS], all_ms[ROUNDS], bytes[ROUNDS], share[ROUNDS];
    struct view view;
    view_default(bench->scene, 1920, 1080, &view);
    view.tier = TIER_PREVIEW;
    move(&view, &(struct pair_case){ NULL, 0, 1 - nearer });
    for (int i = 0; i < ROUNDS; i++) {
        move(&view, &(struct pair_case){ NULL, 1, 0 });
        struct frame *frame = draw(bench, &view);
        struct raster *raster = &bench->renderer->by_soft->preview;
        const struct depth_source source = { raster->depth, (size_t)raster->pitch_px, raster->width_px, raster->height_px, &raster->lens };
        cells_ms[i] = find_cells_ms(raster->soft->kernels, &source, raster->cells);
        double began_ms = measure_ms(CLOCK_THREAD_CPUTIME_ID);
        struct depth_grid *grid = depth_grid_create(raster->cells, &raster->lens, 1920, 1080);
        codes_ms[i] = measure_ms(CLOCK_THREAD_CPUTIME_ID) - began_ms;
        all_ms[i] = cells_ms[i] + codes_ms[i];
        if (!depth_grid_equal(grid, frame->depth[0]))
            abort();
        bytes[i] = WIRE_DEPTH_HEADER_BYTES + grid->wire.payload_bytes;
        share[i] = 100 * bytes[i] / encoded_bytes(bench, frame);
        depth_grid_unref(&grid);
        frame_unref(&frame);
    }
    char name[64];
    const struct {
        const char *what, *unit;
        double *values, goal;
    } rows[] = { { "cells_cpu_ms", "ms", cells_ms, 0 },
                 { "codes_cpu_ms", "ms", codes_ms, 0 },
                 { "cpu_ms", "ms", all_ms, 1.5 },
                 { "bytes", "B", bytes, 25000 },
                 { "percent_of_jpeg", "%", share, 10 } };
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
        snprintf(name, sizeof(name), "depth_1080p_%s%s", nearer < 1 ? "near_" : "", rows[i].what);
        print_row(name, rows[i].values, ROUNDS, rows[i].unit, rows[i].goal);
    }
}

static void write_file(const char *folder, const char *name, const char *suffix, const void *head, size_t head_bytes, const void *bytes,
                       size_t count)
{
    char path[500];
    snprintf(path, sizeof(path), "%s/%s.%s", folder, name, suffix);
    FILE *file = fopen(path, "wb");
    if (!file || (head && fwrite(head, 1, head_bytes, file) != head_bytes) || fwrite(bytes, 1, count, file) != count || fclose(file))
        abort();
}

static void write_picture(struct demo_scene *bench, const struct view *view, const char *folder, const char *name)
{
    struct frame *frame = draw(bench, view);
    struct wire_depth header = frame->depth[0]->wire;
    uint8_t head[WIRE_DEPTH_HEADER_BYTES];
    char camera[500];
    header.seq = 1;
    header.full_width_px = (uint16_t)frame->width_px;
    header.full_height_px = (uint16_t)frame->height_px;
    wire_put_depth(&header, head);
    write_file(folder, name, "bgrx", NULL, 0, frame->bgrx, (size_t)frame->height_px * (size_t)frame->stride_bytes);
    write_file(folder, name, "depth", head, sizeof(head), frame->depth[0]->payload, header.payload_bytes);
    const double *e = view->camera.eye_m, *t = view->camera.target_m, *u = view->camera.up;
    int count = snprintf(camera, sizeof(camera),
                         "{\"width\":%d,\"height\":%d,\"eye\":[%.9g,%.9g,%.9g],\"target\":[%.9g,%.9g,%.9g],\"up\":[%g,%g,%g],\"fov\":%g}",
                         frame->width_px, frame->height_px, e[0], e[1], e[2], t[0], t[1], t[2], u[0], u[1], u[2], view->camera.fov_deg);
    write_file(folder, name, "json", NULL, 0, camera, (size_t)count);
    frame_unref(&frame);
}

static void write_pairs(struct demo_scene *bench, const char *folder)
{
    static const char *const looks[] = { "plain", "flat" };
    char name[64];
    for (int look = 0; look < 2; look++)
        for (size_t i = 0; i <= sizeof(pairs) / sizeof(pairs[0]); i++) {
            struct view view;
            view_default(bench->scene, 1280, 720, &view);
            view.tier = TIER_PREVIEW;
            view.look = look ? LOOK_FLAT : LOOK_DEFAULT;
            move(&view, &(struct pair_case){ NULL, 0, 1 - NEARER });
            if (i > 0)
                move(&view, &pairs[i - 1]);
            snprintf(name, sizeof(name), "%s_%s", looks[look], i ? pairs[i - 1].name : "first");
            write_picture(bench, &view, folder, name);
            const struct colormap *map = colormap_at(NULL, (size_t)view.colormap);
            write_file(folder, "colours", "rgb", NULL, 0, map->rgb, sizeof(map->rgb));
        }
}

int main(int argc, char **argv)
{
    struct demo_scene bench = { 0 };
    bool good = demo_scene_open(&bench) && bench.renderer->by_soft;
    if (good) {
        fill(bench.snapshot, bench.plant);
        renderer_set_depth(bench.renderer, true);
        if (argc > 1)
            write_pairs(&bench, argv[1]);
        measure(&bench, 1);
        measure(&bench, NEARER);
    } else {
        printf("{\"name\": \"depth_1080p_cpu_ms\", \"value\": null, \"p95\": null, \"unit\": \"ms\", \"why\": \"no demo, or a GPU\"}\n");
    }
    demo_scene_close(&bench);
    return 0;
}
