/* SPDX-License-Identifier: GPL-3.0-or-later */
/* If memory for a field cannot be allocated, the asset must be shown as having no data, never as an asset without sensors and
   never with a wrong value. The linker redirects calls of mem_try_array and pool_take to this file. */
#include "tests/support/test.h"

#include "gpu/pool.h"
#include "render/shaded_colormap.h"
#include "render/renderer_impl.h"
#include "tests/support/planned.h"
#include "tests/support/stand_case.h"
#include "value/quality.h"

enum { PLATES = 6, CELLS = 12, VERTICES = (CELLS + 1) * (CELLS + 1), SIDE_PX = 128 };

static enum { ALL_WELL, NO_SUMS, NO_WEIGHTS, NO_SHADOW, NO_BUFFER } fault;

void *__real_mem_try_array(size_t count, size_t bytes_each);
void *__wrap_mem_try_array(size_t count, size_t bytes_each);
struct pool_slice *__real_pool_take(struct pool *pool, size_t count);
struct pool_slice *__wrap_pool_take(struct pool *pool, size_t count);

/* Lets allocations of arrays with one entry per vertex fail, depending on `fault`. An array of doubles contains sums, one of
   floats weights, and one of struct scalar displayed values. */
void *__wrap_mem_try_array(size_t count, size_t bytes_each)
{
    bool by_vertex = count == VERTICES;
    if (by_vertex && ((fault == NO_SUMS && bytes_each == sizeof(double)) || (fault == NO_WEIGHTS && bytes_each == sizeof(float)) ||
                      (fault == NO_SHADOW && bytes_each == sizeof(struct scalar))))
        return NULL;
    return __real_mem_try_array(count, bytes_each);
}

/* Lets allocations of pool slices with one entry per vertex fail if `fault` is NO_BUFFER. Lighting uses slices of the same
   size, but allocates them before. */
struct pool_slice *__wrap_pool_take(struct pool *pool, size_t count)
{
    return fault == NO_BUFFER && count == VERTICES ? NULL : __real_pool_take(pool, count);
}

static int set_up(void **state)
{
    static const double sensors[2][3] = { { 0, 0, 0 }, { 4, 4, 0 } };
    struct test_shape shape = { 0 };
    struct toy *toy = toy_create();
    (void)state;
    fault = ALL_WELL;
    shape_plate(&shape, TOY_BLUE, (double[3]){ 0, 0, 0 }, (double[3]){ 4, 0, 0 }, (double[3]){ 0, 4, 0 }, CELLS);
    toy_add(toy, "PLATE", &shape, (double[3]){ 0, 0, 0 }, sensors, 2);
    stand_init(&stand, &rig, toy);
    toy_set(stand.snapshot, 0, 30, QUALITY_GOOD);
    toy_set(stand.snapshot, 1, 70, QUALITY_GOOD);
    return 0;
}

/* Set-up: several plates side by side, each an asset with two sensors. */
static int set_up_many(void **state)
{
    static const double sensors[2][3] = { { 0, 0, 0 }, { 1.5, 3.5, 0 } };
    struct toy *toy = toy_create();
    (void)state;
    fault = ALL_WELL;
    for (int i = 0; i < PLATES; i++) {
        struct test_shape shape = { 0 };
        char *name = test_printf("P%d", i);
        shape_plate(&shape, TOY_BLUE, (double[3]){ 0, 0, 0 }, (double[3]){ 1.5, 0, 0 }, (double[3]){ 0, 3.5, 0 }, CELLS);
        toy_add(toy, name, &shape, (double[3]){ 2.0 * (i % 2), 4.0 * (i / 2) - 4, 0 }, sensors, 2);
    }
    stand_init(&stand, &rig, toy);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    fault = ALL_WELL;
    stand_finish(&stand);
    return 0;
}

static struct view look_down(void)
{
    struct view view;
    view_default(&stand.toy->scene, SIDE_PX, SIDE_PX, &view);
    view.camera = (struct camera){ .eye_m = { 2, 2, 10 }, .target_m = { 2, 2, 0 }, .up = { 0, 1, 0 }, .fov_deg = 21 };
    view.look = LOOK_FLAT;
    return view;
}

