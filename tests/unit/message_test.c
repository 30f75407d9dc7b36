/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests how the server parses messages of clients and the query strings of snapshots: the fields of valid ones are read
   correctly, and invalid or randomly damaged ones are refused. */
#include "message/message_parse.h"

#include "tests/support/test.h"
#include <dirent.h>

#include "base/text/text.h"
#include "plant/colormaps.h"
#include "message/json_fields.h"
#include "message/view_query.h"
#include "message/view_query_write.h"
#include "session/reply/reply.h"
#include "message/visibility.h"
#include "tests/support/small_scene.h"

#define FOLDER "protocol/vectors/client"

static const struct plant *plant(void)
{
    return small_scene()->plant;
}

static struct params_context context;

static int set_up(void **state)
{
    (void)state;
    context = (struct params_context){ .scene = small_scene(),
                                       .baselines = baselines_create(),
                                       .snapshot = snapshot_create(small_scene()->plant->tag_count) };
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    struct snapshot *snapshot = (struct snapshot *)context.snapshot;
    snapshot_destroy(&snapshot);
    baselines_destroy(&context.baselines);
    return 0;
}

/* Parses a message and applies its parameters to `view`, as a session does. Returns false with *error if it is refused. */
static bool take(const char *text, size_t count, struct message_error *error)
{
    struct message message;
    struct view view;
    view_default(small_scene(), 640, 360, &view);
    if (!message_parse(plant(), text, count, &message, error))
        return false;
    bool params = message.type == MESSAGE_PARAMS || message.hello.has_params;
    return !params || (params_apply(&context, &message.params, &view, error) && split_apply(&context, &message.split, &view, error));
}

static void check_vector(const char *file, int *accepted, int *refused)
{
    size_t count, n = strcspn(file, "-");
    struct message_error error = { 0 };
    char *path = test_printf("%s/%s", FOLDER, file), *text = test_memory(text_read_file(path, 1 << 20, &count));
    assert_non_null(text);
    bool good = take(text, count, &error);
    if (!strncmp(file, "accepted--", 10)) {
        if (!good)
            fail_msg("%s: refused: %s: %s", file, error.code, error.text);
        ++*accepted;
    } else {
        if (good)
            fail_msg("%s: taken", file);
        if (strlen(error.code) != n || strncmp(error.code, file, n) != 0)
            fail_msg("%s: refused with %s: %s", file, error.code, error.text);
        assert_true(error.text[0] != 0);
        ++*refused;
    }
}

TEST(vectors_are_taken_or_refused)
{
    int accepted = 0, refused = 0;
    DIR *folder = opendir(FOLDER);
    assert_non_null(folder);
    for (struct dirent *entry; (entry = readdir(folder));)
        if (strstr(entry->d_name, "--"))
            check_vector(entry->d_name, &accepted, &refused);
    closedir(folder);
    assert_true(accepted >= 13 && refused >= 50);
}

static struct message parse(const char *text)
{
    struct message message;
    struct message_error error;
    if (!message_parse(plant(), text, strlen(text), &message, &error))
        fail_msg("%s: %s: %s", text, error.code, error.text);
    return message;
}

TEST(fields_arrive)
{
    struct message m = parse("{\"type\":\"hello\",\"width\":640,\"height\":360,\"codecs\":[\"av1\",\"png\",\"jpeg\",\"png\"],"
                             "\"camera\":{\"seq\":9,\"eye\":[1,2,3],\"target\":[4,5,6],\"fov\":50}}");
    assert_int_equal(m.type, MESSAGE_HELLO);
    assert_int_equal(m.size.width_px, 640);
    assert_int_equal(m.size.height_px, 360);
    assert_true(m.codecs.count == 2 && m.codecs.at[0] == WIRE_CODEC_PNG && m.codecs.at[1] == WIRE_CODEC_JPEG && !m.codecs.choose);
    assert_true(m.hello.has_camera && !m.hello.has_params);
    assert_int_equal(m.seq, 9);
    assert_true(m.camera.eye_m[2] == 3 && m.camera.target_m[0] == 4 && m.camera.up[2] == 1 && m.camera.fov_deg == 50);
    m = parse("{\"type\":\"camera\",\"seq\":2,\"eye\":[1,2,3],\"target\":[4,5,6],\"projection\":\"orthographic\",\"height_m\":9}");
    assert_true(m.camera.height_m == 9);
    m = parse("{\"type\":\"codecs\",\"codecs\":[\"auto\",\"h264\"]}");
    assert_true(m.codecs.count == 1 && m.codecs.at[0] == WIRE_CODEC_H264 && m.codecs.choose);
    m = parse("{\"type\":\"ack\",\"seq\":12,\"decode_ms\":3.5}");
    assert_true(m.seq == 12 && m.decode_ms == 3.5);
    m = parse("{\"type\":\"ack\",\"seq\":12}");
    assert_true(m.decode_ms < 0);
}

static struct view changed(struct view view, const char *text)
{
    struct message m = parse(text);
    struct message_error error;
    if (!params_apply(&context, &m.params, &view, &error))
        fail_msg("%s: %s", text, error.text);
    return view;
}

