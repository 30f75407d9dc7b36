/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plant files: what each part of a valid file means, and every kind of mistake with its line, column and message. */
#include "plant/plant.h"

#include "tests/support/test.h"
#include <locale.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text/text.h"
#include "plant/sensors.h"
#include "tests/support/plant_case.h"

#define CASE(name) TEST_ON(struct plant_case *f, name, plant_case_set_up, plant_case_tear_down)

/* --- good input ------------------------------------------------------------------------------------------------------------- */

static const char small_yaml[] = "plant: { name: P }\n"
                                 "assets: [{ id: E-1, model: m.glb }, { id: E-2, model: m.glb }]\n"
                                 "groups: [{ id: temp, unit: °C, min: 0, max: 100 }, { id: pressure, unit: bar, min: 0, max: 16 }]\n"
                                 "sources: [{ id: plc, type: modbus, host: h }]\n"
                                 "tags: tags.csv\n";
static const char small_csv[] = "Tag Name,Address\nT1,40001\n";

CASE(defaults_are_as_documented)
{
    plant_case_load(f, small_yaml, small_csv);
    plant_case_assert_loaded(f, 0);
    const struct plant *p = f->plant;
    assert_string_equal(p->time_zone, "UTC");
    assert_int_equal(p->up, AXIS_Z);
    assert_false(p->display.view.set);
    assert_string_equal(p->assets[0].tag, "E-1");
    assert_string_equal(p->assets[0].description, "");
    assert_null(p->assets[0].nodes);
    assert_float_equal(p->assets[0].unit_m, 1, 0);
    assert_int_equal(p->assets[0].up, AXIS_Y);
    assert_false(p->assets[0].sensors_in_asset_frame);
    assert_int_equal(p->assets[0].start, PLANT_START_SHOWN);
    assert_int_equal(p->assets[1].line, 2);
    const struct plant_group *g = &p->groups[1];
    assert_string_equal(g->quantity, "pressure");
    assert_true(isnan(g->limits[LIMIT_LL]) && isnan(g->limits[LIMIT_HH]));
    assert_int_equal(g->interpolation, INTERPOLATION_SHEPARD);
    assert_int_equal(g->distance, DISTANCE_GEODESIC);
    assert_true(g->strength == 1 && g->decay == 1 && g->power == 2 && g->radius_m == 0 && isinf(g->reach_m));
    assert_int_equal(g->fill, FILL_NONE);
    assert_true(!g->log && g->break_count == 0 && g->isoline_count == 0);
    const struct plant_source *s = &p->sources[0];
    assert_true(s->port == 502 && s->unit == 1 && s->poll_ms == 1000 && s->timeout_ms == 1000 && s->address_base == 1);
    assert_int_equal(s->byte_order, BYTE_ORDER_NONE);
    const struct plant_tag *t = &p->tags[0];
    assert_true(t->source == 0 && t->group == -1 && t->asset == -1 && t->signal.modbus_unit == -1 && t->signal.bit == -1 &&
                t->signal.scan_ms == 0);
    assert_int_equal(t->signal.type, DATA_UINT16);
    assert_int_equal(t->scale.kind, SCALING_NONE);
    assert_float_equal(t->validity.stale_s, 5, 0);
    assert_false(t->place.has_position || t->scale.negate || t->place.node);
    char *folder = test_memory(plant_prepared_folder(p)), *expected = temp_path(f->folder, "plant.prepared");
    assert_string_equal(folder, expected);
}

CASE(a_service_has_folders_of_its_own)
{
    struct plant plant = { .files.folder = (char *)"/etc/plantcast/none-here",
                           .files.path = (char *)"/etc/plantcast/none-here/plant.yaml" };
    char *prepared = plant_prepared_folder(&plant), *recorded = plant_recorded_folder(&plant), *history = plant_history_folder(&plant);
    (void)f;
    assert_string_equal(prepared, "/var/lib/plantcast/none-here/prepared");
    assert_string_equal(recorded, "/var/lib/plantcast/none-here/history");
    assert_string_equal(history, "/etc/plantcast/none-here/plant.history");
    mem_free(prepared);
    mem_free(recorded);
    mem_free(history);
    plant.files.path = (char *)"/etc/plantcast/none-here/other.yaml";
    prepared = plant_prepared_folder(&plant);
    assert_string_equal(prepared, "/etc/plantcast/none-here/other.prepared");
    mem_free(prepared);
}

CASE(an_empty_history_folder_does_not_hide_that_of_the_service)
{
    struct plant plant = { .files.folder = (char *)"/etc/plantcast/none-here",
                           .files.path = (char *)"/etc/plantcast/none-here/plant.yaml",
                           .history.folder = temp_path(f->folder, "own.history") };
    assert_int_equal(mkdir(plant.history.folder, 0700), 0);
    char *recorded = test_memory(plant_recorded_folder(&plant));
    assert_string_equal(recorded, "/var/lib/plantcast/none-here/history");
    temp_write_text(plant.history.folder, "views.json", "[]\n");
    recorded = test_memory(plant_recorded_folder(&plant));
    assert_string_equal(recorded, plant.history.folder);
}

