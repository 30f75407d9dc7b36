/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The displayed field compared with the field computed per fragment over all sensors: values, not colours, at random pixels of
   whole plants, from near and far, for all parameters that a client may request. There are two comparisons: at the pixel's own
   point on its level; and with the finest level within a pixel, because a coarser level may move the surface that far. The
   second uses pixel centres first and then many samples per pixel, because much of a distant plant is smaller than a pixel. */
#include "tests/support/test.h"

#include "base/math/vec.h"
#include "message/message.h"
#include "plant/models/transform.h"
#include "tests/support/renderer_compare.h"
#include "tests/support/site.h"
#include "tests/support/synthetic.h"

/* Size of the pictures. The default run draws a sixteenth of the pixels of a long run, but takes as many samples. */
static int width_px, height_px;
enum { VIEWS = 14, SAMPLES = 715 }; /* VIEWS: number of views per case; SAMPLES: number of samples per view */
enum { CLOSE_PX = 32 };             /* samples along each side of the close-up of a pixel, which is two pixels wide */
static const double TOLERANCE = 1.0 / 255;

static struct rig rig;

/* --- comparing ------------------------------------------------------------------------------------------------------------- */

struct reference_tally {
    /* compared: number of compared pixels; over: those whose error at their own point exceeds TOLERANCE; beyond: those whose
       error compared with the finest level nearby does; flags_differ: those with other flags than the reference */
    size_t compared, over, beyond, flags_differ;
    double worst, worst_beyond;
    int worst_camera;
};

static bool has_value(const float pixel[4])
{
    return pixel[1] >= 0 && pixel[1] < 0.5f;
}

struct pixels_seen { /* values of all pixels of a picture, as one camera sees them */
    const struct view *view;
    /* by pixel: shown: values as drawn; here: values computed per fragment on the level that is drawn; finest: values computed
       per fragment on the finest level */
    float (*shown)[4], (*here)[4], (*finest)[4];
    bool shown_is_finest;
};

struct value_span { /* least and largest value */
    double low, high;
};

static void widen(struct value_span *span, const float pixel[4])
{
    if (!has_value(pixel))
        return;
    span->low = fmin(span->low, (double)pixel[0]);
    span->high = fmax(span->high, (double)pixel[0]);
}

static double error_beyond(const struct value_span *span, double value)
{
    return value < span->low ? span->low - value : value > span->high ? value - span->high : 0;
}

/* Makes a view of a square of two by two pixels around a pixel's centre, i.e. up to the centres of its neighbours. */
static void look_close(const struct view *view, int x, int y, struct view *close)
{
    double right[3], up[3], forward[3], per_px = 2 * tan(view->camera.fov_deg * M_PI / 360) / height_px;
    double u = per_px * (x + 0.5 - 0.5 * width_px), v = per_px * (0.5 * height_px - y - 0.5);
    *close = *view;
    close->width_px = close->height_px = CLOSE_PX;
    camera_basis(&view->camera, right, up, forward);
    for (int c = 0; c < 3; c++)
        close->camera.target_m[c] = view->camera.eye_m[c] + forward[c] + u * right[c] + v * up[c];
    /* away from the image centre a pixel covers a smaller angle */
    close->camera.fov_deg = 2 * atan(per_px / (1 + u * u + v * v)) * 180 / M_PI;
}

/* Returns by how much a value lies outside the range of values that the finest level shows within a pixel of this position. The
   drawn level of detail may place the surface up to a pixel away. */