TEST(what_is_left_out_stays)
{
    struct view view;
    view_default(small_scene(), 640, 360, &view);
    view = changed(view, "{\"type\":\"params\",\"seq\":1,\"power\":4,\"colormap\":\"viridis\",\"selected\":\"P-101A\",\"light\":[0,0,9]}");
    view = changed(view, "{\"type\":\"params\",\"seq\":2,\"ramp_interval\":5}");
    assert_true(view.field.power == 4 && view.ramp_interval == 5 && view.selected_asset == 1 && view.light_dir[2] == 1);
    assert_int_equal(view.colormap, colormap_find(NULL, "viridis"));
    view = changed(view, "{\"type\":\"params\",\"seq\":3,\"selected\":null,\"reach_m\":2}");
    assert_true(view.selected_asset == -1 && view.field.reach_m == 2 && view.field.power == 4);
    view = changed(view, "{\"type\":\"params\",\"seq\":4,\"reach_m\":null}");
    assert_true(isinf(view.field.reach_m));
}

TEST(a_light_of_null_is_that_of_a_new_view)
{
    struct view fresh, view;
    view_default(small_scene(), 640, 360, &fresh);
    view = changed(fresh, "{\"type\":\"params\",\"seq\":1,\"light\":[0,0,9]}");
    assert_false(view_equal(&view, &fresh));
    view = changed(view, "{\"type\":\"params\",\"seq\":2,\"light\":null}");
    assert_true(view_equal(&view, &fresh));
}

TEST(a_new_group_brings_its_settings)
{
    struct view view;
    view_default(small_scene(), 640, 360, &view);
    view = changed(view, "{\"type\":\"params\",\"seq\":1,\"power\":4,\"range\":[0,50],\"ramp_interval\":5,\"colormap\":\"viridis\"}");
    struct view same = changed(view, "{\"type\":\"params\",\"seq\":2,\"group\":\"temperature\"}");
    assert_true(same.field.power == 4 && same.range_max == 50 && same.ramp_interval == 5);
    struct view other = changed(view, "{\"type\":\"params\",\"seq\":3,\"group\":\"pressure\",\"distance\":\"geodesic\"}");
    assert_int_equal(other.field.group, 1);
    assert_true(other.field.power == 3 && other.field.radius_m == 2.5 && other.field.reach_m == 4);
    assert_true(other.range_min == 0 && other.range_max == 16 && other.ramp_interval == 0);
    assert_int_equal(other.field.interpolation, INTERPOLATION_PAPER);
    assert_int_equal(other.field.distance, DISTANCE_GEODESIC);
    assert_int_equal(other.colormap, view.colormap);
}

TEST(a_plant_may_begin_with_limits)
{
    struct plant *ours = (struct plant *)plant();
    struct view view;
    ours->display.show = PLANT_SHOW_OPERATOR;
    view_default(small_scene(), 640, 360, &view);
    ours->display.show = PLANT_SHOW_VALUE;
    assert_true(view_is_operator(&view));
    struct view other = changed(view, "{\"type\":\"params\",\"seq\":1,\"group\":\"pressure\"}");
    assert_true(view_is_operator(&other));
    struct view value = changed(view, "{\"type\":\"params\",\"seq\":2,\"show\":\"value\"}");
    assert_true(value.field.show == SHOW_VALUE && value.range_min == 20 && value.range_max == 180);
}

static struct view both_changed(struct view view, const char *text)
{
    struct message m = parse(text);
    struct message_error error;
    if (!params_apply(&context, &m.params, &view, &error) || !split_apply(&context, &m.split, &view, &error))
        fail_msg("%s: %s", text, error.text);
    return view;
}

TEST(bands_and_lines)
{
    struct view view;
    view_default(small_scene(), 640, 360, &view);
    view = changed(view, "{\"type\":\"params\",\"seq\":1,\"ramp_interval\":5,\"isolines\":[30,70]}");
    assert_true(view.ramp_interval == 5 && view.color_scale.line_count == 2 && view.color_scale.lines[1] == 70);
    view = changed(view, "{\"type\":\"params\",\"seq\":2,\"breaks\":\"limits\"}");
    assert_true(view.ramp_interval == 0 && view.color_scale.break_count == 2 && view.color_scale.breaks[0] == 30 &&
                view.color_scale.breaks[1] == 150);
    assert_int_equal(view.color_scale.line_count, 2);
    view = changed(view, "{\"type\":\"params\",\"seq\":3,\"isolines\":50}");
    assert_true(view.color_scale.line_count == 3 && view.color_scale.lines[0] == 50 && view.color_scale.lines[2] == 150);
    view = changed(view, "{\"type\":\"params\",\"seq\":4,\"ramp_interval\":20}");
    assert_true(view.ramp_interval == 20 && view.color_scale.break_count == 0);
    view = changed(view, "{\"type\":\"params\",\"seq\":5,\"scale\":\"log\",\"isolines\":null}");
    assert_true(view.color_scale.log && view.color_scale.line_count == 0);
    view = changed(view, "{\"type\":\"params\",\"seq\":6,\"breaks\":[25,50],\"group\":\"pressure\"}");
    assert_true(!view.color_scale.log && view.color_scale.break_count == 2 && view.range_max == 16);
}

