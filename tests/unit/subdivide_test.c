/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Subdivision of an asset's triangles for its field: a few huge triangles must show the same field as a fine mesh, sensors must
   be vertices, and no cracks may open. The expected field is computed in doubles from exact distances. */
#include "tests/support/test.h"

#include "base/math/search.h"
#include "base/math/vec.h"
#include "preprocess/geometry/welded_positions.h"
#include "preprocess/subdivision/subdivide.h"
#include "protocol/asset_distance.h"
#include "surface/mesh/bvh.h"
#include "surface/mesh/trimesh.h"
#include "tests/support/geometry_case.h"

#define PI 3.14159265358979323846
#define SENSORS 6

struct prepared_body { /* an asset prepared by this test; its sensors belong to two groups */
    struct geometry g;
    struct plant plant;
    struct plant_sensor sensors[SENSORS];
    struct asset_sensor places[SENSORS];
    struct surface *surface;
    struct surface_field field;
    /* true: for shapes whose distances have no formula, the expected field uses distances solved at the very point */
    bool as_solved;
    struct levels levels;
    float *distances; /* distances of all vertices after subdivision */
    uint32_t own_vertices;
    double (*distance)(const double a[3], const double b[3]); /* formula of the distance along this shape's surface */
    size_t own_triangles;
    double radius_m[2][2]; /* paper's: [group][geodesic] */
    double reach_m[2];     /* by group: reach of its sensors in metres; 0: unlimited */
};

static double random_unit(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (*seed >> 8) / 16777216.0;
}

static uint32_t add_vertex(struct geometry *g, double x, double y, double z, double nx, double ny, double nz)
{
    const float p[3] = { (float)x, (float)y, (float)z }, n[3] = { (float)nx, (float)ny, (float)nz };
    memcpy(g->positions_m[g->vertex_count], p, sizeof(p));
    memcpy(g->normals[g->vertex_count], n, sizeof(n));
    return g->vertex_count++;
}

static void add_triangle(struct geometry *g, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t v[3] = { a, b, c };
    memcpy(g->indices + g->index_count, v, sizeof(v));
    g->index_count += 3;
    g->primitives[0].index_count = g->index_count;
}

static double along_plate(const double a[3], const double b[3])
{
    return vec_distance(a, b);
}

/* Returns the distance on a cylinder of radius 1 about the z axis, along the shorter way around. */
static double along_cylinder(const double a[3], const double b[3])
{
    double turn = fabs(atan2(a[1], a[0]) - atan2(b[1], b[0]));
    return hypot(a[2] - b[2], fmin(turn, 2 * PI - turn));
}

/* Makes a plate of 6 m x 4 m from 9 triangles: a fan of 7 around an off-centre point, one of whose edges has a vertex in the
   middle, which adds two. */
static void make_plate(struct prepared_body *body)
{
    static const double rim[7][2] = { { 0, 0 }, { 6, 0 }, { 6, 2 }, { 6, 4 }, { 3.5, 4 }, { 0, 4 }, { 0, 2.5 } };
    struct geometry *g = &body->g;
    geometry_begin(g, 10000, 10000);
    uint32_t middle = add_vertex(g, 2.7, 1.8, 0, 0, 0, 1), first = middle + 1;
    for (int i = 0; i < 7; i++)
        add_vertex(g, rim[i][0], rim[i][1], 0, 0, 0, 1);
    uint32_t half = add_vertex(g, 1.35, 2.15, 0, 0, 0, 1);
    for (uint32_t i = 0; i < 5; i++)
        add_triangle(g, middle, first + i, first + i + 1);
    add_triangle(g, middle, first + 5, half);
    add_triangle(g, half, first + 5, first + 6);
    add_triangle(g, middle, half, first);
    add_triangle(g, half, first + 6, first);
    body->distance = along_plate;
}

/* Makes an open cylinder of radius 1 and length 5 m; vertices at the seam are duplicated. */
static void make_cylinder(struct prepared_body *body, uint32_t around, uint32_t rings)
{
    struct geometry *g = &body->g;
    geometry_begin(g, (size_t)(around + 1) * (rings + 1), 2 * (size_t)around * rings);
    for (uint32_t i = 0; i <= around; i++)
        for (uint32_t j = 0; j <= rings; j++) {
            double a = 2 * PI * (i % around) / around, x = cos(a), y = sin(a);
            add_vertex(g, x, y, 5.0 * j / rings, x, y, 0);
        }
    for (uint32_t i = 0; i < around; i++)
        for (uint32_t j = 0; j < rings; j++) {
            uint32_t a = i * (rings + 1) + j, b = a + rings + 1;
            add_triangle(g, a, b, b + 1);
            add_triangle(g, a, b + 1, a + 1);
        }
    body->distance = along_cylinder;
}

static void make_plant(struct prepared_body *body)
{
    struct plant *plant = &body->plant;
    plant->groups = mem_array(2, sizeof(*plant->groups));
    plant->tags = mem_array(SENSORS, sizeof(*plant->tags));
    plant->group_count = 2;
    plant->tag_count = SENSORS;
    plant->groups[0] = (struct plant_group){ .max = 1, .power = 2, .reach_m = INFINITY };
    plant->groups[1] = (struct plant_group){ .max = 1, .power = 3, .radius_m = 4, .reach_m = INFINITY };
    for (int g = 0; g < 2; g++)
        if (body->reach_m[g] > 0)
            plant->groups[g].reach_m = body->reach_m[g];
    for (int i = 0; i < SENSORS; i++) {
        plant->tags[i] = (struct plant_tag){ .group = i >= 4, .strength = i == 1 ? 2 : 1, .decay = i == 2 ? 2 : 1 };
        body->sensors[i].tag = i;
    }
}

static void finish(struct prepared_body *body)
{
    surface_field_finish(&body->field);
    surface_destroy(&body->surface);
    levels_finish(&body->levels);
    geometry_finish(&body->g);
    mem_free(body->distances);
    mem_free(body->plant.groups);
    mem_free(body->plant.tags);
}

