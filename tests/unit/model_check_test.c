/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Faults that `plantcastd --check` finds in the headers of models and of recorded series, which it reads without the rest of these
   files. */
#include "tests/support/test.h"

#include "base/text/text.h"
#include "plant/models/asset_size.h"
#include "plant/models/model_check.h"
#include "plant/models/model_header.h"
#include "tests/support/plant_case.h"
#include "value/series_check.h"

#define CASE(name) TEST_ON(struct plant_case *c, name, plant_case_set_up, plant_case_tear_down)

/* Model of two pumps of 743 x 200 x 400 model units, y axis up, 1,000 units apart. The second pump is rotated by 90 degrees
   about y and half as large. */
static const char model[] =
    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
    "\"nodes\":[{\"name\":\"hall\",\"children\":[1,2]},{\"name\":\"P-101A\",\"mesh\":0},"
    "{\"name\":\"P-101B\",\"mesh\":0,\"translation\":[1000,0,0],\"rotation\":[0,0.70710678,0,0.70710678],"
    "\"scale\":[0.5,0.5,0.5],\"children\":[3]},"
    "{\"name\":\"P-101A\",\"mesh\":0}],"
    "\"meshes\":[{\"name\":\"pump\",\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
    "\"accessors\":[{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[743,200,400]}]}";

static size_t memory_bytes; /* 0: this machine's */

static void check(struct plant_case *c, const char *assets, const char *sources, const char *tags, char **printed)
{
    char *yaml = test_printf("plant: { name: P }\nassets:\n%sgroups: [{ id: g, unit: K, min: 0, max: 9 }]\nsources: %s\ntags: tags.csv\n",
                            assets, sources);
    size_t bytes;
    char *text = NULL;
    FILE *out = open_memstream(&text, &bytes);
    temp_write_text(c->folder, "m.gltf", model);
    plant_case_load(c, yaml, tags);
    plant_case_assert_loaded(c, c->diag.warnings);
    models_check(c->plant, memory_bytes, &c->diag, out);
    series_check(c->plant, &c->diag);
    fclose(out);
    if (printed)
        *printed = text;
    else
        free(text);
}

CASE(sizes_are_printed_and_doubted)
{
    char *printed;
    check(c, "  - { id: A, model: m.gltf, nodes: '#1', units: mm }\n  - { id: B, model: m.gltf, nodes: P-101B, units: mm, up: z }\n"
             "  - { id: C, model: m.gltf, nodes: '#1' }\n"
             "  - { id: D, model: m.gltf, nodes: '#1', units: mm, placement: { scale: 0.01 } }\n",
          "[]", "Tag Name\n", &printed);
    assert_string_equal(printed, "asset A: 0.743 x 0.4 x 0.2 m\nasset B: 0.2 x 0.1 x 0.371 m\nasset C: 743 x 400 x 200 m\n"
                                 "asset D: 0.00743 x 0.004 x 0.002 m\n");
    FOUND(c,
          { "plant.yaml", 5, 0,
            "743 x 400 x 200 m: check its units. If the numbers of the model are in mm (`units: mm`), its size is 0.7" },
          { "plant.yaml", 6, 0,
            "0.00743 x 0.004 x 0.002 m: check its units. If the numbers of the model are in mm (`units: mm`), its size is 0.7" });
    free(printed);
}

CASE(what_is_no_model_is_said_so)
{
    temp_write_text(c->folder, "s.step", "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\n");
    temp_write_text(c->folder, "o.obj", "v 0 0 0\nv 1 0 0\n");
    temp_write(c->folder, "cut.glb", "glTF\2\0\0\0\0\1\0\0\0\1\0\0JSON{", 21);
    check(c, "  - { id: A, model: s.step }\n  - { id: B, model: o.obj }\n  - { id: C, model: cut.glb }\n", "[]", "Tag Name\n", NULL);
    FOUND(c, { "plant.yaml", 3, 0,
               "s.step' is a STEP file; expected glTF 2.0 (.glb or .gltf): export the model in this format, or convert it" },
          { "plant.yaml", 4, 0, "o.obj' is not a glTF model; expected glTF 2.0 (.glb or .gltf)" },
          { "plant.yaml", 5, 0, "cut.glb' is truncated: its JSON should have 256 bytes" });
}

