/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Software frames of whole plants in the flat look: each pixel's colour is read back as a value and compared with the values
   that reference_test verifies, for previews and refined frames and every level drawn. Where a pixel and its neighbours show
   one surface, the values must be equal. Elsewhere (at rims and on surfaces smaller than a pixel) a preview may differ by
   rounding, and a refined frame mixes colours. */
#include "tests/support/test.h"

#include "tests/support/planned.h"
#include "tests/support/renderer_compare.h"
#include "tests/support/site.h"
#include "tests/support/synthetic.h"
#include "tests/support/rig_case.h"

enum { WIDTH_PX = 640, HEIGHT_PX = 360, PIXELS = WIDTH_PX * HEIGHT_PX };
static const double LEAST_M = 2; /* minimum distance in metres of the camera's eye from every asset's bounding box */

/* --- cameras ---------------------------------------------------------------------------------------------------------------- */

static double distance_to_asset(const struct scene_asset *asset, const double eye_m[3])
{
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        double out = fmax(fmax(asset->bounds_min_m[c] - eye_m[c], eye_m[c] - asset->bounds_max_m[c]), 0);
        sum += out * out;
    }
    return sqrt(sum);
}

static bool is_clear(const struct scene *scene, const double eye_m[3])
{
    for (size_t i = 0; i < scene->asset_count; i++)
        if (distance_to_asset(&scene->assets[i], eye_m) < LEAST_M)
            return false;
    return true;
}

/* Chooses a random camera at a random asset with a field, `away` times the asset's size from it, or farther where space is tight. */
static void look_at_some_asset(struct site *site, double away, struct view *view)
{
    do {
        site_look_at_some(site, away, view);
        away *= 1.05;
    } while (!is_clear(site->scene, view->camera.eye_m));
}

/* --- comparing -------------------------------------------------------------------------------------------------------------- */

static bool has_value(const float number[4])
{
    return number[1] >= 0 && number[1] < 0.5f && number[2] < 0.5f;
}

/* Returns whether depth, followed across three pixels, bends by more than 0.2 %, as at an edge. In the image, depth is linear
   on a flat surface and nearly linear on a curved one. */
static bool bends(const float (*numbers)[4], int at, int step)
{
    double before = (double)numbers[at - step][3], here = (double)numbers[at][3], after = (double)numbers[at + step][3];
    return fabs(before + after - 2 * here) > 0.002 * here;
}

/* Returns whether a pixel and its neighbours show one surface. */
static bool is_within(const float (*numbers)[4], int at)
{
    for (int y = -1; y <= 1; y++)
        for (int x = -1; x <= 1; x++)
            if (!has_value(numbers[at + y * WIDTH_PX + x]))
                return false;
    return !bends(numbers, at, 1) && !bends(numbers, at, WIDTH_PX) && !bends(numbers, at, WIDTH_PX + 1) &&
           !bends(numbers, at, WIDTH_PX - 1);
}

struct soft_values_tally {
    /* within: pixels that show one surface with their neighbours; off: those of them whose colour is not their value's;
       unreadable: those whose colour is not in the map */
    int within, off, unreadable;
    int rims, rims_off;          /* rims: all other pixels that have a value; rims_off: those of them whose colour is not their value's */
    int most;
};

static void compare(const struct view *view, const float (*numbers)[4], const struct frame *frame, struct soft_values_tally *tally)
{
    const struct colormap *map = colormap_at(NULL, (size_t)view->colormap);
    for (int y = 1; y < HEIGHT_PX - 1; y++)
        for (int x = 1; x < WIDTH_PX - 1; x++) {
            int at = y * WIDTH_PX + x;
            if (!has_value(numbers[at]))
                continue;
            int off = map_colors_off(map, frame_pixel(frame, x, y), (double)numbers[at][0]);
            if (!is_within(numbers, at)) {
                tally->rims++;
                tally->rims_off += off < 0 || off > 1;
                continue;
            }
            tally->within++;
            tally->off += off > 1;
            tally->unreadable += off < 0;
            tally->most = off > tally->most ? off : tally->most;
        }
}

static struct frame *draw(struct site *site, const struct view *view)
{
    if (view->tier == TIER_PREVIEW)
        return split_view_draw_now(site->renderer, view, site->snapshot);
    struct render_job *job = planned_begin(site->renderer, view, site->snapshot);
    return job ? renderer_end(site->renderer, &job) : NULL;
}

static void compare_plant(struct site *site, int way, struct soft_values_tally *tally)
{
    static const double away[] = { 1.2, 2, 4, 8, 16, 32 };
    float(*numbers)[4] = mem_array(PIXELS, sizeof(*numbers));
    for (int i = 0; i < (int)(sizeof(away) / sizeof(away[0])); i++) {
        struct view view;
        if (!sweep_takes(way + way / 2, i, 2))
            continue;
        view_default(site->scene, WIDTH_PX, HEIGHT_PX, &view);
        view.look = LOOK_FLAT;
        view.tier = way & 1 ? TIER_REFINED : TIER_PREVIEW;
        view.field.interpolation = way & 2 ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        view.field.distance = way & 2 ? DISTANCE_EUCLIDEAN : DISTANCE_GEODESIC;
        site->random = 1000 * (uint64_t)(way + 1) + (uint64_t)i;
        synthetic_random(&site->random);
        look_at_some_asset(site, away[i], &view);
        assert_true(renderer_measure(site->renderer, &view, site->snapshot, false, numbers));
        struct frame *frame = draw(site, &view);
        assert_non_null(frame);
        compare(&view, (const float(*)[4])numbers, frame, tally);
        frame_unref(&frame);
    }
    mem_free(numbers);
}

static void test_plant(const char *path, const char *name)
{
    struct site site;
    assert_true(site_init(&site, &rig, path, name));
    for (int way = 0; way < 4; way++) {
        struct soft_values_tally tally = { 0 };
        bool refined = way & 1;
        /* in a refined frame, a GPU shows the mean colour of a pixel's samples, not the colour at its centre */
        if (refined && !rig.gl->software)
            continue;
        compare_plant(&site, way, &tally);
        print_message("# %s, %s: %d pixels, %d of another colour (by %d at most), %d of none; at silhouettes %d, %d others\n",
                      refined ? "refined" : "soft", way & 2 ? "paper, euclidean" : "shepard, geodesic", tally.within, tally.off, tally.most,
                      tally.unreadable, tally.rims, tally.rims_off);
        assert_true(tally.within > sweep(PIXELS / 40, PIXELS / 80));
        assert_true(tally.off <= (refined ? 0.005 : 0.0003) * tally.within);
        assert_true(tally.unreadable <= (refined ? 0.1 : 0.0003) * tally.within); /* dark edges have no colour of the map */
        assert_true(refined || tally.rims_off <= 0.002 * tally.rims);
    }
    site_finish(&site);
}

TEST(test_demo)
{
    test_plant(SITE_DEMO, NULL);
}

TEST(test_plant_room)
{
    if (!site_is_there("plm_plant_equipment.glb"))
        skip();
    test_plant("tests/plants/plant_room.yaml", "plant_room");
}

TEST(test_cookie_line)
{
    if (!site_is_there("cookie_factory_mixer.glb"))
        skip();
    test_plant("tests/plants/cookie_line.yaml", "cookie_line");
}
