/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A walk through a plant: frames without a GPU compared with GL, with surfaces in front of, beside and behind the eye. */
#include "tests/support/test.h"

#include "render/split_view.h"
#include "tests/support/site.h"
#include "tests/support/synthetic.h"
#include "tests/support/rig_case.h"

enum { WIDTH_PX = 480, HEIGHT_PX = 270, PIXELS = WIDTH_PX * HEIGHT_PX };

static int differing(const struct frame *a, const struct frame *b)
{
    int count = 0;
    for (int i = 0; i < PIXELS; i++) {
        int most = 0;
        for (int c = 0; c < 3; c++) {
            int by = abs(a->bgrx[4 * i + c] - b->bgrx[4 * i + c]);
            most = by > most ? by : most;
        }
        count += most > 40;
    }
    return count;
}

/* Draws the view in software and with GL. Returns the number of pixels that differ. */
static int compare(struct site *site, const struct view *view)
{
    renderer_use_gl(site->renderer, true);
    struct frame *gl = split_view_draw_now(site->renderer, view, site->snapshot);
    renderer_use_gl(site->renderer, false);
    struct frame *ours = split_view_draw_now(site->renderer, view, site->snapshot);
    assert_non_null(gl);
    assert_non_null(ours);
    int count = differing(gl, ours);
    frame_unref(&gl);
    frame_unref(&ours);
    return count;
}

/* Chooses a random point among the assets at eye height, looking ahead or slightly down. */
static void stand_somewhere(struct site *site, double height_m, struct view *view)
{
    double turn = 2 * M_PI * synthetic_random_unit(&site->random), down = 0.6 * synthetic_random_unit(&site->random);
    const struct scene_asset *asset = &site->scene->assets[synthetic_random(&site->random) % site->scene->asset_count];
    for (int c = 0; c < 2; c++) {
        double part = 3 * synthetic_random_unit(&site->random) - 1;
        view->camera.eye_m[c] = asset->bounds_min_m[c] + part * (asset->bounds_max_m[c] - asset->bounds_min_m[c]);
    }
    view->camera.eye_m[2] = height_m;
    view->camera.target_m[0] = view->camera.eye_m[0] + 5 * cos(turn);
    view->camera.target_m[1] = view->camera.eye_m[1] + 5 * sin(turn);
    view->camera.target_m[2] = view->camera.eye_m[2] - 5 * down;
}

static void walk(enum tier tier, int steps)
{
    struct site site;
    int bad = 0, all = 0;
    assert_true(site_init(&site, &rig, SITE_DEMO, NULL));
    for (int i = 0; i < steps; i++) {
        struct view view;
        view_default(site.scene, WIDTH_PX, HEIGHT_PX, &view);
        view.tier = tier;
        site.random = 500 + (uint64_t)i;
        synthetic_random(&site.random);
        stand_somewhere(&site, i % 4 == 3 ? 10.4 : 1.7, &view);
        int count = compare(&site, &view);
        all += count;
        bad += count > PIXELS / 500;
        if (count > PIXELS / 500)
            print_message("eye %d, %.2f %.2f %.2f m: %d of %d pixels look otherwise\n", i, view.camera.eye_m[0], view.camera.eye_m[1],
                          view.camera.eye_m[2], count, PIXELS);
    }
    print_message("# %d eyes: %.3f %% of the pixels look otherwise\n", steps, 100.0 * all / ((double)steps * PIXELS));
    assert_int_equal(bad, 0);
    assert_true(all < steps * (PIXELS / 1000));
    site_finish(&site);
}

TEST(test_moving)
{
    walk(TIER_PREVIEW, sweep(40, 12));
}

TEST(test_still)
{
    walk(TIER_REFINED, sweep(12, 4));
}
