/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The field along surfaces, compared with the formula and exact distances on polyhedra: of picks, and of the values that
   pictures draw, with all sensors and with a lost one. Wherever a value is off by more than a colour step, it must be marked as
   uncertain, except at two places in a thousand. The shapes are prepared by plantcast-prep, once for distances along surfaces
   and once for straight-line distances. So are parts of real models (shared/data/models). */
#include "tests/support/test.h"

#include "field/field.h"
#include "plant/plant.h"
#include "preprocess/geometry/geometry.h"
#include "preprocess/model/gltf_shim.h"
#include "scene/scene_create.h"
#include "surface/mesh/trimesh.h"
#include "tests/oracle/geodesic.h"
#include "tests/support/cad.h"
#include "tests/support/glb.h"
#include "tests/support/prep_case.h"
#include "tests/support/site.h"
#include "value/quality.h"

enum { SHAPES = 11, SOME_SHAPES = 3, MOST_SENSORS = 16, MOST_POINTS = 600, POWERS = 3 };
/* MOST_BARE: share of the places that may be off by more than a step of colour and not marked */
static const double STEP = 1 / 255.0, MOST_BARE = 0.002;
/* largest distance of the finest level from the shape, in metres */
static const double OFF_SHAPE_M = 1e-5;
static const double powers[POWERS] = { 1, 2, 4 };
static struct cad_random chance;

struct along_sensor {
    uint32_t triangle; /* index of the shape's triangle that contains the sensor */
    double at_m[3];
};
struct along_place {
    struct field_place place; /* in the asset file */
    double at_m[3];
};
struct along_shape {
    const char *name;
    struct cad cad;
    struct along_sensor sensors[MOST_SENSORS];
    size_t sensor_count;
    bool is_exact; /* all values must be nearly exact */
};
struct along_tally {
    int places, picks_off, picks_marked, picks_bare, drawn_off, drawn_marked, drawn_bare;
    double worst_pick, worst_drawn; /* largest error of values that are not marked, as a share of the range */
};

static double between(double low, double high)
{
    return low + (high - low) * cad_random(&chance);
}

/* --- shapes ----------------------------------------------------------------------------------------------------------------- */

static void corners_of(const struct cad *cad, size_t triangle, double at_m[3][3])
{
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            at_m[k][c] = (double)cad->positions[cad->triangles[3 * triangle + (size_t)k]][c];
}

static double area_of(const double at_m[3][3])
{
    double a[3], b[3];
    for (int c = 0; c < 3; c++) {
        a[c] = at_m[1][c] - at_m[0][c];
        b[c] = at_m[2][c] - at_m[0][c];
    }
    return 0.5 * hypot(hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2]), a[0] * b[1] - a[1] * b[0]);
}

/* Writes the barycentric coordinates of a random point of a triangle. */
static void random_parts(double parts[3])
{
    double u = between(0.02, 0.96), w = between(0.02, 0.96);
    if (u + w > 0.98) {
        u = 0.98 - u;
        w = 0.98 - w;
    }
    parts[0] = 1 - u - w;
    parts[1] = u;
    parts[2] = w;
    if (u < 0.01 || w < 0.01)
        random_parts(parts);
}

/* Writes the barycentric coordinates of the point of the triangle's plane that is nearest to at_m, and returns the distance. */
static double locate(const double corners_m[3][3], const double at_m[3], double parts[3])
{
    double a[3], b[3], p[3], aa = 0, ab = 0, bb = 0, ap = 0, bp = 0, off = 0;
    for (int c = 0; c < 3; c++) {
        a[c] = corners_m[1][c] - corners_m[0][c];
        b[c] = corners_m[2][c] - corners_m[0][c];
        p[c] = at_m[c] - corners_m[0][c];
        aa += a[c] * a[c], ab += a[c] * b[c], bb += b[c] * b[c], ap += a[c] * p[c], bp += b[c] * p[c];
    }
    double divisor = aa * bb - ab * ab;
    parts[1] = divisor > 0 ? (bb * ap - ab * bp) / divisor : -1;
    parts[2] = divisor > 0 ? (aa * bp - ab * ap) / divisor : -1;
    parts[0] = 1 - parts[1] - parts[2];
    for (int c = 0; c < 3; c++)
        off = hypot(off, p[c] - parts[1] * a[c] - parts[2] * b[c]);
    return off;
}

