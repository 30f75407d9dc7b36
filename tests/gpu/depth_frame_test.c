/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Depth grids that are sent with frames. The points of the scene that follow from a grid by the rule of PROTOCOL.md are
   compared with the points that rays through the same pixels hit, for the software renderer and for GL. */
#include "tests/support/test.h"

#include "render/pick/pick.h"
#include "scene/camera.h"
#include "tests/support/depth_reader.h"
#include "tests/support/planned.h"
#include "tests/support/stand_case.h"
#include "value/quality.h"

enum { WIDTH = 437, HEIGHT = 250 };

static int set_up(void **state)
{
    (void)state;
    stand_init(&stand, &rig, toy_unit());
    for (int i = 0; i < 8; i++)
        toy_set(stand.snapshot, i, 12.0 * i, QUALITY_GOOD);
    renderer_set_depth(stand.renderer, true);
    return 0;
}

/* Returns a point's depth: its distance from the eye, measured along the camera's viewing direction. */
static double depth_of(const struct view *view, const double point_m[3])
{
    double right[3], up[3], forward[3], z = 0;
    camera_basis(&view->camera, right, up, forward);
    for (int c = 0; c < 3; c++)
        z += forward[c] * (point_m[c] - view->camera.eye_m[c]);
    return z;
}

static bool is_right(const struct depth_read *read, int code, double z)
{
    double value = code ? depth_read_value(read, code) : 0;
    bool parallel = read->wire.flags & WIRE_DEPTH_ORTHOGRAPHIC;
    double unit = fabs((double)read->wire.unit), expected = parallel ? z : 1 / z;
    return code && fabs(value - expected) < unit + (parallel ? 0.05 : 0.02 / z);
}

/* Compares the cells of a depth grid with rays through their centres. left_px: the grid's left edge in the picture. */
static void check_grid(const struct view *view, const struct depth_grid *grid, int left_px)
{
    struct depth_read read;
    int right = 0, wrong = 0, ground = 0;
    assert_non_null(grid);
    assert_true(depth_read_init(&read, grid));
    for (int i = 0; i < read.wire.columns * read.wire.rows; i++) {
        int x0 = i % read.wire.columns * 8, y0 = i / read.wire.columns * 8;
        double x = 0.5 * (x0 + fmin(x0 + 8, read.wire.width_px)), y = 0.5 * (y0 + fmin(y0 + 8, read.wire.height_px));
        struct pick pick;
        pick_at(&stand.toy->scene, stand.field, view, stand.snapshot, x + left_px, y, &pick);
        if (pick.asset < 0) {
            ground += read.near[i] > 0 && read.near[i] == read.far[i];
            continue;
        }
        double z = depth_of(view, pick.position_m);
        bool good = is_right(&read, read.near[i], z) || is_right(&read, read.far[i], z);
        right += good;
        wrong += !good;
    }
    print_message("%d cells right, %d wrong, %d on the ground, %u bytes\n", right, wrong, ground, read.wire.payload_bytes);
    /* up to 4 % of the cells may be wrong: at outlines, the centre of a cell may miss the surface whose depth the cell has */
    assert_true(right > 40 && wrong <= (right + wrong) / 25);
    depth_read_finish(&read);
}

static void check_view(struct view *view)
{
    for (int by_gl = 0; by_gl < 2; by_gl++)
        for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
            renderer_use_gl(stand.renderer, by_gl);
            view->tier = (enum tier)tier;
            struct frame *frame = split_view_draw_now(stand.renderer, view, stand.snapshot);
            for (int half = 0; half < (view->split ? 2 : 1); half++)
                check_grid(view, frame->depth[half], half ? view_left_px(view) : 0);
            assert_true(view->split || !frame->depth[1]);
            frame_unref(&frame);
        }
}

TEST_WITH(grids_are_those_of_rays, set_up, stand_tear_down)
{
    struct view view;
    for (int i = 0; i < sweep(4, 2); i++) {
        view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
        stand_look(&stand, i, &view);
        check_view(&view);
    }
}

TEST_WITH(orthographic_grids_too, set_up, stand_tear_down)
{
    struct view view;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    double away_m = 0;
    for (int c = 0; c < 3; c++)
        away_m = hypot(away_m, view.camera.eye_m[c] - view.camera.target_m[c]);
    view.camera.height_m = 2 * away_m * tan(view.camera.fov_deg * M_PI / 360);
    check_view(&view);
}

TEST_WITH(halves_have_grids_of_their_own, set_up, stand_tear_down)
{
    struct view view, right;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    right = view;
    right.look = LOOK_FLAT;
    view_split(&view, &right);
    check_view(&view);
}

TEST_WITH(cuts_count_as_surfaces, set_up, stand_tear_down)
{
    struct view view;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    double middle_m = 0.5 * (stand.toy->scene.bounds_min_m[2] + stand.toy->scene.bounds_max_m[2]);
    view.visibility.clip = (struct clip){ .plane_count = 1, .planes = { { 0, 0, -1, middle_m } } };
    check_view(&view);
}

/* A ghost is transparent: its pixels have the depth of what is drawn solid behind it. */
TEST_WITH(ghosts_have_no_depth, set_up, stand_tear_down)
{
    struct view view;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    for (int i = 0; i < (int)stand.toy->scene.asset_count; i += 2)
        asset_set_add(&view.visibility.ghosts, i);
    check_view(&view);
}

/* With a still camera, only the colours of a frame are computed again. Such frames must have the same depth grid as the first
   one. */
TEST_WITH(recoloured_frames_keep_the_grid, set_up, stand_tear_down)
{
    struct view view;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        struct depth_grid *first = NULL;
        view.tier = (enum tier)tier;
        for (int i = 0; i < 4; i++) {
            toy_set(stand.snapshot, 0, 10.0 + i, QUALITY_GOOD);
            struct frame *frame = split_view_draw_now(stand.renderer, &view, stand.snapshot);
            assert_non_null(frame->depth[0]);
            assert_true(!first || depth_grid_equal(first, frame->depth[0]));
            if (!first)
                first = depth_grid_ref(frame->depth[0]);
            frame_unref(&frame);
        }
        depth_grid_unref(&first);
    }
}