TEST(a_view_splits)
{
    struct view view, half;
    view_default(small_scene(), 641, 360, &view);
    view = both_changed(view, "{\"type\":\"params\",\"seq\":1,\"colormap\":\"viridis\",\"split\":{\"distance\":\"euclidean\"}}");
    assert_true(view.split && view.field.distance == DISTANCE_GEODESIC && view.right.field.distance == DISTANCE_EUCLIDEAN);
    /* when a view is split, the right half starts with the colour map of the left half */
    assert_int_equal(view.right.colormap, colormap_find(NULL, "viridis"));
    view = both_changed(view, "{\"type\":\"params\",\"seq\":2,\"colormap\":\"cividis\",\"split\":{\"group\":\"pressure\"}}");
    assert_true(view.field.group == 0 && view.right.field.group == 1 && view.right.range_max == 16);
    assert_int_equal(view.right.colormap, colormap_find(NULL, "viridis"));
    view_half(&view, 0, &half);
    assert_true(half.width_px == 320 && !half.split && half.field.group == 0);
    view_half(&view, 1, &half);
    assert_true(half.width_px == 321 && !half.split && half.field.group == 1 && half.range_max == 16);
    view = both_changed(view, "{\"type\":\"params\",\"seq\":3,\"split\":null}");
    assert_false(view.split);
    view_half(&view, 0, &half);
    assert_true(view_equal(&half, &view));
}

static void refuse(const struct view *view, const char *text, const char *word)
{
    struct message m = parse(text);
    struct message_error error;
    struct view before = *view, after = *view;
    assert_false(params_apply(&context, &m.params, &after, &error));
    assert_memory_equal(&before, &after, sizeof(before));
    assert_int_equal(strncmp(error.text, word, strlen(word)), 0);
}

TEST(what_is_shown_brings_its_own_range_and_colors)
{
    struct view view;
    view_default(small_scene(), 640, 360, &view);
    view = changed(view, "{\"type\":\"params\",\"seq\":1,\"range\":[0,50],\"ramp_interval\":5,\"colormap\":\"viridis\"}");
    struct view distance = changed(view, "{\"type\":\"params\",\"seq\":2,\"show\":\"distance\",\"sensor\":\"TI-1\"}");
    assert_true(distance.range_min == 0 && distance.range_max == 7 && distance.ramp_interval == 0);
    assert_int_equal(distance.colormap, view.colormap);
    assert_string_equal(view_unit(plant(), &distance), "m");
    struct view straight = changed(distance, "{\"type\":\"params\",\"seq\":3,\"distance\":\"euclidean\"}");
    assert_true(straight.range_max == 5);
    straight = changed(straight, "{\"type\":\"params\",\"seq\":4,\"range\":[0,3]}");
    assert_true(straight.range_max == 3);
    straight = changed(straight, "{\"type\":\"params\",\"seq\":5,\"range\":null}");
    assert_true(straight.range_max == 5);
    struct view difference = changed(distance, "{\"type\":\"params\",\"seq\":6,\"show\":\"difference\",\"baseline\":\"now\"}");
    assert_true(difference.range_min == -40 && difference.range_max == 40);
    assert_int_equal(difference.colormap, colormap_find(NULL, "diverging"));
    struct view value = changed(difference, "{\"type\":\"params\",\"seq\":7,\"show\":\"value\"}");
    assert_true(value.range_min == 20 && value.range_max == 180 && value.colormap == 0);
    struct view group = changed(difference, "{\"type\":\"params\",\"seq\":8,\"group\":\"pressure\"}");
    assert_true(group.field.show == SHOW_VALUE && group.field.baseline == 0 && group.range_max == 16);
    refuse(&distance, "{\"type\":\"params\",\"seq\":9,\"sensor\":null}", "sensor");
}

TEST(a_range_too_small_for_a_logarithmic_scale_is_refused)
{
    struct view view;
    view_default(small_scene(), 640, 360, &view);
    refuse(&view, "{\"type\":\"params\",\"seq\":1,\"range\":[5e-324,1],\"scale\":\"log\"}", "scale");
    view = changed(view, "{\"type\":\"params\",\"seq\":2,\"range\":[1e-18,1],\"scale\":\"log\"}");
    assert_true(view.color_scale.log);
    view = changed(view, "{\"type\":\"params\",\"seq\":3,\"range\":[1e-12,1e-10]}");
    assert_true(view.range_max == 1e-10);
    view = changed(view, "{\"type\":\"params\",\"seq\":4,\"range\":[0,1e-18],\"scale\":\"linear\"}");
    assert_true(view.range_max == 1e-18);
}

TEST(overrides_of_sensors_are_merged)
{
    struct view view, first;
    view_default(small_scene(), 640, 360, &first);
    view = changed(first, "{\"type\":\"params\",\"seq\":1,\"sensors\":{\"TI-1\":{\"strength\":2}}}");
    assert_true(view.field.override_count == 1 && view.field.overrides[0].strength == 2.0f);
    assert_true(view.field.overrides[0].decay == FIELD_AS_CONFIGURED && !field_params_equal(&view.field, &first.field));
    view = changed(view, "{\"type\":\"params\",\"seq\":2,\"sensors\":{\"TI-1\":{\"decay\":0}}}");
    assert_true(view.field.override_count == 1 && view.field.overrides[0].strength == FIELD_AS_CONFIGURED);
    struct view gone = changed(view, "{\"type\":\"params\",\"seq\":3,\"sensors\":{\"TI-1\":null}}");
    assert_true(field_params_equal(&gone.field, &first.field));
    gone = changed(view, "{\"type\":\"params\",\"seq\":4,\"sensors\":null}");
    assert_true(field_params_equal(&gone.field, &first.field));
    gone = changed(view, "{\"type\":\"params\",\"seq\":5,\"group\":\"pressure\"}");
    assert_int_equal(gone.field.override_count, 0);
    refuse(&view, "{\"type\":\"params\",\"seq\":6,\"sensors\":{\"PI-1\":{\"decay\":1}}}", "sensors");
}

