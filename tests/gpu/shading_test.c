/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shading must not be mistaken for a value: frames of a heat exchanger and a tank are read back by the nearest legend colour. */
#include "tests/support/test.h"

#include <turbojpeg.h>

#include "base/math/search.h"
#include "encode/encoder.h"
#include "tests/support/stand_case.h"
#include "value/quality.h"

enum { WIDTH = 1280, HEIGHT = 720 };

static int set_up(void **state)
{
    static const double values[8] = { 4, 30, 55, 80, 97, 12, 45, 88 };
    (void)state;
    stand_init(&stand, &rig, toy_unit());
    for (int i = 0; i < 8; i++)
        toy_set(stand.snapshot, i, values[i], QUALITY_GOOD);
    return 0;
}

/* One way in which a viewer gets a frame: how it is encoded, and the viewer's colour vision. */
struct delivery_path {
    const char *name;
    int quality;                             /* quality of the JPEG; 0: no JPEG */
    /* full_chroma: JPEG without chroma subsampling; deuteranope: the viewer lacks green vision; standard: another JPEG encoder,
       which uses the standard tables */
    bool full_chroma, deuteranope, standard;
};
static const struct delivery_path ways[] = {
    { "as drawn", 0, false, false, false },
    { "JPEG q80 4:2:0", 80, false, false, false },
    { "deuteranope", 0, false, true, false },
    { "JPEG, deuteranope", 80, false, true, false },
    { "refined, as sent, deuteranope", 92, true, true, false }, /* quality and chroma of a refined frame as session_frames.c requests it */
    { "JPEG by another", 80, false, false, true },
    { "that, deuteranope", 80, false, true, true },
};
enum { WAYS = sizeof(ways) / sizeof(*ways), OURS = 5 };

static void decode(struct frame *frame, const uint8_t *bytes, size_t count)
{
    tjhandle turbo = tjInitDecompress();
    assert_int_equal(tjDecompress2(turbo, bytes, count, frame->bgrx, frame->width_px, frame->stride_bytes, frame->height_px, TJPF_BGRX, 0),
                     0);
    tjDestroy(turbo);
}

static void through_standard_jpeg(struct frame *frame, const struct delivery_path *way)
{
    unsigned char *bytes = NULL;
    unsigned long count = 0;
    tjhandle turbo = tjInitCompress();
    assert_int_equal(tjCompress2(turbo, frame->bgrx, frame->width_px, frame->stride_bytes, frame->height_px, TJPF_BGRX, &bytes, &count,
                                 TJSAMP_420, way->quality, 0),
                     0);
    decode(frame, bytes, count);
    tjFree(bytes);
    tjDestroy(turbo);
}

/* Encodes the frame as JPEG, as for a client, and replaces its pixels with the decoded ones. */
static void through_jpeg(struct frame *frame, const struct delivery_path *way)
{
    struct encoder *encoder = encoder_create(rig.log, "jpeg", NULL);
    struct packet *packet;
    assert_int_equal(encoder_send(encoder, frame, &(struct encoder_params){ .quality = way->quality, .full_chroma = way->full_chroma }), 0);
    assert_int_equal(encoder_receive(encoder, &packet), 0);
    decode(frame, packet->bytes, packet->count);
    packet_unref(&packet);
    encoder_destroy(&encoder);
}

/* Returns the 95th percentile of the errors, in percent of the range, of the values that a viewer reads from a shaded frame by
   the nearest colour of the legend. truth: the same frame without shading and edges, whose colours give the true values. */
static double misread(const struct colormap *map, const struct frame *truth, const struct frame *shaded, bool deuteranope)
{
    double *errors = mem_array(WIDTH * HEIGHT, sizeof(*errors)), p95;
    int count = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            int place = map_index_exact(map, frame_pixel(truth, x, y));
            if (place >= 0)
                errors[count++] = abs(map_index_nearest(map, frame_pixel(shaded, x, y), deuteranope) - place) / 2.56;
        }
    assert_true(count > WIDTH * HEIGHT / 500);
    qsort(errors, (size_t)count, sizeof(*errors), compare_doubles);
    p95 = errors[count * 95 / 100];
    mem_free(errors);
    return p95;
}

/* Stores in p95[] the reading error for each way of delivery. Returns the largest of them. */
static double measure(const struct view *view, double p95[WAYS])
{
    const struct colormap *map = colormap_at(NULL, (size_t)view->colormap);
    struct view flat = *view;
    double worst = 0;
    flat.look = LOOK_FLAT;
    flat.tier = TIER_PREVIEW;
    struct frame *truth = stand_draw(&stand, &flat);
    struct frame *drawn = stand_draw(&stand, view);
    for (int i = 0; i < WAYS; i++) {
        struct frame *shaded = frame_create(NULL, WIDTH, HEIGHT);
        memcpy(shaded->bgrx, drawn->bgrx, (size_t)HEIGHT * (size_t)drawn->stride_bytes);
        if (ways[i].quality)
            (ways[i].standard ? through_standard_jpeg : through_jpeg)(shaded, &ways[i]);
        p95[i] = misread(map, truth, shaded, ways[i].deuteranope);
        worst = fmax(worst, p95[i]);
        frame_unref(&shaded);
    }
    frame_unref(&truth);
    frame_unref(&drawn);
    printf("# %-9s %s:", map->name, view->tier == TIER_REFINED ? "still " : "moving");
    for (int i = 0; i < WAYS; i++)
        printf(" %s %.2f %%%s", ways[i].name, p95[i], i + 1 < WAYS ? "," : " (p95)\n");
    return worst;
}