CASE(everything_is_read)
{
    plant_case_load(f,
         "plant:\n"
         "  name: Werk Süd\n"
         "  time_zone: Europe/Berlin\n"
         "  up: y\n"
         "  show: operator\n"
         "  reprojection: off\n"
         "  view: { eye: [1, 2.5, -3], target: [0, 0, 1e1], fov: 60 }\n"
         "assets:\n"
         "  - { id: 101, tag: T, description: d, model: m.glb, nodes: 'E*', units: ft, up: z, sensor_frame: asset }\n"
         "groups:\n"
         "  - { id: g, quantity: q, unit: '', min: -1, max: 1, limits: { L: -0.5, HH: 0.5 }, interpolation: paper, distance: euclidean,\n"
         "      strength: 2, decay: 3, power: 4, radius_m: 5, reach_m: 6, fill: neighbours,\n"
         "      breaks: [-0.5, 0, 0.25], isolines: [0.1] }\n"
         "  - { id: l, unit: Pa, min: 1e-3, max: 10, scale: log, singles: cut }\n"
         "sources:\n"
         "  - { id: s, type: modbus, host: h, port: 5020, unit: 9, poll_ms: 2000, timeout_ms: 99, byte_order: CDAB, address_base: 0 }\n"
         "tags: tags.csv\n",
         "Tag Name,Address,Data Type,Scan Rate,Scaling,Raw Low,Raw High,Scaled Low,Scaled High,Engineering Units,Negate Value,Description,"
         "Source,Group,Asset,Node,X,Y,Z,Strength,Decay,Byte Order,Stale s,LL,L,H,HH\n"
         "A,40001,Float,500,Square Root,0,27648,-50,150,mm,1,say \"hi\",s,g,101,,1,2,3,7,8,BADC,9,-2,,,2\n"
         "B,3!300007.4,,,,,,,,,,,,g,101,TI-B,,,,,,,,,,,\n");
    plant_case_assert_loaded(f, 1); /* one warning is expected: the group has no unit, while the unit of its tag is mm */
    const struct plant *p = f->plant;
    assert_string_equal(p->name, "Werk Süd");
    assert_true(p->up == AXIS_Y && p->display.view.set && p->display.view.eye_m[1] == 2.5 && p->display.view.target_m[2] == 10 &&
                p->display.view.fov_deg == 60);
    assert_int_equal(p->display.show, PLANT_SHOW_OPERATOR);
    assert_true(p->display.no_reprojection);
    const struct plant_asset *a = &p->assets[0];
    assert_string_equal(a->id, "101");
    assert_string_equal(a->nodes, "E*");
    assert_true(fabs(a->unit_m - 0.3048) < 1e-12 && a->up == AXIS_Z && a->sensors_in_asset_frame);
    const struct plant_group *g = &p->groups[0];
    assert_true(g->limits[LIMIT_L] == -0.5 && g->limits[LIMIT_HH] == 0.5 && isnan(g->limits[LIMIT_H]));
    assert_true(g->interpolation == INTERPOLATION_PAPER && g->distance == DISTANCE_EUCLIDEAN && g->fill == FILL_NEIGHBOURS);
    assert_true(g->strength == 2 && g->decay == 3 && g->power == 4 && g->radius_m == 5 && g->reach_m == 6);
    assert_true(g->break_count == 3 && g->breaks[2] == 0.25 && g->isoline_count == 1 && g->isolines[0] == 0.1 && p->groups[1].log);
    assert_true(!g->cuts_singles && p->groups[1].cuts_singles);
    const struct plant_tag *t = &p->tags[0];
    assert_true(t->signal.register_index == 1 && t->signal.table == TABLE_HOLDING && t->signal.type == DATA_FLOAT32 &&
                t->signal.byte_order == BYTE_ORDER_BADC);
    assert_true(t->signal.scan_ms == 500 && t->scale.kind == SCALING_SQUARE_ROOT && t->scale.raw_high == 27648 &&
                t->scale.scaled_low == -50 && t->scale.negate);
    assert_true(t->strength == 7 && t->decay == 8 && t->validity.stale_s == 9 && t->place.has_position && t->place.position_m[2] == 3);
    assert_true(t->alarms.limits[LIMIT_LL] == -2 && t->alarms.limits[LIMIT_L] == -0.5 && t->alarms.limits[LIMIT_HH] == 2);
    assert_string_equal(t->description, "say \"hi\"");
    const struct plant_tag *b = &p->tags[1];
    assert_true(b->signal.modbus_unit == 3 && b->signal.table == TABLE_INPUT && b->signal.register_index == 7 && b->signal.bit == 4 &&
                b->signal.type == DATA_BIT);
    assert_true(b->strength == 2 && b->decay == 3 && b->validity.stale_s == 6 && b->line == 3);
    assert_string_equal(b->place.node, "TI-B");
    assert_string_equal(b->unit, "");
    assert_int_equal(plant_find_asset(p, "101"), 0);
    assert_int_equal(plant_find_group(p, "x"), -1);
    assert_int_equal(plant_find_tag(p, "B"), 1);
    assert_int_equal(plant_find_tag(p, "AB"), -1);
}

CASE(names_of_a_long_list_are_found)
{
    struct text *csv = test_text();
    text_add(csv, "Tag Name,Address\n");
    for (int i = 0; i < 500; i++)
        text_add(csv, "TT-%d,hr:%d\n", i * 7919 % 500, i);
    plant_case_load(f, small_yaml, csv->at);
    plant_case_assert_loaded(f, 0);
    for (int i = 0; i < 500; i++)
        assert_int_equal(plant_find_tag(f->plant, f->plant->tags[i].name), i);
}

CASE(nodes_are_a_pattern_or_a_list)
{
    static const char rest[] = "plant: { name: P }\ngroups: [{ id: g, unit: K, min: 0, max: 1 }]\ntags: tags.csv\nassets:\n";
    char *good = test_printf("%s- { id: A, model: m.glb, nodes: [P-1, '!motor', '#12', 'mesh:cap*', north/P-2] }\n"
                            "- { id: B, model: m.glb, nodes: 'P*' }\n",
                            rest);
    plant_case_load(f, good, "Tag Name\n");
    plant_case_assert_loaded(f, 0);
    assert_string_equal(f->plant->assets[0].nodes, "P-1\n!motor\n#12\nmesh:cap*\nnorth/P-2");
    assert_string_equal(f->plant->assets[1].nodes, "P*");
    char *unquoted = test_printf("%s- id: A\n  model: m.glb\n  nodes: #12\n- id: B\n  model: m.glb\n  nodes: !motor\n", rest);
    plant_case_load(f, unquoted, "Tag Name\n");
    plant_case_assert_loaded(f, 2);
    FOUND(f, { "plant.yaml", 7, 9, "nodes: has no value, so the whole model is used" }, { "plant.yaml", 10, 10, "in quotes" });
    char *bad = test_printf("%s- { id: A, model: m.glb, nodes: [] }\n- { id: B, model: m.glb, nodes: [P, ~] }\n"
                           "- { id: C, model: m.glb, nodes: { P: 1 } }\n- { id: D, model: m.glb, nodes: \"a\\nb\" }\n",
                           rest);
    plant_case_load(f, bad, "Tag Name\n");
    FOUND(f, { "plant.yaml", 5, 33, "expected at least one pattern" }, { "plant.yaml", 6, 37, "a node's name or a pattern" },
          { "plant.yaml", 7, 33, "found a mapping" }, { "plant.yaml", 8, 33, "contains a line break" });
}

static void assert_point(const double point[3], double x, double y, double z)
{
    const double expected[3] = { x, y, z };
    for (int i = 0; i < 3; i++)
        if (!(fabs(point[i] - expected[i]) < 1e-9))
            fail_msg("(%g, %g, %g) is not (%g, %g, %g)", point[0], point[1], point[2], x, y, z);
}