TEST(baselines_are_set_shown_and_forgotten)
{
    struct view view;
    struct baseline list[BASELINES_NAMED];
    view_default(small_scene(), 640, 360, &view);
    view = changed(view, "{\"type\":\"params\",\"seq\":1,\"baseline\":{\"set\":\"calm\"}}");
    uint32_t id = view.field.baseline;
    assert_true(id && id == baselines_find(context.baselines, "calm"));
    view.field.baseline = 0;
    view = changed(view, "{\"type\":\"params\",\"seq\":2,\"show\":\"difference\",\"baseline\":\"calm\"}");
    assert_int_equal(view.field.baseline, id);
    refuse(&view, "{\"type\":\"params\",\"seq\":3,\"baseline\":{\"set\":\"other\"},\"radius_m\":1e-4}", "radius_m");
    assert_int_equal(baselines_find(context.baselines, "other"), 0);
    changed(view, "{\"type\":\"params\",\"seq\":4,\"baseline\":{\"remove\":\"calm\"}}");
    assert_int_equal(baselines_find(context.baselines, "calm"), 0);
    for (int i = (int)baselines_list(context.baselines, list); i < BASELINES_NAMED; i++)
        changed(view, test_printf("{\"type\":\"params\",\"seq\":5,\"baseline\":{\"set\":\"b%d\"}}", i));
    refuse(&view, "{\"type\":\"params\",\"seq\":6,\"baseline\":{\"set\":\"one too many\"}}", "baseline");
    changed(view, "{\"type\":\"params\",\"seq\":7,\"baseline\":{\"set\":\"b31\"}}");
    assert_int_equal(baselines_list(context.baselines, list), BASELINES_NAMED);
}

static bool query(const char *const *args, size_t count, struct view *view, struct message_error *error)
{
    *error = (struct message_error){ 0 };
    const struct params_context of_query = { .scene = small_scene(), .baselines = context.baselines };
    return view_query_parse(&of_query, ROLE_ENGINEER, args, count, view, NULL, error);
}

TEST(queries_make_views)
{
    static const char *const args[] = { "width=320",      "height=200",  "camera=1,2,3,4,5,6,50",
                                        "group=pressure", "range=1,2.5", "reach_m=3",
                                        "selected=E-101", "look=flat",   "light=0,0,2" };
    struct view view;
    struct message_error error;
    assert_true(query(args, sizeof(args) / sizeof(args[0]), &view, &error));
    assert_true(view.width_px == 320 && view.height_px == 200 && view.camera.eye_m[1] == 2 && view.camera.target_m[2] == 6);
    assert_true(view.camera.fov_deg == 50 && view.field.group == 1 && view.range_max == 2.5 && view.field.reach_m == 3);
    assert_true(view.selected_asset == 0 && view.look == LOOK_FLAT && view.light_dir[2] == 1 && view.tier == TIER_REFINED);
    static const char *const shown[] = { "show=distance", "sensor=TI-1", "sensors=TI-1=2:0.5" };
    assert_true(query(shown, sizeof(shown) / sizeof(shown[0]), &view, &error));
    assert_true(view.field.show == SHOW_DISTANCE && view.field.sensor == 0 && view.range_max == 7);
    assert_true(view.field.overrides[0].strength == 2.0f && view.field.overrides[0].decay == 0.5f);
    assert_true(query(&(const char *){ "sensors=TI-1=:3" }, 1, &view, &error) && view.field.overrides[0].decay == 3.0f);
    static const char *const painted[] = { "breaks=limits", "isolines=every:20", "scale=log",
                                           "split=group=pressure;breaks=1,2.5;isolines=3,4;look=flat" };
    assert_true(query(painted, sizeof(painted) / sizeof(painted[0]), &view, &error));
    assert_true(view.color_scale.break_count == 2 && view.color_scale.line_count == 9 && view.color_scale.lines[8] == 180 &&
                view.color_scale.log);
    assert_true(view.split && view.right.field.group == 1 && view.right.color_scale.breaks[1] == 2.5 &&
                view.right.color_scale.lines[1] == 4);
    assert_true(view.right.look == LOOK_FLAT && !view.right.color_scale.log);
    assert_true(view.camera.height_m == 0 && view.visibility.hidden.count == 0);
    static const char *const seen[] = { "fit=E-101",     "side=top",           "projection=orthographic",
                                        "hidden=P-101A", "ghost=E-101,P-101A", "clip=1,0,0,2;0,3,0,1.5" };
    assert_true(query(seen, sizeof(seen) / sizeof(seen[0]), &view, &error));
    /* without a stated camera, the plant is fitted into the part of the picture that the legend leaves free */
    assert_true(view.camera.height_m > 2 && view.camera.target_m[0] > 0.2 && view.camera.eye_m[2] > 2.5);
    assert_int_equal(visibility_of(&view.visibility, 0), ASSET_GHOST);
    assert_int_equal(visibility_of(&view.visibility, 1), ASSET_HIDDEN);
    assert_true(view.visibility.clip.plane_count == 2 && view.visibility.clip.planes[1][3] == 0.5 && !view.visibility.clip.is_box);
    static const char *const parallel[] = { "projection=orthographic", "height_m=7", "clip_box=-1,-1,0,1,1,2" };
    assert_true(query(parallel, 3, &view, &error));
    assert_true(view.camera.height_m == 7 && view.visibility.clip.is_box);
    assert_true(query(&(const char *){ "backdrop=dark" }, 1, &view, &error) && view.dark);
    assert_true(query(NULL, 0, &view, &error));
    assert_true(view.width_px == 1280 && view.height_px == 720 && !view.dark);
}