static double error_within_a_pixel(struct site *site, const struct pixels_seen *seen, size_t at, double value)
{
    struct value_span span = { INFINITY, -INFINITY };
    int x = (int)(at % width_px), y = (int)(at / width_px);
    for (int v = y > 0 ? y - 1 : 0; v <= y + 1 && v < height_px; v++)
        for (int u = x > 0 ? x - 1 : 0; u <= x + 1 && u < width_px; u++)
            widen(&span, seen->finest[v * width_px + u]);
    if (error_beyond(&span, value) <= TOLERANCE || seen->shown_is_finest)
        return error_beyond(&span, value);
    struct view close;
    float(*samples)[4] = mem_array((size_t)CLOSE_PX * CLOSE_PX, sizeof(*samples));
    look_close(seen->view, x, y, &close);
    renderer_set_per_fragment(site->renderer, true);
    assert_true(renderer_measure(site->renderer, &close, site->snapshot, true, samples));
    renderer_set_per_fragment(site->renderer, false);
    for (int i = 0; i < CLOSE_PX * CLOSE_PX; i++)
        widen(&span, samples[i]);
    mem_free(samples);
    return error_beyond(&span, value);
}

static void compare(struct site *site, const struct pixels_seen *seen, size_t samples, int camera, struct reference_tally *tally)
{
    for (size_t i = 0, tries = 0; i < samples && tries < 200 * samples; tries++) {
        size_t at = (size_t)(synthetic_random_unit(&site->random) * width_px * height_px);
        if (!has_value(seen->shown[at]))
            continue;
        i++;
        if (!has_value(seen->here[at])) {
            tally->flags_differ++;
            continue;
        }
        double value = (double)seen->shown[at][0], error = fabs(value - (double)seen->here[at][0]);
        double beyond = error_within_a_pixel(site, seen, at, value);
        tally->compared++;
        tally->over += error > TOLERANCE;
        /* a point near which the finest level has no value counts as an error, too (`beyond` is then infinite) */
        tally->beyond += beyond > TOLERANCE;
        tally->worst_beyond = isinf(beyond) ? tally->worst_beyond : fmax(tally->worst_beyond, beyond);
        if (error > tally->worst) {
            tally->worst = error;
            tally->worst_camera = camera;
        }
    }
}

/* Returns the signed solid angle of a triangle in steradians. Van Oosterom and Strackee, "The solid angle of a plane triangle", 1983. */
static double solid_angle(const double corners[3][3])
{
    double length[3], across[3];
    for (int c = 0; c < 3; c++)
        length[c] = sqrt(vec_dot(corners[c], corners[c]));
    vec_cross(corners[0], corners[1], across);
    return 2 * atan2(vec_dot(across, corners[2]), length[0] * length[1] * length[2] + vec_dot(corners[0], corners[1]) * length[2] +
                                                      vec_dot(corners[1], corners[2]) * length[0] +
                                                      vec_dot(corners[2], corners[0]) * length[1]);
}

/* Returns whether the eye is inside the asset, by its winding number. Such cameras are avoided, because surfaces inside bodies
   were removed. */
static bool is_inside(const struct scene_asset *asset, const double eye_m[3])
{
    const struct asset_view *file = &asset->file->view;
    double sum = 0;
    for (int axis = 0; axis < 3; axis++)
        if (eye_m[axis] < asset->bounds_min_m[axis] || eye_m[axis] > asset->bounds_max_m[axis])
            return false;
    for (uint32_t p = 0; p < file->levels[0].primitive_count; p++) {
        const struct asset_primitive *primitive = &file->primitives[file->levels[0].first_primitive + p];
        for (uint32_t i = 0; i < primitive->index_count; i += 3) {
            double corners[3][3];
            for (int c = 0; c < 3; c++) {
                const float *at = file->positions_m[file->indices[primitive->first_index + i + (uint32_t)c]];
                transform_point(asset->placement, (double[3]){ (double)at[0], (double)at[1], (double)at[2] }, corners[c]);
                for (int k = 0; k < 3; k++)
                    corners[c][k] -= eye_m[k];
            }
            sum += solid_angle((const double(*)[3])corners);
        }
    }
    return fabs(sum) > 2 * M_PI;
}

static bool is_inside_any(const struct scene *scene, const double eye_m[3])
{
    for (size_t i = 0; i < scene->asset_count; i++)
        if (is_inside(&scene->assets[i], eye_m))
            return true;
    return false;
}