static double nearest(const struct prepared_body *body, int group, const double *distance_m)
{
    double near_m = INFINITY;
    for (int i = 0; i < SENSORS; i++)
        if (body->plant.tags[i].group == group)
            near_m = fmin(near_m, distance_m[i]);
    return near_m;
}

/* Returns the field's value from distances to sensors that read 0 or 1 (bits of `readings`). paper: Algorithm 1 of the paper,
   otherwise Shepard. Where no sensor reaches, only the nearest one counts. */
static double field(const struct prepared_body *body, int group, bool paper, const double *distance_m, double radius_m, unsigned readings)
{
    double value = 0, weight = 0, near_m = nearest(body, group, distance_m), reach_m = body->plant.groups[group].reach_m;
    for (int i = 0; i < SENSORS; i++) {
        const struct plant_tag *tag = &body->plant.tags[i];
        if (tag->group != group)
            continue;
        double v = readings >> i & 1, d = fmax(0, 1 - distance_m[i] / radius_m);
        if (!paper && distance_m[i] < 1e-6)
            return v;
        double w = paper ? exp(d * tag->strength) : tag->strength / pow(distance_m[i], body->plant.groups[group].power);
        if (isfinite(reach_m) && distance_m[i] > near_m)
            w = distance_m[i] < reach_m ? w * pow((reach_m - distance_m[i]) / (reach_m - near_m), 2) : 0;
        weight += w;
        value += w * v * (paper ? pow(d, tag->decay) : 1);
    }
    return value / weight;
}

static void true_distances(const struct prepared_body *body, const double p[3], bool geodesic, double *out)
{
    float solved_m[SENSORS];
    struct surface_point hit;
    if (geodesic && body->as_solved) {
        surface_find_point(body->surface, p, NULL, &hit);
        surface_field_at_point(&body->field, body->surface, &hit, solved_m);
    }
    for (int i = 0; i < SENSORS; i++) {
        const float *s = body->places[i].surface_m;
        const double at[3] = { (double)s[0], (double)s[1], (double)s[2] };
        out[i] = !geodesic ? vec_distance(p, at) : body->as_solved ? (double)solved_m[i] : body->distance(p, at);
    }
}

static double largest(const struct prepared_body *body, int group, bool geodesic)
{
    double most = 0;
    for (uint32_t v = 0; v < body->own_vertices; v++) {
        const float *q = body->g.positions_m[v];
        double distance_m[SENSORS];
        true_distances(body, (const double[3]){ (double)q[0], (double)q[1], (double)q[2] }, geodesic, distance_m);
        for (int i = 0; i < SENSORS; i++)
            if (body->plant.tags[i].group == group)
                most = fmax(most, distance_m[i]);
    }
    return most;
}

/* Writes the distances as plantcast-prep stores them in the asset file and reads them back into columns[], so that tests use
   the stored precision. */
static void take_columns(const struct distance_rows *rows, float *columns)
{
    const size_t count = asset_distance_count(rows->sensor_count, rows->vertex_count), bytes = count * sizeof(uint16_t), before = 12;
    FILE *file = tmpfile();
    uint16_t *codes = mem_array(count, sizeof(*codes));
    assert_non_null(file);
    assert_int_equal(distance_rows_write(rows, NULL, fileno(file), (off_t)before), 0);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    assert_int_equal(ftell(file), before + bytes);
    assert_int_equal(fseek(file, (long)before, SEEK_SET), 0);
    assert_int_equal(fread(codes, 1, bytes, file), bytes);
    fclose(file);
    const struct asset_header header = { .sensor_count = (uint32_t)rows->sensor_count };
    const struct asset_view view = { .header = &header, .geodesic = codes };
    for (size_t s = 0; s < rows->sensor_count; s++)
        for (size_t v = 0; v < rows->vertex_count; v++)
            columns[s * rows->vertex_count + v] = asset_distance_m(&view, s, v);
    mem_free(codes);
}

static void prepare(struct prepared_body *body, const double (*points)[3])
{
    float(*places)[3] = mem_array(SENSORS, sizeof(*places));
    struct linear_error linear;
    struct geometry *g = &body->g;
    make_plant(body);
    body->own_vertices = g->vertex_count;
    body->own_triangles = g->index_count / 3;
    body->surface = surface_create(NULL, NULL, (const float(*)[3])g->positions_m, g->vertex_count, g->indices, g->index_count / 3,
                                   &(struct surface_params){ 0 });
    assert_non_null(body->surface);
    assert_true(surface_field_init(&body->field, body->surface, points, SENSORS, NULL));
    for (int i = 0; i < SENSORS; i++)
        for (int axis = 0; axis < 3; axis++)
            places[i][axis] = body->places[i].surface_m[axis] = (float)body->field.sources[i].point_m[axis];
    linear_error_init(&linear, &body->plant, body->sensors, SENSORS, (const float(*)[3])places);
    assert_true(levels_make(&body->levels, g, NULL));
    struct distance_rows rows;
    assert_true(subdivide_levels(&body->levels, g,
                                 &(struct subdiv_input){
                                     .linear = &linear, .surface = body->surface, .field = &body->field, .sensors = body->places },
                                 &rows));
    body->distances = mem_array((size_t)g->vertex_count * SENSORS, sizeof(*body->distances));
    take_columns(&rows, body->distances);
    distance_rows_finish(&rows);
    linear_error_finish(&linear);
    mem_free(places);
    for (int geodesic = 0; geodesic < 2; geodesic++) {
        body->radius_m[0][geodesic] = largest(body, 0, geodesic);
        body->radius_m[1][geodesic] = 4;
    }
}

static void onto_surface(const struct prepared_body *body, double p[3])
{
    struct surface_point hit;
    surface_find_point(body->surface, p, NULL, &hit);
    memcpy(p, hit.point_m, sizeof(hit.point_m));
}

struct field_shown { /* which field a level of detail is to show: group, interpolation, kind of distance, and readings of 0 or 1 */
    int group;
    bool paper, geodesic;
    unsigned readings;
};