/* Around a single sensor, preparation may leave triangles whole. What such triangles cannot show exactly must then be refused:
   the interpolation `paper` and the display of distances. E-101 has only the sensor TI-1. */
TEST(what_is_not_drawn_truly_on_whole_triangles_is_refused)
{
    static const char *const paper[] = { "interpolation=paper" }, *const split[] = { "split=interpolation=paper" };
    static const char *const far[] = { "show=distance", "sensor=TI-1" }, *const other[] = { "group=pressure" };
    struct plant_group *group = &small_scene()->plant->groups[0];
    struct message_error error = { 0 };
    struct view view;
    assert_true(query(paper, 1, &view, &error) && query(split, 1, &view, &error) && query(far, 2, &view, &error));
    group->cuts_singles = false;
    assert_false(query(paper, 1, &view, &error));
    assert_int_equal(error.refusal.code, REFUSAL_UNCUT);
    assert_string_equal(error.refusal.args, "group=temperature\ncount=1\nall=2\nasset=E-101");
    assert_non_null(strstr(error.text, "“paper” (Kim & Suh) cannot be drawn accurately where temperature has one"));
    assert_false(query(split, 1, &view, &error));
    assert_false(query(far, 2, &view, &error));
    assert_int_equal(error.refusal.code, REFUSAL_FAR_UNCUT);
    /* accepted: the plant file itself sets `paper` for this group, so preparation has subdivided its triangles */
    assert_true(query(other, 1, &view, &error));
    assert_int_equal(view.field.interpolation, INTERPOLATION_PAPER);
    group->cuts_singles = true;
}

TEST(what_is_fitted_lies_beside_the_legend)
{
    static const char *const args[] = { "fit=E-101", "side=front", "look=materials", "split=colormap=viridis;look=default" };
    const struct params_context bare = { .scene = small_scene(), .bare = true };
    struct message_error error = { 0 };
    struct view whole, view;
    assert_true(view_query_parse(&bare, ROLE_ENGINEER, args, 2, &whole, NULL, &error));
    assert_float_equal(whole.camera.target_m[0], 0, 1e-6);
    assert_true(query(args, 2, &view, &error));
    assert_true(view.camera.target_m[0] > 0.2 && view.camera.eye_m[1] < whole.camera.eye_m[1]);
    assert_true(query(args, 3, &view, &error)); /* no legend */
    assert_float_equal(view.camera.target_m[0], 0, 1e-6);
    struct view all;
    assert_true(view_query_parse(&bare, ROLE_ENGINEER, NULL, 0, &whole, NULL, &error) && query(NULL, 0, &all, &error));
    assert_true(all.camera.target_m[0] > whole.camera.target_m[0] && all.camera.eye_m[1] < whole.camera.eye_m[1]);
    assert_true(view_query_parse(&bare, ROLE_ENGINEER, args, 2, &whole, NULL, &error));
    assert_true(query(args, 4, &view, &error)); /* one to the right */
    assert_true(view.camera.target_m[0] > 0.2 && view.camera.eye_m[1] < 1.5 * whole.camera.eye_m[1]);
}

/* The plant file's view was chosen for a wide picture. In a split view each half is half as wide and would cut off the plant,
   so the camera must move back. */
TEST(halves_show_what_the_plants_own_view_does)
{
    static const char *const args[] = { "split=colormap=viridis", "camera=0,-9,3,0,0,0,40" };
    struct plant *plant = (struct plant *)small_scene()->plant;
    const struct params_context bare = { .scene = small_scene(), .bare = true };
    struct message_error error = { 0 };
    struct view own, one, halves, given;
    assert_true(view_query_parse(&bare, ROLE_ENGINEER, NULL, 0, &one, NULL, &error));
    plant->display.view = (struct plant_view){ .set = true, .fov_deg = one.camera.fov_deg };
    memcpy(plant->display.view.eye_m, one.camera.eye_m, sizeof(one.camera.eye_m));
    memcpy(plant->display.view.target_m, one.camera.target_m, sizeof(one.camera.target_m));
    assert_true(query(NULL, 0, &own, &error));
    /* without a split, the camera is that of the plant file */
    assert_memory_equal(own.camera.eye_m, one.camera.eye_m, sizeof(own.camera.eye_m));
    assert_true(view_query_parse(&bare, ROLE_ENGINEER, args, 1, &halves, NULL, &error));
    double nearer = 0, farther = 0, before[3], after[3];
    for (int i = 0; i < 3; i++) {
        before[i] = own.camera.target_m[i] - own.camera.eye_m[i];
        after[i] = halves.camera.target_m[i] - halves.camera.eye_m[i];
        nearer += before[i] * before[i];
        farther += after[i] * after[i];
    }
    assert_true(farther > 1.5 * nearer); /* the camera steps back */
    for (int i = 0; i < 3; i++)          /* the direction of view is unchanged: the camera has moved straight back */
        assert_float_equal(after[i] / sqrt(farther), before[i] / sqrt(nearer), 1e-6);
    assert_true(query(args, 2, &given, &error) && given.camera.eye_m[1] == -9); /* if the client states a camera, it is used unchanged */
    plant->display.view = (struct plant_view){ 0 };
}

