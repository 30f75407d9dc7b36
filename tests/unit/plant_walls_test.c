/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plant file's `views` and `walls` sections: parsing, and errors reported with their position. */
#include "tests/support/test.h"

#include "message/views_message.h"
#include "plant/walls/wall.h"
#include "tests/support/plant_case.h"

#define CASE(name) TEST_ON(struct plant_case *c, name, plant_case_set_up, plant_case_tear_down)

static void load(struct plant_case *c, const char *more)
{
    char *yaml = test_printf("plant: { name: P }\nassets: [{ id: E-1, model: m.glb }]\n"
                    "groups: [{ id: t, unit: degC, min: 0, max: 1 }]\ntags: tags.csv\nsources: [{ id: a, type: modbus, host: h }]\n%s\n",
             more);
    plant_case_load(c, yaml, "Tag Name,Address,Source\nTI-1,40001,a\nTI-2,40003,a\n");
}

CASE(all_keys_are_read)
{
    load(c, "walls:\n"
            "- id: room\n  dim_hours: 22:00-06:30\n  dim_percent: 40\n  inches: 65\n  distance_m: 4.5\n  displays:\n"
            "  - grid: [main main side, main main low]\n    panes:\n"
            "    - { area: main, views: [all, near], every_s: 20, on_alarm: yes, title: Plant }\n"
            "    - { area: side, alarms: yes }\n"
            "    - { area: low, tiles: [TI-1, TI-2] }\n"
            "  - grid: [d]\n    panes: [{ area: d, tour: round, on_alarm: yes }]\n"
            "  - grid: [a b, c .]\n    panes: [{ area: a, trend: TI-1, hours: 2 }, { area: b, clock: UTC }, { area: c, text: Hello }]\n"
            "views: [{ id: all, view: group=t }, { id: near, title: \"Near by\", view: \"group=t&camera=1,2,3\" }]\n"
            "tours: [{ id: round, stops: [{ view: near, dwell_s: 8, text: Look here }, { view: all }] }]");
    plant_case_assert_loaded(c, 0);
    assert_int_equal(c->plant->screens.view_count, 2);
    assert_string_equal(c->plant->screens.views[1].title, "Near by");
    assert_int_equal(c->plant->screens.wall_count, 1);
    char *text = test_memory(walls_text(c->plant, NULL));
    assert_string_equal(text,
                        "{\"walls\":[{\"id\":\"room\",\"inches\":65.0,\"distance_m\":4.5,\"displays\":[{\"grid\":[\"main main side\","
                        "\"main main low\"],\"panes\":[{\"area\":\"main\",\"kind\":\"views\",\"title\":\"Plant\",\"items\":[\"all\","
                        "\"near\"],\"every_s\":20.0,\"hours\":8.0,\"on_alarm\":true},{\"area\":\"side\",\"kind\":\"alarms\",\"title\""
                        ":null,\"items\":[\"yes\"],\"every_s\":30.0,\"hours\":8.0,\"on_alarm\":false},{\"area\":\"low\",\"kind\":\"ti"
                        "les\",\"title\":null,\"items\":[\"TI-1\",\"TI-2\"],\"every_s\":30.0,\"hours\":8.0,\"on_alarm\":false}]},{\"gri"
                        "d\":[\"d\"],\"panes\":[{\"area\":\"d\",\"kind\":"
                        "\"views\",\"title\":null,\"items\":[\"near\",\"all\"],\"every_s\":30.0,\"hours\":8.0,\"on_alarm\":true,"
                        "\"stops\":[{"
                        "\"dwell_s\":8.0,\"text\":\"Look here\"},{\"dwell_s\":15.0,\"text\":null}]}]},{\"g"
                        "rid\":[\"a b\",\"c .\"],\"panes\":[{\"area\":\"a\",\"kind\":\"trend\",\"title\":null,\"items\":[\"TI-1\"],\""
                        "every_s\":30.0,\"hours\":2.0,\"on_alarm\":false},{\"area\":\"b\",\"kind\":\"clock\",\"title\":null,\"items\""
                        ":[\"UTC\"],\"every_s\":30.0,\"hours\":8.0,\"on_alarm\":false},{\"area\":\"c\",\"kind\":\"text\",\"title\":nu"
                        "ll,\"items\":[\"Hello\"],\"every_s\":30.0,\"hours\":8.0,\"on_alarm\":false}]}],\"dim\":{\"from_min\":1320,"
                        "\"to_min\":390,\"percent\":40.0}}],\"tours\":[{\"id\":\"round\",\"stops\":[{\"id\":\"near\",\"view\":"
                        "\"group=t&camera=1,2,3\",\"dwell_s\":8.0,\"text\":\"Look here\"},{\"id\":\"all\",\"view\":\"group=t\",\"dwel"
                        "l_s\":15.0,\"text\":null}]}]}");
}