static double *sum_areas(const struct cad *cad)
{
    double *areas = mem_array(cad->triangle_count, sizeof(*areas)), sum = 0, at_m[3][3];
    for (size_t t = 0; t < cad->triangle_count; t++) {
        corners_of(cad, t, at_m);
        areas[t] = sum += area_of((const double(*)[3])at_m);
    }
    return areas;
}

static size_t pick_triangle(const double *areas, size_t count)
{
    double at = between(0, areas[count - 1]);
    size_t t = 0;
    while (t + 1 < count && areas[t] < at)
        t++;
    return t;
}

static void scatter_sensors(struct along_shape *shape, size_t count)
{
    double *areas = sum_areas(&shape->cad), at_m[3][3], parts[3];
    for (size_t s = 0; s < count; s++) {
        struct along_sensor *sensor = &shape->sensors[shape->sensor_count++];
        sensor->triangle = (uint32_t)pick_triangle(areas, shape->cad.triangle_count);
        corners_of(&shape->cad, sensor->triangle, at_m);
        random_parts(parts);
        for (int c = 0; c < 3; c++)
            sensor->at_m[c] = parts[0] * at_m[0][c] + parts[1] * at_m[1][c] + parts[2] * at_m[2][c];
    }
    mem_free(areas);
}

/* Folds the plate's part beyond x_m up by a right angle, which makes an L-bracket. */
static void fold(struct cad *cad, double x_m)
{
    for (size_t v = 0; v < cad->vertex_count; v++) {
        float *p = cad->positions[v], beyond_m = p[0] - (float)x_m;
        if (beyond_m > 0) {
            p[0] = (float)x_m;
            p[2] = beyond_m;
        }
    }
}