/* Writes views as query strings, which signed frames contain; parsing the result must give the same view. */
TEST(views_are_written_as_queries)
{
    static const char *const views[][4] = {
        { "width=640", "language=ko" },
        { "group=pressure", "range=1,2.5", "reach_m=3", "selected=E-101" },
        { "show=distance", "sensor=TI-1", "sensors=TI-1=2:0.5", "backdrop=dark" },
        { "sensors=TI-1=:0.1", "isolines=every:7", "light=0.1,0.2,0.3", "strip=legend" },
        { "breaks=limits", "isolines=none", "look=glossy", "hidden=E-101" },
        { "clip=1,2,3,0.3;0.1,0,-1,2", "ghost=E-101", "camera=1,2,3,4,5,6,50", "up=0.1,1,0.3" },
        { "clip_box=-1,-2,-3,1,2,3.3", "camera=1,2,3,4,5,6.1", "projection=orthographic", "height_m=0.7" },
        { "split=group=pressure;range=1,2;look=flat", "interpolation=paper", "ramp_interval=0.1", "colormap=viridis" },
    };
    const struct params_context of_query = { .scene = small_scene(), .baselines = context.baselines };
    for (size_t i = 0; i < sizeof(views) / sizeof(views[0]); i++) {
        struct message_error error = { 0 };
        struct view_address said;
        struct view view;
        size_t count = 0;
        while (count < 4 && views[i][count])
            count++;
        if (!query(views[i], count, &view, &error))
            fail_msg("view %zu: %s", i, error.text);
        view.tier = i % 2 ? TIER_REFINED : TIER_PREVIEW;
        view_set_instant(&view, (int64_t)i, (int)i);
        if (!view_query_write(&of_query, &view, &said, &error))
            fail_msg("view %zu: %s", i, error.text);
        view_address_finish(&said);
    }
}

TEST(what_no_query_says_is_refused)
{
    const struct params_context of_query = { .scene = small_scene(), .baselines = context.baselines };
    struct message_error error;
    struct view_address said;
    struct view view;
    assert_true(query(NULL, 0, &view, &error));
    view_set_trial(&view, 3);
    assert_false(view_query_write(&of_query, &view, &said, &error));
    assert_non_null(strstr(error.text, "tried out"));
    view_address_finish(&said);
    assert_true(query(NULL, 0, &view, &error));
    view.field.show = SHOW_DIFFERENCE;
    view.field.baseline = baselines_keep(context.baselines, context.snapshot);
    assert_false(view_query_write(&of_query, &view, &said, &error));
    assert_non_null(strstr(error.text, "has no name"));
    view_address_finish(&said);
    assert_true(query(&(const char *){ "split=colormap=viridis" }, 1, &view, &error));
    view.right.field.strength = -1; /* no query can express this value, so the view cannot be written (not_signed) */
    assert_false(view_query_write(&of_query, &view, &said, &error));
    assert_string_equal(error.code, "not_signed");
    view_address_finish(&said);
}

TEST(bad_queries_are_named)
{
    static const char *const bad[] = { "width=0",
                                       "width=1e9",
                                       "width=",
                                       "width",
                                       "width=640px",
                                       "width=100.5",
                                       "height=nan",
                                       "camera=1,2,3",
                                       "camera=1,2,3,1,2,3",
                                       "camera=1,2,3,4,5,inf",
                                       "camera=,,,,,",
                                       "group=none",
                                       "range=2,1",
                                       "range=1",
                                       "colour=red",
                                       "=",
                                       "",
                                       "look=",
                                       "selected=x",
                                       "light=0,0,0",
                                       "power=1e400",
                                       "show=speed",
                                       "show=distance",
                                       "sensors=TI-1",
                                       "sensors=TI-1=",
                                       "sensors=TI-1=2:",
                                       "sensors=TI-1=2,",
                                       "sensors=TI-1=2x",
                                       "sensors=X=2",
                                       "sensors=",
                                       "baseline=unknown",
                                       "breaks=group",
                                       "breaks=3,2",
                                       "breaks=high",
                                       "isolines=every:",
                                       "isolines=every:0",
                                       "isolines=all",
                                       "scale=log2",
                                       "split=pressure",
                                       "split=group=flow",
                                       "split=group=pressure;scale=log",
                                       "split=split=group=pressure",
                                       "split=width=100;light=0,0,1",
                                       "baseline=now",
                                       "projection=orthographic",
                                       "height_m=tall",
                                       "fit=E-102",
                                       "side=inside",
                                       "hidden=E-101,,P-101A",
                                       "ghost=x",
                                       "clip=1,0,0",
                                       "clip=",
                                       "clip_box=0,0,0,1,1",
                                       "clip_box=0,0,0,1,1,0" };
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        struct view view;
        struct message_error error;
        if (query(&bad[i], 1, &view, &error))
            fail_msg("'%s' was taken", bad[i]);
        assert_true(error.text[0] != 0);
    }
}

