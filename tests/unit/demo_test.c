/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The demo plant as its generator writes it: the same bytes each time, a plant file without a finding, the exchanger of the
   paper's size, sensors on the surfaces, and the faults that were put in on purpose. */
#include "tests/support/test.h"
/* cmocka needs those first */
#include <fnmatch.h>
#include <jansson.h>
#include <math.h>
#include <spawn.h>
#include <sys/wait.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "deploy/demo/sim_values.h"
#include "plant/plant.h"
#include "tests/support/temp.h"

extern char **environ;

static char *folder;
static struct plant *plant;
static char *glb;
static json_t *gltf;
static const char *binary;

static void generate(const char *into)
{
    const char *bin = getenv("PLANTCAST_BIN");
    char *program = mem_printf("%s/plantcast-demo", bin ? bin : "build");
    char *arguments[] = { program, (char *)into, NULL };
    pid_t child;
    int status = -1;
    assert_int_equal(posix_spawn(&child, program, NULL, NULL, arguments, environ), 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    mem_free(program);
}

static char *read_from(const char *in, const char *name, size_t *bytes)
{
    char *path = temp_path(in, name), *content = text_read_file(path, 64 << 20, bytes);
    assert_non_null(content);
    mem_free(path);
    return content;
}

static int set_up(void **state)
{
    (void)state;
    struct diag diag = { 0 };
    size_t bytes;
    uint32_t json_bytes;
    folder = temp_folder_create();
    generate(folder);
    char *path = temp_path(folder, "plant.yaml");
    plant = plant_load(path, &diag);
    diag_print(&diag, stderr);
    assert_int_equal(diag.count, 0);
    assert_non_null(plant);
    diag_finish(&diag);
    mem_free(path);
    glb = read_from(folder, "plant.glb", &bytes);
    assert_memory_equal(glb, "glTF\2\0\0\0", 8);
    memcpy(&json_bytes, glb + 12, 4);
    assert_true(json_bytes < bytes);
    gltf = json_loadb(glb + 20, json_bytes, 0, NULL);
    assert_non_null(gltf);
    binary = glb + 20 + json_bytes + 8;
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    json_decref(gltf);
    mem_free(glb);
    plant_destroy(&plant);
    temp_folder_destroy(&folder);
    return 0;
}

/* --- reading the model ------------------------------------------------------------------------------------------------------ */

static json_t *item(const char *list, json_int_t index)
{
    json_t *found = json_array_get(json_object_get(gltf, list), (size_t)index);
    assert_non_null(found);
    return found;
}

static json_int_t integer(json_t *object, const char *key)
{
    json_t *value = json_object_get(object, key);
    assert_true(json_is_integer(value));
    return json_integer_value(value);
}

static const void *accessor_data(json_int_t index, size_t *count)
{
    json_t *accessor = item("accessors", index);
    *count = (size_t)integer(accessor, "count");
    return binary + integer(item("bufferViews", integer(accessor, "bufferView")), "byteOffset");
}

static void matrix_multiply(const double a[16], const double b[16], double out[16])
{
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++) {
            out[4 * c + r] = 0;
            for (int k = 0; k < 4; k++)
                out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
        }
}

static void node_matrix(json_t *node, double out[16])
{
    json_t *matrix = json_object_get(node, "matrix"), *translation = json_object_get(node, "translation");
    for (int i = 0; i < 16; i++)
        out[i] = matrix ? json_number_value(json_array_get(matrix, (size_t)i)) : i % 5 == 0;
    for (int i = 0; i < 3 && translation; i++)
        out[12 + i] = json_number_value(json_array_get(translation, (size_t)i));
}

struct visit { /* what a walk over a sub-tree collects, in the plant frame */
    const char *wanted;           /* a node whose place is asked for */
    int found;
    double place[3];
    int primitives;
    size_t triangles;
    double (*corners)[3][3];      /* per triangle */
    size_t capacity;
};