static const char placed_csv[] = "Tag Name,Address,Group,Asset,Node,X,Y,Z\n"
                                 "P,hr:0,g,A,,1,2,3\n"
                                 "Q,hr:1,g,B,,1,2,3\n"
                                 "N,hr:2,g,A,TI,,,\n"
                                 "-,hr:3,,A,,1,2,3\n";

CASE(sensors_are_given_in_the_asset_frame)
{
    struct plant_sensor *s;
    plant_case_load(f,
         "plant: { name: P }\n"
         "assets:\n"
         "- { id: A, model: m.glb, placement: { translate: [1, 0, 0], rotate_deg: [90, 0, 90], scale: 2 }, units: mm }\n"
         "- { id: B, model: m.glb, sensor_frame: asset, placement: { translate: [1, 0, 0] } }\n"
         "groups: [{ id: g, unit: K, min: 0, max: 1 }]\n"
         "sources: [{ id: s, type: modbus, host: h }]\n"
         "tags: tags.csv\n",
         placed_csv);
    plant_case_assert_loaded(f, 0);
    assert_int_equal(plant_sensors(f->plant, 0, &s), 2);
    /* The asset's rotation is about x, (x, y, z) -> (x, -z, y), and then about z, (x, y, z) -> (-y, x, z); together (a, b, c)
       -> (c, a, b). The expected positions result from the inverse, applied to the sensors' positions relative to (0, 2, 3). */
    /* the asset is drawn twice as large as its model, but positions remain in metres of the plant */
    assert_point(s[0].position_m, 2, 3, 0);
    assert_true(s[0].tag == 0 && s[0].node_hash == 0 && !s[0].node);
    assert_float_equal(f->plant->assets[0].unit_m, 2e-3, 1e-15);
    assert_true(s[1].tag == 2 && s[1].node_hash != 0);
    assert_string_equal(s[1].node, "TI");
    mem_free(s);
    assert_int_equal(plant_sensors(f->plant, 1, &s), 1);
    assert_point(s[0].position_m, 1, 2, 3);
    mem_free(s);
}

CASE(an_assumed_place_is_another_than_the_same_place_known)
{
    struct plant_sensor *s;
    plant_case_load(f,
         "plant: { name: P }\nassets: [{ id: A, model: m.glb }]\ngroups: [{ id: g, unit: K, min: 0, max: 1 }]\n"
         "sources: [{ id: s, type: modbus, host: h }]\ntags: tags.csv\n",
         "Tag Name,Address,Group,Asset,Place,Node,X,Y,Z\na,hr:1,g,A,equipment,,,,\nb,hr:2,g,A,Equipment,,1,2,3\n"
         "c,hr:3,g,A,position,,1,2,3\nd,hr:4,g,A,equipment,N,,,\ne,hr:5,g,A,,N,,,\n");
    plant_case_assert_loaded(f, 0);
    assert_int_equal(plant_sensors(f->plant, 0, &s), 5);
    assert_string_equal(s[0].node, "");
    assert_true(s[0].node_hash != 0 && f->plant->tags[0].place.assumed);
    assert_null(s[1].node);
    assert_true(s[1].node_hash != 0 && f->plant->tags[1].place.assumed);
    assert_point(s[1].position_m, 1, 2, 3);
    assert_true(s[2].node_hash == 0 && !f->plant->tags[2].place.assumed);
    assert_string_equal(s[3].node, "N");
    assert_true(s[3].node_hash != s[4].node_hash);
    mem_free(s);
}

CASE(an_asset_stands_upright_in_a_plant_that_is_y_up)
{
    struct plant_sensor *s;
    plant_case_load(f,
         "assets: [{ id: A, model: m.glb, placement: { translate: [0, 10, 0] } }, { id: B, model: m.glb }]\n"
         "groups: [{ id: g, unit: K, min: 0, max: 1 }]\n"
         "sources: [{ id: s, type: modbus, host: h }]\n"
         "tags: tags.csv\n"
         "plant: { name: P, up: y }\n",
         placed_csv);
    plant_case_assert_loaded(f, 0);
    assert_int_equal(plant_sensors(f->plant, 0, &s), 2);
    /* position relative to the asset: 8 m below its foot, and 3 m to the south, which is z in the model and -y here */
    assert_point(s[0].position_m, 1, -3, -8);
    mem_free(s);
}

CASE(the_locale_changes_nothing)
{
    char *command = test_printf("localedef -i de_DE -f UTF-8 %s/de_DE.UTF-8 2>&1", f->folder);
    setenv("LOCPATH", f->folder, 1);
    bool german = system(command) == 0 && setlocale(LC_NUMERIC, "de_DE.UTF-8");
    if (!german) {
        print_message("# a locale with a decimal comma cannot be made: the package locales is missing\n");
        skip();
    }
    assert_string_equal(localeconv()->decimal_point, ",");
    plant_case_load(f,
         "plant: { name: P }\nassets: [{ id: A, model: m.glb }]\n"
         "groups: [{ id: g, unit: K, min: 0.25, max: 1.5 }]\ntags: tags.csv\n",
         "Tag Name,L\nT,0.5\n");
    setlocale(LC_NUMERIC, "C");
    plant_case_assert_loaded(f, 0);
    assert_float_equal(f->plant->groups[0].max, 1.5, 0);
    assert_float_equal(f->plant->tags[0].alarms.limits[LIMIT_L], 0.5, 0);
}

/* --- plant.yaml, bad -------------------------------------------------------------------------------------------------------- */

/* Loads small_yaml with its line number `line` replaced by `text` (0: no replacement), together with the tag list `csv`. */
static void load_csv_with(struct plant_case *f, int line, const char *text, const char *csv)
{
    struct text *yaml = test_text();
    const char *p = small_yaml;
    for (int i = 1; *p; i++) {
        size_t length = strcspn(p, "\n") + 1;
        if (i == line)
            text_add(yaml, "%s\n", text);
        else
            text_add_bytes(yaml, p, length);
        p += length;
    }
    plant_case_load(f, yaml->at, csv);
}

static void load_with(struct plant_case *f, int line, const char *text)
{
    load_csv_with(f, line, text, small_csv);
    assert_null(f->plant);
}