/* Randomly changed messages must be refused or give a view that the renderer can draw. */
TEST(damaged_messages_stay_harmless)
{
    static const char *const seeds[] = {
        "{\"type\":\"camera\",\"seq\":17,\"eye\":[12.5,-20.25,8],\"target\":[0,1.5,2],\"up\":[0,0,1],\"fov\":45}",
        "{\"type\":\"params\",\"seq\":3,\"group\":\"pressure\",\"power\":3,\"reach_m\":4,\"range\":[0,12.5],\"light\":[0.3,-0.4,0.8]}",
        "{\"type\":\"hello\",\"width\":1920,\"height\":1080,\"codecs\":[\"png\",\"jpeg\"]}",
    };
    static const char alphabet[] = "0123456789eE+-.,:[]{}\"nulltrue \\";
    unsigned seed = (unsigned)sweep_seed();
    int taken = 0;
    for (int i = 0; i < 100000; i++) {
        char text[256];
        struct message m;
        struct message_error error;
        size_t n = strlen(strcpy(text, seeds[i % 3]));
        for (int k = rand_r(&seed) % 3 + 1; k > 0; k--)
            text[(size_t)rand_r(&seed) % n] = alphabet[(size_t)rand_r(&seed) % (sizeof(alphabet) - 1)];
        if (!message_parse(plant(), text, n, &m, &error))
            continue;
        taken++;
        if (m.type == MESSAGE_CAMERA)
            assert_true(camera_valid(&m.camera));
        if (m.type == MESSAGE_HELLO)
            assert_true(view_size_valid(m.size.width_px, m.size.height_px));
    }
    assert_true(taken > 1000);
}

#define NARROW                                                                                                                             \
    "range: the end of the range must exceed its beginning by 1e-18 or more, and by a millionth of the larger absolute value or more"

TEST(a_refused_number_is_told_why)
{
    static const char *const said[][2] = {
        { "\"range\":[1e-300,1e300]", "range: a number from -1e+12 to 1e+12 is expected" },
        { "\"range\":[-1e13,0]", "range: a number from -1e+12 to 1e+12 is expected" },
        { "\"range\":[20,20]", NARROW },
        { "\"range\":[0,1e-40]", NARROW },
        { "\"range\":[20]", NARROW },
        { "\"range\":[10000000,10000000.000000002],\"isolines\":1e-10", NARROW },
        { "\"breaks\":[1,1e13]", "breaks: a number from -1e+12 to 1e+12 is expected" },
        { "\"breaks\":[2,1]", "breaks: at most 16 numbers, each larger than the one before" },
        { "\"isolines\":[1e13]", "isolines: a number from -1e+12 to 1e+12 is expected" },
        { "\"isolines\":1e13", "isolines: a number from 0 to 1e+12 is expected" },
        { "\"isolines\":-1", "isolines: at most 32 numbers, each larger than the one before" },
    };
    for (size_t i = 0; i < sizeof(said) / sizeof(said[0]); i++) {
        struct message_error error = { 0 };
        char *text = test_printf("{\"type\":\"params\",\"seq\":1,%s}", said[i][0]);
        assert_false(take(text, strlen(text), &error));
        assert_string_equal(error.text, said[i][1]);
    }
}

/* How names appear in error messages: Korean and German letters stay readable, control characters and invalid bytes become "?",
   and a shortened name never ends within a character. */
TEST(names_are_quoted_in_their_own_letters)
{
    static const char name[] = "온도 측정기 A-101 입구 온도 측정기";
    static const char *const quotes[][2] = {
        { "Kühlwasser", "Kühlwasser" },
        { "a\nb\x7f\xc2\x85 \xff\xeb\x8f", "a?b?? ???" },
        { name, "온도 측정기 A-101 입구 온도 측..." },
        { "0123456789012345678901234567890123456789", "0123456789012345678901234567890123456789" },
        { "012345678901234567890123456789012345678é", "012345678901234567890123456789012345678..." },
    };
    char out[48];
    struct message_error error = { 0 };
    for (size_t i = 0; i < sizeof(quotes) / sizeof(quotes[0]); i++)
        assert_string_equal(quoted(quotes[i][0], out), quotes[i][1]);
    message_fail(&error, "bad_field", "'%.11s'", name);
    assert_string_equal(error.text, "'온도 측'");
    message_refuse_with(&error, "unknown_tag", "tag", REFUSAL_NO_TAG, "name=%.11s", name);
    assert_string_equal(error.refusal.args, "name=온도 측");
}