/* Makes the default view, from `distance` times its distance; at 1 the whole plant fills the image. */
static void look_from(double distance, struct view *view)
{
    view_default(&stand.toy->scene, WIDTH, HEIGHT, view);
    for (int c = 0; c < 3; c++)
        view->camera.eye_m[c] = view->camera.target_m[c] + distance * (view->camera.eye_m[c] - view->camera.target_m[c]);
}

/* A camera close enough to read values: assets fill a good part of the image. */
static void look_close(struct view *view)
{
    look_from(0.5, view);
}

/* A viewer reads no wrong values from shading even if the whole plant is in view, or twice as far away, where its parts are a
   few pixels wide. At that size JPEG encoders with the standard tables, made for photographs, lose too much colour, shaded or
   not; they are compared with the flat look only. */
TEST_WITH(test_far_away_it_is_not_either, set_up, stand_tear_down)
{
    struct view view;
    double shaded[WAYS], flat[WAYS];
    for (int distance = 1; distance < 3; distance++) {
        look_from(distance, &view);
        view.tier = TIER_REFINED;
        measure(&view, shaded);
        view.look = LOOK_FLAT;
        measure(&view, flat);
        for (int i = 0; i < WAYS; i++)
            /* ways that Plantcast itself uses: at most 3 % error (one step of the map is 0.39 %); others: at most 0.8 % more
               than without shading */
            assert_true(shaded[i] <= (i < OURS ? 3 : flat[i] + 0.8));
    }
}

/* Colour maps that claim to be readable under shading must be read correctly; maps that are not must not claim it. */
TEST_WITH(test_shading_is_not_read_as_value, set_up, stand_tear_down)
{
    struct view view;
    double p95[WAYS];
    look_close(&view);
    for (int map = 0; map < (int)colormap_count(NULL); map++)
        for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
            if (!sweep_takes(map, tier - TIER_PREVIEW, 2))
                continue;
            view.colormap = map;
            view.tier = (enum tier)tier;
            double worst = measure(&view, p95);
            assert_true(worst <= 3 || !colormap_at(NULL, (size_t)map)->safe);
        }
}

TEST_WITH(test_glossy_would_be_misread, set_up, stand_tear_down)
{
    struct view view;
    double p95[WAYS];
    look_close(&view);
    view.look = LOOK_GLOSSY;
    measure(&view, p95);
    assert_true(p95[0] > 3); /* the glossy look is misread by more than the 3 % allowed above, so the test can detect a misread map */
}

/* Lightness differs little between the tiers, so that the change from preview to refined does not flash. */
TEST_WITH(test_tiers_agree, set_up, stand_tear_down)
{
    struct view view;
    double sum = 0;
    int count = 0, far = 0;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    view.tier = TIER_REFINED;
    struct frame *still = test_frame(stand_draw(&stand, &view));
    view.tier = TIER_PREVIEW;
    struct frame *moving = test_frame(stand_draw(&stand, &view));
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++, count++) {
            int difference = frame_pixel(still, x, y)[1] - frame_pixel(moving, x, y)[1];
            sum += difference;
            far += abs(difference) > 24;
        }
    printf("# still - moving: mean %.2f of 255, %.1f %% differ by more than 24\n", sum / count, 100.0 * far / count);
    assert_true(fabs(sum / count) < 2);
    assert_true(far < count * 6 / 100);
}

/* The operator's view is grey while all readings are within their limits: every pixel that differs from the view of values,
   whether of a field or of a model without sensors, must be grey. */
TEST_WITH(test_operator_sees_greys, set_up, stand_tear_down)
{
    struct view values, limits;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &values);
    for (size_t i = 0; i < stand.toy->plant.tag_count; i++)
        memcpy(stand.toy->plant.tags[i].alarms.limits, (double[]){ -20, -10, 110, 120 }, 4 * sizeof(double));
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        int other = 0, coloured = 0;
        values.tier = (enum tier)tier;
        limits = values;
        limits.field.show = SHOW_OPERATOR;
        view_default_scale(&stand.toy->scene, &limits);
        struct frame *first = stand_draw(&stand, &values), *second = stand_draw(&stand, &limits);
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            const uint8_t *a = frame_pixel(first, i % WIDTH, i / WIDTH), *b = frame_pixel(second, i % WIDTH, i / WIDTH);
            if (abs(a[0] - b[0]) + abs(a[1] - b[1]) + abs(a[2] - b[2]) < 12)
                continue;
            other++;
            coloured += abs(b[0] - b[1]) > 3 || abs(b[1] - b[2]) > 3;
        }
        printf("# tier %d: %d pixels look other than as values, %d of them are not grey\n", tier, other, coloured);
        assert_true(other > WIDTH * HEIGHT / 20);
        assert_true(coloured <= other / 50); /* silhouettes are antialiased and mix with the sky */
        frame_unref(&first);
        frame_unref(&second);
    }
}
