/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models and sensors that are difficult for the field, prepared by plantcast-prep. For any readings, the finest level must be
   within one colour step (1/255 of the range), or the report must name the asset and its error. All shapes are plates, whose
   exact values have a formula. Plates and points are random, by default from one seed. tests/bench/notes/awkward.md names seeds
   that exceed a limit. */
#include "tests/support/test.h"
#include <jansson.h>

#include "base/math/search.h"
#include "preprocess/cache/folder.h"
#include "protocol/asset_distance.h"
#include "tests/support/glb.h"
#include "tests/support/prep_case.h"

#define STEP (1 / 255.0)
#define POINTS 20000      /* number of random points that are checked per distance method */
#define FEW 4             /* number of random points whose error may exceed the limit in a case without a reach */
#define FEW_AT_RIMS 1000  /* where reaches end, */
#define MOST_STEPS 4.0    /* limit for the error at any point, in colour steps (1/255 of the range) */
#define ROUNDING 1.1      /* factor on the allowed error, because distances are rounded to floats */
/* factor: the error that the report names is measured at sample points, and between these the error may be this many times as
   large */
#define NAMED 2.0
#define LEAST_M 1e-5      /* metres; at a distance below this, a sensor gets all the weight, as in server/field */
#define RIM_OF_REACH 0.05 /* as a fraction of the reach: points this close to the border of the area with data are not compared */
#define MOST 4096         /* maximum number of sensors, vertices and triangles of a case */

/* How the distances in a point's true value are computed. FROM_CORNERS: from the prepared distances of the triangle's corners
   (server/field/layout.h), so that errors of prepared distances do not count. EXACT: straight on the plate */
enum truth { STRAIGHT, FROM_CORNERS, EXACT, TRUTHS };

struct awkward {
    struct prep_case *files;
    double vertices_m[MOST][2], sensors_m[MOST][2];
    uint32_t triangles[MOST][3];
    size_t vertex_count, triangle_count, sensor_count;
    double power, reach_m; /* reach_m: INFINITY: none */
};

static uint64_t seed;

static double chance(double low, double high)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(seed >> 11) * 0x1p-53;
}

static uint32_t add_vertex(struct awkward *a, double x, double y)
{
    assert_true(a->vertex_count < MOST);
    a->vertices_m[a->vertex_count][0] = x;
    a->vertices_m[a->vertex_count][1] = y;
    return (uint32_t)a->vertex_count++;
}

static void add_triangle(struct awkward *a, uint32_t i, uint32_t j, uint32_t k)
{
    const uint32_t v[3] = { i, j, k };
    assert_true(a->triangle_count < MOST);
    memcpy(a->triangles[a->triangle_count++], v, sizeof(v));
}

static void add_sensor(struct awkward *a, double x, double y)
{
    assert_true(a->sensor_count < MOST);
    a->sensors_m[a->sensor_count][0] = x;
    a->sensors_m[a->sensor_count++][1] = y;
}

/* Makes a plate of about 6 m x 4 m from nine triangles, which share a random vertex near its middle. */
static void make_plate(struct awkward *a)
{
    double wide_m = chance(5, 7), high_m = chance(3, 5), t = chance(0.3, 0.7);
    const double rim[9][2] = { { 0, 0 },
                               { t * wide_m, 0 },
                               { wide_m, 0 },
                               { wide_m, t * high_m },
                               { wide_m, high_m },
                               { t * wide_m, high_m },
                               { 0.1 * wide_m, high_m },
                               { 0, high_m },
                               { 0, t * high_m } };
    *a = (struct awkward){ .files = a->files, .power = 2, .reach_m = INFINITY };
    uint32_t middle = add_vertex(a, chance(0.4, 0.6) * wide_m, chance(0.4, 0.6) * high_m), first = middle + 1;
    for (int i = 0; i < 9; i++)
        add_vertex(a, rim[i][0], rim[i][1]);
    for (uint32_t i = 0; i < 9; i++)
        add_triangle(a, middle, first + i, first + (i + 1) % 9);
}

static void scatter_sensors(struct awkward *a, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const double y = chance(0, 3), x = chance(0, 5); /* in this order with every compiler */
        add_sensor(a, x, y);
    }
}