TEST_WITH(what_no_memory_holds_is_refused, plant_case_set_up, plant_case_tear_down)
{
    struct plant_case *c = *state;
    char *more = test_memory(mem_strdup(model)), *count = strstr(more, "\"count\":3,");
    memcpy(count, "\"count\":9", 9);
    char *huge = test_printf("%.*s000000000000000%s", (int)(count + 9 - more), more, count + 9);
    temp_write_text(c->folder, "h.gltf", huge);
    check(c, "  - { id: A, model: h.gltf, nodes: '#1', units: mm }\n  - { id: B, model: h.gltf, nodes: '#1', units: mm }\n", "[]",
          "Tag Name\n", NULL);
    FOUND(c, { "plant.yaml", 0, 0, "3000000000.00 million triangles are too many: " }); /* in memory once */
    /* a model that states 4.67 million triangles, for which preparation was measured to take 1.03 GB: it must be accepted with
       1.1 GB of memory and not with 1.0 GB */
    huge = test_printf("%.*s00000000%s", (int)(count + 8 - more), more, count + 9);
    memcpy(strstr(huge, "\"count\":") + 8, "14000000", 8);
    temp_write_text(c->folder, "h.gltf", huge);
    for (memory_bytes = 1100000000; memory_bytes >= 1000000000; memory_bytes -= 100000000) {
        plant_case_tear_down(state);
        plant_case_set_up(state);
        c = *state;
        temp_write_text(c->folder, "h.gltf", huge);
        check(c, "  - { id: A, model: h.gltf, nodes: '#1', units: mm }\n", "[]", "Tag Name\n", NULL);
        if (memory_bytes > 1000000000)
            assert_int_equal(c->diag.errors, 0);
        else
            FOUND(c, { "plant.yaml", 0, 0, "4.67 million triangles are too many: 1.00 GB of memory hold at most 4.22 million. Leave" });
    }
    memory_bytes = 0;
}

CASE(nodes_are_looked_up)
{
    check(c, "  - { id: A, model: m.gltf, units: mm }\n  - { id: B, model: m.gltf, nodes: P-102B, units: mm }\n", "[]",
          "Tag Name,Group,Asset,Node\nT1,g,A,P-101B\nT2,g,A,P101B\nT3,g,A,P-101A\nT4,g,A,#9\nT5,g,A,#3\n", NULL);
    FOUND(c, { "plant.yaml", 4, 0, "asset B: nodes: no node's name matches 'P-102B': did you mean 'P-101B'?" },
          { "tags.csv", 3, 1, "tag T2: asset A: the model has no node 'P101B': did you mean 'P-101B'?" },
          { "tags.csv", 4, 1, "tag T3: asset A: the model has 2 nodes 'P-101A', in different places (#1, #3)" },
          { "tags.csv", 5, 1, "tag T4: asset A: the model has no node '#9'" });
}

/* A node without triangles counts as located at the origin of its own frame, as in plantcast-prep. Nodes with equal names at
   the same place are no ambiguity. */
CASE(nodes_without_triangles_are_compared)
{
    temp_write_text(c->folder, "n.gltf",
                    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,1,2,3,4,5,6]}],"
                    "\"nodes\":[{\"name\":\"P\",\"mesh\":0},{\"name\":\"S\"},{\"name\":\"S\",\"translation\":[5,0,0]},"
                    "{\"name\":\"T\"},{\"name\":\"T\",\"mesh\":0},{\"name\":\"U\",\"translation\":[1,2,3]},"
                    "{\"name\":\"U\",\"translation\":[1,2,3]}],"
                    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                    "\"accessors\":[{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,1]}]}");
    check(c, "  - { id: A, model: n.gltf }\n", "[]", "Tag Name,Group,Asset,Node\nT1,g,A,S\nT2,g,A,T\nT3,g,A,U\n", NULL);
    FOUND(c, { "tags.csv", 2, 1, "tag T1: asset A: the model has 2 nodes 'S', in different places (#1, #2)" },
          { "tags.csv", 3, 1, "tag T2: asset A: the model has 2 nodes 'T', in different places (#3, #4)" });
}

CASE(transforms_that_cannot_be_prepared_are_refused)
{
    static const struct {
        const char *transform, *why;
    } transforms[] = {
        { "\"translation\":[1e16,0,0]",
          "is not valid: node 1: the node's transformation in the glTF file has numbers that are infinite, invalid or above 1e15" },
        { "\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,-1e300,0,1]",
          "is not valid: node 1: the node's transformation in the glTF file has numbers that are infinite, invalid or above 1e15" },
        { "\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,0]",
          "is not valid: node 1: the node's matrix in the glTF file is invalid: its last row is not 0 0 0 1" },
        { "\"matrix\":[1,0,0,0]", "is not valid: node 1: matrix is not 16 numbers" },
        { "\"rotation\":[0,0,0,0]",
          "is not valid: node 1: the node's rotation in the glTF file is invalid: its quaternion has length 0, expected 1" },
        { "\"rotation\":[0,0,1]", "is not valid: node 1: rotation is not 4 numbers" },
        { "\"scale\":[1,1,\"1\"]", "is not valid: node 1: scale is not 3 numbers" },
        { "\"translation\":5", "is not valid: node 1: translation is not 3 numbers" },
        { "\"mesh\":7", "is not valid: node 1: mesh: there is no mesh 7" },
        { "\"mesh\":\"0\"", "is not valid: node 1: mesh is not a whole number" },
        { "\"children\":[2]", "is not valid: node 1: children: there is no node 2" },
        { "\"skin\":0", "is not valid: node 1: skin: there is no skin 0" },
        { "\"weights\":[0,0.5]", "is not valid: node 1: Plantcast does not support morph targets: export the model without them" },
        { "\"rotation\":[0,0,2,0],\"scale\":null", NULL }, /* plantcast-prep normalises the rotation */
    };
    for (size_t i = 0; i < sizeof(transforms) / sizeof(*transforms); i++) {
        struct model_header header;
        char why[300] = "", *text = test_printf("{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"name\":\"P\"},{%s}]}",
                                                transforms[i].transform);
        char *path = temp_write_text(c->folder, "far.gltf", text);
        bool read = model_header_read(&header, path, why, sizeof(why));
        assert_string_equal(why, transforms[i].why ? transforms[i].why : "");
        assert_int_equal(read, !transforms[i].why);
        if (read)
            model_header_finish(&header);
    }
}