TEST_WITH(test_without_memory_there_is_no_data, set_up, tear_down)
{
    struct view view = look_down();
    for (int kind = NO_SUMS; kind <= NO_BUFFER; kind++)
        for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
            view.tier = (enum tier)tier;
            /* each frame has a power (exponent of distance) that no earlier frame had, so that its field is not cached */
            view.field.power = 1 + kind + 0.25 * tier;
            fault = kind;
            uint64_t content = planned_content(stand.renderer, &view, stand.snapshot);
            stand_expect_hatched(&view);
            fault = ALL_WELL;
            /* the planned content differs from that of the hatched frame, so the renderer draws the frame again instead of
               reusing it */
            assert_true(planned_content(stand.renderer, &view, stand.snapshot) != content);
            struct frame *frame = stand_draw(&stand, &view);
            assert_true(map_index_exact(colormap_at(NULL, 0), frame_pixel(frame, 8, SIDE_PX - 8)) >= 0);
            frame_unref(&frame);
        }
}

TEST_WITH(test_bit_by_bit_too, set_up, tear_down)
{
    struct view view = look_down();
    view.tier = TIER_REFINED;
    view.field.power = 9;
    fault = NO_WEIGHTS;
    struct render_job *job = planned_begin(stand.renderer, &view, stand.snapshot);
    fault = ALL_WELL; /* ends the fault, because drawing allocates other arrays of the same size */
    assert_non_null(job);
    while (!renderer_step(stand.renderer, job, 1000000)) {
    }
    struct frame *frame = test_frame(renderer_end(stand.renderer, &job));
    const uint8_t *pixel = frame_pixel(frame, SIDE_PX / 2, SIDE_PX / 2);
    assert_true(is_grey(pixel));
}

/* The cache limit is smaller than the fields of one frame. Fields that belong to the same frame must not evict each other or
   their displayed values, so the frame looks the same as without a limit. */
TEST_WITH(test_with_little_room_many_are_shown_alike, set_up_many, tear_down)
{
    struct view view;
    struct field *poor = field_create(rig.workers, &stand.toy->scene);
    struct renderer *frugal = renderer_create(rig.log, rig.gl, &stand.toy->scene, poor);
    assert_non_null(frugal);
    field_set_cache_limit(poor, 1);
    view = look_down();
    view.camera.eye_m[2] = 40;
    for (int round = 0; round < 24; round++) {
        view.tier = round % 3 == 2 ? TIER_REFINED : TIER_PREVIEW;
        view.field.interpolation = round % 2 ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD;
        view.field.power = 2 + round / 2 % 2;
        for (int i = 0; i < 2 * PLATES; i++)
            if ((i + round) % 3)
                toy_set(stand.snapshot, i, (i * 37 + round * 11) % 100, (i + round) % 11 ? QUALITY_GOOD : QUALITY_BAD_SENSOR_FAILURE);
        struct frame *want = stand_draw(&stand, &view), *got = split_view_draw_now(frugal, &view, stand.snapshot);
        assert_non_null(got);
        int shown = 0;
        for (int i = 0; i < SIDE_PX * SIDE_PX; i++) {
            const uint8_t *a = frame_pixel(want, i % SIDE_PX, i / SIDE_PX), *b = frame_pixel(got, i % SIDE_PX, i / SIDE_PX);
            shown += a[0] != a[1] || a[1] != a[2];
            for (int c = 0; c < 3; c++)
                /* allows a difference of 2, because sums that are computed again are rounded differently */
                assert_true(abs(a[c] - b[c]) <= 2);
        }
        assert_true(shown > SIDE_PX * SIDE_PX / 10);
        frame_unref(&want);
        frame_unref(&got);
    }
    renderer_destroy(&frugal);
    field_destroy(&poor);
}

static void assert_kept(const struct fields *fields, struct fields_entry *const was[PLATES])
{
    assert_int_equal(fields->count, PLATES);
    for (int i = 0; i < PLATES; i++)
        assert_ptr_equal(fields->entries[i], was[i]);
}

/* One frame of this plant needs more fields than the cache limit allows. The frame's fields must nevertheless be kept for the
   next frame, while fields that it does not need are evicted. */
TEST_WITH(test_what_one_picture_needs_stays, set_up_many, tear_down)
{
    struct view view;
    struct frame *frame;
    struct fields *fields = &stand.renderer->fields;
    struct fields_entry *was[PLATES];
    fields->bound_bytes = 1;
    view = look_down();
    view.camera.eye_m[2] = 40;
    for (int way = 0; way < 2; way++) {
        view.field.power = 2 + way;
        for (int i = 0; i < 4; i++) {
            view.camera.eye_m[0] += 0.01;
            frame = stand_draw(&stand, &view);
            frame_unref(&frame);
            if (i == 1)
                memcpy(was, fields->entries, sizeof(was));
            if (i > 1)
                assert_kept(fields, was);
        }
    }
}