CASE(tiles_are_the_first_displays)
{
    load(c, "views: [{ id: all, view: group=t }]\n"
            "walls:\n- { id: big, tile: { columns: 3, rows: 2, bezel_mm: [8, 6.5], views: all, every_s: 9, on_alarm: yes },\n"
            "    displays: [{ grid: [a], panes: [{ area: a, clock: yes }] }] }\n"
            "- { id: two, tile: { columns: 2, rows: 1, views: [all, all] } }");
    plant_case_assert_loaded(c, 0);
    const struct wall *wall = wall_find(c->plant, "big");
    assert_non_null(wall);
    assert_null(wall_find(c->plant, "none"));
    assert_int_equal(wall->display_count, 7);
    assert_true(wall->tile.bezel_mm[0] == 8 && wall->tile.bezel_mm[1] == 6.5);
    for (int i = 0; i < 6; i++) {
        assert_string_equal(wall->displays[i].panes[0].area, "main");
        assert_string_equal(wall->displays[i].panes[0].items[0], "all");
        assert_true(wall->displays[i].panes[0].on_alarm && wall->displays[i].panes[0].every_s == 9);
    }
    assert_int_equal(wall->displays[6].panes[0].kind, PANE_CLOCK);
    assert_true(wall_find(c->plant, "two")->tile.bezel_mm[0] == 0 && wall_find(c->plant, "two")->display_count == 2);
    char *text = test_memory(walls_text(c->plant, NULL));
    assert_non_null(strstr(text, "\"tile\":{\"columns\":3,\"rows\":2,\"number\":6}"));
    assert_non_null(strstr(text, "\"kind\":\"clock\",\"title\":null,\"items\":[\"yes\"],\"every_s\":30.0,\"hours\":8.0,"
                                 "\"on_alarm\":false}"));
}

CASE(other_plants_are_read)
{
    load(c, "other_plants:\n- { id: tanks, url: \"https://tanks.example/\", view: all, every_s: 10, width: 1920, height: 1080 }\n"
            "- { id: pier, url: \"http://localhost:8080\" }\n"
            "walls: [{ id: room, displays: [{ grid: [a b], panes: [{ area: a, snapshot: tanks }, { area: b, snapshot: [pier] }] }] }]");
    plant_case_assert_loaded(c, 0);
    assert_int_equal(c->plant->screens.other_plant_count, 2);
    const struct other_plant *tanks = &c->plant->screens.other_plants[0], *pier = &c->plant->screens.other_plants[1];
    assert_string_equal(tanks->view, "all");
    assert_true(tanks->every_s == 10 && tanks->width_px == 1920 && tanks->height_px == 1080);
    assert_true(!pier->view && !pier->token_file && pier->every_s == 5 && pier->width_px == 1280 && pier->height_px == 720);
    assert_int_equal(other_plant_find(c->plant, "pier"), 1);
    assert_int_equal(other_plant_find(c->plant, "room"), -1);
    assert_true(wall_display_has(wall_display_find(c->plant, "room", 1), PANE_SNAPSHOT, "pier"));
    char *text = test_memory(walls_text(c->plant, NULL));
    assert_non_null(strstr(text, "\"kind\":\"snapshot\",\"title\":null,\"items\":[\"tanks\"]"));
}

CASE(wrong_other_plants_are_said_at_their_place)
{
    load(c, "other_plants:\n- { id: a, url: \"ftp://h/\" }\n- { id: b, url: \"http://h/\", token_file: t }\n"
            "- { id: b, url: \"https://u:p@h/\" }\n- { id: c, url: \"https://h/?x\", every_s: 1, width: 100 }\n"
            "- { id: c d, url: \"https://h/\", view: a&b }\n- { url: \"https://h/\" }");
    FOUND(c, { "plant.yaml", 7, 17, "url: the address begins with a scheme" }, { "plant.yaml", 8, 42, "cannot be read" },
          { "plant.yaml", 8, 42, "token_file: needs an address that begins with https" },
          { "plant.yaml", 9, 17, "do not write a password in the plant file" }, { "plant.yaml", 9, 9, "'b'" },
          { "plant.yaml", 10, 17, "without '?' and '#'" }, { "plant.yaml", 10, 42, "every_s" }, { "plant.yaml", 10, 52, "width" },
          { "plant.yaml", 11, 9, "id: expected letters" }, { "plant.yaml", 11, 39, "view: expected the id" },
          { "plant.yaml", 12, 3, "id" });
}