/* Chooses a random camera at a random asset with a field, `away` times the asset's size from it. */
static void look_at_some_asset(struct site *site, double away, struct view *view)
{
    do
        site_look_at_some(site, away, view);
    while (is_inside_any(site->scene, view->camera.eye_m));
}

struct reference_display { /* parameters with which one case shows a plant */
    int group;
    int number, each; /* number of the case; the default run tests only every each-th one */
    enum interpolation interpolation;
    enum distance_mode distance;
    enum tier tier;
    bool finest;
    uint64_t seed; /* seed of the case's views */
};

/* Sets the view's parameters through the same parser as a client's message. Returns false if the plant refuses them. */
static bool ask_for(const struct site *site, const struct reference_display *way, struct view *view)
{
    struct params_change change;
    struct message_error error;
    json_t *wish = json_pack("{s:s,s:s,s:s}", "group", site->plant->groups[way->group].id, "interpolation",
                             way->interpolation == INTERPOLATION_PAPER ? "paper" : "shepard", "distance",
                             way->distance == DISTANCE_EUCLIDEAN ? "euclidean" : "geodesic");
    assert_true(params_parse(site->plant, wish, &change, &error));
    json_decref(wish);
    return params_apply(&(struct params_context){ .scene = site->scene }, &change, view, &error);
}

static void compare_views(struct site *site, const struct reference_display *way, struct reference_tally *tally)
{
    static const double away[VIEWS / 2] = { 0.8, 1.2, 2, 4, 8, 16, 32 };
    struct pixels_seen seen = { .shown = mem_array((size_t)width_px * (size_t)height_px, sizeof(*seen.shown)),
                                .here = mem_array((size_t)width_px * (size_t)height_px, sizeof(*seen.here)),
                                .finest = way->finest ? NULL : mem_array((size_t)width_px * (size_t)height_px, sizeof(*seen.finest)),
                                .shown_is_finest = way->finest };
    for (int i = 0; i < VIEWS; i++) {
        struct view view;
        if (!sweep_takes(way->number, i, way->each))
            continue;
        view_default(site->scene, width_px, height_px, &view);
        ask_for(site, way, &view);
        view.tier = way->tier;
        if (i % 2) /* in every second view sensors have an unlimited reach; in the others they have the reach of the plant file */
            view.field.reach_m = (double)INFINITY;
        /* seeds the camera by case and view but not by the levels to draw, so that a case has the same cameras for all of them
           */
        site->random = way->seed + (uint64_t)i;
        synthetic_random(&site->random);
        look_at_some_asset(site, away[i / 2], &view);
        assert_true(renderer_measure(site->renderer, &view, site->snapshot, way->finest, seen.shown));
        renderer_set_per_fragment(site->renderer, true);
        assert_true(renderer_measure(site->renderer, &view, site->snapshot, way->finest, seen.here));
        assert_true(way->finest || renderer_measure(site->renderer, &view, site->snapshot, true, seen.finest));
        renderer_set_per_fragment(site->renderer, false);
        struct pixels_seen all = seen;
        all.view = &view;
        all.finest = way->finest ? seen.here : seen.finest;
        compare(site, &all, SAMPLES, i, tally);
    }
    mem_free(seen.shown);
    mem_free(seen.here);
    mem_free(seen.finest);
}

static void say(const struct reference_display *way, const struct reference_tally *tally)
{
    print_message("# group %d, %s, %s, %s, %s: %zu pixels; over 1/255: %zu, worst %.3f %% (camera %d); "
                  "within a pixel of the finest level: %zu, worst %.3f %%; other flags %zu\n",
                  way->group, way->interpolation == INTERPOLATION_PAPER ? "paper" : "shepard",
                  way->distance == DISTANCE_EUCLIDEAN ? "euclidean" : "geodesic", way->tier == TIER_REFINED ? "still" : "moving",
                  way->finest ? "finest level" : "levels as drawn", tally->compared, tally->over, 100 * tally->worst, tally->worst_camera,
                  tally->beyond, 100 * tally->worst_beyond, tally->flags_differ);
}