static double true_field(const struct prepared_body *body, const struct field_shown *showing, const double p[3])
{
    double distance_m[SENSORS];
    true_distances(body, p, showing->geodesic, distance_m);
    if (nearest(body, showing->group, distance_m) > body->plant.groups[showing->group].reach_m)
        return NAN; /* there is no data */
    return field(body, showing->group, showing->paper, distance_m, body->radius_m[showing->group][showing->geodesic], showing->readings);
}

static void random_showing(struct field_shown *showing, uint32_t *seed)
{
    *showing = (struct field_shown){ .group = random_unit(seed) < 0.5,
                                     .paper = random_unit(seed) < 0.5,
                                     .geodesic = random_unit(seed) < 0.5,
                                     .readings = (unsigned)(random_unit(seed) * (1 << SENSORS)) };
}

/* Returns the level's value at a point of one of its triangles, interpolated between the corners. */
static double shown_field(const struct prepared_body *body, const struct field_shown *showing, const uint32_t v[3], const double w[3])
{
    double shown = 0;
    for (int c = 0; c < 3; c++) {
        const float *q = body->g.positions_m[v[c]];
        double at[SENSORS];
        true_distances(body, (const double[3]){ (double)q[0], (double)q[1], (double)q[2] }, false, at);
        for (int i = 0; showing->geodesic && i < SENSORS; i++)
            at[i] = (double)body->distances[(size_t)i * body->g.vertex_count + v[c]];
        shown +=
            w[c] * field(body, showing->group, showing->paper, at, body->radius_m[showing->group][showing->geodesic], showing->readings);
    }
    return shown;
}

/* Returns the error of the field that the finest level shows at a random point of it. snap() moves the point onto the true
   surface; NULL: the level itself is the true surface. */
static double error_somewhere(const struct prepared_body *body, const struct level *level, uint32_t *seed, void (*snap)(double p[3]))
{
    const uint32_t *v = level->indices + 3 * (uint32_t)(random_unit(seed) * (level->index_count / 3));
    double a = random_unit(seed), b = random_unit(seed), p[3] = { 0 };
    struct field_shown showing;
    random_showing(&showing, seed);
    if (a + b > 1) {
        a = 1 - a;
        b = 1 - b;
    }
    const double w[3] = { 1 - a - b, a, b };
    for (int c = 0; c < 3; c++)
        for (int axis = 0; axis < 3; axis++)
            p[axis] += w[c] * (double)body->g.positions_m[v[c]][axis];
    if (!snap)
        onto_surface(body, p);
    else if (showing.geodesic)
        snap(p);
    return fabs(shown_field(body, &showing, v, w) - true_field(body, &showing, p));
}

/* --- coarser levels compared along rays, as a camera sees them ----------------------------------------------------------------- */

struct sight_target { /* a mesh and its bounding volume hierarchy, for casting rays */
    struct trimesh mesh;
    struct bvh *bvh;
};

static void seen_init(struct sight_target *seen, const struct geometry *g, const uint32_t *indices, size_t index_count)
{
    *seen = (struct sight_target){ 0 };
    for (size_t v = 0; v < g->vertex_count; v++)
        trimesh_add_point(&seen->mesh,
                          (const double[3]){ (double)g->positions_m[v][0], (double)g->positions_m[v][1], (double)g->positions_m[v][2] });
    for (size_t i = 0; i < index_count; i += 3)
        trimesh_add_tri(&seen->mesh, indices[i], indices[i + 1], indices[i + 2], 0);
    seen->bvh = bvh_create(&seen->mesh);
}

static void seen_finish(struct sight_target *seen)
{
    bvh_destroy(&seen->bvh);
    trimesh_finish(&seen->mesh);
}

struct first_hit {
    uint32_t tri;
    double t;
};

static void keep_first(void *arg, uint32_t tri, double t)
{
    struct first_hit *hit = arg;
    if (t < hit->t)
        *hit = (struct first_hit){ tri, t };
}

static bool look(const struct sight_target *seen, const double from[3], const double along[3], struct first_hit *hit, double place[3],
                 double w[3])
{
    *hit = (struct first_hit){ TRIMESH_NONE, INFINITY };
    bvh_ray(seen->bvh, from, along, keep_first, hit);
    if (hit->tri == TRIMESH_NONE)
        return false;
    const uint32_t *v = seen->mesh.tris[hit->tri];
    for (int axis = 0; axis < 3; axis++)
        place[axis] = from[axis] + hit->t * along[axis];
    triangle_nearest(place, seen->mesh.points[v[0]], seen->mesh.points[v[1]], seen->mesh.points[v[2]], w);
    return true;
}

/* if the depths of neighbouring pixels differ by more than this many pixel widths, the pixels show two surfaces: an outline */
#define OUTLINE 12.0
/* A distant orthographic camera. A pixel is as wide as the error of the level that is tested: closer cameras would draw a finer
   level. */
struct outline_camera {
    double along[3], right[3], up[3], pixel_m, back_m;
};

static void random_camera(struct outline_camera *camera, double pixel_m, double size_m, uint32_t *seed)
{
    double turn = 2 * PI * random_unit(seed), high = 2 * random_unit(seed) - 1, flat = sqrt(1 - high * high);
    const double along[3] = { flat * cos(turn), flat * sin(turn), high }, right[3] = { -sin(turn), cos(turn), 0 };
    memcpy(camera->along, along, sizeof(along));
    memcpy(camera->right, right, sizeof(right));
    vec_cross(right, along, camera->up);
    camera->pixel_m = pixel_m;
    camera->back_m = 4 * size_m;
}

/* points that side * side rays within a pixel hit on the finest level: lowest and highest value of the field, nearest and farthest
   depth; missed: a ray hit nothing */
struct sighted {
    double low, high, nearest, farthest;
    bool missed;
};

