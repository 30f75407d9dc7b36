/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests lighting that one session selects while other sessions are served: it is computed (baked) in small steps within a
   memory limit, and shown when it is ready. */
#include "tests/support/test.h"
#include <unistd.h>

#include "render/light/light.h"
#include "tests/support/planned.h"
#include "tests/support/rig.h"
#include "value/quality.h"

static struct rig rig;
static struct stand stand;
static struct environments environments;

static struct light_key sun(int i)
{
    double height = 0.4 + 0.05 * (i % 9), across = sqrt(1 - height * height);
    return (struct light_key){ .towards = { across * cos(0.7 * i), across * sin(0.7 * i), height } };
}

static void *bytes_of(const struct gpu_scene *gpu_scene, const struct light_set *set, size_t asset, size_t *count)
{
    *count = 4 * gpu_scene->of_asset[asset]->mesh.vertex_count;
    uint8_t *bytes = malloc(*count);
    glGetNamedBufferSubData(set->baked[asset]->page->buffer, (GLintptr)pool_offset(set->baked[asset]), (GLsizeiptr)*count, bytes);
    return bytes;
}

static void assert_same_light(const struct gpu_scene *gpu_scene, const struct light_set *a, const struct light_set *b)
{
    for (size_t i = 0; i < gpu_scene->scene->asset_count; i++) {
        size_t count;
        void *first = bytes_of(gpu_scene, a, i, &count), *second = bytes_of(gpu_scene, b, i, &count);
        assert_memory_equal(first, second, count);
        free(first);
        free(second);
    }
}

static bool init_scene(struct gpu_scene *gpu_scene, const struct toy *toy)
{
    struct environment_light sky = environments_get(&environments, 0);
    return gpu_scene_init(gpu_scene, rig.gl, &toy->scene, &sky);
}

static int count_steps(struct light *light, const struct light_key *key)
{
    int steps = 1;
    while (!light_step(light, key, 0))
        steps++;
    return steps;
}

/* A light baked in small steps has the same bits as one baked at once, both for the first sun, for which the sky light is baked
   too, and for the second, which reuses the sky light. */
TEST(test_bits_make_the_same_light)
{
    struct gpu_scene gpu_scene;
    struct light at_once, in_bits;
    const struct light_key suns[2] = { sun(1), sun(2) };
    assert_true(init_scene(&gpu_scene, stand.toy) && light_init(&at_once, &gpu_scene, &environments) &&
                light_init(&in_bits, &gpu_scene, &environments));
    for (int i = 0; i < 2; i++) {
        assert_true(count_steps(&in_bits, &suns[i]) > (int)gpu_scene.scene->asset_count);
        struct light_set *a = light_get(&at_once, &suns[i]), *b = light_get(&in_bits, &suns[i]);
        assert_true(a && b && !in_bits.bake);
        assert_same_light(&gpu_scene, a, b);
    }
    light_finish(&at_once);
    light_finish(&in_bits);
    gpu_scene_finish(&gpu_scene);
}

static void damage(const char *path)
{
    FILE *file = fopen(path, "r+");
    assert_non_null(file);
    assert_int_equal(fseek(file, 70000, SEEK_SET), 0);
    int byte = fgetc(file);
    assert_int_equal(fseek(file, 70000, SEEK_SET), 0);
    fputc(byte ^ 1, file);
    fclose(file);
}

/* The second start reads the sky's openness from the cache of the first, bakes only the rest and gets the same light, for
   another sun, too. A damaged cache, or one made before the plant's assets moved, is not used. */
TEST(test_openness_is_kept)
{
    struct gpu_scene gpu_scene;
    struct light anew, first, second;
    struct openness openness;
    const struct light_key suns[2] = { sun(1), sun(2) };
    char folder[] = "/tmp/plantcast-light-XXXXXX", path[64];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof(path), "%s/openness", folder);
    assert_true(init_scene(&gpu_scene, stand.toy));
    assert_true(light_init(&anew, &gpu_scene, &environments));
    const int all = count_steps(&anew, &suns[0]);
    stand.toy->scene.folder = folder;
    assert_false(openness_open(&openness, &gpu_scene));
    assert_true(light_init(&first, &gpu_scene, &environments));
    assert_int_equal(count_steps(&first, &suns[0]), all);
    light_finish(&first);
    assert_int_equal(access(path, R_OK), 0);
    assert_true(light_init(&second, &gpu_scene, &environments));
    assert_true(count_steps(&second, &suns[0]) < all / 2);
    for (int i = 0; i < 2; i++)
        assert_same_light(&gpu_scene, light_get(&anew, &suns[i]), light_get(&second, &suns[i]));
    assert_null(second.writer);
    light_finish(&second);

    stand.toy->scene.assets[0].placement[12] += 0.5;
    assert_false(openness_open(&openness, &gpu_scene));
    stand.toy->scene.assets[0].placement[12] -= 0.5;
    assert_true(openness_open(&openness, &gpu_scene));
    openness_close(&openness);
    damage(path);
    assert_false(openness_open(&openness, &gpu_scene));
    stand.toy->scene.folder = NULL;
    light_finish(&anew);
    gpu_scene_finish(&gpu_scene);
    unlink(path);
    rmdir(folder);
}