CASE(what_a_snapshot_names_is_checked)
{
    load(c, "other_plants: [{ id: tanks, url: \"https://h/\" }]\nwalls:\n- id: r\n  displays:\n  - grid: [a b]\n    panes:\n"
            "    - { area: a, snapshot: tank }\n    - { area: b, snapshot: [tanks, tanks] }");
    FOUND(c, { "plant.yaml", 13, 28, "snapshot: expected one item, found 2" });
    load(c, "other_plants: [{ id: tanks, url: \"https://h/\" }]\nwalls:\n- id: r\n  displays:\n  - grid: [a]\n    panes:\n"
            "    - { area: a, snapshot: tank }");
    FOUND(c, { "plant.yaml", 12, 28, "snapshot: `other_plants` has no plant 'tank'; did you mean 'tanks'?" });
}

CASE(wrong_tiles_are_said_at_their_place)
{
    load(c, "views: [{ id: all, view: group=t }]\nwalls:\n- { id: a, tile: { columns: 1, rows: 1, views: all } }\n"
            "- { id: b, tile: { columns: 5, rows: 4, views: all } }\n- { id: c, tile: { columns: 2, rows: 2 } }\n"
            "- { id: d, tile: { columns: 2, rows: 2, bezel_mm: 900, views: all } }\n"
            "- { id: e, tile: { columns: 2, rows: 2, bezel_mm: [1, 2, 3], views: all } }\n- { id: f }\n"
            "- { id: g, tile: { columns: 4, rows: 4, views: all }, displays: [{ grid: [a], panes: [] }] }\n"
            "- { id: h, tile: { columns: 2, rows: 2, tour: [x, y] } }\n- { id: i, tile: { columns: 2.5, rows: 2, tour: x } }");
    FOUND(c, { "plant.yaml", 8, 18, "tile: expected 2 to 16 displays, found 1 columns and 1 rows" },
          { "plant.yaml", 9, 18, "tile: expected 2 to 16 displays, found 5 columns and 4 rows" },
          { "plant.yaml", 10, 18, "tile: expected views or a tour, not both" }, { "plant.yaml", 11, 51, "bezel_mm" },
          { "plant.yaml", 12, 51, "bezel_mm: expected one number, or two" }, { "plant.yaml", 13, 3, "expected displays, a tile" },
          { "plant.yaml", 14, 18, "`tile` defines 16 and `displays` lists 1" },
          { "plant.yaml", 15, 47, "tour: expected one item, found 2" },
          { "plant.yaml", 16, 29, "columns" });
}

CASE(what_a_tile_names_is_checked_once)
{
    load(c, "walls:\n- { id: a, tile: { columns: 2, rows: 2, tour: rond } }");
    FOUND(c, { "plant.yaml", 7, 47, "tour: `tours` has no 'rond'" });
}