CASE(unknown_keys_are_named)
{
    load_with(f, 1, "plant: { name: P, timezone: UTC }");
    FOUND(f, { "plant.yaml", 1, 19, "unknown key 'timezone' in plant; did you mean 'time_zone'?" });
    load_with(f, 1, "plant: { name: P, colour: red }");
    FOUND(f, { "plant.yaml", 1, 19, "unknown key 'colour' in plant; expected one of: name, time_zone, up, view, show" });
    load_with(f, 5, "tags: tags.csv\nsorces: []");
    FOUND(f, { "plant.yaml", 6, 1, "did you mean 'sources'?" });
    load_with(f, 1, "plant: { name: P, [a]: 1 }");
    FOUND(f, { "plant.yaml", 1, 19, "expected the name of a key, found a list" });
}

/* Surroundings for lighting, given as Radiance HDR files: two files of white pixels are accepted, and a black one is refused.
   */
CASE(surroundings_are_read)
{
    static const char hdr[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x80\x80\x81\x80\x80\x80\x81";
    temp_write(f->folder, "hall.hdr", hdr, sizeof(hdr) - 1);
    temp_write(f->folder, "sky.hdr", hdr, sizeof(hdr) - 1);
    temp_write_text(f->folder, "yard.exr", "no picture");
    plant_case_load(f,
                    "plant: { name: P }\nassets: [{ id: E-1, model: m.glb }]\ngroups: [{ id: g, unit: K, min: 0, max: 1 }]\n"
                    "sources: [{ id: plc, type: modbus, host: h }]\ntags: tags.csv\nenvironment: hall.hdr\n",
                    small_csv);
    plant_case_assert_loaded(f, 0);
    assert_int_equal(f->plant->display.environment_count, 1);
    assert_string_equal(f->plant->display.environments[0].name, "hall");
    assert_int_equal(plant_find_environment(f->plant, "hall"), 1);
    assert_int_equal(plant_find_environment(f->plant, "sky"), 0);
    assert_int_equal(plant_find_environment(f->plant, "yard"), -1);
    load_with(f, 1, "plant: { name: P }\nenvironment: [hall.hdr, none.hdr, ./hall.hdr, sky.hdr, yard.exr, 3.5, {}]");
    FOUND(f, { "plant.yaml", 2, 25, "none.hdr" }, { "plant.yaml", 2, 35, "the name 'hall' is already used" },
          { "plant.yaml", 2, 47, "the name 'sky' is already used" }, { "plant.yaml", 2, 56, "yard.exr" }, { "plant.yaml", 2, 66, "3.5" },
          { "plant.yaml", 2, 71, "environment: expected the path of a picture, found" });
}

CASE(links_are_templates_of_addresses)
{
    load_csv_with(f, 1,
                  "plant: { name: P }\nlinks: [{ name: Maintenance, url: 'https://cmms.example/e?id={id}&in={area}' },"
                  " { name: DCS, of: tag, url: 'http://dcs.example:81/{name}' }]",
                  small_csv);
    plant_case_assert_loaded(f, 0);
    assert_int_equal(f->plant->display.link_count, 2);
    assert_string_equal(f->plant->display.links[0].name, "Maintenance");
    assert_false(f->plant->display.links[0].of_tags);
    assert_true(f->plant->display.links[1].of_tags);
    assert_string_equal(f->plant->display.links[1].url, "http://dcs.example:81/{name}");
    load_with(f, 1,
              "plant: { name: P }\nlinks:\n- { name: A, url: 'javascript:alert(1)' }\n- { name: B, url: 'https://{id}.example/' }\n"
              "- { name: C, url: 'https://a.example/{name}' }\n- { name: D, url: 'https:// a/' }\n- { url: 'http://a/' }\n"
              "- { name: F, of: pump, url: 'http:///x' }\n- { name: G, of: tag, url: 'http://a/{tag' }");
    FOUND(f, { "plant.yaml", 3, 19, "must begin with https:// or http://" },
          { "plant.yaml", 4, 19, "the address of the link names no server" },
          { "plant.yaml", 5, 19, "may contain only {id}, {tag} and {area} in braces" }, { "plant.yaml", 6, 19, "white space" },
          { "plant.yaml", 7, 3, "a link needs the key 'name'" }, { "plant.yaml", 8, 18, "expected" },
          { "plant.yaml", 8, 29, "the address of the link names no server" },
          { "plant.yaml", 9, 28, "may contain only {name}, {asset} and {group} in braces" });
}

CASE(assets_have_properties_of_their_own)
{
    load_csv_with(f, 2,
                  "assets: [{ id: E-1, model: m.glb, properties: { Maker: Example Works, Built: 2011, Länge: '3 m', None: ~ } }, "
                  "{ id: E-2, model: m.glb }]",
                  small_csv);
    plant_case_assert_loaded(f, 0);
    const struct plant_asset *asset = &f->plant->assets[0];
    assert_int_equal(asset->property_count, 3);
    assert_string_equal(asset->properties[0].name, "Maker");
    assert_string_equal(asset->properties[0].text, "Example Works");
    assert_string_equal(asset->properties[1].text, "2011");
    assert_string_equal(asset->properties[2].name, "Länge");
    assert_int_equal(f->plant->assets[1].property_count, 0);
    load_with(f, 2, "assets: [{ id: E-1, model: m.glb, properties: { Maker: [a], A: 1, A: 2, '': x } }, { id: E-2, model: m.glb }]");
    FOUND(f, { "plant.yaml", 2, 56, "Maker: expected text or a number" }, { "plant.yaml", 2, 67, "'A' is listed twice" },
          { "plant.yaml", 2, 73, "expected a name of 1 to 63 bytes" });
    load_with(f, 2, "assets: [{ id: E-1, model: m.glb, properties: [a] }, { id: E-2, model: m.glb }]");
    FOUND(f, { "plant.yaml", 2, 47, "properties: expected a mapping" });
}

CASE(missing_keys_are_named)
{
    plant_case_load(f, "plant: {}\n", small_csv);
    assert_null(f->plant);
    FOUND(f, { "plant.yaml", 1, 1, "needs the key 'assets'" }, { "plant.yaml", 1, 1, "needs the key 'groups'" },
          { "plant.yaml", 1, 1, "needs the key 'tags'" }, { "plant.yaml", 1, 8, "plant needs the key 'name'" });
    load_with(f, 3, "groups:\n- id: temp\n  unit: K");
    FOUND(f, { "plant.yaml", 4, 3, "a group needs the key 'min'" }, { "plant.yaml", 4, 3, "a group needs the key 'max'" });
    load_with(f, 4, "sources: [{ id: plc, type: modbus, host: }]");
    FOUND(f, { "plant.yaml", 4, 42, "a source requires the key 'host'" });
    load_with(f, 2, "assets: []");
    FOUND(f, { "plant.yaml", 2, 9, "assets: expected at least one" });
}

CASE(wrong_types_are_named)
{
    load_with(f, 1, "plant: P");
    FOUND(f, { "plant.yaml", 1, 8, "plant: expected a mapping (key: value), found 'P'" });
    load_with(f, 2, "assets: { id: E-1 }");
    FOUND(f, { "plant.yaml", 2, 9, "assets: expected a list (lines that begin with -), found a mapping" });
    load_with(f, 2, "assets: [E-1]");
    FOUND(f, { "plant.yaml", 2, 10, "an asset: expected a mapping (key: value), found 'E-1'" });
    load_with(f, 2, "assets: [{ id: [1], model: m.glb }]");
    FOUND(f, { "plant.yaml", 2, 16, "id: expected text, found a list" });
    load_with(f, 2, "assets: [{ id: '', model: m.glb }]");
    FOUND(f, { "plant.yaml", 2, 16, "id: expected text, found ''" });
    load_with(f, 3, "groups: [{ id: g, unit: K, min: \"0\", max: ten }]");
    FOUND(f, { "plant.yaml", 3, 33, "min: expected a number, found the text \"0\"" },
          { "plant.yaml", 3, 43, "max: expected a number, found 'ten'" });
    load_with(f, 4, "sources: [{ id: s, type: modbus, host: h, port: 502.5, poll_ms: [1] }]");
    FOUND(f, { "plant.yaml", 4, 49, "port: expected a whole number from 1 to 65535, found '502.5'" },
          { "plant.yaml", 4, 65, "poll_ms: expected a whole number from 10 to 86400000, found a list" });
    load_with(f, 2, "assets: [{ id: E, model: m.glb, placement: { translate: [1, 2], rotate_deg: [1, x, 3], scale: big } }]");
    FOUND(f, { "plant.yaml", 2, 57, "translate: expected a list of three numbers" },
          { "plant.yaml", 2, 81, "rotate_deg: expected a number from -36000 to 36000, found 'x'" },
          { "plant.yaml", 2, 95, "scale: expected a number from 1e-06 to 1000000, found 'big'" });
    load_with(f, 3, "groups: [{ id: g, unit: K, min: 0, max: 1, radius_m: [], limits: 5 }]");
    FOUND(f, { "plant.yaml", 3, 54, "radius_m: expected auto or a number, found a list" },
          { "plant.yaml", 3, 66, "limits: expected a mapping" });
    load_with(f, 3, "groups: [{ id: g, unit: K, min: 0, max: 1, breaks: [0.1, x, 0.5, 0.3], isolines: 5, scale: log }]");
    FOUND(f, { "plant.yaml", 3, 58, "breaks: expected a number, found 'x'" },
          { "plant.yaml", 3, 66, "breaks: expected a number greater than the previous one (0.5), found 0.3" },
          { "plant.yaml", 3, 82, "isolines: expected a list" },
          { "plant.yaml", 3, 92, "scale: a logarithmic scale needs min of at least 1e-18, found 0" });
    load_with(f, 3, "groups: [{ id: g, unit: K, min: 10000000, max: 10000000.000000002 }]");
    FOUND(f, { "plant.yaml", 3, 33,
               "min, max: the range from 10000000 to 10000000.000000002 is too narrow: max must exceed min by at least 1e-18, and by at "
               "least 1e-06 of the larger of their absolute values" });
    load_with(f, 3, "groups: [{ id: g, unit: K, min: 0, max: 1e-40 }]");
    FOUND(f, { "plant.yaml", 3, 33,
               "min, max: the range from 0 to 9.9999999999999993e-41 is too narrow: max must exceed min by at least 1e-18, and by at least "
               "1e-06 of the larger of their absolute values" });
}

CASE(bad_choices_list_the_allowed)
{
    load_with(f, 2, "assets: [{ id: E, model: m.glb, units: yd, up: x, sensor_frame: world, start: away }]");
    FOUND(f, { "plant.yaml", 2, 40, "units: expected m, mm, cm, in or ft, found 'yd'" },
          { "plant.yaml", 2, 48, "up: expected z or y, found 'x'" },
          { "plant.yaml", 2, 65, "sensor_frame: expected plant or asset, found 'world'" },
          { "plant.yaml", 2, 79, "start: expected shown, ghost or hidden, found 'away'" });
    load_with(f, 3, "groups: [{ id: g, unit: K, min: 0, max: 1, interpolation: idw, distance: [geodesic], fill: some }]");
    FOUND(f, { "plant.yaml", 3, 59, "interpolation: expected shepard, paper, harmonic, fin or gp, found 'idw'" },
          { "plant.yaml", 3, 74, "distance: expected geodesic or euclidean, found a list" },
          { "plant.yaml", 3, 92, "fill: expected none or neighbours, found 'some'" });
    load_with(f, 4, "sources: [{ id: s, type: ethip, host: h, byte_order: abcd, address_base: 2 }]");
    FOUND(f, { "plant.yaml", 4, 26, "type: expected modbus, mqtt, opcua or replay, found 'ethip'" },
          { "plant.yaml", 4, 54, "byte_order: expected ABCD, CDAB, BADC or DCBA, found 'abcd'" },
          { "plant.yaml", 4, 74, "address_base: expected a whole number from 0 to 1, found '2'" });
}

CASE(assets_may_start_out_of_the_way)
{
    struct text *yaml = test_text();
    load_csv_with(f, 2, "assets: [{ id: E, model: m.glb, start: hidden }, { id: F, model: m.glb, start: ghost }, { id: G, model: m.glb }]",
                  small_csv);
    plant_case_assert_loaded(f, 0);
    assert_int_equal(f->plant->assets[0].start, PLANT_START_HIDDEN);
    assert_int_equal(f->plant->assets[1].start, PLANT_START_GHOST);
    assert_int_equal(f->plant->assets[2].start, PLANT_START_SHOWN);
    text_add(yaml, "assets:");
    for (int i = 0; i <= PLANT_STARTS; i++)
        text_add(yaml, "\n- { id: A%d, model: m.glb, start: %s }", i, i < PLANT_STARTS ? "shown" : "hidden");
    load_with(f, 2, yaml->at);
    FOUND(f, { "plant.yaml", 4099, 37, "start: only the first 4096 assets of the plant file can be hidden or ghosts" });
}

CASE(sources_say_how_they_are_reached)
{
    load_with(f, 4,
              "sources:\n"
              "- { id: a, type: modbus, hosts: [10.0.0.1, 10.0.0.2], max_registers: 60, max_bits: 100, max_gap: 8, pause_ms: 20 }\n"
              "- { id: b, type: modbus, transport: rtu-over-tcp, host: gw, port: 4001, heartbeat: { tag: B, longest_s: 2.5 } }\n"
              "- { id: c, type: modbus, transport: rtu, device: /dev/ttyS0, baud: 9600, parity: none, stop_bits: 2, simulated: yes }\n"
              "- { id: d, type: replay, file: tags.csv, speed: 60, loop: yes }\n"
              "- { id: e, type: modbus, transport: rtu, device: /dev/ttyS1 }");
    FOUND(f, { "plant.yaml", 6, 1, "heartbeat: unknown tag 'B'" }, { "tags.csv", 2, 1, "Source: expected the id of one of the 5 sources" });
    load_csv_with(f, 4,
                  "sources:\n"
                  "- { id: a, type: modbus, hosts: [10.0.0.1, 10.0.0.2], max_registers: 60, max_bits: 100, max_gap: 8, pause_ms: 20 }\n"
                  "- { id: b, type: modbus, transport: rtu-over-tcp, host: gw, port: 4001, heartbeat: { tag: B, longest_s: 2.5 } }\n"
                  "- { id: c, type: modbus, transport: rtu, device: /dev/ttyS0, baud: 9600, parity: none, stop_bits: 2, simulated: yes }\n"
                  "- { id: d, type: replay, file: tags.csv, speed: 60, loop: yes }\n"
                  "- { id: e, type: modbus, transport: rtu, device: /dev/ttyS1 }",
                  "Tag Name,Address,Source\nA,40001,a\nB,40001,b\nC,Shell inlet,d\n");
    plant_case_assert_loaded(f, 0);
    const struct plant_source *s = f->plant->sources;
    assert_true(s[0].host_count == 2 && !strcmp(s[0].hosts[1], "10.0.0.2") && s[0].transport == TRANSPORT_TCP && !s[0].base_stated);
    assert_true(s[0].max_registers == 60 && s[0].max_bits == 100 && s[0].max_gap == 8 && s[0].pause_ms == 20 && s[0].heartbeat_s == 0);
    assert_true(s[1].transport == TRANSPORT_RTU_TCP && s[1].port == 4001 && s[1].heartbeat_tag == 1 && s[1].heartbeat_s == 2.5);
    assert_true(s[1].max_registers == 125 && s[1].max_bits == 2000 && s[1].max_gap == 0 && s[1].pause_ms == 0 && !s[1].simulated);
    assert_true(s[2].transport == TRANSPORT_RTU && s[2].baud == 9600 && s[2].parity == 'N' && s[2].stop_bits == 2 && s[2].simulated);
    assert_true(!strcmp(s[3].kind, "replay") && s[3].speed == 60 && s[3].loop && s[3].simulated);
    assert_true(s[4].baud == 19200 && s[4].parity == 'E' && s[4].stop_bits == 1); /* Modbus over serial line 2.5.1 */
    assert_string_equal(f->plant->tags[2].signal.address, "Shell inlet");
}

CASE(keys_without_meaning_are_errors)
{
    load_csv_with(f, 4,
                  "sources:\n"
                  "- { id: a, type: modbus, host: h, baud: 9600, file: x }\n"
                  "- { id: b, type: modbus, transport: rtu, host: h }\n"
                  "- { id: c, type: replay, file: no.csv, port: 5 }\n"
                  "- { id: d, type: modbus, host: g, hosts: [h] }\n"
                  "- { id: e, type: modbus, hosts: [1, 2, 3, 4, 5] }\n"
                  "- { id: f, type: modbus, transport: rtu, device: /dev/a }\n"
                  "- { id: g, type: modbus, transport: rtu, device: /dev/a }\n"
                  "- { id: h, type: replay, file: tags.csv, heartbeat: { longest_s: 0 } }",
                  "Tag Name,Address,Source\nA,40001,a\n");
    FOUND(f, { "plant.yaml", 5, 41, "baud: has no effect for a modbus source over TCP" }, { "plant.yaml", 5, 53, "file: has no effect" },
          { "plant.yaml", 5, 53, "cannot be read" }, { "plant.yaml", 6, 48, "host: has no effect for transport rtu" },
          { "plant.yaml", 6, 3, "a source requires the key 'device'" }, { "plant.yaml", 7, 32, "no.csv' cannot be read" },
          { "plant.yaml", 7, 46, "port: has no effect for a replay" }, { "plant.yaml", 8, 42, "hosts: expected host or hosts, not both" },
          { "plant.yaml", 8, 3, "h:502 is also used by source a: the device gets two connections" },
          { "plant.yaml", 8, 3, "h:502 is also used by source b" }, { "plant.yaml", 9, 33, "hosts: expected 1 to 4, found 5" },
          { "plant.yaml", 11, 50, "device: '/dev/a' is already used by source f" },
          { "plant.yaml", 12, 53, "heartbeat needs the key 'tag'" },
          { "plant.yaml", 12, 66, "longest_s: expected a number from 0.1 to 86400" });
}

CASE(numbers_have_ranges)
{
    load_with(f, 3, "groups: [{ id: g, unit: K, min: .nan, max: .inf, strength: -1, power: 99, reach_m: 0, radius_m: 1e999 }]");
    FOUND(f, { "plant.yaml", 3, 33, "min: expected a finite number, found '.nan'" },
          { "plant.yaml", 3, 44, "max: expected a finite number, found '.inf'" },
          { "plant.yaml", 3, 60, "strength: expected a number from 0 to 100, found '-1'" },
          { "plant.yaml", 3, 71, "power: expected a number from 0.5 to 16, found '99'" },
          { "plant.yaml", 3, 84, "reach_m: expected a number from 0.001 to 1000000, found '0'" },
          { "plant.yaml", 3, 97, "radius_m: expected a finite number from 0.001 to 1000000, found '1e999'" });
    load_with(f, 4, "sources: [{ id: s, type: modbus, host: h, port: 0, unit: 256, poll_ms: 5, timeout_ms: 1e9 }]");
    FOUND(f, { "plant.yaml", 4, 49, "port: expected a whole number from 1 to 65535" },
          { "plant.yaml", 4, 58, "unit: expected a whole number from 0 to 255" },
          { "plant.yaml", 4, 72, "poll_ms: expected a whole number from 10 to 86400000" },
          { "plant.yaml", 4, 87, "timeout_ms: expected a whole number from 10 to 60000" });
    load_with(f, 1, "plant: { name: P, view: { eye: [1, 1, 1], target: [1, 1, 1], fov: 180 } }");
    FOUND(f, { "plant.yaml", 1, 51, "target: must be another point than `eye`" },
          { "plant.yaml", 1, 67, "fov: expected a number from 1 to 120" });
    load_with(f, 2, "assets: [{ id: E, model: m.glb, placement: { translate: [0, 2e7, 0], scale: 0 } }]");
    FOUND(f, { "plant.yaml", 2, 61, "translate: expected a number from -10000000 to 10000000" },
          { "plant.yaml", 2, 77, "scale: expected" });
}

CASE(meaning_is_checked)
{
    load_with(f, 3, "groups:\n- id: temp\n  unit: K\n  min: 100\n  max: 100");
    FOUND(f, { "plant.yaml", 6, 8, "min: expected less than max, which is 100, found 100" });
    load_with(f, 3, "groups: [{ id: g, unit: K, min: 0, max: 9, limits: { LL: 1, L: 1, H: 8, HH: 7.5 } }]");
    FOUND(f, { "plant.yaml", 3, 64, "L: expected more than LL, which is 1, found 1 (LL < L < H < HH)" });
    load_with(f, 3, "groups: [{ id: g, unit: K, min: 0, max: 9, limits: { HH: 1, LL: 2 } }]");
    FOUND(f, { "plant.yaml", 3, 58, "HH: expected more than LL, which is 2, found 1" });
    load_with(f, 3, "groups: [{ id: g, unit: K, min: 0, max: 9, limits: { H: hot } }]");
    FOUND(f, { "plant.yaml", 3, 57, "H: expected a number, found 'hot'" });
    load_with(f, 2, "assets:\n- { id: A, model: m.glb }\n- { id: B, model: m.glb }\n- { model: m.glb, id: A }");
    FOUND(f, { "plant.yaml", 5, 23, "id: asset 'A' is listed twice (first at line 3)" });
    load_with(f, 4, "sources: [{ id: s, type: modbus, host: h }, { id: s, type: modbus, host: g }]");
    FOUND(f, { "plant.yaml", 4, 51, "id: source 's' is listed twice" },
          { "tags.csv", 2, 1, "Source: expected the id of one of the 2 sources" });
    load_with(f, 2, "assets: [{ id: A, model: nowhere/x.glb }, { id: B, model: . }]");
    FOUND(f, { "plant.yaml", 2, 26, "nowhere/x.glb' cannot be read: No such file or directory" },
          { "plant.yaml", 2, 59, "is not a file" });
    load_with(f, 5, "tags: no.csv");
    FOUND(f, { "plant.yaml", 5, 7, "no.csv' cannot be read: No such file or directory" });
}

CASE(time_zones_are_looked_up)
{
    static const char *const wrong[] = { "Europe/Berln", "Europe", "../zoneinfo/UTC", "/usr/share/zoneinfo/UTC", "tzdata.zi", "CEST+1?" };
    if (access("/usr/share/zoneinfo/Europe/Berlin", R_OK) != 0) {
        print_message("# no time zone database is installed\n");
        skip();
    }
    for (size_t i = 0; i < sizeof(wrong) / sizeof(*wrong); i++) {
        load_with(f, 1, test_printf("plant: { name: P, time_zone: %s }", wrong[i]));
        FOUND(f, { "plant.yaml", 1, 30, "expected an IANA name such as Europe/Berlin or UTC" });
    }
}

CASE(all_errors_come_at_once)
{
    plant_case_load(f,
         "plant: { nam: P }\n"
         "assets: [{ id: A, model: gone.glb, units: yd }]\n"
         "groups: [{ id: g, unit: K, min: 2, max: 1 }]\n"
         "sources: [{ id: s, type: modbus, host: h, port: -1 }]\n"
         "tags: tags.csv\n",
         "Tag Name,Address,Group\nT1,4,g\nT1,40001,gg\n");
    FOUND(f, { "plant.yaml", 1, 8, "plant needs the key 'name'" }, { "plant.yaml", 1, 10, "did you mean 'name'?" },
          { "plant.yaml", 2, 26, "cannot be read" }, { "plant.yaml", 2, 43, "units: expected" },
          { "plant.yaml", 3, 33, "min: expected less" },
          { "plant.yaml", 4, 49, "port: expected" }, { "tags.csv", 2, 4, "Address: '4'" },
          { "tags.csv", 2, 6, "'T1' has a group but no asset" },
          { "tags.csv", 3, 1, "Tag Name: 'T1' is listed twice (first at line 2)" },
          { "tags.csv", 3, 10, "unknown group 'gg'; the plant file has no such id" },
          { "tags.csv", 3, 10, "'T1' has a group but no asset" });
    assert_int_equal(f->diag.errors, 9);
}

/* --- plant.yaml, not YAML --------------------------------------------------------------------------------------------------- */

CASE(syntax_errors_have_a_place)
{
    load_with(f, 2, "assets: [{ id: A, model: m.glb }");
    FOUND(f, { "plant.yaml", 3, 1, "invalid YAML: did not find expected ',' or ']', while parsing a flow sequence that begins at line 2" });
    load_with(f, 1, "plant: { name: 'P }");
    FOUND(f, { "plant.yaml", 6, 1, "invalid YAML: found unexpected end of stream" });
    load_with(f, 1, "plant: { name: *P }");
    FOUND(f, { "plant.yaml", 1, 16, "invalid YAML: found undefined alias" });
    load_with(f, 1, "plant:\n\tname: P\n\ttime_zone: UTC");
    FOUND(f, { "plant.yaml", 2, 1, "tab in the indentation" }, { "plant.yaml", 3, 1, "tab in the indentation" });
    load_with(f, 1, "plant: { name: P\x01 }");
    FOUND(f, { "plant.yaml", 1, 17, "invalid YAML: control characters are not allowed" });
    load_with(f, 5, "tags: tags.csv\n---\nplant: 1");
    FOUND(f, { "plant.yaml", 7, 1, "a second YAML document begins here" });
}

CASE(keys_that_come_twice_are_named)
{
    load_with(f, 1, "plant:\n  name: P\n  name: Q");
    FOUND(f, { "plant.yaml", 3, 3, "key 'name' is listed twice (first at line 2)" });
    load_with(f, 5, "tags: tags.csv\nplant: { name: Q }");
    FOUND(f, { "plant.yaml", 6, 1, "key 'plant' is listed twice (first at line 1)" });
}

CASE(what_is_not_utf8_text_has_a_place)
{
    load_with(f, 1, "plant: { name: K\xFChler } # \xFC");
    FOUND(f, { "plant.yaml", 1, 17, "byte 0xFC is not UTF-8 text" });
    load_with(f, 3, "groups: [{ id: ä, unit: \xB0"
                    "C, min: 1, max: 0 }]");
    FOUND(f, { "plant.yaml", 3, 25, "byte 0xB0 is not UTF-8 text" }, { "plant.yaml", 3, 34, "min: expected less than max" });
    const char utf16[] = "\xFF\xFEp\0l\0a\0n\0t\0";
    temp_write(f->folder, "plant.yaml", utf16, sizeof(utf16));
    plant_case_forget(f);
    f->plant = plant_load(f->path, &f->diag);
    FOUND(f, { "plant.yaml", 1, 1, "is UTF-16" });
    plant_case_load(f, "\xEF\xBB\xBFplant: { nam: P }\nassets: [{ id: A, model: m.glb }]\ngroups: [{ id: g, unit: K, min: 0, max: 1 }]\n"
            "tags: tags.csv\n",
         small_csv);
    FOUND(f, { "plant.yaml", 1, 8, "needs the key 'name'" }, { "plant.yaml", 1, 10, "did you mean 'name'?" });
}

CASE(files_without_content_are_refused)
{
    plant_case_load(f, "", small_csv);
    FOUND(f, { "plant.yaml", 1, 1, "is empty" });
    plant_case_load(f, " \n\n", small_csv);
    FOUND(f, { "plant.yaml", 1, 1, "is empty" });
    plant_case_load(f, "# nothing but this\n", small_csv);
    FOUND(f, { "plant.yaml", 1, 1, "is empty" });
    plant_case_load(f, "[]", small_csv);
    FOUND(f, { "plant.yaml", 1, 1, "the plant file: expected a mapping" });
    plant_case_load(f, small_yaml, "");
    FOUND(f, { "tags.csv", 1, 1, "is empty" });
}

CASE(files_that_cannot_be_read_are_named)
{
    f->plant = plant_load(f->path, &f->diag);
    assert_null(f->plant);
    FOUND(f, { "plant.yaml", 0, 0, "cannot be read: No such file or directory" });
    plant_case_forget(f);
    f->plant = plant_load(f->folder, &f->diag);
    FOUND(f, { "", 0, 0, "cannot be read: Is a directory" });
    plant_case_load(f, small_yaml, small_csv);
    plant_case_forget(f);
    char *path = temp_path(f->folder, "tags.csv");
    assert_int_equal(truncate(path, 64 * 1024 * 1024 + 1), 0);
    f->plant = plant_load(f->path, &f->diag);
    assert_null(f->plant);
    FOUND(f, { "tags.csv", 0, 0, "larger than the limit of 64 MiB" });
    assert_int_equal(truncate(f->path, 64 * 1024 * 1024 + 1), 0);
    plant_case_forget(f);
    f->plant = plant_load(f->path, &f->diag);
    FOUND(f, { "plant.yaml", 0, 0, "larger than the limit of 64 MiB" });
}

static void write_image(struct plant_case *f, const char *name, int width, int height, const uint8_t *rgb)
{
    char header[32];
    int n = snprintf(header, sizeof(header), "P6\n%d %d\n255\n", width, height);
    size_t bytes = (size_t)(3 * width * height);
    uint8_t *all = mem_array(1, (size_t)n + bytes);
    memcpy(all, header, (size_t)n);
    memcpy(all + n, rgb, bytes);
    temp_write(f->folder, name, all, (size_t)n + bytes);
    mem_free(all);
}

CASE(colour_maps_come_from_images)
{
    static const uint8_t lying[3 * 3] = { 0, 0, 0, 200, 100, 0, 200, 200, 200 }, standing[2 * 3] = { 255, 0, 0, 0, 0, 255 };
    write_image(f, "lying.ppm", 3, 1, lying);
    write_image(f, "standing.ppm", 1, 2, standing);
    char *yaml = test_printf("%scolormaps:\n  - { name: a, image: lying.ppm }\n  - { name: b, image: standing.ppm }\n", small_yaml);
    plant_case_load(f, yaml, small_csv);
    plant_case_assert_loaded(f, 0);
    assert_int_equal(f->plant->display.colormap_count, 2);
    const struct colormap *a = &f->plant->display.colormaps[0], *b = &f->plant->display.colormaps[1];
    assert_string_equal(a->name, "a");
    assert_true(a->rgb[0][0] == 0 && a->rgb[255][2] == 200 && abs(a->rgb[127][0] - 200) < 3 && abs(a->rgb[127][1] - 100) < 3);
    assert_true(abs(a->rgb[85][0] - 100) < 3); /* half-way between the first two */
    assert_true(b->rgb[0][2] == 255 && b->rgb[255][0] == 255); /* from the bottom up */
}

CASE(bad_colour_maps_are_named)
{
    static const uint8_t dot[3] = { 1, 2, 3 };
    write_image(f, "dot.ppm", 1, 1, dot);
    temp_write_text(f->folder, "text.png", "no image");
    load_with(f, 5, "tags: tags.csv\n"
                    "colormaps: [{ name: viridis, image: none.png }, { name: b, image: dot.ppm },\n"
                    "  { name: b, image: text.png }, { name: c }, { name: d, image: . }]");
    FOUND(f, { "plant.yaml", 6, 21, "name: there is a colour map 'viridis' already" },
          { "plant.yaml", 6, 37, "none.png': No such file or directory" },
          { "plant.yaml", 6, 67, "dot.ppm': the picture has only one pixel" },
          { "plant.yaml", 7, 11, "name: there is a colour map 'b' already" }, { "plant.yaml", 7, 21, "text.png': " },
          { "plant.yaml", 7, 33, "image" }, { "plant.yaml", 7, 64, "': not a file" });
}
