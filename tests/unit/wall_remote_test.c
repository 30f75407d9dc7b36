/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests the remote control of walls. A pane has only one command, the newest, which survives a restart. A position to which a
   user points is reported once. A display or pane that the plant file lacks is refused; stored commands for it are not listed. */
#include "tests/support/test.h"

#include <jansson.h>

#include "views/wall_remote.h"

struct wall_remote_fixture {
    struct log *log;
    struct plant plant;
    struct wall wall;
    struct wall_display display;
    char *folder;
    struct wall_remote *remote;
};

static void begin(struct wall_remote_fixture *f)
{
    f->log = test_log();
    f->display.panes[0] = (struct wall_pane){ .area = "main", .kind = PANE_VIEWS };
    f->display.panes[1] = (struct wall_pane){ .area = "side", .kind = PANE_ALARMS };
    f->display.pane_count = 2;
    f->wall = (struct wall){ .id = "room", .displays = &f->display, .display_count = 1 };
    f->plant = (struct plant){ .screens.walls = &f->wall, .screens.wall_count = 1 };
    f->folder = temp_folder();
    f->remote = wall_remote_open(f->log, &f->plant, f->folder, NULL);
}

static void end(struct wall_remote_fixture *f)
{
    wall_remote_close(&f->remote);
}

TEST_FIXTURE(struct wall_remote_fixture, begin, end)

#define CASE(name) TEST_ON(struct wall_remote_fixture *f, name, set_up, tear_down)

static const struct wall_place MAIN = { "room", "main", 1 };

static enum refusal_code order(struct wall_remote_fixture *f, const char *view, bool held)
{
    return wall_remote_order(f->remote, &(struct wall_order){ MAIN, view, "Title", held, "Desk 2" }, "kim", 7);
}

/* Asserts that the JSON message `text` has a list of `count` items and contains `part`; frees the text. */
static void assert_list(char *text, size_t count, const char *part)
{
    json_t *message = test_json(json_loads(text, 0, NULL));
    assert_int_equal(json_array_size(json_object_get(message, "list")), count);
    assert_non_null(strstr(text, part));
    mem_free(text);
}

CASE(the_newest_order_counts_and_is_kept)
{
    assert_int_equal(order(f, "group=t", false), REFUSAL_NONE);
    assert_int_equal(order(f, "group=p", false), REFUSAL_NONE);
    wall_remote_close(&f->remote);
    f->remote = wall_remote_open(f->log, &f->plant, f->folder, NULL);
    assert_list(wall_remote_text(f->remote), 1, "group=p");
    uint64_t number = wall_remote_number(f->remote);
    assert_int_equal(order(f, "", true), REFUSAL_NONE);
    assert_true(wall_remote_number(f->remote) > number);
    assert_list(wall_remote_text(f->remote), 1, "\"held\":true");
    assert_int_equal(order(f, "", false), REFUSAL_NONE);
    assert_list(wall_remote_text(f->remote), 0, "walls");
}

CASE(places_are_those_of_the_plant_file)
{
    assert_null(wall_place_wrong(&f->plant, &MAIN));
    assert_null(wall_place_wrong(&f->plant, &(struct wall_place){ "room", "", 1 }));
    assert_non_null(wall_place_wrong(&f->plant, &(struct wall_place){ "hall", "main", 1 }));
    assert_non_null(wall_place_wrong(&f->plant, &(struct wall_place){ "room", "main", 2 }));
    assert_non_null(wall_place_wrong(&f->plant, &(struct wall_place){ "room", "side", 1 }));
    assert_non_null(wall_place_wrong(&f->plant, &(struct wall_place){ "room", "none", 1 }));
    assert_int_equal(order(f, "group=t", false), REFUSAL_NONE);
    /* as after a reload with a plant file in which the display has no panes: the command stays stored but is not listed */
    f->display.pane_count = 0;
    assert_list(wall_remote_text(f->remote), 0, "walls");
    f->display.pane_count = 2;
    assert_list(wall_remote_text(f->remote), 1, "group=t");
}

CASE(pointers_are_told_once)
{
    const double at[3] = { 1, 2, 3 };
    wall_remote_point(f->remote, &MAIN, at, "kim", "Desk 2");
    assert_list(wall_remote_pointers_text(f->remote, 0), 1, "Desk 2, kim");
    uint64_t number = wall_remote_pointer_number(f->remote);
    assert_list(wall_remote_pointers_text(f->remote, number), 0, "pointed");
    wall_remote_point(f->remote, &MAIN, NULL, "kim", "");
    assert_list(wall_remote_pointers_text(f->remote, number), 1, "\"position\":null");
    for (int i = 0; i < 3 * WALL_POINTERS; i++) {
        struct wall_place place = MAIN;
        snprintf(place.area, sizeof(place.area), "a%d", i);
        wall_remote_point(f->remote, &place, at, "kim", "");
    }
    assert_list(wall_remote_pointers_text(f->remote, number), WALL_POINTERS, "a23");
}

CASE(displays_come_and_go)
{
    wall_remote_see(f->remote, "room", 1, true);
    uint64_t number = wall_remote_number(f->remote);
    assert_list(wall_remote_text(f->remote), 0, "{\"wall\":\"room\",\"display\":1}");
    wall_remote_see(f->remote, "room", 1, true);
    assert_true(wall_remote_number(f->remote) == number);
    wall_remote_see(f->remote, "room", 1, false);
    assert_list(wall_remote_text(f->remote), 0, "\"displays\":[]");
}

CASE(without_a_folder_it_is_forgotten_with_the_daemon)
{
    wall_remote_close(&f->remote);
    f->remote = wall_remote_open(f->log, &f->plant, NULL, NULL);
    assert_int_equal(order(f, "group=t", false), REFUSAL_NONE);
    assert_list(wall_remote_text(f->remote), 1, "group=t");
}