/* Stretches the shape along the axes. */
static void stretch(struct cad *cad, const double by[3])
{
    for (size_t v = 0; v < cad->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            cad->positions[v][c] *= (float)by[c];
}

/* Bends a tube that is cut open along its length into a square plate with a round hole, whose triangles are needles from the
   hole's rim to the outer edge. */
static void flatten(struct cad *cad, double side_m)
{
    for (size_t v = 0; v < cad->vertex_count; v++) {
        float *p = cad->positions[v];
        double outer = side_m / fmax(fabs((double)p[0]), fabs((double)p[1])), by = p[2] > 0 ? outer : 1;
        p[0] *= (float)by;
        p[1] *= (float)by;
        p[2] = 0;
    }
}

static void make_shapes(struct along_shape *shapes)
{
    const int fine = sweep(2, 1);
    shapes[0].name = "slotted plate";
    cad_slotted_plate(&shapes[0].cad, &chance, 12 * fine, 8 * fine, 6, 4, 5 * fine, fine, 6 * fine);
    shapes[1].name = "tube";
    cad_cylinder(&shapes[1].cad, &chance, 14 * fine, 10 * fine, between(2, 5), 0.5);
    shapes[2].name = "L-bracket";
    cad_slotted_plate(&shapes[2].cad, &chance, 12 * fine, 6 * fine, 4, 2, 3 * fine, 2 * fine, 4 * fine);
    fold(&shapes[2].cad, 2);
    shapes[3].name = "box";
    cad_box(&shapes[3].cad, &chance, 3 * fine, 4 * fine, 6 * fine, 0.5 / fine);
    shapes[4].name = "torus";
    cad_torus(&shapes[4].cad, &chance, 18 * fine, 10 * fine, between(0.2, 0.6), 0.5);
    shapes[5].name = "bent pipe";
    cad_bent_pipe(&shapes[5].cad, &chance, 26 * fine, 8 * fine, between(0.15, 0.35), 0.5);
    shapes[6].name = "long tube";
    cad_cylinder(&shapes[6].cad, &chance, 24 * fine, 1, between(8, 20), 0);
    shapes[7].name = "round hole";
    cad_cylinder(&shapes[7].cad, &chance, 40 * fine, 1, 1, 0);
    flatten(&shapes[7].cad, between(2, 6));
    shapes[8].name = "beam";
    cad_box(&shapes[8].cad, &chance, 1, 1, 2 * fine, 1);
    stretch(&shapes[8].cad, (double[3]){ between(0.2, 0.6), between(0.5, 1), between(4, 8) / fine });
    shapes[9].name = "needles round a hole";
    cad_cylinder(&shapes[9].cad, &chance, 640, 1, 1, 0);
    flatten(&shapes[9].cad, 4);
    for (int i = 0; i < 10; i++)
        scatter_sensors(&shapes[i], (size_t[]){ 3, 2, 5, 16, 8, 4, 6, 5, 4, 5 }[i]);
    /* takes no random numbers from the shapes before, whose sensors stay as they were */
    const struct cad_random before = chance;
    shapes[10].name = "sensors at a hole of needles";
    shapes[10].is_exact = true;
    cad_cylinder(&shapes[10].cad, &chance, 1200, 1, 1, 0);
    flatten(&shapes[10].cad, 4);
    while (shapes[10].sensor_count < 5) {
        scatter_sensors(&shapes[10], 1);
        const double *at_m = shapes[10].sensors[shapes[10].sensor_count - 1].at_m;
        shapes[10].sensor_count -= hypot(at_m[0], at_m[1]) > 1.5;
    }
    chance = before;
}

/* --- preparing -------------------------------------------------------------------------------------------------------------- */

static void write_model(const struct along_shape *shapes, int shape_count, const char *folder)
{
    struct text *bin = test_text(), *meshes = test_text(), *nodes = test_text(), *accessors = test_text(), *list = test_text();
    size_t size;
    for (int i = 0; i < shape_count; i++) {
        const struct cad *cad = &shapes[i].cad;
        const char *comma = i ? "," : "";
        text_add(accessors,
                 "%s{\"bufferView\":0,\"byteOffset\":%zu,\"componentType\":5126,\"count\":%zu,\"type\":\"VEC3\"},"
                 "{\"bufferView\":0,\"byteOffset\":%zu,\"componentType\":5125,\"count\":%zu,\"type\":\"SCALAR\"}",
                 comma, bin->length, cad->vertex_count, bin->length + 12 * cad->vertex_count, 3 * cad->triangle_count);
        text_add(meshes, "%s{\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d}]}", comma, 2 * i, 2 * i + 1);
        text_add(nodes, "%s{\"name\":\"shape%d\",\"mesh\":%d}", comma, i, i);
        text_add(list, "%s%d", comma, i);
        text_add_bytes(bin, cad->positions, cad->vertex_count * sizeof(*cad->positions));
        text_add_bytes(bin, cad->triangles, 3 * cad->triangle_count * sizeof(*cad->triangles));
    }
    char *json = test_printf("{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu}],\"bufferViews\":[{\"buffer\":0,"
                             "\"byteLength\":%zu}],\"scenes\":[{\"nodes\":[%s]}],\"nodes\":[%s],\"meshes\":[%s],\"accessors\":[%s]}",
                             bin->length, bin->length, list->at, nodes->at, meshes->at, accessors->at);
    char *glb = test_memory(glb_build(json, bin->at, bin->length, &size));
    temp_write(folder, "model.glb", glb, size);
}

static struct plant *prepare(const struct along_shape *shapes, int shape_count, struct prep_case *c, const char *distance)
{
    struct text *tags = test_text(), *yaml = test_text();
    struct diag diag = { 0 };
    write_model(shapes, shape_count, c->folder);
    text_add(yaml,
             "plant: { name: Along }\ngroups: [{ id: t, unit: K, min: 0, max: 1, power: 2, distance: %s }]\ntags: tags.csv\nassets:\n",
             distance);
    text_add(tags, "Tag Name,Group,Asset,X,Y,Z\n");
    for (int i = 0; i < shape_count; i++) {
        text_add(yaml, "  - { id: A%d, model: model.glb, nodes: shape%d, up: z }\n", i, i);
        for (size_t s = 0; s < shapes[i].sensor_count; s++)
            text_add(tags, "S%d-%zu,t,A%d,%.9g,%.9g,%.9g\n", i, s, i, shapes[i].sensors[s].at_m[0], shapes[i].sensors[s].at_m[1],
                     shapes[i].sensors[s].at_m[2]);
    }
    prep_case_plant(c, yaml->at);
    temp_write_text(c->folder, "tags.csv", tags->at);
    prep_case_expect(c, "$PLANT", 0);
    struct plant *plant = plant_load(c->plant, &diag);
    diag_finish(&diag);
    assert_non_null(plant);
    return plant;
}

/* --- truth ------------------------------------------------------------------------------------------------------------------ */

struct split_mesh { /* the shape, with a vertex at each place and each sensor */
    struct cad cad;
    uint32_t *of; /* by triangle: the shape's triangle that contains it */
    size_t capacity;
};

/* Splits the triangle that contains the point into three. Returns the index of the new vertex; UINT32_MAX: the point is too close
   to an edge. */
static uint32_t add_point(struct split_mesh *mesh, uint32_t inside, const double at_m[3])
{
    struct cad *cad = &mesh->cad;
    double corners_m[3][3], parts[3];
    for (size_t t = 0; t < cad->triangle_count; t++) {
        if (mesh->of[t] != inside)
            continue;
        corners_of(cad, t, corners_m);
        locate((const double(*)[3])corners_m, at_m, parts);
        if (fmin(parts[0], fmin(parts[1], parts[2])) < 1e-3)
            continue;
        uint32_t *v = cad->triangles + 3 * t, a = v[0], b = v[1], c = v[2], new = (uint32_t)cad->vertex_count++;
        mem_grow(&cad->positions, &cad->position_capacity, cad->vertex_count, sizeof(*cad->positions));
        for (int i = 0; i < 3; i++)
            cad->positions[new][i] = (float)at_m[i];
        mem_grow(&cad->triangles, &cad->index_capacity, 3 * (cad->triangle_count + 2), sizeof(*cad->triangles));
        mem_grow(&mesh->of, &mesh->capacity, cad->triangle_count + 2, sizeof(*mesh->of));
        memcpy(cad->triangles + 3 * t, (const uint32_t[3]){ a, b, new }, 3 * sizeof(uint32_t));
        memcpy(cad->triangles + 3 * cad->triangle_count, (const uint32_t[6]){ b, c, new, c, a, new }, 6 * sizeof(uint32_t));
        mesh->of[cad->triangle_count] = mesh->of[cad->triangle_count + 1] = inside;
        cad->triangle_count += 2;
        return new;
    }
    return UINT32_MAX;
}

static void copy_shape(struct split_mesh *mesh, const struct cad *cad)
{
    *mesh = (struct split_mesh){ 0 };
    cad_append(&mesh->cad, cad, (double[3]){ 0 });
    mem_grow(&mesh->of, &mesh->capacity, cad->triangle_count, sizeof(*mesh->of));
    for (size_t t = 0; t < cad->triangle_count; t++)
        mesh->of[t] = (uint32_t)t;
}

/* Chooses random places on the finest level of an asset, and writes the exact distances of the sensors from them to
   distances_m[place * MOST_SENSORS + sensor]. Returns the number of places. */
static size_t choose_places(const struct along_shape *shape, const struct asset_view *file, size_t wanted, struct along_place *places,
                            double *distances_m)
{
    struct split_mesh mesh;
    struct cad finest = { .positions = (float(*)[3])file->positions_m };
    uint32_t vertices[MOST_POINTS], sources[MOST_SENSORS];
    size_t count = 0, triangle;
    copy_shape(&mesh, &shape->cad);
    for (size_t s = 0; s < shape->sensor_count; s++) {
        sources[s] = add_point(&mesh, shape->sensors[s].triangle, shape->sensors[s].at_m);
        assert_int_not_equal(sources[s], UINT32_MAX);
    }
    assert_int_equal(file->levels[0].primitive_count, 1);
    const struct asset_primitive *primitive = &file->primitives[file->levels[0].first_primitive];
    finest.triangles = (uint32_t *)file->indices + primitive->first_index;
    finest.triangle_count = primitive->index_count / 3;
    double *areas = sum_areas(&finest);
    for (size_t tries = 0; tries < 2 * wanted && count < wanted; tries++) {
        struct along_place *place = &places[count];
        double corners_m[3][3], parts[3], nearest_m = INFINITY, off_m;
        size_t inside = 0;
        triangle = pick_triangle(areas, finest.triangle_count);
        corners_of(&finest, triangle, corners_m);
        random_parts(place->place.parts);
        for (int k = 0; k < 3; k++)
            place->place.corners[k] = finest.triangles[3 * triangle + (size_t)k];
        for (int c = 0; c < 3; c++) {
            place->at_m[c] = file->header->origin_m[c];
            for (int k = 0; k < 3; k++)
                place->at_m[c] += place->place.parts[k] * corners_m[k][c];
        }
        for (size_t t = 0; t < shape->cad.triangle_count; t++) {
            corners_of(&shape->cad, t, corners_m);
            off_m = locate((const double(*)[3])corners_m, place->at_m, parts);
            if (fmin(parts[0], fmin(parts[1], parts[2])) > -1e-6 && off_m < nearest_m) {
                nearest_m = off_m;
                inside = t;
            }
        }
        assert_true(nearest_m < OFF_SHAPE_M);
        vertices[count] = add_point(&mesh, (uint32_t)inside, place->at_m);
        count += vertices[count] != UINT32_MAX;
    }
    struct oracle_mesh oracle = { (const float(*)[3])mesh.cad.positions, mesh.cad.triangles, mesh.cad.vertex_count,
                                  mesh.cad.triangle_count };
    double *all = mem_array(mesh.cad.vertex_count, sizeof(*all));
    for (size_t s = 0; s < shape->sensor_count; s++) {
        size_t t = 0, corner = 0;
        while (mesh.cad.triangles[t] != sources[s])
            t++;
        corner = t % 3;
        assert_true(oracle_distances(&oracle, t / 3, (const double[3]){ corner == 0, corner == 1, corner == 2 }, all));
        for (size_t i = 0; i < count; i++)
            distances_m[i * MOST_SENSORS + s] = all[vertices[i]];
    }
    mem_free(all);
    mem_free(areas);
    cad_finish(&mesh.cad);
    mem_free(mesh.of);
    return count;
}

/* lost: the first sensor has no usable reading. Returns NAN if it is the nearest, so that there is no data. */
static double truth_of(const double *distances_m, size_t sensors, double power, bool lost)
{
    double sum = 0, total = 0, nearest_m = INFINITY;
    for (size_t s = lost; s < sensors; s++) {
        double weight = pow(fmax(distances_m[s], 1e-9), -power);
        total += weight;
        sum += s % 2 ? weight : 0;
        nearest_m = fmin(nearest_m, distances_m[s]);
    }
    return lost && distances_m[0] < nearest_m ? (double)NAN : sum / total;
}

/* --- comparing -------------------------------------------------------------------------------------------------------------- */

/* Writes the value that pictures interpolate at a place. Returns whether pictures mark it as uncertain. */
static bool drawn_at(const struct scalars *scalars, const struct field_place *place, double *value)
{
    double uncertain = 0;
    *value = 0;
    for (int k = 0; k < 3; k++) {
        *value += place->parts[k] * (double)scalars->at[place->corners[k]].value;
        uncertain += place->parts[k] * scalars->at[place->corners[k]].uncertain / 255.0;
    }
    return uncertain > 0.5;
}

static void compare(struct field *field, int asset, struct snapshot *snapshot, const struct along_shape *shape,
                    const struct along_place *places, const double *distances_m, size_t count, const struct field_params *params, bool lost,
                    struct along_tally *tally)
{
    const struct asset_view *file = &field_scene(field)->assets[asset].file->view;
    for (size_t i = 0; i < count; i++) {
        struct field_point point;
        double drawn, truth = truth_of(distances_m + i * MOST_SENSORS, shape->sensor_count, params->power, lost);
        assert_true(field_at(field, asset, params, snapshot, &places[i].place, &point));
        const struct scalars *scalars = field_scalars_of(field, asset, params, snapshot, file->header->vertex_count);
        bool marked = drawn_at(scalars, &places[i].place, &drawn), pick_marked = point.uncertain || point.drawn_error > 0;
        if (isnan(truth) || point.no_data)
            continue;
        double pick_off = fabs(point.value - truth), drawn_off = fabs(drawn - truth);
        tally->places++;
        tally->picks_off += pick_off > STEP;
        tally->picks_marked += pick_marked;
        tally->picks_bare += pick_off > STEP && !pick_marked;
        tally->drawn_off += drawn_off > STEP;
        tally->drawn_marked += marked;
        tally->drawn_bare += drawn_off > STEP && !marked;
        tally->worst_pick = pick_marked ? tally->worst_pick : fmax(tally->worst_pick, pick_off);
        tally->worst_drawn = marked ? tally->worst_drawn : fmax(tally->worst_drawn, drawn_off);
    }
}

static void add_tally(struct along_tally *all, const struct along_tally *tally)
{
    all->places += tally->places;
    all->picks_off += tally->picks_off;
    all->picks_marked += tally->picks_marked;
    all->picks_bare += tally->picks_bare;
    all->drawn_off += tally->drawn_off;
    all->drawn_marked += tally->drawn_marked;
    all->drawn_bare += tally->drawn_bare;
    all->worst_pick = fmax(all->worst_pick, tally->worst_pick);
    all->worst_drawn = fmax(all->worst_drawn, tally->worst_drawn);
}

static void show(const char *name, const struct along_tally *tally)
{
    print_message("# %s: %d places; picks: %d off, %d marked, %d off and not marked, by %.2f steps; drawn: %d, %d, %d, %.2f\n", name,
                  tally->places, tally->picks_off, tally->picks_marked, tally->picks_bare, tally->worst_pick / STEP, tally->drawn_off,
                  tally->drawn_marked, tally->drawn_bare, tally->worst_drawn / STEP);
}

/* Prepares the shapes, and compares the field of each with the truth. shapes: freed. distance: that of the plant file for which the shapes
   are prepared. reloaded: the plant file changes afterwards to distances along surfaces and the largest power, and only the daemon reads it
   again. Returns the sum of the comparisons. */
static struct along_tally compare_shapes(struct prep_case *c, struct along_shape *shapes, int shape_count, const char *distance,
                                         bool reloaded)
{
    struct plant *plant = prepare(shapes, shape_count, c, distance);
    struct log *log = test_log();
    struct workers *workers = test_workers(1);
    if (reloaded) {
        plant->groups[0].distance = DISTANCE_GEODESIC;
        plant->groups[0].power = powers[POWERS - 1];
    }
    struct scene *scene = scene_create(log, plant, test_printf("%s/plant.prepared", c->folder));
    assert_non_null(scene);
    struct field *field = field_create(workers, scene);
    struct snapshot *snapshot = snapshot_create(plant->tag_count);
    struct along_place *places = mem_array(MOST_POINTS, sizeof(*places));
    double *distances_m = mem_array(MOST_POINTS * MOST_SENSORS, sizeof(*distances_m));
    struct along_tally all = { 0 };
    for (int a = 0; a < shape_count; a++) {
        for (size_t s = 0; s < shapes[a].sensor_count; s++)
            snapshot->readings[scene->assets[a].sensors[s].tag] = (struct reading){ .value = s % 2, .quality = QUALITY_GOOD };
        const int off_before = all.picks_off;
        size_t count = choose_places(&shapes[a], &scene->assets[a].file->view, (size_t)sweep(MOST_POINTS, 150), places, distances_m);
        for (int p = 0; p < 2 * POWERS; p++) {
            const bool lost = p >= POWERS;
            snapshot->readings[scene->assets[a].sensors[0].tag].quality = lost ? QUALITY_BAD_COMMUNICATION_ERROR : QUALITY_GOOD;
            struct along_tally tally = { 0 };
            struct field_params params;
            field_params_default(plant, 0, &params);
            params.distance = DISTANCE_GEODESIC;
            params.power = powers[p % POWERS];
            compare(field, a, snapshot, &shapes[a], places, distances_m, count, &params, lost, &tally);
            show(test_printf("%s, %s, power %g%s", distance, shapes[a].name, powers[p % POWERS], lost ? ", a lost sensor" : ""), &tally);
            add_tally(&all, &tally);
            assert_true(!shapes[a].is_exact || fmax(tally.worst_pick, tally.worst_drawn) <= 2 * STEP);
        }
        /* distances that were wrong near the source made 8 to 24 of about 800 picks wrong; now 0 to 2 (eight seeds) */
        assert_true(!shapes[a].is_exact || strcmp(distance, "geodesic") != 0 || 150 * (all.picks_off - off_before) <= 5 * (int)count);
    }
    show(test_printf("%s, all shapes", distance), &all);
    mem_free(places);
    mem_free(distances_m);
    snapshot_destroy(&snapshot);
    field_destroy(&field);
    scene_destroy(&scene);
    plant_destroy(&plant);
    for (int i = 0; i < shape_count; i++)
        cad_finish(&shapes[i].cad);
    return all;
}

/* reloaded: compares some of the shapes */
static void compare_prepared(struct prep_case *c, const char *distance, bool reloaded)
{
    struct along_shape shapes[SHAPES] = { 0 };
    const int shape_count = reloaded ? SOME_SHAPES : SHAPES;
    chance.state = sweep_seed();
    make_shapes(shapes);
    for (int i = shape_count; i < SHAPES; i++)
        cad_finish(&shapes[i].cad);
    const struct along_tally all = compare_shapes(c, shapes, shape_count, distance, reloaded);
    /* the limits of server/render/ACCURACY.md: errors of distances are not marked for these powers */
    assert_true(all.picks_bare <= MOST_BARE * all.places && all.drawn_bare <= MOST_BARE * all.places);
    /* the largest of eight seeds: 1.8 steps, or 2.6 with a lost sensor */
    assert_true(all.worst_pick <= 3 * STEP && all.worst_drawn <= 3 * STEP);
}

TEST_WITH(test_prepared_along_surfaces, prep_case_set_up, prep_case_tear_down)
{
    compare_prepared(*state, "geodesic", false);
}

TEST_WITH(test_prepared_for_straight_lines, prep_case_set_up, prep_case_tear_down)
{
    compare_prepared(*state, "euclidean", false);
}

TEST_WITH(test_reloaded_without_preparing, prep_case_set_up, prep_case_tear_down)
{
    compare_prepared(*state, "euclidean", true);
}

/* --- parts of real models ------------------------------------------------------------------------------------------------------ */

enum { PARTS = 15, LEAST_TRIS = 40, MOST_TRIS = 1500, PARTS_EACH = 3 };
/* limits of parts; the largest of six seeds were 0.004 and 3.7 steps */
#define MOST_BARE_OF_PARTS 0.005
#define WORST_OF_PARTS 4
#define DIAGONAL_M 2.0 /* the parts are scaled to this size, because a field along a surface does not depend on the scale */

/* Copies one connected component of a mesh, centred and scaled. Returns false if its number of triangles is unsuitable. */
static bool take_component(const struct trimesh *mesh, const uint32_t *component, uint32_t wanted, struct cad *cad)
{
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    uint32_t *vertex = mem_array(mesh->point_count, sizeof(*vertex));
    size_t tris = 0, points = 0;
    for (size_t t = 0; t < mesh->tri_count; t++)
        tris += component[mesh->tris[t][0]] == wanted;
    bool good = tris >= LEAST_TRIS && tris <= MOST_TRIS;
    for (size_t p = 0; good && p < mesh->point_count; p++)
        for (int c = 0; component[p] == wanted && c < 3; c++) {
            low[c] = fmin(low[c], mesh->points[p][c]);
            high[c] = fmax(high[c], mesh->points[p][c]);
        }
    const double size = hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
    for (size_t p = 0; good && p < mesh->point_count; p++) {
        if (component[p] != wanted)
            continue;
        vertex[p] = (uint32_t)points++;
        mem_grow(&cad->positions, &cad->position_capacity, points, sizeof(*cad->positions));
        for (int c = 0; c < 3; c++)
            cad->positions[vertex[p]][c] = (float)((mesh->points[p][c] - 0.5 * (low[c] + high[c])) * DIAGONAL_M / size);
    }
    for (size_t t = 0; good && t < mesh->tri_count; t++) {
        if (component[mesh->tris[t][0]] != wanted)
            continue;
        mem_grow(&cad->triangles, &cad->index_capacity, 3 * (cad->triangle_count + 1), sizeof(*cad->triangles));
        for (int k = 0; k < 3; k++)
            cad->triangles[3 * cad->triangle_count + (size_t)k] = vertex[mesh->tris[t][k]];
        cad->triangle_count++;
    }
    cad->vertex_count = points;
    mem_free(vertex);
    return good;
}

static bool has_edge(const struct cad *cad, uint32_t from, uint32_t to)
{
    for (size_t i = 0; i < 3 * cad->triangle_count; i++)
        if (cad->triangles[i] == from && cad->triangles[i % 3 == 2 ? i - 2 : i + 1] == to)
            return true;
    return false;
}

/* An open part may have slits, which plantcast-prep closes. */
static bool is_closed(const struct cad *cad)
{
    for (size_t i = 0; i < 3 * cad->triangle_count; i++)
        if (!has_edge(cad, cad->triangles[i % 3 == 2 ? i - 2 : i + 1], cad->triangles[i]))
            return false;
    return true;
}

/* Returns whether the exact solver takes the shape: a manifold with consistent orientation. */
static bool is_solvable(const struct cad *cad)
{
    struct oracle_mesh oracle = { (const float(*)[3])cad->positions, cad->triangles, cad->vertex_count, cad->triangle_count };
    double *distances_m = mem_array(cad->vertex_count, sizeof(*distances_m));
    bool good = oracle_distances(&oracle, 0, (const double[3]){ 1, 0, 0 }, distances_m);
    for (size_t v = 0; good && v < cad->vertex_count; v++)
        good = isfinite(distances_m[v]);
    mem_free(distances_m);
    return good;
}

/* Adds some random closed parts of a model, of different numbers of triangles. Returns the new number of parts. */
static int add_parts(struct along_shape *parts, int count, const char *name)
{
    char why[MODEL_WHY_BYTES];
    struct model_source source;
    struct gltf_model model;
    struct geometry g;
    struct trimesh mesh = { 0 };
    size_t degenerate = 0, repeated = 0;
    const int first = count;
    assert_true(model_source_open(&source, test_printf("../shared/data/models/%s", name), why));
    assert_true(gltf_load(&model, &source, why));
    assert_true(geometry_cut(&g, &model, &(struct geometry_params){ .unit_m = 1, .up = AXIS_Y }, why));
    uint32_t *point = mem_array(g.vertex_count, sizeof(*point));
    assert_true(trimesh_weld(&mesh,
                             &(struct trimesh_model){ (const float(*)[3])g.positions_m, g.vertex_count, g.indices, g.index_count / 3 }, 0,
                             point, &degenerate, &repeated));
    uint32_t *component = mem_array(mesh.point_count, sizeof(*component));
    trimesh_components(&mesh, component);
    for (int tries = 0; tries < 300 && count < PARTS && count < first + sweep(PARTS_EACH, 1); tries++) {
        struct along_shape *part = &parts[count];
        uint32_t chosen = component[(size_t)(cad_random(&chance) * (double)mesh.point_count)];
        bool good = take_component(&mesh, component, chosen, &part->cad);
        for (int i = first; good && i < count; i++)
            good = parts[i].cad.triangle_count != part->cad.triangle_count;
        if (good && is_closed(&part->cad) && is_solvable(&part->cad)) {
            part->name = test_printf("%s, part of %zu triangles", name, part->cad.triangle_count);
            scatter_sensors(part, 2 + (size_t)(cad_random(&chance) * 7));
            count++;
        } else {
            cad_finish(&part->cad);
            part->cad = (struct cad){ 0 };
        }
    }
    mem_free(component);
    mem_free(point);
    trimesh_finish(&mesh);
    geometry_finish(&g);
    gltf_free(&model);
    model_source_finish(&source);
    return count;
}

TEST_WITH(test_parts_of_real_models, prep_case_set_up, prep_case_tear_down)
{
    static const char *const models[] = { "cookie_factory_mixer.glb", "cookie_factory_water_tank.glb", "industrial_tanker.glb",
                                          "plm_plant_equipment.glb", "huldra_wd1_psup.glb" };
    struct along_shape parts[PARTS] = { 0 };
    int count = 0;
    if (!site_is_there(models[0])) {
        print_message("# ../shared/data/models is not there\n");
        skip();
    }
    chance.state = sweep_seed();
    for (size_t i = 0; i < sizeof(models) / sizeof(*models); i++)
        count = add_parts(parts, count, models[i]);
    assert_true(count >= 4);
    const struct along_tally all = compare_shapes(*state, parts, count, "geodesic", false);
    assert_true(all.picks_bare <= MOST_BARE_OF_PARTS * all.places && all.drawn_bare <= MOST_BARE_OF_PARTS * all.places);
    assert_true(all.worst_pick <= WORST_OF_PARTS * STEP && all.worst_drawn <= WORST_OF_PARTS * STEP);
}