static void to_plant(const double m[16], const float p[3], double out[3])
{
    double g[3];
    for (int i = 0; i < 3; i++)
        g[i] = m[i] * (double)p[0] + m[4 + i] * (double)p[1] + m[8 + i] * (double)p[2] + m[12 + i];
    out[0] = g[0];
    out[1] = -g[2];
    out[2] = g[1];
}

static void visit_mesh(json_int_t mesh, const double world[16], struct visit *visit)
{
    size_t index, vertices, corners;
    json_t *primitive;
    json_array_foreach(json_object_get(item("meshes", mesh), "primitives"), index, primitive)
    {
        const float(*positions)[3] = accessor_data(integer(json_object_get(primitive, "attributes"), "POSITION"), &vertices);
        const uint32_t *indices = accessor_data(integer(primitive, "indices"), &corners);
        visit->primitives++;
        mem_grow(&visit->corners, &visit->capacity, visit->triangles + corners / 3, sizeof(*visit->corners));
        for (size_t i = 0; i < corners; i++) {
            assert_true(indices[i] < vertices);
            to_plant(world, positions[indices[i]], visit->corners[visit->triangles + i / 3][i % 3]);
        }
        visit->triangles += corners / 3;
    }
}

static void visit_node(json_int_t index, const double above[16], struct visit *visit)
{
    json_t *node = item("nodes", index), *child;
    double own[16], world[16];
    size_t i;
    node_matrix(node, own);
    matrix_multiply(above, own, world);
    if (visit->wanted && !strcmp(visit->wanted, json_string_value(json_object_get(node, "name")))) {
        to_plant(world, (const float[3]){ 0, 0, 0 }, visit->place);
        visit->found++;
    }
    if (json_object_get(node, "mesh"))
        visit_mesh(integer(node, "mesh"), world, visit);
    json_array_foreach(json_object_get(node, "children"), i, child)
        visit_node(json_integer_value(child), world, visit);
}

/* The sub-tree of an asset: node 0 is the root, the assets are its children. */
static void visit_asset(const struct plant_asset *asset, struct visit *visit)
{
    double root[16];
    json_t *child;
    size_t i;
    int matches = 0;
    node_matrix(item("nodes", 0), root);
    json_array_foreach(json_object_get(item("nodes", 0), "children"), i, child)
    {
        if (fnmatch(asset->nodes, json_string_value(json_object_get(item("nodes", json_integer_value(child)), "name")), 0) != 0)
            continue;
        visit_node(json_integer_value(child), root, visit);
        matches++;
    }
    assert_int_equal(matches, 1);
}

/* --- tests ------------------------------------------------------------------------------------------------------------------ */

TEST(test_same_bytes)
{
    static const char *const names[] = { "plant.glb", "plant.yaml", "tags.csv" };
    char *again = temp_folder_create();
    generate(again);
    for (int i = 0; i < 3; i++) {
        size_t first_bytes, second_bytes;
        char *first = read_from(folder, names[i], &first_bytes), *second = read_from(again, names[i], &second_bytes);
        assert_int_equal(first_bytes, second_bytes);
        assert_memory_equal(first, second, first_bytes);
        mem_free(first);
        mem_free(second);
    }
    temp_folder_destroy(&again);
}

TEST(test_assets_and_tags)
{
    static const char *const groups[] = { "temperature", "pressure", "vibration" };
    int in_group[3] = { 0 }, well_equipped = 0;
    assert_in_range(plant->asset_count, 20, 30);
    assert_in_range(plant->tag_count, 100, 400);
    assert_true(plant->view.set);
    for (size_t i = 0; i < plant->tag_count; i++)
        for (int g = 0; g < 3; g++)
            in_group[g] += plant->tags[i].group == plant_find_group(plant, groups[g]);
    for (int g = 0; g < 3; g++)
        assert_in_range(in_group[g], 20, 400);
    for (size_t a = 0; a < plant->asset_count; a++) {
        int tags = 0;
        for (size_t i = 0; i < plant->tag_count; i++)
            tags += plant->tags[i].asset == (int)a;
        well_equipped += tags >= 3;
    }
    assert_in_range(well_equipped, 15, 30);
}