static struct sighted look_round(const struct prepared_body *body, const struct sight_target *finest, const struct outline_camera *camera,
                                 const struct field_shown *showing, const double from[3], int side)
{
    struct sighted sighted = { INFINITY, -INFINITY, INFINITY, -INFINITY, false };
    for (int i = 0; i < side * side; i++) {
        double x = (2.0 * (i % side) / (side - 1) - 1) * camera->pixel_m, y = (2.0 * (i / side) / (side - 1) - 1) * camera->pixel_m;
        double at[3], place[3], w[3];
        struct first_hit hit;
        for (int axis = 0; axis < 3; axis++)
            at[axis] = from[axis] + x * camera->right[axis] + y * camera->up[axis];
        if (!look(finest, at, camera->along, &hit, place, w)) {
            sighted.missed = true;
            continue;
        }
        double value = true_field(body, showing, place);
        sighted.nearest = fmin(sighted.nearest, hit.t);
        sighted.farthest = fmax(sighted.farthest, hit.t);
        sighted.low = fmin(sighted.low, value);
        sighted.high = fmax(sighted.high, value);
    }
    return sighted;
}

/* Returns by how much the value that a level shows in a random pixel lies outside the values that rays within that pixel see on
   the finest level, or NAN if nothing is visible. *outline: the surface ends within the pixel, so the level may show another
   one there. An apparent error is checked again with more rays, because near a sensor the field's peak may be only a pixel
   wide. */
static double error_as_seen(const struct prepared_body *body, const struct sight_target *level, const struct sight_target *finest,
                            const struct outline_camera *camera, uint32_t *seed, bool *outline)
{
    static const int sides[] = { 5, 33 };
    struct first_hit hit;
    struct field_shown showing;
    double from[3], place[3], w[3], error = NAN;
    *outline = false;
    random_showing(&showing, seed);
    const uint32_t *v = level->mesh.tris[(uint32_t)(random_unit(seed) * (double)level->mesh.tri_count)];
    double a = random_unit(seed), b = (1 - a) * random_unit(seed);
    for (int axis = 0; axis < 3; axis++)
        from[axis] = (1 - a - b) * level->mesh.points[v[0]][axis] + a * level->mesh.points[v[1]][axis] +
                     b * level->mesh.points[v[2]][axis] - camera->back_m * camera->along[axis];
    if (!look(level, from, camera->along, &hit, place, w))
        return NAN;
    double shown = shown_field(body, &showing, level->mesh.tris[hit.tri], w);
    for (size_t i = 0; i < sizeof(sides) / sizeof(*sides) && !(error <= 1 / 255.0); i++) {
        struct sighted at = look_round(body, finest, camera, &showing, from, sides[i]);
        *outline = at.missed || at.farthest - at.nearest > OUTLINE * camera->pixel_m;
        error = at.low > at.high ? NAN : fmax(0, fmax(at.low - shown, shown - at.high));
    }
    return error;
}

static void say_errors(const struct prepared_body *body, size_t level, const char *name, const char *where, double *errors, size_t count)
{
    if (count == 0)
        return;
    qsort(errors, count, sizeof(*errors), compare_doubles);
    print_message("# %s, level %zu: %u triangles, %u split; %zu places %s err by %.2f steps (95 %%), %.2f (99.5 %%), %.2f at most\n", name,
                  level, body->levels.at[level].whole_count / 3, body->levels.at[level].index_count / 3, count, where,
                  255 * errors[count * 95 / 100], 255 * errors[count * 995 / 1000], 255 * errors[count - 1]);
}

#define POINTS sweep(20000, 5000)
/* Checks the field of the finest level at random points: 99.5 % of the errors must be at most one step of the colour map (1/255
   of the range), all at most `most` steps. */
static void assert_field(const struct prepared_body *body, const char *name, void (*snap)(double p[3]), double most)
{
    double *errors = mem_array(POINTS, sizeof(*errors));
    uint32_t seed = 11;
    for (int i = 0; i < POINTS; i++)
        errors[i] = error_somewhere(body, &body->levels.at[0], &seed, snap);
    say_errors(body, 0, name, "on the surface", errors, POINTS);
    assert_true(errors[POINTS / 1000 * 995] <= 1 / 255.0);
    assert_true(errors[POINTS - 1] <= most / 255.0);
    mem_free(errors);
}

#define PIXELS 6000
/* Checks the field of a coarser level at random pixels from random directions. Away from outlines 99.5 % of the errors must be
   at most one step of the colour map and 99.9 % at most `most` steps, as rarely a ray slips between triangles; at outlines 95 %
   at most one. If the body is so small that outlines are half of it: 98 %, or 95 % if they are nine tenths. */
static void assert_pixels(const struct prepared_body *body, size_t number, const char *name, double most)
{
    const struct level *level = &body->levels.at[number];
    double *errors[2] = { mem_array(PIXELS, sizeof(double)), mem_array(PIXELS, sizeof(double)) };
    struct sight_target finest, coarse;
    struct outline_camera camera;
    uint32_t seed = 11;
    size_t counts[2] = { 0 };
    seen_init(&finest, &body->g, body->g.indices, body->g.index_count);
    seen_init(&coarse, &body->g, level->indices, level->index_count);
    for (int i = 0; i < PIXELS; i++) {
        bool outline;
        if (i % 500 == 0)
            random_camera(&camera, (double)level->error_m, 20, &seed);
        double error = error_as_seen(body, &coarse, &finest, &camera, &seed, &outline);
        if (!isnan(error))
            errors[outline][counts[outline]++] = error;
    }
    say_errors(body, number, name, "within", errors[0], counts[0]);
    say_errors(body, number, name, "at the outline", errors[1], counts[1]);
    assert_true(counts[0] + counts[1] > PIXELS * 9 / 10);
    bool large = counts[0] > PIXELS / 2; /* large: most pixels are away from outlines; otherwise the body is only a few pixels wide */
    bool some = counts[0] > PIXELS / 50; /* some: enough pixels away from outlines for a percentage to mean anything */
    size_t most_of_1000 = large ? 995 : counts[0] > PIXELS / 10 ? 980 : 950;
    assert_true(!some || errors[0][counts[0] * most_of_1000 / 1000] <= 1 / 255.0);
    assert_true(!large || errors[0][counts[0] * 999 / 1000] <= most / 255.0);
    assert_true(errors[1][counts[1] * 95 / 100] <= 1 / 255.0);
    mem_free(errors[0]);
    mem_free(errors[1]);
    seen_finish(&finest);
    seen_finish(&coarse);
}

