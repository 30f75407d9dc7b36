/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From which side the player shows the place of an alarm, and through what: protocol/vectors/wall/sights.json, which
   tests/web/sight.test.mjs reads too. */
#include "clients/wall/view_sight.h"

#include <libwebsockets.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double PLACE_M[3] = { 1, 0.5, 0.5 };

/* A plant in which, from each side, some things stand before the place, as `before` has it; from others what it stands on itself does. */
struct world {
    const json_t *before;
    struct links links;
    struct link link;
    struct view_sight sight;
    uint32_t params_seq;
    json_t *ghosts; /* as the server was told last */
    int shown;
};

static void take(const json_t *from, double to[3])
{
    for (size_t i = 0; i < 3; i++)
        to[i] = json_number_value(json_array_get(from, i));
}

static int side_of(const struct world *world, const double eye_m[3])
{
    for (int side = 0; side < APPROACH_SIDES; side++) {
        struct camera camera = approach_camera(&world->sight.first, PLACE_M, side);
        if (hypot(hypot(camera.eye_m[0] - eye_m[0], camera.eye_m[1] - eye_m[1]), camera.eye_m[2] - eye_m[2]) < 1e-3)
            return side;
    }
    return -1;
}

static bool is_ghost(const struct world *world, const char *id)
{
    for (size_t i = 0; i < json_array_size(world->ghosts); i++)
        if (!strcmp(json_string_value(json_array_get(world->ghosts, i)), id))
            return true;
    return false;
}

/* NULL: nothing is in front but ghosts. Static `null` of the case: nothing is hit. */
static const json_t *front_of(const struct world *world, int side)
{
    static json_t *own;
    char name[8];
    snprintf(name, sizeof(name), "%d", side);
    const json_t *all = json_object_get(world->before, name), *one;
    size_t i;
    own = own ? own : json_string("own");
    if (!all)
        return own;
    json_array_foreach(all, i, one) if (json_is_null(one) || !is_ghost(world, json_string_value(one))) return one;
    return NULL;
}

static json_t *answer(const struct world *world, const json_t *pick)
{
    double eye_m[3];
    take(json_object_get(json_object_get(pick, "camera"), "eye"), eye_m);
    bool in_middle =
        fabs(json_number_value(json_object_get(pick, "x")) - 640) < 1 && fabs(json_number_value(json_object_get(pick, "y")) - 360) < 1;
    const json_t *front = front_of(world, side_of(world, eye_m));
    json_t *picked = json_pack("{s:s,s:O}", "type", "picked", "seq", json_object_get(pick, "seq"));
    if (in_middle && !front)
        json_object_update_new(picked, json_pack("{s:s,s:[f,f,f]}", "asset", "own", "position", PLACE_M[0], PLACE_M[1], PLACE_M[2]));
    else if (in_middle && json_is_string(front))
        json_object_update_new(picked, json_pack("{s:s,s:[f,f,f]}", "asset", json_string_value(front), "position", 9.0, 9.0, 9.0));
    return picked;
}

/* Does what was posted. Returns false if nothing was. */
static bool serve(struct world *world)
{
    struct camera camera;
    if (world->link.queued == 0)
        return false;
    json_t *message = json_loads(world->link.queue[0], 0, NULL);
    free(world->link.queue[0]);
    world->link.queued--;
    memmove(world->link.queue, world->link.queue + 1, (size_t)world->link.queued * sizeof(world->link.queue[0]));
    if (!strcmp(json_string_value(json_object_get(message, "type")), "params")) {
        json_decref(world->ghosts);
        world->ghosts = json_incref(json_object_get(message, "ghost"));
    } else {
        json_t *picked = answer(world, message);
        if (view_sight_hear(&world->sight, &world->link, picked, &camera))
            world->shown = side_of(world, camera.eye_m);
        json_decref(picked);
    }
    json_decref(message);
    return true;
}

static void run(const json_t *one)
{
    struct lws_context_creation_info info = { .port = CONTEXT_PORT_NO_LISTEN };
    const json_t *own = json_object_get(one, "ghosts"), *made = json_object_get(one, "made");
    struct world world = { .before = json_object_get(one, "before"), .ghosts = json_deep_copy(own) };
    world.links.context = lws_create_context(&info);
    world.link = (struct link){ .links = &world.links, .state = LINK_WELCOMED };
    struct view_sight *sight = &world.sight;
    *sight = (struct view_sight){ .tag = "TI-1", .asset = "own", .x_px = 640, .y_px = 360, .width_px = 1280, .height_px = 720 };
    memcpy(sight->place_m, PLACE_M, sizeof(PLACE_M));
    sight->first = (struct camera){ .eye_m = { 6, 5, 4 }, .target_m = { 1, 0.5, 0.5 }, .up = { 0, 0, 1 }, .fov_deg = 45 };
    sight->ghosts = json_deep_copy(own);
    sight->params_seq = &world.params_seq;
    view_sight_begin(sight, &world.link);
    while (serve(&world))
        continue;
    json_t *expected = json_deep_copy(own);
    json_array_extend(expected, (json_t *)made);
    if (world.shown != json_integer_value(json_object_get(one, "side")) || !json_equal(world.ghosts, expected))
        fail_msg("%s: side %d, %zu ghosts", json_string_value(json_object_get(one, "name")), world.shown, json_array_size(world.ghosts));
    assert_false(sight->looks);
    json_decref(expected);
    json_decref(world.ghosts);
    view_sight_finish(sight);
    lws_context_destroy(world.links.context);
}

static void a_place_is_looked_at_as_in_the_page(void **state)
{
    json_error_t error;
    json_t *all = json_load_file("protocol/vectors/wall/sights.json", 0, &error);
    (void)state;
    if (!all)
        fail_msg("%s", error.text);
    for (size_t i = 0; i < json_array_size(all); i++)
        run(json_array_get(all, i));
    json_decref(all);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(a_place_is_looked_at_as_in_the_page) };
    lws_set_log_level(LLL_ERR, NULL);
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