TEST(test_registers_do_not_overlap)
{
    static unsigned char used[65536];
    for (size_t i = 0; i < plant->tag_count; i++) {
        const struct plant_tag *tag = plant->tags + i;
        int registers = tag->type == DATA_FLOAT32 ? 2 : 1;
        assert_int_equal(tag->table, TABLE_HOLDING);
        assert_int_equal(tag->byte_order, registers == 2 ? BYTE_ORDER_CDAB : BYTE_ORDER_NONE);
        for (int k = 0; k < registers; k++)
            assert_int_equal(used[tag->register_index + k]++, 0);
    }
}

TEST(test_exchanger)
{
    struct visit visit = { 0 };
    int asset = plant_find_asset(plant, "E-101"), thermometers = 0;
    visit_asset(plant->assets + asset, &visit);
    assert_in_range(visit.triangles, 60000, 66000);
    assert_int_equal(visit.primitives, 5);
    for (size_t i = 0; i < plant->tag_count; i++)
        thermometers += plant->tags[i].asset == asset && plant->tags[i].group == plant_find_group(plant, "temperature");
    assert_int_equal(thermometers, 5);
    mem_free(visit.corners);
}

TEST(test_triangle_budget)
{
    size_t triangles = 0;
    for (size_t a = 0; a < plant->asset_count; a++) {
        struct visit visit = { 0 };
        visit_asset(plant->assets + a, &visit);
        assert_true(visit.triangles > 0);
        triangles += visit.triangles;
        mem_free(visit.corners);
    }
    assert_in_range(triangles, 300000, 450000);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double segment_distance(const double p[3], const double a[3], const double b[3])
{
    double ab[3], ap[3];
    for (int i = 0; i < 3; i++) {
        ab[i] = b[i] - a[i];
        ap[i] = p[i] - a[i];
    }
    double length = dot(ab, ab), t = length > 0 ? fmin(1, fmax(0, dot(ap, ab) / length)) : 0;
    for (int i = 0; i < 3; i++)
        ap[i] -= t * ab[i];
    return sqrt(dot(ap, ap));
}

/* Inside the triangle's prism: the height above its plane; else the nearest edge. */
static double triangle_distance(const double p[3], const double corner[3][3])
{
    double u[3], v[3], w[3];
    for (int i = 0; i < 3; i++) {
        u[i] = corner[1][i] - corner[0][i];
        v[i] = corner[2][i] - corner[0][i];
        w[i] = p[i] - corner[0][i];
    }
    double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), wu = dot(w, u), wv = dot(w, v), scale = uu * vv - uv * uv;
    double s = (vv * wu - uv * wv) / scale, t = (uu * wv - uv * wu) / scale;
    if (scale > 0 && s >= 0 && t >= 0 && s + t <= 1) {
        for (int i = 0; i < 3; i++)
            w[i] -= s * u[i] + t * v[i];
        return sqrt(dot(w, w));
    }
    return fmin(segment_distance(p, corner[0], corner[1]),
                fmin(segment_distance(p, corner[1], corner[2]), segment_distance(p, corner[2], corner[0])));
}

TEST(test_sensors_on_surface)
{
    int by_node = 0;
    for (size_t i = 0; i < plant->tag_count; i++) {
        const struct plant_tag *tag = plant->tags + i;
        struct visit visit = { .wanted = tag->node };
        visit_asset(plant->assets + tag->asset, &visit);
        assert_int_equal(visit.found, tag->node ? 1 : 0);
        by_node += visit.found;
        const double *place = tag->node ? visit.place : tag->position_m;
        double nearest = INFINITY;
        for (size_t t = 0; t < visit.triangles; t++)
            nearest = fmin(nearest, triangle_distance(place, (const double(*)[3])visit.corners[t]));
        if (nearest > 0.001)
            print_error("%s: %g m from the surface of %s\n", tag->name, nearest, plant->assets[tag->asset].id);
        assert_true(nearest <= 0.001);
        mem_free(visit.corners);
    }
    assert_in_range(by_node, plant->tag_count / 3, plant->tag_count * 2 / 3);
}