/* A large wall whose corners lie inside other bodies, where no light arrives: its middle must be as bright as computed for it
   and not as dark as the corners. */
TEST(test_large_faces_are_lit_within)
{
    static const double here[3] = { 0, 0, 0 };
    struct toy *toy = toy_create();
    struct test_shape shape = { 0 };
    struct gpu_scene gpu_scene;
    struct light light;
    struct light_key key = sun(1);
    size_t count;
    shape_plate(&shape, TOY_STEEL, (double[]){ 0, 0, 0 }, (double[]){ 10, 0, 0 }, (double[]){ 0, 0, 4 }, 1);
    int wall = toy_add(toy, "WALL", &shape, here, NULL, 0);
    for (int i = 0; i < 4; i++) {
        double x = i % 2 * 10, z = i / 2 * 4;
        shape_box(&shape, TOY_STEEL, (double[]){ x - 0.3, -0.3, z - 0.3 }, (double[]){ x + 0.3, 0.3, z + 0.3 });
    }
    toy_add(toy, "CORNERS", &shape, here, NULL, 0);
    assert_true(init_scene(&gpu_scene, toy) && light_init(&light, &gpu_scene, &environments));
    const struct light_set *set = light_get(&light, &key);
    assert_non_null(set);
    uint8_t(*baked)[4] = bytes_of(&gpu_scene, set, (size_t)wall, &count);
    for (size_t i = 0; i < count / 4; i++) {
        print_message("# corner %zu: openness %d of 255\n", i, baked[i][2]);
        assert_true(baked[i][2] > 200);
    }
    free(baked);
    light_finish(&light);
    gpu_scene_finish(&gpu_scene);
    toy_destroy(&toy);
}

/* folder with the cached openness for the default sky, which speeds up the tests that do not test sky light */
static char *openness_folder;

static int keep_openness(void **state)
{
    (void)state;
    stand.toy->scene.folder = openness_folder;
    return 0;
}

static int forget_openness(void **state)
{
    (void)state;
    stand.toy->scene.folder = NULL;
    return 0;
}

/* Many sessions request lights, each for another sun (40 in a long run), while one light stays in use. Memory stays within the
   limit of three lights. */
TEST_WITH(test_many_lights_fit_in_a_bound, keep_openness, forget_openness)
{
    struct gpu_scene gpu_scene;
    struct light light;
    struct light_key key = sun(0);
    assert_true(init_scene(&gpu_scene, stand.toy) && light_init(&light, &gpu_scene, &environments));
    size_t one = bake_bytes(&gpu_scene);
    light.bound_bytes = 3 * one;
    struct light_set *held = light_get(&light, &key);
    uint64_t id = held->id;
    light_hold(held);
    for (int i = 1; i < sweep(40, 6); i++) {
        key = sun(i);
        assert_non_null(light_get(&light, &key));
        assert_true(light.bytes <= light.bound_bytes);
        assert_true(held->id == id);
    }
    assert_true(light.bytes == 3 * one);
    light_release(held);
    for (int i = 1; i < 4; i++) {
        key = sun(i);
        light_get(&light, &key);
    }
    assert_true(held->id != id);
    light_finish(&light);
    gpu_scene_finish(&gpu_scene);
}

TEST_WITH(test_the_nearest_sun_stands_in, keep_openness, forget_openness)
{
    struct gpu_scene gpu_scene;
    struct light light;
    assert_true(init_scene(&gpu_scene, stand.toy) && light_init(&light, &gpu_scene, &environments));
    assert_null(light_near(&light, &(struct light_key){ .towards = { 0, 0, 1 } }));
    light_get(&light, &(struct light_key){ .towards = { 1, 0, 0 } });
    light_get(&light, &(struct light_key){ .towards = { 0, 0, 1 } });
    assert_true(light_near(&light, &(struct light_key){ .towards = { 0.6, 0, 0.8 } })->key.towards[2] == 1);
    assert_true(light_near(&light, &(struct light_key){ .towards = { 0.8, 0, 0.6 } })->key.towards[0] == 1);
    light_finish(&light);
    gpu_scene_finish(&gpu_scene);
}

