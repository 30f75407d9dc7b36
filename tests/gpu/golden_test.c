/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares frames with tests/golden, made on llvmpipe: drawn as for a session without a GPU (render/soft, render/refined; the
   same code for each context), and drawn by the context itself. GOLDEN_UPDATE=1 rewrites the golden files: look at them before
   committing them. */
#include "tests/support/test.h"
#include <sys/stat.h>

#include <png.h>

#include "render/split_view.h"
#include "render/overlay/overlay.h"
#include "scene/framing.h"
#include "tests/support/rig.h"
#include "value/alarm.h"

enum { WIDTH = 480, HEIGHT = 270, BYTES = WIDTH * HEIGHT * 4 };
static struct rig rig;
static struct stand stand;

struct golden {
    const char *name;
    enum tier tier;
    enum look look;
    double ramp_interval;
    int selected_asset;
    bool overlay, opened; /* overlay: draws legend and labels; opened: orthographic view with a section plane and a ghosted asset */
    double far_part;      /* largest allowed fraction of pixels with a channel that differs from the golden file by more than FAR */
    bool split;           /* left: operator's view; right: isolines and breaks on a logarithmic scale */
    bool dark;
};
enum { FAR = 20 };

static const struct golden goldens[] = {
    { "moving", TIER_PREVIEW, LOOK_DEFAULT, 0, -1, false, false, 0.01, false, false },
    { "still", TIER_REFINED, LOOK_DEFAULT, 0, -1, false, false, 0.01, false, false },
    { "ramp", TIER_REFINED, LOOK_FLAT, 20, 1, false, false, 0.01, false, false },
    { "glossy", TIER_REFINED, LOOK_GLOSSY, 0, -1, false, false, 0.015, false, false },
    { "opened", TIER_REFINED, LOOK_DEFAULT, 0, -1, false, true, 0.015, false, false },
    { "split", TIER_REFINED, LOOK_DEFAULT, 0, -1, true, false, 0.04, true, false },
    { "dark", TIER_PREVIEW, LOOK_DEFAULT, 0, -1, false, false, 0.01, false, true },
    /* allows 4 % of the pixels to differ, because the shapes of letters depend on the version of the font */
    { "overlay", TIER_REFINED, LOOK_DEFAULT, 0, -1, true, false, 0.04, false, false },
};

static void save(const char *folder, const char *name, const char *what, const uint8_t *bgrx)
{
    png_image image = { .version = PNG_IMAGE_VERSION, .width = WIDTH, .height = HEIGHT, .format = PNG_FORMAT_BGR };
    uint8_t *packed = mem_array(WIDTH * HEIGHT, 3);
    char *path = test_printf("%s/%s%s.png", folder, name, what);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        memcpy(packed + 3 * i, bgrx + 4 * i, 3);
    if (!png_image_write_to_file(&image, path, 0, packed, 0, NULL))
        fail_msg("%s: %s", path, image.message);
    mem_free(packed);
}

static uint8_t *load(const char *name)
{
    png_image image = { .version = PNG_IMAGE_VERSION };
    char *path = test_printf("tests/golden/%s.png", name);
    uint8_t *bgrx = mem_array(BYTES, 1);
    if (!png_image_begin_read_from_file(&image, path) || image.width != WIDTH || image.height != HEIGHT)
        fail_msg("%s: %s", path, image.message[0] ? image.message : "another size");
    image.format = PNG_FORMAT_BGRA;
    if (!png_image_finish_read(&image, NULL, bgrx, 0, NULL))
        fail_msg("%s: %s", path, image.message);
    return bgrx;
}

/* Returns the share of pixels far from the golden ones; `differences` receives the differences times ten. */
static double compare(const uint8_t *got, const uint8_t *want, uint8_t *differences)
{
    int far = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        int most = 0;
        for (int c = 0; c < 3; c++) {
            int d = abs(got[4 * i + c] - want[4 * i + c]);
            differences[4 * i + c] = (uint8_t)(d * 10 > 255 ? 255 : d * 10);
            most = d > most ? d : most;
        }
        far += most > FAR;
    }
    return (double)far / (WIDTH * HEIGHT);
}