static int compare_triangles(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(double[3][3]));
}

/* Faults on purpose: faces that are there twice, and slivers. */
TEST(test_faults)
{
    struct visit visit = { 0 };
    size_t repeated = 0, slivers = 0;
    visit_asset(plant->assets + plant_find_asset(plant, "E-101"), &visit);
    qsort(visit.corners, visit.triangles, sizeof(*visit.corners), compare_triangles);
    for (size_t t = 0; t < visit.triangles; t++) {
        const double(*c)[3] = (const double(*)[3])visit.corners[t];
        double longest = 0, height = INFINITY;
        for (int k = 0; k < 3; k++) {
            double edge[3];
            for (int i = 0; i < 3; i++)
                edge[i] = c[(k + 1) % 3][i] - c[k][i];
            longest = fmax(longest, sqrt(dot(edge, edge)));
            height = fmin(height, segment_distance(c[k], c[(k + 1) % 3], c[(k + 2) % 3]));
        }
        slivers += longest > 100 * height;
        repeated += t > 0 && compare_triangles(visit.corners[t], visit.corners[t - 1]) == 0;
    }
    assert_in_range(repeated, 5, 1000);
    assert_in_range(slivers, 5, 5000);
    mem_free(visit.corners);
}

/* --- the process against the limits ----------------------------------------------------------------------------------------- */

enum { CALM, UPSET_KINDS = 3, CYCLE_S = 690, MACHINES = 5, RECOVERY_S = 60 };

static bool beyond(const struct plant_tag *tag, double value, enum limit low, enum limit high)
{
    return value < tag->limits[low] || value > tag->limits[high]; /* NaN: no limit */
}

/* 1..3: the upset that runs, or whose traces are still there; CALM: none. */
static int upset_now(const struct sim_values *values, int *last, int *since_s)
{
    static const char *const names[] = { "cooling water lost", "exchanger fouled", "bearing worn" };
    const char *name;
    sim_values_upset(values, &name);
    for (int u = 0; u < UPSET_KINDS; u++)
        if (!strcmp(name, names[u])) {
            *last = u + 1;
            *since_s = 0;
            return *last;
        }
    return ++*since_s <= RECOVERY_S ? *last : CALM;
}

/* In calm every tag is within its limits; an upset brings at most 12 of them beyond H or L, and some beyond HH or LL. Over as many
   cycles as there are machines, so that each has had its worn bearing. */
TEST(test_limits_fit_the_process)
{
    struct diag diag = { 0 };
    struct sim_map map = { 0 };
    struct sim_values *values = sim_values_create(plant, &map, false, &diag);
    int last = CALM, since_s = 0, most[UPSET_KINDS + 1] = { 0 }, most_far[UPSET_KINDS + 1] = { 0 };
    assert_non_null(values);
    for (int second = 0; second < MACHINES * CYCLE_S; second++) {
        sim_values_step(values, 1);
        int upset = upset_now(values, &last, &since_s), count = 0, far = 0;
        for (size_t i = 0; i < plant->tag_count; i++) {
            double value = sim_values_at(values, i);
            bool out = beyond(&plant->tags[i], value, LIMIT_L, LIMIT_H);
            if (out && upset == CALM)
                print_error("%s: %g after %d s, in calm\n", plant->tags[i].name, value, second);
            count += out;
            far += beyond(&plant->tags[i], value, LIMIT_LL, LIMIT_HH);
        }
        most[upset] = count > most[upset] ? count : most[upset];
        most_far[upset] = far > most_far[upset] ? far : most_far[upset];
    }
    assert_int_equal(most[CALM], 0);
    for (int u = 1; u <= UPSET_KINDS; u++) {
        assert_in_range(most[u], 3, 12);
        assert_in_range(most_far[u], 1, most[u]);
    }
    sim_values_destroy(&values);
    diag_finish(&diag);
}

TEST_GROUP(set_up, tear_down)