/* --- preparing ------------------------------------------------------------------------------------------------------------------ */

static void write_model(const struct awkward *a)
{
    struct text *bin = test_text();
    size_t size;
    for (size_t v = 0; v < a->vertex_count; v++)
        text_add_bytes(bin, (const float[3]){ (float)a->vertices_m[v][0], (float)a->vertices_m[v][1], 0 }, 3 * sizeof(float));
    text_add_bytes(bin, a->triangles, a->triangle_count * sizeof(*a->triangles));
    char *json = test_printf(
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":%zu}],"
        "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"name\":\"plate\",\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":"
        "{\"POSITION\":0},\"indices\":1}]}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":%zu,"
        "\"type\":\"VEC3\"},{\"bufferView\":0,\"byteOffset\":%zu,\"componentType\":5125,\"count\":%zu,\"type\":\"SCALAR\"}]}",
        bin->length, bin->length, a->vertex_count, 12 * a->vertex_count, 3 * a->triangle_count);
    char *glb = test_memory(glb_build(json, bin->at, bin->length, &size));
    temp_write(a->files->folder, "model.glb", glb, size);
}

static void write_plant(const struct awkward *a)
{
    struct text *tags = test_text();
    char *reach = test_memory(a->reach_m < INFINITY ? mem_printf(", reach_m: %.9g", a->reach_m) : mem_strdup(""));
    char *yaml = test_printf("plant: { name: Awkward }\ngroups: [{ id: t, unit: K, min: 0, max: 1, power: %.9g%s }]\ntags: tags.csv\n"
                            "assets: [{ id: A, model: model.glb, nodes: plate, up: z }]\n",
                            a->power, reach);
    prep_case_plant(a->files, yaml);
    text_add(tags, "Tag Name,Group,Asset,X,Y,Z\n");
    for (size_t s = 0; s < a->sensor_count; s++)
        text_add(tags, "S%zu,t,A,%.9g,%.9g,0\n", s, a->sensors_m[s][0], a->sensors_m[s][1]);
    temp_write_text(a->files->folder, "tags.csv", tags->at);
}

/* errors of an asset's finest level that the report of the preparation names, in colour steps; 0: the report names none */
struct named {
    /* worth_a_look: error in the report's list of assets to look at; beside_rims: error in the report's table, which also
       includes edges that are too short to cut and edges at the border of the data */
    double worth_a_look, beside_rims;
    double by_power;                  /* error for distances along the surface and interpolation with a high power */
};

/* Returns the error in colour steps that the report names for an interpolation with a high power of distances along the
   surface; 0: it names none. */
static double steps_by_power(const json_t *look_at)
{
    size_t i;
    const json_t *item;
    json_array_foreach(look_at, i, item)
    {
        const char *said = strstr(json_string_value(json_object_get(item, "text")), "may err by up to ");
        if (said)
            return strtod(said + strlen("may err by up to "), NULL);
    }
    return 0;
}

static struct named prepare(const struct awkward *a, struct folder_file *file)
{
    uint64_t key;
    char why[200], *folder = temp_path(a->files->folder, "plant.prepared");
    write_model(a);
    write_plant(a);
    prep_case_expect(a->files, "$PLANT --report json", 0);
    json_t *report = prep_case_json(&a->files->out);
    const char *text = json_string_value(json_object_get(json_array_get(json_object_get(report, "look_at"), 0), "text"));
    struct named named = { .beside_rims = fmax(prep_case_number(report, "assets.0.levels.0.steps_by_length"),
                                               prep_case_number(report, "assets.0.levels.0.steps_by_jumps")) };
    if (text && strstr(text, "values err by up to"))
        named.worth_a_look = prep_case_number(report, "assets.0.levels.0.steps_by_triangles");
    named.by_power = steps_by_power(json_object_get(report, "look_at"));
    prep_case_file(a->files, ".asset", &key);
    assert_int_equal(folder_open(file, folder, key, why), 1);
    assert_true(folder_unpack(file));
    return named;
}

/* --- truth ---------------------------------------------------------------------------------------------------------------------- */