/* FINEST_OVER: share of pixels that may have an error above 1/255 of the range at their own point, if the finest level is
   drawn, as in refined frames with room for it. FINEST_WORST: no pixel may have a larger error. */
static const double FINEST_OVER = 0.0005, FINEST_WORST = 2.0 / 255;

struct bounds {           /* limits for previews, which draw coarser levels */
    /* largest shares of pixels with an error above TOLERANCE; drawn: at their own point; beyond: compared with the finest level
       within a pixel */
    double drawn, beyond;
    double worst;
};

/* The default run tests every `each`-th case, different ones for each row. */
static void compare_group(struct site *site, int group, int row, int each, int refused, const struct bounds *bounds)
{
    int bad = 0;
    struct view view;
    view_default(site->scene, width_px, height_px, &view);
    for (int i = 0; i < 16; i++) {
        const struct reference_display way = {
            .group = group,
            .number = i + i / 4,
            /* the default run tests every fourth preview case with coarser levels, where errors are largest, and every seventh
               of the other cases */
            .each = (i & 12) == 8 ? 4 : 7,
            .interpolation = i & 1 ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD,
            .distance = i & 2 ? DISTANCE_EUCLIDEAN : DISTANCE_GEODESIC,
            .tier = i & 4 ? TIER_REFINED : TIER_PREVIEW,
            .finest = !(i & 8),
            .seed = 1000 * (uint64_t)(i + 1),
        };
        struct reference_tally tally = { 0 };
        if (!ask_for(site, &way, &view)) {
            refused--;
            continue;
        }
        if (!sweep_takes(row, i + i / 2 + i / 4 + i / 8, each))
            continue;
        compare_views(site, &way, &tally);
        say(&way, &tally);
        assert_true(tally.compared > (size_t)sweep(VIEWS, VIEWS / way.each) * SAMPLES / 2);
        assert_in_range(tally.flags_differ, 0, tally.compared / 200);
        bool finest = way.finest || way.tier == TIER_REFINED;
        bad += (double)tally.over > (finest ? FINEST_OVER : bounds->drawn) * (double)tally.compared;
        bad += tally.worst > (finest ? FINEST_WORST : bounds->worst);
        bad += (double)tally.beyond > (finest ? FINEST_OVER : bounds->beyond) * (double)tally.compared;
    }
    assert_int_equal(bad, 0);
    assert_int_equal(refused, 0);
}

static void test_plant(const char *path, const char *name, int row, int each, const struct bounds *bounds)
{
    struct site site;
    assert_true(site_init(&site, &rig, path, name));
    compare_group(&site, 0, row, each, 0, bounds);
    site_finish(&site);
}

TEST(test_demo)
{
    test_plant(SITE_DEMO, NULL, 0, 2, &(struct bounds){ 0.03, 0.01, 0.025 });
}

TEST(test_plant_room)
{
    if (!site_is_there("plm_plant_equipment.glb"))
        skip();
    struct site site;
    assert_true(site_init(&site, &rig, "tests/plants/plant_room.yaml", "plant_room"));
    compare_group(&site, 0, 0, 4, 0, &(struct bounds){ 0.001, 0.001, 0.008 });
    /* 8: number of cases that must be refused, those with mode paper, because the plant's single sensors have no subdivided
       triangles */
    compare_group(&site, 1, 2, 4, 8, &(struct bounds){ 0.001, 0.001, 0.008 });
    site_finish(&site);
}

TEST(test_cookie_line)
{
    if (!site_is_there("cookie_factory_mixer.glb"))
        skip();
    test_plant("tests/plants/cookie_line.yaml", "cookie_line", 3, 4, &(struct bounds){ 0.004, 0.004, 0.012 });
}

int main(void)
{
    width_px = sweep(640, 160);
    height_px = sweep(360, 90);
    return rig_run(&rig);
}