static void stay(double p[3])
{
    (void)p;
}

static void onto_cylinder(double p[3])
{
    double r = hypot(p[0], p[1]);
    p[0] /= r;
    p[1] /= r;
}

/* Asserts for each level that an edge belongs to two triangles, or to one where it lies on the border of the original mesh:
   subdivision has opened no cracks. */
static void assert_no_cracks(const struct prepared_body *body, double border_m)
{
    struct welded_positions places;
    assert_true(welded_init(&places, (const float(*)[3])body->g.positions_m, body->g.vertex_count));
    for (size_t l = 0; l < body->levels.count; l++) {
        const struct level *level = &body->levels.at[l];
        struct edge_table edges;
        int *faces = mem_array(level->index_count, sizeof(*faces));
        double *lengths = mem_array(level->index_count, sizeof(*lengths)), sum_m = 0;
        edge_table_init(&edges, level->index_count);
        for (uint32_t i = 0; i < level->index_count; i++) {
            uint32_t a = level->indices[i], b = level->indices[i % 3 == 2 ? i - 2 : i + 1];
            const float *p = body->g.positions_m[a], *q = body->g.positions_m[b];
            assert_int_not_equal(places.of_vertex[a], places.of_vertex[b]);
            uint32_t e = edge_table_add(&edges, places.of_vertex[a], places.of_vertex[b]);
            faces[e]++;
            lengths[e] = (double)hypotf(p[0] - q[0], hypotf(p[1] - q[1], p[2] - q[2]));
        }
        for (size_t e = 0; e < edges.count; e++) {
            assert_true(faces[e] == 1 || faces[e] == 2);
            sum_m += faces[e] == 1 ? lengths[e] : 0;
        }
        assert_float_equal(sum_m, border_m, 0.02 * border_m);
        edge_table_finish(&edges);
        mem_free(faces);
        mem_free(lengths);
    }
    welded_finish(&places);
}

/* Asserts that each sensor is at its own vertex, with a stored distance of 0. */
static void assert_sensors(const struct prepared_body *body)
{
    for (size_t i = 0; i < SENSORS; i++) {
        uint32_t v = body->places[i].nearest_vertex;
        assert_memory_equal(body->g.positions_m[v], body->places[i].surface_m, sizeof(float[3]));
        assert_float_equal(body->distances[i * body->g.vertex_count + v], 0, 0);
    }
}

static const double plate_sensors[SENSORS][3] = { { 1, 1, 0 }, { 5, 1.5, 0 }, { 3, 3.5, 0 }, { 2.7, 1.8, 0 }, { 0.7, 3, 0 }, { 4, 0, 0 } };

TEST(nine_triangles_show_the_field)
{
    struct prepared_body body = { 0 };
    make_plate(&body);
    prepare(&body, plate_sensors);
    assert_sensors(&body);
    assert_no_cracks(&body, 20);
    assert_field(&body, "plate", stay, 1);
    assert_true(body.levels.at[0].index_count / 3 < 7000);
    finish(&body);
}

/* Checks the field on a plate at points distributed evenly over its area. Drawing random triangles instead would favour the
   smallest ones: they lie where the reaches of two sensors and the data end in one point and the field jumps. */
static void assert_plate(const struct prepared_body *body)
{
    struct sight_target finest;
    double *errors = mem_array(POINTS, sizeof(*errors));
    size_t count = 0, over = 0;
    uint32_t seed = 11;
    seen_init(&finest, &body->g, body->levels.at[0].indices, body->levels.at[0].index_count);
    for (int i = 0; i < POINTS; i++) {
        const double from[3] = { 6 * random_unit(&seed), 4 * random_unit(&seed), 1 }, down[3] = { 0, 0, -1 };
        double place[3], w[3];
        struct field_shown showing;
        struct first_hit hit;
        random_showing(&showing, &seed);
        if (!look(&finest, from, down, &hit, place, w))
            continue;
        double error = fabs(shown_field(body, &showing, finest.mesh.tris[hit.tri], w) - true_field(body, &showing, place));
        if (isnan(error))
            continue;
        errors[count++] = error;
        over += error > 1 / 255.0;
    }
    seen_finish(&finest);
    say_errors(body, 0, "plate with reaches", "with data", errors, count);
    assert_true(count > (size_t)POINTS / 3);
    assert_in_range(over, 0, count / 2000);
    mem_free(errors);
}

TEST(nine_triangles_show_how_far_sensors_reach)
{
    static const double reaches_m[][2] = { { 2.2, 3 }, { 3.5, 6 }, { 20, 1.5 } };
    for (size_t i = 0; i < sizeof(reaches_m) / sizeof(*reaches_m); i++) {
        struct prepared_body body = { .as_solved = true, .reach_m = { reaches_m[i][0], reaches_m[i][1] } };
        make_plate(&body);
        prepare(&body, plate_sensors);
        assert_sensors(&body);
        assert_no_cracks(&body, 20);
        assert_plate(&body);
        finish(&body);
    }
}

/* Makes a box and a plate of two triangles that passes through it. The plate's part within the box is invisible; its outer
   parts must be as exact as other surfaces. */
static void make_plate_through_box(struct prepared_body *body)
{
    static const double rim[4][2] = { { -1.6, -1.3 }, { 1.6, -1.3 }, { 1.6, 1.3 }, { -1.6, 1.3 } };
    static const uint32_t sides[6][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 }, { 2, 6, 7, 3 }, { 0, 4, 6, 2 }, { 1, 3, 7, 5 } };
    struct geometry *g = &body->g;
    geometry_begin(g, 12, 14);
    for (int i = 0; i < 8; i++) {
        double x = i & 1 ? 1 : -1, y = i & 2 ? 1 : -1, z = i & 4 ? 1 : -1;
        add_vertex(g, x, y, z, x / sqrt(3), y / sqrt(3), z / sqrt(3));
    }
    for (int i = 0; i < 6; i++) {
        add_triangle(g, sides[i][0], sides[i][1], sides[i][2]);
        add_triangle(g, sides[i][0], sides[i][2], sides[i][3]);
    }
    for (int i = 0; i < 4; i++)
        add_vertex(g, 0, rim[i][0], rim[i][1], 1, 0, 0);
    add_triangle(g, 8, 9, 10);
    add_triangle(g, 8, 10, 11);
}