CASE(what_is_wrong_is_said_at_its_place)
{
    load(c, "views:\n- { id: a b, view: x }\n- { id: v, view: \"a b\" }\n- { id: v, view: \"#x\" }\n- { id: w }\n"
            "walls:\n- { id: r, displays: [] }\n- id: r\n  inches: 5\n  dim_hours: night\n"
            "  displays:\n  - grid: [A b]\n    panes: [{ area: b }]\n"
            "  - grid: [b b]\n    panes: [{ area: b, clock: yes, text: x }, { area: b, views: v }, { area: z, clock: yes, every_s: 9 },"
            " { area: b, tiles: [] }]");
    FOUND(c, { "plant.yaml", 7, 9, "id: expected letters, digits" },
          { "plant.yaml", 8, 18, "a blank, a control character or a non-ASCII letter" },
          { "plant.yaml", 9, 18, "the address of the view must not begin with #" },
          { "plant.yaml", 9, 9, "view 'v' is listed twice (first at line 8)" }, { "plant.yaml", 10, 3, "view" },
          { "plant.yaml", 12, 22, "displays: expected at least one" }, { "plant.yaml", 14, 11, "inches" },
          { "plant.yaml", 15, 14, "a span such as" }, { "plant.yaml", 17, 12, "the names of panes' areas" },
          { "plant.yaml", 18, 13, "must have exactly one of views, trend, alarms" }, { "plant.yaml", 18, 21, "the grid has no area 'b'" },
          { "plant.yaml", 20, 13, "must have exactly one of views" }, { "plant.yaml", 20, 55, "'b' is used by two panes" },
          { "plant.yaml", 20, 102, "allowed only for a pane with `views`" }, { "plant.yaml", 20, 78, "the grid has no area 'z'" },
          { "plant.yaml", 20, 125, "tiles: expected 1 to 16, found 0" }, { "plant.yaml", 20, 115, "'b' is used by two panes" },
          { "plant.yaml", 13, 7, "wall 'r' is listed twice" });
}

CASE(a_grid_is_made_of_rectangles)
{
    load(c, "walls:\n- id: r\n  displays:\n  - { grid: [a a b, a c], panes: [] }\n  - { grid: [a a, a b], panes: [] }\n"
            "  - { grid: [a b a], panes: [] }\n  - { grid: [\" \"], panes: [] }\n  - { grid: [. a a, b a a, b . .], panes: [] }");
    FOUND(c, { "plant.yaml", 9, 13, "grid: expected the same number of areas in each row, found 3 in the first row and 2 in 'a c'" },
          { "plant.yaml", 10, 13, "grid: the cells of area 'a' do not form one rectangle" },
          { "plant.yaml", 11, 13, "grid: the cells of area 'a' do not form one rectangle" },
          { "plant.yaml", 12, 13, "grid: expected the same number of areas in each row, found 0" });
}

CASE(what_panes_name_must_be_there)
{
    load(c, "walls:\n- id: r\n  displays:\n  - grid: [a b]\n    panes: [{ area: a, tiles: [TI-1, TI-3] }, { area: b, trend: none }]");
    FOUND(c, { "plant.yaml", 10, 38, "tiles: there is no tag 'TI-3'; did you mean 'TI-1'?" },
          { "plant.yaml", 10, 65, "trend: there is no tag 'none'" });
    load(c, "views: [{ id: all, view: x }]\nwalls:\n- id: r\n  displays:\n  - grid: [a]\n    panes: [{ area: a, views: [all, al] }]");
    /* an unknown view in a pane is only a warning, because users may save a view of that name on the page later */
    plant_case_assert_loaded(c, 1);
}

CASE(what_tours_name_must_be_there)
{
    load(c, "views: [{ id: all, view: x }]\ntours:\n- id: a b\n  stops: [{ view: al, dwell_s: 0 }]\n- id: t\n  stops: []\n"
            "- id: u\n  stops: [{ text: x }, { view: all, dwell_s: 5 }, { view: none }]\n- id: u\n  stops: [{ view: all }]\n"
            "walls:\n- id: r\n  displays:\n  - grid: [a b c]\n    panes: [{ area: a, tour: round }, { area: b, tour: u, every_s: 9 },"
            " { area: c, tour: [t, u] }]");
    FOUND(c, { "plant.yaml", 8, 7, "id: expected letters" }, { "plant.yaml", 9, 32, "dwell_s" },
          { "plant.yaml", 11, 10, "stops: expected at least one" }, { "plant.yaml", 13, 11, "view" },
          { "plant.yaml", 14, 7, "tour 'u' is listed twice (first at line 12)" },
          { "plant.yaml", 20, 68, "every_s: allowed only for a pane with `views`" },
          { "plant.yaml", 20, 90, "tour: expected one item, found 2" });
    load(c, "views: [{ id: all, view: x }]\ntours: [{ id: round, stops: [{ view: al }, { view: none }] }]\n"
            "walls:\n- id: r\n  displays:\n  - grid: [a]\n    panes: [{ area: a, tour: raund }]");
    FOUND(c, { "plant.yaml", 7, 38, "view: `views` has no 'al'; did you mean 'all'?" }, { "plant.yaml", 7, 52, "`views` has no 'none'" },
          { "plant.yaml", 12, 30, "tour: `tours` has no 'raund'; did you mean 'round'?" });
}
