/* SPDX-License-Identifier: GPL-3.0-or-later */
/* RVM files built byte by byte: areas and volumes compared with formulas, closed joints, and damaged files. */
#include "preprocess/import/rvm.h"

#include "tests/support/test.h"

#include "base/math/vec.h"
#include "base/text/text.h"
#include "preprocess/import/rvm_shape.h"

static const struct rvm_params params = { .chord_m = 1e-4 };

static void add_word(struct text *file, uint32_t word)
{
    const char bytes[4] = { (char)(word >> 24), (char)(word >> 16), (char)(word >> 8), (char)word };
    text_add_bytes(file, bytes, 4);
}

static void add_float(struct text *file, double number)
{
    float value = (float)number;
    uint32_t word;
    memcpy(&word, &value, 4);
    add_word(file, word);
}

static void add_string(struct text *file, const char *text)
{
    static const char zeros[4];
    size_t length = strlen(text), words = length / 4 + 1;
    add_word(file, (uint32_t)words);
    text_add_bytes(file, text, length);
    text_add_bytes(file, zeros, words * 4 - length);
}

static size_t begin(struct text *file, const char *id)
{
    size_t at = file->length;
    for (int i = 0; i < 4; i++)
        add_word(file, (uint32_t)id[i]);
    add_word(file, 0);
    add_word(file, 1);
    return at;
}

static void end(struct text *file, size_t at)
{
    uint32_t next = (uint32_t)file->length;
    for (int i = 0; i < 4; i++)
        file->at[at + 16 + (size_t)i] = (char)(next >> (24 - 8 * i));
}

static void add_head(struct text *file)
{
    size_t at = begin(file, "HEAD");
    add_word(file, 1);
    for (int i = 0; i < 4; i++)
        add_string(file, i == 1 ? "a test" : "x");
    end(file, at);
    at = begin(file, "MODL");
    add_word(file, 1);
    add_string(file, "PROJECT");
    add_string(file, "MODEL");
    end(file, at);
}

static void add_group(struct text *file, const char *name)
{
    size_t at = begin(file, "CNTB");
    add_word(file, 2);
    add_string(file, name);
    for (int i = 0; i < 3; i++)
        add_float(file, 0);
    add_word(file, 1);
    end(file, at);
}

static void end_group(struct text *file)
{
    size_t at = begin(file, "CNTE");
    add_word(file, 1);
    end(file, at);
}

static const double in_place[12] = { 0.001, 0, 0, 0, 0.001, 0, 0, 0, 0.001, 0, 0, 0 };

static size_t begin_primitive(struct text *file, const char *id, uint32_t kind, const double m[12])
{
    size_t at = begin(file, id);
    add_word(file, 1);
    add_word(file, kind);
    for (int i = 0; i < 12; i++)
        add_float(file, m[i]);
    for (int i = 0; i < 6; i++)
        add_float(file, 0);
    return at;
}

static void add_primitive(struct text *file, uint32_t kind, const double m[12], const double *numbers)
{
    size_t at = begin_primitive(file, "PRIM", kind, m);
    for (int i = 0; i < rvm_numbers[kind]; i++)
        add_float(file, numbers[i]);
    end(file, at);
}

static struct cad_model *read_with(const struct text *file, const struct rvm_params *how, struct rvm_counts *counts)
{
    char why[256];
    struct cad_model *model = cad_model_create();
    if (!rvm_read(model, file->at, file->length, how, counts, why, sizeof(why)))
        fail_msg("%s", why);
    return model;
}

static struct cad_model *read_text(const struct text *file, struct rvm_counts *counts)
{
    return read_with(file, &params, counts);
}

static double area_m2(const struct cad_node *node)
{
    double sum = 0;
    for (size_t i = 0; i < node->triangle_count; i++) {
        double n[3];
        vec_normal(node->vertices[node->triangles[i][0]].position_m, node->vertices[node->triangles[i][1]].position_m,
                   node->vertices[node->triangles[i][2]].position_m, n);
        sum += vec_length(n) / 2;
    }
    return sum;
}