static double nearest_m(const struct awkward *a, const double *distance_m)
{
    double near_m = INFINITY;
    for (size_t s = 0; s < a->sensor_count; s++)
        near_m = fmin(near_m, distance_m[s]);
    return near_m;
}

/* Computes the Shepard weights of all sensors from their distances, as server/field defines them. If the point is beyond every
   sensor's reach, the nearest sensor gets all the weight. */
static void weights_of(const struct awkward *a, const double *distance_m, double *weights)
{
    double near_m = fmax(nearest_m(a, distance_m), LEAST_M), sum = 0;
    for (size_t s = 0; s < a->sensor_count; s++) {
        double far_m = fmax(distance_m[s], LEAST_M);
        weights[s] = pow(near_m / far_m, a->power);
        if (a->reach_m < INFINITY && far_m > near_m)
            weights[s] *= far_m < a->reach_m ? pow((a->reach_m - far_m) / (a->reach_m - near_m), 2) : 0;
        sum += weights[s];
    }
    for (size_t s = 0; s < a->sensor_count; s++)
        weights[s] /= sum;
}

static void distances_from(const struct awkward *a, const struct asset_view *view, const double at[2], double *distance_m)
{
    for (size_t s = 0; s < a->sensor_count; s++)
        distance_m[s] = hypot(at[0] - (double)view->sensors[s].surface_m[0], at[1] - (double)view->sensors[s].surface_m[1]);
}

static const struct asset_primitive *finest(const struct asset_view *view)
{
    return &view->primitives[view->levels[0].first_primitive];
}

static double area_of(const struct asset_view *view, const uint32_t v[3])
{
    const float *p = view->positions_m[v[0]], *q = view->positions_m[v[1]], *r = view->positions_m[v[2]];
    double ax = (double)q[0] - (double)p[0], ay = (double)q[1] - (double)p[1], bx = (double)r[0] - (double)p[0],
           by = (double)r[1] - (double)p[1];
    return fabs(ax * by - ay * bx) / 2;
}

/* Returns the running sums of the areas of the finest level's triangles, in which triangles without data have area 0. The
   caller frees the array (mem_free). */
static double *sum_areas(const struct awkward *a, const struct asset_view *view)
{
    size_t count = finest(view)->index_count / 3;
    double *areas = mem_array(count, sizeof(*areas)), sum = 0, distance_m[MOST];
    for (size_t t = 0; t < count; t++) {
        const uint32_t *v = view->indices + finest(view)->first_index + 3 * t;
        bool any = false;
        for (int c = 0; c < 3 && !any; c++) {
            const float *p = view->positions_m[v[c]];
            distances_from(a, view, (const double[2]){ (double)p[0], (double)p[1] }, distance_m);
            any = nearest_m(a, distance_m) < a->reach_m;
        }
        areas[t] = sum += any ? area_of(view, v) : 0;
    }
    return areas;
}

/* Chooses a random triangle, each with a probability proportional to its area. areas: from sum_areas(). */
static const uint32_t *triangle_somewhere(const struct asset_view *view, const double *areas)
{
    size_t low = 0, high = finest(view)->index_count / 3 - 1;
    double at = chance(0, areas[high]);
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (areas[middle] < at)
            low = middle + 1;
        else
            high = middle;
    }
    return view->indices + finest(view)->first_index + 3 * low;
}

/* Computes the sensors' distances from a point of a triangle from those of its corners, as server/field does. part: barycentric
   coordinates of the point */
static void distances_inside(const struct awkward *a, const struct asset_view *view, const uint32_t v[3], const double part[3],
                             const double at[2], const double (*corners_m)[MOST], double *distance_m)
{
    for (size_t s = 0; s < a->sensor_count; s++) {
        double square_m2 = 0, least_m = 0, most_m = INFINITY;
        for (int c = 0; c < 3; c++) {
            double far_m = corners_m[c][s],
                   away_m = hypot(at[0] - (double)view->positions_m[v[c]][0], at[1] - (double)view->positions_m[v[c]][1]);
            square_m2 += part[c] * (far_m * far_m - away_m * away_m);
            least_m = fmax(least_m, far_m - away_m);
            most_m = fmin(most_m, far_m + away_m);
        }
        distance_m[s] = fmin(fmax(sqrt(fmax(square_m2, 0)), least_m), most_m);
    }
}