/* If sensor coordinates lie on the equipment only with another unit or another up axis of the model, --check must suggest
   these. */
CASE(sensors_tell_units_and_axes)
{
    static const struct {
        const char *asset, *says;
    } cases[] = {
        { "{ id: A, model: m.gltf, nodes: '#1', units: cm }", NULL },
        { "{ id: A, model: m.gltf, nodes: '#1', units: mm }",
          "3 of the 3 sensors with X, Y, Z are far from the asset; with `units: cm` in the plant file, they would be on it" },
        { "{ id: A, model: m.gltf, nodes: '#1', units: cm, up: z }", "with `up: y` in the plant file, they would be on it" },
        { "{ id: A, model: m.gltf, nodes: '#1', units: cm, placement: { translate: [99, 0, 0] } }",
          "check units, up, placement and sensor_frame" },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        char *assets = test_printf("  - %s\n", cases[i].asset);
        check(c, assets, "[]", "Tag Name,Group,Asset,X,Y,Z\nT1,g,A,1,-3.9,0.1\nT2,g,A,7,-3.8,0.2\nT3,g,A,3,-3.7,1.9\n", NULL);
        size_t found = 0;
        for (size_t k = 0; k < c->diag.count; k++)
            found += cases[i].says && strstr(c->diag.items[k].text, cases[i].says) != NULL;
        assert_int_equal(found, cases[i].says != NULL);
        assert_true(cases[i].says || c->diag.count == 0);
    }
}

CASE(series_are_looked_up)
{
    static const char assets[] = "  - { id: A, model: m.gltf, units: mm }\n";
    temp_write_text(c->folder, "wide.csv", "Time,TI_101,TI_102\n2026-10-25T00:00:00Z,1,2\n");
    temp_write_text(c->folder, "long.csv", "1000,x,pump,flow,7,,\n1000,x,pump,temp,70,,\n");
    temp_write_text(c->folder, "values.csv", "Tag,Time,Value\nT5,2026-10-25T00:00:00Z,1\n");
    temp_write_text(c->folder, "none.csv", "a,b\n1,2\n");
    check(c, assets, "[{ id: w, type: replay, file: wide.csv }, { id: l, type: replay, file: long.csv },\n"
                     "  { id: v, type: replay, file: values.csv }, { id: n, type: replay, file: none.csv }]",
          "Tag Name,Source,Address\nT1,w,TI_101\nT2,w,TI_103\nT3,l,pump/temp\nT4,l,pump/tmp\nT5,v,\nT6,v,\nT7,n,a\n", NULL);
    FOUND(c, { "plant.yaml", 6, 0, "none.csv:1: no time column: expected a name that ends in _ms, _s, _min or _h" },
          { "tags.csv", 3, 1, "wide.csv has no series 'TI_103'; did you mean 'TI_101'?" },
          { "tags.csv", 5, 1, "long.csv has no series 'pump/tmp'; did you mean 'pump/temp'?" },
          { "tags.csv", 7, 1, "values.csv has no series 'T6'; did you mean 'T5'?" });
}

/* A randomly damaged model file must be read, or refused with a reason. */
CASE(broken_models_are_refused)
{
    unsigned seed = 7;
    int read = 0;
    char *path = temp_path(c->folder, "m.gltf"), *text = test_memory(mem_strdup(model));
    size_t length = strlen(text);
    for (int round = 0; round < 2000; round++) {
        static const char signs[] = "0123456789-[]{},:\"eE.x";
        struct model_header header;
        char why[300] = "";
        memcpy(text, model, length);
        for (int i = rand_r(&seed) % 4; i >= 0; i--)
            text[(size_t)rand_r(&seed) % length] = signs[(size_t)rand_r(&seed) % (sizeof(signs) - 1)];
        temp_write_text(c->folder, "m.gltf", text);
        if (model_header_read(&header, path, why, sizeof(why))) {
            read++;
            model_header_finish(&header);
        } else {
            assert_true(*why);
        }
    }
    assert_true(read > 100 && read < 1900);
}