static double volume_m3(const struct cad_node *node)
{
    double sum = 0;
    for (size_t i = 0; i < node->triangle_count; i++) {
        const double *a = node->vertices[node->triangles[i][0]].position_m, *b = node->vertices[node->triangles[i][1]].position_m,
                     *c = node->vertices[node->triangles[i][2]].position_m;
        sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return sum / 6;
}

/* Asserts that the normals of each triangle's corners point to the side from which the corners appear counter-clockwise. */
static void check_normals(const struct cad_node *node)
{
    for (size_t i = 0; i < node->triangle_count; i++) {
        const struct cad_vertex *v[3];
        double n[3];
        for (int k = 0; k < 3; k++)
            v[k] = &node->vertices[node->triangles[i][k]];
        vec_normal(v[0]->position_m, v[1]->position_m, v[2]->position_m, n);
        double size = vec_length(n);
        for (int k = 0; k < 3 && size > 1e-12; k++) {
            double along = (n[0] * (double)v[k]->normal[0] + n[1] * (double)v[k]->normal[1] + n[2] * (double)v[k]->normal[2]) / size;
            assert_true(along > 0.5);
        }
    }
}

static const double sphere_area = 4 * M_PI * 0.25, sphere_volume = 4 / 3.0 * M_PI * 0.125;

TEST(test_areas_and_volumes_are_those_of_the_formulas)
{
    static const double mirrored[12] = { -0.001, 0, 0, 0, 0.001, 0, 0, 0, 0.001, 5, 6, 7 };
    const struct {
        uint32_t kind;
        double numbers[RVM_MAX_NUMBERS], area, volume;
    } cases[] = {
        { RVM_BOX, { 1000, 2000, 3000 }, 22, 6 },
        { RVM_PYRAMID, { 2000, 2000, 0, 0, 0, 0, 3000 }, 4 + 4 * sqrt(10), 4 },
        { RVM_PYRAMID, { 2000, 1000, 2000, 1000, 500, 0, 3000 }, 4 + 2 * 6 + 2 * sqrt(9.25), 6 },
        { RVM_RECTANGULAR_TORUS, { 1000, 2000, 500, M_PI / 2 }, 3 * M_PI / 2 + M_PI / 4 * 3 + 1, 3 * M_PI / 8 },
        { RVM_RECTANGULAR_TORUS, { 1000, 2000, 500, 2 * M_PI }, 6 * M_PI + M_PI * 3, 3 * M_PI / 2 },
        { RVM_CIRCULAR_TORUS, { 1000, 250, M_PI / 2 }, M_PI * M_PI / 4 + M_PI / 8, M_PI * M_PI / 32 },
        { RVM_CIRCULAR_TORUS, { 1000, 250, -M_PI / 3 }, M_PI * M_PI / 6 + M_PI / 8, M_PI * M_PI / 48 },
        { RVM_ELLIPTICAL_DISH, { 500, 500 }, sphere_area / 2 + M_PI / 4, sphere_volume / 2 },
        { RVM_SPHERICAL_DISH, { 500, 500 }, sphere_area / 2 + M_PI / 4, sphere_volume / 2 },
        { RVM_SPHERICAL_DISH, { 500, 100 }, M_PI * (0.25 + 0.01) + M_PI / 4, M_PI * 0.1 / 6 * (3 * 0.25 + 0.01) },
        { RVM_CYLINDER, { 500, 2000 }, M_PI * 2 + M_PI / 2, M_PI / 2 },
        { RVM_SNOUT, { 500, 250, 2000 }, M_PI * (0.75 * sqrt(4.0625) + 0.25 + 0.0625), M_PI * 2 / 3 * (0.25 + 0.125 + 0.0625) },
        { RVM_SPHERE, { 1000 }, sphere_area, sphere_volume },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
        for (int mirror = 0; mirror < 2; mirror++) {
            struct text file = { 0 };
            struct rvm_counts counts;
            add_head(&file);
            add_group(&file, "/G");
            add_primitive(&file, cases[i].kind, mirror ? mirrored : in_place, cases[i].numbers);
            end_group(&file);
            begin(&file, "END:");
            struct cad_model *model = read_text(&file, &counts);
            double area = area_m2(&model->nodes[0]), volume = volume_m3(&model->nodes[0]);
            if (fabs(area / cases[i].area - 1) > 0.002 || fabs(volume / cases[i].volume - 1) > 0.004)
                fail_msg("case %zu, kind %u: area %.6f for %.6f, volume %.6f for %.6f", i, cases[i].kind, area, cases[i].area, volume,
                         cases[i].volume);
            check_normals(&model->nodes[0]);
            cad_model_destroy(&model);
            text_finish(&file);
        }
}

/* Counts edges with only one triangle, after merging vertices closer than a micrometre. */
static size_t open_edges(const struct cad_model *model)
{
    size_t triangles = 0, open = 0;
    for (size_t n = 0; n < model->node_count; n++)
        triangles += model->nodes[n].triangle_count;
    int64_t(*edges)[6] = mem_array(triangles * 3, sizeof(*edges));
    size_t count = 0;
    for (size_t n = 0; n < model->node_count; n++)
        for (size_t t = 0; t < model->nodes[n].triangle_count; t++)
            for (int k = 0; k < 3; k++, count++) {
                const uint32_t *corner = model->nodes[n].triangles[t];
                int64_t a[3], b[3];
                for (int axis = 0; axis < 3; axis++) {
                    a[axis] = llround(model->nodes[n].vertices[corner[k]].position_m[axis] * 1e5);
                    b[axis] = llround(model->nodes[n].vertices[corner[(k + 1) % 3]].position_m[axis] * 1e5);
                }
                bool swap = memcmp(a, b, sizeof(a)) > 0;
                memcpy(edges[count], swap ? b : a, sizeof(a));
                memcpy(edges[count] + 3, swap ? a : b, sizeof(a));
            }
    for (size_t i = 0; i < count; i++) {
        size_t same = 0;
        bool point = memcmp(edges[i], edges[i] + 3, 3 * sizeof(int64_t)) == 0;
        for (size_t k = 0; k < count && !point; k++)
            same += memcmp(edges[i], edges[k], sizeof(edges[i])) == 0;
        open += !point && same % 2 == 1;
    }
    mem_free(edges);
    return open;
}

/* A pipe run in a slanted plane: pipe, elbow, pipe, reducer, and a pipe closed by a dish. Joined together, they must form a
   closed body. */
TEST(test_a_pipe_run_is_closed)
{
    struct text *file = test_text();
    struct rvm_counts counts;
    double c = cos(0.7), s = sin(0.7);
    /* The elbow makes a quarter turn from (offset, 0, 0) to (0, offset, 0), all rotated about x by 0.7. */
    const double turned[12] = { 0.001, 0, 0, 0, 0.001 * c, 0.001 * s, 0, -0.001 * s, 0.001 * c, 0, 0, 0 };
    /* At the elbow's first end, which faces -y, lies a pipe along y, 1 m long, with its centre at (300, -500, 0) mm. */
    const double first[12] = { 0.001, 0, 0, 0, -0.001 * s, 0.001 * c, 0, -0.001 * c, -0.001 * s, 0.3, -0.5 * c, -0.5 * s };
    /* At the elbow's second end, which faces -x, follow a pipe, a reducer and a dish. */
    const double second[12] = { 0, 0.001 * c, 0.001 * s, 0, -0.001 * s, 0.001 * c, -0.001, 0, 0, -0.5, 0.3 * c, 0.3 * s };
    double third[12], fourth[12];
    memcpy(third, second, sizeof(third));
    memcpy(fourth, second, sizeof(fourth));
    third[9] = -1.2;
    fourth[9] = -1.4;
    add_head(file);
    add_group(file, "/PIPE");
    add_primitive(file, RVM_CIRCULAR_TORUS, turned, (double[]){ 300, 100, M_PI / 2 });
    add_group(file, "/PIPE/1");
    add_primitive(file, RVM_CYLINDER, first, (double[]){ 100, 1000 });
    end_group(file);
    add_group(file, "/PIPE/2");
    add_primitive(file, RVM_CYLINDER, second, (double[]){ 100, 1000 });
    add_primitive(file, RVM_SNOUT, third, (double[]){ 100, 50, 400, 0, 0, 0, 0, 0, 0 });
    add_primitive(file, RVM_ELLIPTICAL_DISH, fourth, (double[]){ 50, 25 });
    end_group(file);
    end_group(file);
    begin(file, "END:");
    struct cad_model *model = read_text(file, &counts);
    assert_int_equal(counts.primitives, 5);
    assert_int_equal(counts.covered_faces, 8);
    assert_int_equal(open_edges(model), 0);
    assert_int_equal(model->node_count, 3);
    assert_string_equal(model->nodes[2].name, "/PIPE/2");
    assert_int_equal(model->nodes[2].parent, 0);
    cad_model_destroy(&model);
}

TEST(test_a_polygon_keeps_its_hole)
{
    struct text *file = test_text();
    struct rvm_counts counts;
    static const double outer[4][2] = { { 0, 0 }, { 2000, 0 }, { 2000, 2000 }, { 0, 2000 } };
    static const double inner[4][2] = { { 500, 500 }, { 500, 1500 }, { 1500, 1500 }, { 1500, 500 } };
    add_head(file);
    add_group(file, "/G");
    size_t at = begin_primitive(file, "PRIM", RVM_FACETS, in_place);
    add_word(file, 1);
    add_word(file, 2);
    for (int contour = 0; contour < 2; contour++) {
        add_word(file, 4);
        for (int i = 0; i < 4; i++)
            for (int number = 0; number < 6; number++)
                add_float(file, number < 2 ? (contour ? inner : outer)[i][number] : number == 5);
    }
    end(file, at);
    end_group(file);
    begin(file, "END:");
    struct cad_model *model = read_text(file, &counts);
    assert_true(fabs(area_m2(&model->nodes[0]) - 3) < 1e-6);
    assert_true((double)model->nodes[0].vertices[0].normal[2] > 0.99);
    cad_model_destroy(&model);
}

TEST(test_what_is_not_shown_is_named)
{
    struct text *file = test_text();
    struct rvm_counts counts;
    add_head(file);
    add_group(file, "/G");
    for (int i = 0; i < 2; i++) {
        size_t at = begin_primitive(file, i ? "OBST" : "INSU", RVM_BOX, in_place);
        add_word(file, 50U << 24);
        for (int side = 0; side < 3; side++)
            add_float(file, 100);
        end(file, at);
    }
    size_t at = begin_primitive(file, "PRIM", 99, in_place);
    end(file, at);
    at = begin(file, "WHAT");
    add_string(file, "is this");
    end(file, at);
    add_primitive(file, RVM_SPHERE, in_place, (double[]){ 0 });
    add_primitive(file, RVM_BOX, in_place, (double[]){ NAN, 1, 1 });
    end_group(file);
    end_group(file); /* one too many */
    add_group(file, "/H");
    add_primitive(file, RVM_CYLINDER, in_place, (double[]){ 50, 0 });
    add_primitive(file, RVM_CYLINDER, in_place, (double[]){ -50, 100 });
    end_group(file);
    struct text *said = test_text();
    struct rvm_params naming = params;
    naming.findings = said;
    struct cad_model *model = read_with(file, &naming, &counts);
    assert_int_equal(counts.unknown_kinds, 1);
    assert_string_equal(counts.unknown_chunk, "WHAT at byte 512");
    assert_int_equal(counts.empty, 3);
    assert_int_equal(model->nodes[0].triangle_count, 0);
    assert_string_equal(said->at, "lost\tbyte 408\t/G\tgroup\t\t3 of the 3 primitives of the group are left out: primitive at byte 408: "
                                  "Plantcast does not know this kind of RVM primitive\n"
                                  "error\t1\tRVM: /H: 1 of the 2 primitives of the group is left out: cylinder at byte 992: "
                                  "the primitive's dimensions in the RVM file are zero, negative or contradictory\n"
                                  "left out: 1 obstruction volume of /G\nleft out: 1 insulation volume of /G\n");
    cad_model_destroy(&model);
}

TEST(test_names_that_are_not_utf8_are_latin1)
{
    struct text *file = test_text();
    struct rvm_counts counts;
    add_head(file);
    add_group(file, "/PI\xc8"
                     "CE\x07");
    end_group(file);
    struct cad_model *model = read_text(file, &counts);
    assert_string_equal(model->nodes[0].name, "/PIÈCE ");
    cad_model_destroy(&model);
}

TEST(test_a_long_name_stays_whole)
{
    struct text *file = test_text(), *name = test_text();
    struct rvm_counts counts;
    while (name->length < 5000)
        text_add(name, "펌");
    add_head(file);
    add_group(file, name->at);
    end_group(file);
    struct cad_model *model = read_text(file, &counts);
    assert_string_equal(model->nodes[0].name, name->at);
    cad_model_destroy(&model);
}

/* Damaged RVM files: cut off at each byte, or with one of the first 4,096 bytes set to 255. Each must be read completely or
   refused with the position of the faulty byte. */
TEST(test_broken_files_are_refused_at_a_byte)
{
    struct text *file = test_text();
    struct rvm_counts counts;
    size_t refused = 0;
    add_head(file);
    for (int i = 0; i < 6; i++) {
        add_group(file, "/GROUP");
        add_primitive(file, RVM_CYLINDER, in_place, (double[]){ 100, 1000 });
    }
    for (int i = 0; i < 6; i++)
        end_group(file);
    size_t end_mark = file->length + 16; /* length of the file up to and including the name of the chunk END */
    begin(file, "END:");
    for (size_t i = 0; i < 2 * file->length; i++) {
        size_t length = i < file->length ? i : file->length;
        char *copy = malloc(length + 1), why[256]; /* exactly sized, so that the sanitizer detects an overrun */
        assert_non_null(copy);
        memcpy(copy, file->at, length);
        if (i >= file->length)
            copy[i - file->length] = (char)0xff;
        struct cad_model *model = cad_model_create();
        if (!rvm_read(model, copy, length, &params, &counts, why, sizeof(why))) {
            assert_true(strncmp(why, "byte ", 5) == 0);
            refused++;
        } else if (length < end_mark) {
            assert_true(counts.no_end);
        } else if (i < file->length) {
            assert_false(counts.no_end);
        }
        cad_model_destroy(&model);
        free(copy);
    }
    assert_true(refused > file->length);
}
