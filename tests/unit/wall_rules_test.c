/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The player of a wall's displays decides as the page does: protocol/vectors/wall, which tests/web/wall_vectors.test.mjs reads too. */
#include <jansson.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "clients/wall/approach.h"
#include "clients/wall/rules.h"
#include "clients/wall/view_address.h"
#include "plant/burn_shift.h"

static json_t *cases(const char *name)
{
    char path[80];
    json_error_t error;
    snprintf(path, sizeof(path), "protocol/vectors/wall/%s.json", name);
    json_t *all = json_load_file(path, JSON_DECODE_ANY, &error);
    if (!all)
        fail_msg("%s: %s", path, error.text);
    return all;
}

static double number(const json_t *o, const char *name)
{
    return json_number_value(json_object_get(o, name));
}

static bool truth(const json_t *o, const char *name)
{
    return json_is_true(json_object_get(o, name));
}

static void alarms_call_as_on_the_page(void **state)
{
    static const int64_t now_us = 1000000000000000;
    json_t *all = cases("alarm_calls");
    (void)state;
    for (size_t i = 0; i < json_array_size(all); i++) {
        const json_t *one = json_array_get(all, i), *list = json_object_get(one, "alarms"), *steps = json_object_get(one, "steps");
        struct rules_alarm alarms[32];
        struct rules_call call = { .shown = -1 };
        size_t count = json_array_size(list);
        assert_true(count <= 32);
        for (size_t k = 0; k < count; k++) {
            const json_t *o = json_array_get(list, k);
            alarms[k] =
                (struct rules_alarm){ (int)number(o, "id"), (int)number(o, "priority"), truth(o, "gone"),
                                      truth(o, "waiting"),  truth(o, "place"),          now_us - (int64_t)(1e6 * number(o, "ago_s")) };
        }
        for (size_t k = 0; k < json_array_size(steps); k++) {
            const json_t *step = json_array_get(steps, k), *expected = json_array_get(step, 1);
            int found = rules_next(&call, alarms, count, json_integer_value(json_array_get(step, 0)) * 1000000, now_us);
            int wanted = json_is_null(expected) ? -1 : (int)json_integer_value(expected);
            if ((found < 0 ? -1 : alarms[found].id) != wanted)
                fail_msg("%s, step %zu: %d", json_string_value(json_object_get(one, "name")), k, found < 0 ? -1 : alarms[found].id);
        }
    }
    json_decref(all);
}

/* Equal, where 1 is 1.0. */
static bool equal(const json_t *a, const json_t *b)
{
    const char *key;
    json_t *value;
    if (json_is_number(a) || json_is_number(b))
        return json_is_number(a) && json_is_number(b) && json_number_value(a) == json_number_value(b);
    if (json_is_array(a) && json_is_array(b)) {
        bool same = json_array_size(a) == json_array_size(b);
        for (size_t i = 0; same && i < json_array_size(a); i++)
            same = equal(json_array_get(a, i), json_array_get(b, i));
        return same;
    }
    if (!json_is_object(a) || !json_is_object(b))
        return json_equal(a, b);
    json_object_foreach((json_t *)a, key, value) if (!equal(value, json_object_get(b, key))) return false;
    return json_object_size(a) == json_object_size(b);
}

static void check(const char *text, const json_t *read, const json_t *expected)
{
    if (read ? equal(read, expected) : json_is_null(expected))
        return;
    char *got = json_dumps(read, JSON_COMPACT | JSON_ENCODE_ANY);
    fail_msg("%s: %s", text, got ? got : "nothing");
}

static void addresses_read_as_on_the_page(void **state)
{
    json_t *all = cases("addresses");
    (void)state;
    for (size_t i = 0; i < json_array_size(all); i++) {
        const json_t *one = json_array_get(all, i);
        const char *text = json_string_value(json_object_get(one, "text"));
        json_t *params = view_address_params(text), *camera = view_address_camera(text);
        check(text, params, json_object_get(one, "params"));
        check(text, camera, json_object_get(one, "camera"));
        json_decref(params);
        json_decref(camera);
    }
    json_decref(all);
}