/* Returns the largest error at a random point of the triangle that any readings can cause, as a share of the range. Returns 0
   if there is no data, or almost none. */
static double error_in(const struct awkward *a, const struct asset_view *view, const uint32_t v[3], enum truth kind)
{
    static double corners_m[3][MOST], weights[MOST], shown[MOST], truth[MOST];
    double u = chance(0, 1), w = chance(0, 1), at[2] = { 0 }, above = 0, below = 0;
    const double part[3] = { u + w > 1 ? u + w - 1 : 1 - u - w, u + w > 1 ? 1 - u : u, u + w > 1 ? 1 - w : w };
    memset(shown, 0, a->sensor_count * sizeof(*shown));
    for (int c = 0; c < 3; c++) {
        const double corner[2] = { (double)view->positions_m[v[c]][0], (double)view->positions_m[v[c]][1] };
        distances_from(a, view, corner, corners_m[c]);
        for (size_t s = 0; s < a->sensor_count && kind != STRAIGHT; s++)
            corners_m[c][s] = (double)asset_distance_m(view, s, v[c]);
        weights_of(a, corners_m[c], weights);
        for (size_t s = 0; s < a->sensor_count; s++)
            shown[s] += part[c] * weights[s];
        at[0] += part[c] * corner[0];
        at[1] += part[c] * corner[1];
    }
    distances_from(a, view, at, truth);
    if (nearest_m(a, truth) > (1 - RIM_OF_REACH) * a->reach_m)
        return 0;
    if (kind == FROM_CORNERS)
        distances_inside(a, view, v, part, at, (const double(*)[MOST])corners_m, truth);
    weights_of(a, truth, truth);
    for (size_t s = 0; s < a->sensor_count; s++)
        *(shown[s] > truth[s] ? &above : &below) += fabs(shown[s] - truth[s]);
    return fmax(above, below);
}

/* Asserts that all errors but a few are at most `steps` colour steps, or that the report names the asset with an error that is
   large enough. */
static void assert_errors(const struct awkward *a, double *errors, const char *name, double steps, const struct named *named)
{
    const size_t few = a->reach_m < INFINITY ? FEW_AT_RIMS : FEW;
    const double worst_named = a->reach_m < INFINITY ? fmax(named->worth_a_look, named->beside_rims) : named->worth_a_look;
    size_t over = 0;
    qsort(errors, POINTS, sizeof(*errors), compare_doubles);
    while (over < POINTS && errors[POINTS - 1 - over] > steps * ROUNDING)
        over++;
    print_message("# %s: %zu of %d places err by more than %.0f steps, the worst by %.2f; %.2f named\n", name, over, POINTS, steps,
                  errors[POINTS - 1], worst_named);
    if ((over > few && errors[POINTS - 1] > NAMED * named->worth_a_look) ||
        errors[POINTS - 1] > fmax(MOST_STEPS * steps, NAMED * worst_named))
        fail_msg("%s: it is not named", name);
}

static struct named assert_true_or_named(const struct awkward *a)
{
    static double errors[TRUTHS][POINTS];
    struct folder_file file;
    struct named named = prepare(a, &file);
    double *areas = sum_areas(a, &file.view);
    for (int kind = 0; kind < TRUTHS; kind++)
        for (size_t i = 0; i < POINTS; i++)
            errors[kind][i] = error_in(a, &file.view, triangle_somewhere(&file.view, areas), (enum truth)kind) / STEP;
    mem_free(areas);
    folder_close(&file);
    assert_errors(a, errors[STRAIGHT], "straight distances", 1, &named);
    assert_errors(a, errors[FROM_CORNERS], "geodesic distances", fmax(1, named.by_power), &named);
    assert_errors(a, errors[EXACT], "geodesic distances, compared with exact ones", fmax(1, named.by_power), &named);
    return named;
}

TEST_WITH(edges_longer_than_the_reach, prep_case_set_up, prep_case_tear_down)
{
    struct awkward a = { .files = *state };
    make_plate(&a);
    scatter_sensors(&a, 5);
    a.reach_m = chance(0.3, 0.6);
    assert_true_or_named(&a);
}