/* light_drop() with the default light leaves exactly one light in memory: the default one if it is there, otherwise another. */
TEST_WITH(test_one_light_stays, keep_openness, forget_openness)
{
    struct gpu_scene gpu_scene;
    struct light light;
    const struct light_key usual = sun(0), others[2] = { sun(1), sun(4) };
    assert_true(init_scene(&gpu_scene, stand.toy) && light_init(&light, &gpu_scene, &environments));
    light.bound_bytes = 3 * bake_bytes(&gpu_scene);
    for (int cached = 1; cached >= 0; cached--) {
        for (int i = 0; i < 2; i++)
            light_get(&light, &others[i]);
        if (cached)
            light_get(&light, &usual);
        light_drop(&light, &usual);
        assert_true(light.bytes == bake_bytes(&gpu_scene));
        assert_true((light_near(&light, &usual)->key.towards[0] == usual.towards[0]) == cached);
        light_drop(&light, &others[0]); /* light_drop() with another light keeps that one and drops all others, also the default light */
        light_get(&light, &others[0]);
        light_drop(&light, &others[0]);
    }
    light_finish(&light);
    gpu_scene_finish(&gpu_scene);
}

static bool same_pixels(const struct frame *a, const struct frame *b)
{
    return !memcmp(a->bgrx, b->bgrx, (size_t)a->stride_bytes * (size_t)a->height_px);
}

/* A session that only draws previews rotates the sun: no frame waits until the new light is baked, and a few frames later the
   light is ready and shown. */
TEST(test_a_moving_session_does_not_wait)
{
    struct view view;
    view_default(&stand.toy->scene, 320, 180, &view);
    view.tier = TIER_PREVIEW;
    struct frame *before = test_frame(stand_draw(&stand, &view));
    renderer_set_bake_budget(stand.renderer, 1);
    memcpy(view.light_dir, sun(3).towards, sizeof(view.light_dir));
    struct frame *first = test_frame(stand_draw(&stand, &view));
    assert_true(same_pixels(before, first) && first->content != before->content);
    uint64_t content = first->content;
    int pictures = 1;
    for (; content == first->content && pictures < 1000; pictures++) {
        struct frame *frame = stand_draw(&stand, &view);
        frame_unref(&frame);
        content = planned_content(stand.renderer, &view, stand.snapshot);
    }
    assert_true(pictures > 3 && pictures < 1000);
    struct frame *after = test_frame(stand_draw(&stand, &view));
    renderer_set_bake_budget(stand.renderer, 0);
    struct frame *exact = test_frame(stand_draw(&stand, &view));
    assert_true(same_pixels(after, exact) && !same_pixels(after, before));
}

/* A preview is drawn before its light is baked; baking continues while no frame is requested. */
TEST(test_the_first_light_is_rough)
{
    struct stand fresh;
    struct view view;
    stand_init(&fresh, &rig, toy_unit());
    for (int i = 0; i < 8; i++)
        toy_set(fresh.snapshot, i, 20 + 7 * i, QUALITY_GOOD);
    view_default(&fresh.toy->scene, 320, 180, &view);
    view.tier = TIER_PREVIEW;
    assert_true(renderer_set_bake_budget(fresh.renderer, 1));
    struct frame *first = test_frame(stand_draw(&fresh, &view));
    int steps = 1;
    while (!renderer_bake_idle(fresh.renderer, 1))
        steps++;
    assert_true(steps > 8 && planned_content(fresh.renderer, &view, fresh.snapshot) != first->content);
    struct frame *after = test_frame(stand_draw(&fresh, &view)), *exact = test_frame(stand_draw(&stand, &view));
    assert_true(same_pixels(after, exact) && !same_pixels(first, exact));
    stand_finish(&fresh);
}

/* A refined frame has the requested sun, however long baking takes. */
TEST(test_a_still_picture_waits_for_its_light)
{
    struct view view;
    view_default(&stand.toy->scene, 320, 180, &view);
    memcpy(view.light_dir, sun(4).towards, sizeof(view.light_dir));
    struct render_job *job = planned_begin(stand.renderer, &view, stand.snapshot);
    int steps = 1;
    for (; !renderer_step(stand.renderer, job, 1); steps++) {
    }
    struct frame *bits = test_frame(renderer_end(stand.renderer, &job)), *whole = test_frame(stand_draw(&stand, &view));
    assert_true(steps > 8 && same_pixels(bits, whole) && bits->content == whole->content);
}

int main(void)
{
    unsetenv("PLANTCAST_SHARED"); /* ignores caches of other runs */
    if (!rig_init(&rig, "light_test"))
        return 0;
    stand_init(&stand, &rig, toy_unit());
    for (int i = 0; i < 8; i++)
        toy_set(stand.snapshot, i, 20 + 7 * i, QUALITY_GOOD);
    if (!environments_init(&environments, rig.gl, &stand.toy->plant, rig.workers))
        return 1;
    openness_folder = temp_folder();
    int failed = tests_run(NULL);
    environments_finish(&environments);
    stand_finish(&stand);
    rig_finish(&rig);
    return failed;
}