static void letters_are_as_large_as_on_the_page(void **state)
{
    json_t *all = cases("letters");
    const json_t *sizes = json_object_get(all, "sizes"), *dimming = json_object_get(all, "dimming");
    (void)state;
    for (size_t i = 0; i < json_array_size(sizes); i++) {
        const json_t *o = json_array_get(sizes, i), *display = json_object_get(o, "display"), *window = json_object_get(o, "window");
        double unit = rules_unit(number(o, "inches"), number(o, "metres"), json_number_value(json_array_get(display, 0)),
                                 json_number_value(json_array_get(display, 1)), json_number_value(json_array_get(window, 0)),
                                 json_number_value(json_array_get(window, 1)));
        assert_true(fabs(unit - number(o, "unit")) < 1e-9);
    }
    for (size_t i = 0; i < json_array_size(dimming); i++) {
        const json_t *o = json_array_get(dimming, i);
        double light =
            rules_brightness(number(o, "from_min"), number(o, "to_min"), number(o, "percent"), number(o, "minute"), truth(o, "calls"));
        assert_true(fabs(light - number(o, "light")) < 1e-12);
    }
    json_decref(all);
}

static void what_is_shown_is_moved_as_in_the_page(void **state)
{
    json_t *all = cases("shifts");
    (void)state;
    assert_true(json_array_size(all) > 8);
    for (size_t i = 0; i < json_array_size(all); i++) {
        const json_t *o = json_array_get(all, i), *wanted = json_object_get(o, "shift");
        struct burn_shift shift = burn_shift_at((int64_t)json_integer_value(json_object_get(o, "us")) * 1000);
        assert_int_equal(shift.x_px, json_integer_value(json_array_get(wanted, 0)));
        assert_int_equal(shift.y_px, json_integer_value(json_array_get(wanted, 1)));
        assert_true(abs(shift.x_px) <= BURN_SHIFT_PX && abs(shift.y_px) <= BURN_SHIFT_PX);
    }
    json_decref(all);
}

static void take(const json_t *from, double to[3])
{
    for (size_t i = 0; i < 3; i++)
        to[i] = json_number_value(json_array_get(from, i));
}

static void places_are_looked_at_from_the_sides_of_the_page(void **state)
{
    json_t *all = cases("approaches");
    (void)state;
    assert_true(json_array_size(all) > 0);
    for (size_t i = 0; i < json_array_size(all); i++) {
        const json_t *one = json_array_get(all, i), *given = json_object_get(one, "camera"), *sides = json_object_get(one, "sides");
        struct camera first = { .fov_deg = number(given, "fov") };
        double place_m[3];
        take(json_object_get(given, "eye"), first.eye_m);
        take(json_object_get(given, "target"), first.target_m);
        take(json_object_get(given, "up"), first.up);
        take(json_object_get(one, "place"), place_m);
        assert_int_equal(json_array_size(sides), APPROACH_SIDES);
        for (int side = 0; side < APPROACH_SIDES; side++) {
            struct camera camera = approach_camera(&first, place_m, side);
            double eye_m[3], target_m[3];
            take(json_array_get(json_array_get(sides, (size_t)side), 0), eye_m);
            take(json_array_get(json_array_get(sides, (size_t)side), 1), target_m);
            for (int k = 0; k < 3; k++)
                if (fabs(camera.eye_m[k] - eye_m[k]) > 1e-6 || fabs(camera.target_m[k] - target_m[k]) > 1e-6)
                    fail_msg("case %zu, side %d", i, side);
        }
    }
    json_decref(all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(alarms_call_as_on_the_page),
        cmocka_unit_test(addresses_read_as_on_the_page),
        cmocka_unit_test(letters_are_as_large_as_on_the_page),
        cmocka_unit_test(what_is_shown_is_moved_as_in_the_page),
        cmocka_unit_test(places_are_looked_at_from_the_sides_of_the_page),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