TEST(no_number_is_minus_nought)
{
    struct pick_answer answer = { .pick = { .sensor = -1, .state = PICK_BETWEEN, .value = -0.0, .position_m = { -0.0, 2, -0.0 } } };
    view_default(small_scene(), 640, 360, &answer.query.view);
    char *text = test_memory(reply_picked_text(plant(), &answer));
    assert_non_null(strstr(text, "\"position\":[0.0,2.0,0.0]"));
    assert_non_null(strstr(text, "\"value\":0.0"));
    assert_null(strstr(text, "-0.0"));
}

/* maximum time to parse a message, as a multiple of the time that Jansson alone takes for its text. A search through a list for each
   member of the message takes more than a hundred times as long. */
enum { MOST_PARSINGS = 20 };

/* Maximum number of hidden assets; with this length of ids they just fit into a message of 64 KiB. */
enum { MANY_ASSETS = ASSET_SET_MAX };

static struct plant *load_many(void)
{
    struct text *yaml = test_text();
    char *folder = temp_folder(), *model = realpath("tests/fuzz/gltf/data_uri.gltf", NULL);
    assert_non_null(model);
    text_add(yaml, "plant: { name: Many }\ngroups:\n  - { id: t, unit: K, min: 0, max: 1 }\ntags: tags.csv\nassets:\n");
    for (int i = MANY_ASSETS - 1; i >= 0; i--)
        text_add(yaml, "  - { id: EQUIP-%06d, model: %s }\n", i, model);
    temp_write_text(folder, "tags.csv", "Tag Name,Address,Data Type\n");
    struct plant *many = plant_load_or_print(temp_write_text(folder, "plant.yaml", yaml->at));
    assert_non_null(many);
    free(model);
    return many;
}

static double thread_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

/* Returns the time in ms in which Jansson parses a text: the shortest of five runs. */
static double time_json(const struct text *said)
{
    double least_ms = INFINITY;
    for (int i = 0; i < 5; i++) {
        double began_ms = thread_ms();
        json_decref(json_loadb(said->at, said->length, 0, NULL));
        least_ms = fmin(least_ms, thread_ms() - began_ms);
    }
    return least_ms;
}

/* Returns the time in ms to parse a message and to write the visibility that results from it: the shortest of five runs. */
static double time_message(const struct plant *many, const struct text *said, struct message *message)
{
    double least_ms = INFINITY;
    assert_in_range(said->length, 1, WIRE_MAX_MESSAGE_BYTES);
    for (int i = 0; i < 5; i++) {
        struct message_error error;
        double began_ms = thread_ms();
        bool good = message_parse(many, said->at, said->length, message, &error);
        json_t *answer = test_json(json_object());
        if (good)
            visibility_print(many, &message->params.visibility, answer);
        least_ms = fmin(least_ms, thread_ms() - began_ms);
    }
    return least_ms;
}

/* The event loop, which serves all clients, parses messages. So even a message of the maximum length must be parsed quickly,
   whatever it contains. */
TEST(no_long_message_is_slow)
{
    static const struct {
        /* parts of a message: `begin`, then `count` times `each` (a format for a number that starts with `first` and grows by
           `step`), then `end` */
        const char *begin, *each, *end;
        int first, step, count;
        const char *what;
    } all[] = {
        { "{\"type\":\"params\",\"seq\":1,\"hidden\":[", "\"EQUIP-%06d\"", "]}", 0, 1, MANY_ASSETS, "all are hidden" },
        { "{\"type\":\"params\",\"seq\":1,\"isolate\":[", "\"EQUIP-%06d\"", "]}", MANY_ASSETS - 1, 0, 4300, "one, often" },
        { "{\"type\":\"params\",\"seq\":1,\"ghost\":[", "\"%d\"", "]}", 0, 1, 8000, "none is there" },
        { "{\"type\":\"params\",\"seq\":1,\"sensors\":{", "\"TT-%06d\":{}", "}}", 0, 1, 4300, "sensors" },
        { "{\"type\":\"alarm\",\"seq\":1,\"action\":\"acknowledge\",\"alarms\":[", "[\"TT-%06d\",\"HH\"]", "]}", 0, 1, 3300, "alarms" },
        { "{\"type\":\"params\",\"seq\":1", ",\"x%05d\":1", "}", 0, 1, 5900, "unknown fields" },
        { "{\"type\":\"params\",\"seq\":1,\"isolines\":[", "%d", "]}", 0, 1, 11000, "numbers" },
    };
    struct plant *many = load_many();
    for (size_t k = 0; k < sizeof(all) / sizeof(all[0]); k++) {
        struct text said = { 0 };
        struct message message;
        text_add(&said, "%s", all[k].begin);
        for (int i = 0; i < all[k].count; i++) {
            if (i > 0 && all[k].each[0] != ',')
                text_add(&said, ",");
            text_add(&said, all[k].each, all[k].first + i * all[k].step);
        }
        text_add(&said, "%s", all[k].end);
        double ms = time_message(many, &said, &message), json_ms = time_json(&said);
        print_message("# %s: %zu bytes take %.2f ms, as JSON alone %.2f ms\n", all[k].what, said.length, ms, json_ms);
        assert_true(ms < MOST_PARSINGS * json_ms);
        if (k == 0)
            assert_int_equal(message.params.visibility.hidden.count, MANY_ASSETS);
        text_finish(&said);
    }
    plant_destroy(&many);
}

TEST_GROUP(set_up, tear_down)