TEST_WITH(a_reach_shorter_than_the_sampling, prep_case_set_up, prep_case_tear_down)
{
    struct awkward a = { .files = *state };
    make_plate(&a);
    a.reach_m = chance(0.02, 0.04);
    double x = chance(1, 4), y = chance(1, 2);
    for (int i = 0; i < 8; i++)
        add_sensor(&a, x + chance(0, 3 * a.reach_m), y + chance(0, 3 * a.reach_m));
    assert_true_or_named(&a);
}

TEST_WITH(triangles_without_area, prep_case_set_up, prep_case_tear_down)
{
    struct awkward a = { .files = *state };
    make_plate(&a);
    for (int i = 0; i < 40; i++) {
        uint32_t v = (uint32_t)chance(0, 10), w = (uint32_t)chance(0, 10);
        double t = chance(0, 1);
        const double *p = a.vertices_m[v], *q = a.vertices_m[w];
        uint32_t between = add_vertex(&a, p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1]));
        add_triangle(&a, v, w, i % 3 ? between : v);
    }
    scatter_sensors(&a, 5);
    assert_true_or_named(&a);
}

TEST_WITH(sensors_on_an_edge_a_vertex_and_beside, prep_case_set_up, prep_case_tear_down)
{
    static const double hairs_m[] = { 0, 1e-6, 1e-5, 1e-4, 1e-3 };
    for (int beside = 0; beside < 2; beside++) {
        struct awkward a = { .files = *state };
        make_plate(&a);
        const double *p = a.vertices_m[0], *q = a.vertices_m[5];
        for (size_t i = 0; i < sizeof(hairs_m) / sizeof(*hairs_m); i++) {
            const double *r = a.vertices_m[1 + 2 * i % 9];
            double t = chance(0.2, 0.8), hair_m = hairs_m[i];
            if (beside)
                add_sensor(&a, p[0] + t * (q[0] - p[0]) + hair_m, p[1] + t * (q[1] - p[1]) + hair_m);
            else
                add_sensor(&a, r[0] + (r[0] > p[0] ? -hair_m : hair_m), r[1] + (r[1] > p[1] ? -hair_m : hair_m));
        }
        assert_true_or_named(&a);
    }
}

TEST_WITH(two_sensors_at_one_place, prep_case_set_up, prep_case_tear_down)
{
    struct awkward a = { .files = *state };
    make_plate(&a);
    scatter_sensors(&a, 4);
    add_sensor(&a, a.sensors_m[0][0], a.sensors_m[0][1]);
    add_sensor(&a, a.sensors_m[1][0] + 1e-4, a.sensors_m[1][1]);
    assert_true_or_named(&a);
}

TEST_WITH(power_of_16, prep_case_set_up, prep_case_tear_down)
{
    struct awkward a = { .files = *state };
    make_plate(&a);
    scatter_sensors(&a, 6);
    a.power = 16;
    assert_true(assert_true_or_named(&a).by_power > 4);
}

TEST_WITH(hundreds_of_sensors_on_nine_triangles, prep_case_set_up, prep_case_tear_down)
{
    struct awkward a = { .files = *state };
    make_plate(&a);
    scatter_sensors(&a, 300);
    assert_true(assert_true_or_named(&a).worth_a_look > 1);
}

/* Thousands of sensors on nine triangles, far too many to show exactly. Comparing all points would take too long, so the test
   only asserts that the report names the asset. */
TEST_WITH(thousands_of_sensors_on_nine_triangles, prep_case_set_up, prep_case_tear_down)
{
    struct awkward a = { .files = *state };
    struct folder_file file;
    make_plate(&a);
    scatter_sensors(&a, (size_t)sweep(4096, 1024));
    struct named named = prepare(&a, &file);
    print_message("# %zu sensors: %.1f steps named\n", a.sensor_count, named.worth_a_look);
    assert_true(named.worth_a_look > 1);
    folder_close(&file);
}

int main(void)
{
    seed = sweep_seed();
    return tests_run(NULL);
}