static bool is_in_box(const double p[3])
{
    return fabs(p[0]) < 1 && fabs(p[1]) < 1 && fabs(p[2]) < 1;
}

/* Returns the value that the level shows at p, a point of the plate that passes through the other body, or NAN if no triangle
   covers p. */
static double shown_on_plate(const struct prepared_body *body, const struct level *level, const struct field_shown *showing,
                             const double p[3])
{
    for (uint32_t t = 0; t < level->index_count; t += 3) {
        double corners[3][3], w[3], aside_m = 0;
        for (uint32_t c = 0; c < 3; c++)
            for (int axis = 0; axis < 3; axis++)
                corners[c][axis] = (double)body->g.positions_m[level->indices[t + c]][axis];
        for (int c = 0; c < 3; c++)
            aside_m = fmax(aside_m, fabs(corners[c][0]));
        triangle_nearest(p, corners[0], corners[1], corners[2], w);
        double y = w[0] * corners[0][1] + w[1] * corners[1][1] + w[2] * corners[2][1];
        double z = w[0] * corners[0][2] + w[1] * corners[1][2] + w[2] * corners[2][2];
        if (aside_m == 0 && hypot(y - p[1], z - p[2]) < 1e-6)
            return shown_field(body, showing, level->indices + t, w);
    }
    return NAN;
}

/* Stores in errors[] the field's errors at random points of the plate where is_hidden() is false. Uses straight-line distances,
   because the distances around the other body have no formula. */
static void find_errors_on_plate(const struct prepared_body *body, const struct level *level, bool (*is_hidden)(const double p[3]),
                                 double *errors)
{
    uint32_t seed = 11;
    for (int i = 0; i < POINTS;) {
        const double p[3] = { 0, 3.2 * random_unit(&seed) - 1.6, 2.6 * random_unit(&seed) - 1.3 };
        struct field_shown showing;
        if (is_hidden(p))
            continue;
        random_showing(&showing, &seed);
        showing.geodesic = false;
        errors[i++] = fabs(shown_on_plate(body, level, &showing, p) - true_field(body, &showing, p));
    }
}

TEST(what_stands_out_of_a_body_shows_the_field)
{
    static const double points[SENSORS][3] = { { 0, 1.3, 0.2 }, { 0, -1.3, 0.5 },  { 0, 0.1, 1.1 },
                                               { 1, 0.3, 0.2 }, { -1, -0.4, 0.6 }, { 0, -0.2, -1.1 } };
    struct prepared_body body = { .as_solved = true };
    double *errors = test_memory(mem_array(POINTS, sizeof(*errors)));
    make_plate_through_box(&body);
    prepare(&body, points);
    find_errors_on_plate(&body, &body.levels.at[0], is_in_box, errors);
    say_errors(&body, 0, "plate through a box", "outside that", errors, POINTS);
    assert_true(errors[POINTS / 1000 * 995] <= 1 / 255.0);
    assert_true(errors[POINTS - 1] <= 2 / 255.0);
    finish(&body);
}

/* Makes a sphere of radius 1 and a plate of two triangles that passes through its centre. */
static void make_plate_through_ball(struct prepared_body *body)
{
    enum { AROUND = 64, HIGH = 32 };
    static const double rim[4][2] = { { -1.6, -1.3 }, { 1.6, -1.3 }, { 1.6, 1.3 }, { -1.6, 1.3 } };
    struct geometry *g = &body->g;
    geometry_begin(g, (AROUND + 1) * (HIGH + 1) + 4, 2 * AROUND * HIGH + 2);
    for (uint32_t i = 0; i <= AROUND; i++)
        for (uint32_t j = 0; j <= HIGH; j++) {
            double flat = j % HIGH == 0 ? 0 : sin(PI * j / HIGH), turn = 2 * PI * (i % AROUND) / AROUND;
            double x = flat * cos(turn), y = flat * sin(turn), z = -cos(PI * j / HIGH);
            add_vertex(g, x, y, z, x, y, z);
        }
    for (uint32_t i = 0; i < AROUND; i++)
        for (uint32_t j = 0; j < HIGH; j++) {
            uint32_t a = i * (HIGH + 1) + j, b = a + HIGH + 1;
            if (j > 0)
                add_triangle(g, a, b, b + 1);
            if (j + 1 < HIGH)
                add_triangle(g, a, b + 1, a + 1);
        }
    for (int i = 0; i < 4; i++)
        add_vertex(g, 0, rim[i][0], rim[i][1], 1, 0, 0);
    add_triangle(g, g->vertex_count - 4, g->vertex_count - 3, g->vertex_count - 2);
    add_triangle(g, g->vertex_count - 4, g->vertex_count - 2, g->vertex_count - 1);
}

static bool is_in_ball(const double p[3])
{
    return vec_dot(p, p) < 1;
}

/* In coarser levels, too, the visible parts of a plate through a ball must show the field exactly, except for the smallest
   triangles at sensors; the coarsest level, which has no others, is not tested. */
TEST(what_stands_out_is_true_on_coarser_levels_too)
{
    static const double points[SENSORS][3] = { { 0, 1.3, 0.2 }, { 0, -1.3, 0.5 }, { 0, 0.1, 1.1 },
                                               { 1, 0, 0 },     { -0.8, 0, 0.6 }, { 0, -0.2, -1.1 } };
    struct prepared_body body = { .as_solved = true };
    double *errors = test_memory(mem_array(POINTS, sizeof(*errors)));
    make_plate_through_ball(&body);
    prepare(&body, points);
    assert_true(body.levels.count > 2 && (double)body.levels.at[2].error_m < 0.05);
    for (size_t l = 1; l < body.levels.count && (double)body.levels.at[l].error_m < 0.05; l++) {
        find_errors_on_plate(&body, &body.levels.at[l], is_in_ball, errors);
        say_errors(&body, l, "plate through a ball", "outside that", errors, POINTS);
        assert_true(errors[POINTS / 1000 * 995] <= 3 / 255.0);
        assert_true(errors[POINTS - 1] <= 20 / 255.0);
    }
    finish(&body);
}