static void judge(const struct golden *golden, bool by_gl, const uint8_t *got)
{
    const char *out = getenv("PLANTCAST_OUT");
    char *folder = test_printf("%s/golden-%s%s", out ? out : "build", gl_kind_name(rig.gl->kind), by_gl ? "-by-gl" : "");
    uint8_t *want = load(golden->name), *differences = mem_array(BYTES, 1);
    double far = compare(got, want, differences);
    print_message("# %s%s: %.2f %% of the pixels differ by more than %d\n", golden->name, by_gl ? ", by GL" : "", 100 * far, FAR);
    if (far > golden->far_part) {
        mkdir(folder, 0777);
        save(folder, golden->name, "-got", got);
        save(folder, golden->name, "-want", want);
        save(folder, golden->name, "-diff", differences);
        print_message("%s: %.2f %% of the pixels differ by more than %d (%.2f %% may); see %s\n", golden->name, 100 * far, FAR,
                      100 * golden->far_part, folder);
    }
    assert_true(far <= golden->far_part);
    mem_free(want);
    mem_free(differences);
}

static void open_up(struct view *view)
{
    struct framing framing = { .asset = -1, .tag = -1, .side = SIDE_ISO };
    view->camera.height_m = 1;
    framing_look(&stand.toy->scene, &framing, (double)WIDTH / HEIGHT, &view->camera);
    asset_set_add(&view->visibility.ghosts, 1);
    view->visibility.clip = (struct clip){ .plane_count = 1, .planes = { { 0, 1, 0, 0.1 } } };
}

static void split_up(struct view *view)
{
    struct view right = *view;
    view->field.show = SHOW_OPERATOR;
    view_default_scale(&stand.toy->scene, view);
    right.range_min = 10;
    right.color_scale.log = true;
    memcpy(right.color_scale.breaks, (double[]){ 30, 60 }, 2 * sizeof(double));
    right.color_scale.break_count = 2;
    right.color_scale.lines[right.color_scale.line_count++] = 45;
    right.colormap = colormap_find(NULL, "calm");
    view_split(view, &right);
}

static void test_golden(void **state)
{
    const struct golden *golden = *state;
    struct view view;
    view_default(&stand.toy->scene, WIDTH, HEIGHT, &view);
    view.tier = golden->tier;
    view.look = golden->look;
    view.ramp_interval = golden->ramp_interval;
    view.dark = golden->dark;
    view.selected_asset = golden->selected_asset;
    if (golden->opened)
        open_up(&view);
    if (golden->split)
        split_up(&view);
    for (int by_gl = 0; by_gl <= 1; by_gl++) {
        renderer_use_gl(stand.renderer, by_gl);
        struct frame *frame = split_view_draw_now(stand.renderer, &view, stand.snapshot);
        frame_read_markers(frame, stand.snapshot, NULL);
        if (golden->overlay)
            overlay_draw(frame, &stand.toy->scene, stand.snapshot, NULL);
        if (getenv("GOLDEN_UPDATE") && !by_gl)
            save("tests/golden", golden->name, "", frame->bgrx);
        judge(golden, by_gl, frame->bgrx);
        frame_unref(&frame);
    }
}

/* Sets readings: several values, one beyond the range, one uncertain and one bad. */
static void fill(void)
{
    toy_fill(stand.snapshot, 0);
    for (int i = 0; i < 7; i++) /* sets the limits of all tags but the last one, which has none */
        memcpy(stand.toy->plant.tags[i].alarms.limits, (double[]){ 10, 20, 70, 100 }, LIMIT_COUNT * sizeof(double));
    alarm_by_limits(&stand.toy->plant, stand.snapshot);
}

int main(void)
{
    struct CMUnitTest tests[sizeof(goldens) / sizeof(goldens[0])];
    for (size_t i = 0; i < sizeof(goldens) / sizeof(goldens[0]); i++)
        tests[i] = (struct CMUnitTest){ .name = goldens[i].name, .test_func = test_golden, .initial_state = (void *)&goldens[i] };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    setenv("TZ", "UTC", 1);
    if (!rig_init(&rig, "golden_test"))
        return 0;
    stand_init(&stand, &rig, toy_unit());
    fill();
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    stand_finish(&stand);
    rig_finish(&rig);
    return failed;
}