/* A fine flat mesh needs no subdivision: it must stay as it is, except for the vertices that sensors add. */
TEST(straight_edges_are_not_cut)
{
    struct prepared_body body = { 0 };
    struct geometry *g = &body.g;
    const uint32_t n = 120;
    geometry_begin(g, 2 * (size_t)(n + 1) * (n + 1), 2 * (size_t)n * n);
    for (uint32_t y = 0; y <= n; y++)
        for (uint32_t x = 0; x <= n; x++)
            add_vertex(g, 6.0 * x / n, 4.0 * y / n, 0, 0, 0, 1);
    for (uint32_t y = 0; y < n; y++)
        for (uint32_t x = 0; x < n; x++) {
            uint32_t a = y * (n + 1) + x, c = a + n + 1;
            add_triangle(g, a, a + 1, c + 1);
            add_triangle(g, a, c + 1, c);
        }
    body.distance = along_plate;
    prepare(&body, plate_sensors);
    assert_field(&body, "fine plate", stay, 1);
    assert_true(body.levels.at[0].index_count / 3 <= 2 * n * n + 300);
    finish(&body);
}

static bool turns_left(const struct geometry *g, uint32_t a, uint32_t b, uint32_t c)
{
    const float *p = g->positions_m[a], *q = g->positions_m[b], *r = g->positions_m[c];
    return (q[0] - p[0]) * (r[1] - p[1]) > (q[1] - p[1]) * (r[0] - p[0]);
}

/* Makes a rectangle of irregular cells with sensors at random points. Cells are triangulated without overlap: where surfaces
   overlap, one point would have two distances. */
static void make_random_plate(struct prepared_body *body, double points[SENSORS][3], uint32_t *seed)
{
    struct geometry *g = &body->g;
    double width_m = 2 + 7 * random_unit(seed), height_m = 1 + 5 * random_unit(seed);
    uint32_t across = 1 + (uint32_t)(12 * random_unit(seed)), up = 1 + (uint32_t)(12 * random_unit(seed));
    geometry_begin(g, 200, 400);
    for (uint32_t y = 0; y <= up; y++)
        for (uint32_t x = 0; x <= across; x++) {
            double dx = x % across ? 0.6 * (random_unit(seed) - 0.5) : 0, dy = y % up ? 0.6 * (random_unit(seed) - 0.5) : 0;
            add_vertex(g, width_m * (x + dx) / across, height_m * (y + dy) / up, 0, 0, 0, 1);
        }
    for (uint32_t y = 0; y < up; y++)
        for (uint32_t x = 0; x < across; x++) {
            uint32_t a = y * (across + 1) + x, c = a + across + 2;
            bool flat = turns_left(g, a, a + 1, c) && turns_left(g, a, c, c - 1);
            add_triangle(g, a, a + 1, flat ? c : c - 1);
            add_triangle(g, flat ? a : a + 1, c, c - 1);
        }
    for (int i = 0; i < SENSORS; i++) {
        points[i][0] = width_m * random_unit(seed);
        points[i][1] = height_m * random_unit(seed);
        points[i][2] = 0;
    }
    body->distance = along_plate;
}

TEST(random_plates_show_the_field)
{
    uint32_t seed = (uint32_t)sweep_seed();
    for (int n = 0; n < 6; n++) {
        struct prepared_body body = { 0 };
        double points[SENSORS][3];
        make_random_plate(&body, points, &seed);
        body.as_solved = true;
        prepare(&body, (const double(*)[3])points);
        assert_sensors(&body);
        if (body.levels.at[0].index_count / 3 < body.own_triangles + 100000)
            assert_field(&body, "random plate", stay, 2);
        /* two close sensors of one group on a large plate would need more triangles than the limit allows; then the limit must
           be reported */
        else
            assert_true(body.levels.at[0].left[LEVEL_LIMIT_TRIANGLES].edges > 0);
        finish(&body);
    }
}

TEST(a_cylinder_shows_the_field)
{
    static const double at[SENSORS][2] = { { 0.3, 1 }, { 2.1, 4 }, { 4, 2.5 }, { 5.5, 4.5 }, { 1, 3 }, { 3, 0.5 } };
    struct prepared_body body = { 0 };
    double points[SENSORS][3];
    for (int i = 0; i < SENSORS; i++) {
        points[i][0] = cos(at[i][0]);
        points[i][1] = sin(at[i][0]);
        points[i][2] = at[i][1];
    }
    make_cylinder(&body, 96, 20);
    prepare(&body, (const double(*)[3])points);
    assert_sensors(&body);
    assert_no_cracks(&body, 4 * PI);
    assert_field(&body, "cylinder", onto_cylinder, 1);
    finish(&body);
}

/* Makes a ring of random size and varying thickness, rotated at random. Its sensors are at different random vertices, because a
   point with two sensors would have two readings. */
static void make_random_ring(struct prepared_body *body, double points[SENSORS][3], uint32_t *seed)
{
    struct geometry *g = &body->g;
    uint32_t around = 60 + (uint32_t)(60 * random_unit(seed)), tube = 24 + (uint32_t)(24 * random_unit(seed));
    double major_m = 0.5 + 3 * random_unit(seed), minor_m = major_m * (0.15 + 0.25 * random_unit(seed)), turn = 2 * PI * random_unit(seed);
    int waves = 2 + (int)(4 * random_unit(seed));
    geometry_begin(g, (size_t)around * tube, 2 * (size_t)around * tube);
    for (uint32_t i = 0; i < around; i++)
        for (uint32_t j = 0; j < tube; j++) {
            double a = 2 * PI * i / around, b = 2 * PI * j / tube, r = minor_m * (1 + 0.3 * sin(waves * a));
            double x = (major_m + r * cos(b)) * cos(a), y = (major_m + r * cos(b)) * sin(a), z = r * sin(b);
            double nx = cos(b) * cos(a), ny = cos(b) * sin(a), nz = sin(b);
            add_vertex(g, x * cos(turn) - z * sin(turn), y, x * sin(turn) + z * cos(turn), nx * cos(turn) - nz * sin(turn), ny,
                       nx * sin(turn) + nz * cos(turn));
        }
    for (uint32_t i = 0; i < around; i++)
        for (uint32_t j = 0; j < tube; j++) {
            uint32_t next = (i + 1) % around * tube, a = i * tube + j, b = next + j, c = next + (j + 1) % tube,
                     d = i * tube + (j + 1) % tube;
            add_triangle(g, a, b, c);
            add_triangle(g, a, c, d);
        }
    for (int s = 0; s < SENSORS; s++) {
        const float *at = g->positions_m[(uint32_t)((s + random_unit(seed)) * (g->vertex_count / SENSORS))];
        for (int axis = 0; axis < 3; axis++)
            points[s][axis] = (double)at[axis];
    }
}

TEST(random_rings_show_the_field_on_every_level)
{
    uint32_t seed = (uint32_t)sweep_seed();
    for (int n = 0; n < sweep(3, 1); n++) {
        struct prepared_body body = { .as_solved = true };
        double points[SENSORS][3];
        make_random_ring(&body, points, &seed);
        prepare(&body, (const double(*)[3])points);
        assert_sensors(&body);
        assert_true(body.levels.count >= 3);
        /* allows errors of 3 steps, because subdivision itself checks only a few points of each triangle */
        assert_field(&body, "ring", NULL, 3);
        for (size_t l = 1; l < body.levels.count; l++)
            assert_pixels(&body, l, "ring", 4);
        finish(&body);
    }
}

/* With many sensors, distances are most of the asset file. A level is then worth its size only if it has at most half as many
   triangles as the next finer one. */
TEST(levels_of_many_sensors_have_half_of_the_triangles)
{
    enum { MANY = 128 };
    struct prepared_body body = { 0 };
    struct plant_sensor sensors[MANY] = { 0 };
    struct asset_sensor places[MANY] = { 0 };
    double points[MANY][3];
    float places_m[MANY][3];
    uint32_t seed = 7;
    struct linear_error linear;
    struct distance_rows rows;
    make_plant(&body);
    mem_free(body.plant.tags);
    body.plant.tag_count = MANY;
    body.plant.tags = mem_array(MANY, sizeof(*body.plant.tags));
    for (int i = 0; i < MANY; i++) {
        double turn = 2 * PI * random_unit(&seed);
        points[i][0] = cos(turn);
        points[i][1] = sin(turn);
        points[i][2] = 5 * random_unit(&seed);
        body.plant.tags[i] = (struct plant_tag){ .strength = 1, .decay = 1 };
        sensors[i].tag = i;
    }
    make_cylinder(&body, 96, 40);
    body.surface = surface_create(NULL, NULL, (const float(*)[3])body.g.positions_m, body.g.vertex_count, body.g.indices,
                                  body.g.index_count / 3, &(struct surface_params){ 0 });
    assert_non_null(body.surface);
    assert_true(surface_field_init(&body.field, body.surface, (const double(*)[3])points, MANY, NULL));
    for (int i = 0; i < MANY; i++)
        for (int axis = 0; axis < 3; axis++)
            places_m[i][axis] = places[i].surface_m[axis] = (float)body.field.sources[i].point_m[axis];
    linear_error_init(&linear, &body.plant, sensors, MANY, (const float(*)[3])places_m);
    assert_true(levels_make(&body.levels, &body.g, NULL));
    const struct subdiv_input input = { .linear = &linear, .surface = body.surface, .field = &body.field, .sensors = places };
    assert_true(subdivide_levels(&body.levels, &body.g, &input, &rows));
    assert_true(body.levels.count >= 2);
    for (size_t l = 1; l < body.levels.count; l++)
        assert_true(2 * body.levels.at[l].index_count <= body.levels.at[l - 1].index_count);
    distance_rows_finish(&rows);
    linear_error_finish(&linear);
    finish(&body);
}

/* Distances in random order cannot be compressed: they must be stored plainly. A compressed section must never be as long as a
   plain one, because it would be read as plain. */
TEST(distances_that_do_not_pack_stay_plain)
{
    enum { MANY = 64, FEW_VERTICES = 256 };
    uint32_t seed = 5;
    for (int random = 0; random < 2; random++) {
        struct distance_rows rows = { .sensor_count = MANY, .vertex_count = FEW_VERTICES };
        rows.distances_m = mem_array(MANY * FEW_VERTICES, sizeof(*rows.distances_m));
        rows.place_of = mem_array(FEW_VERTICES, sizeof(*rows.place_of));
        for (uint32_t i = 0; i < MANY * FEW_VERTICES; i++)
            rows.distances_m[i] = (float)(random ? exp2(30 * random_unit(&seed) - 14) : 0.1 * (i / MANY));
        for (uint32_t v = 0; v < FEW_VERTICES; v++)
            rows.place_of[v] = v;
        assert_true(distance_rows_pack(&rows, NULL));
        assert_true((rows.packed_bytes == 0) == random);
        if (random) {
            float *columns = mem_array(MANY * FEW_VERTICES, sizeof(*columns));
            take_columns(&rows, columns);
            for (size_t s = 0; s < MANY; s++)
                for (size_t v = 0; v < FEW_VERTICES; v++) {
                    double m = (double)rows.distances_m[v * MANY + s];
                    assert_true(fabs((double)columns[s * FEW_VERTICES + v] - m) <= m * 0x1p-12 + 15e-9);
                }
            mem_free(columns);
        }
        distance_rows_finish(&rows);
    }
}
