/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast-prep distances`, from a CAD file to the printed lines: the distances along a cylinder are compared with the
   formula. */
#include "tests/support/test.h"

#include "tests/support/cad.h"
#include "tests/support/model_maker.h"
#include "tests/support/prep_case.h"

enum { AROUND = 160, ALONG = 130 };
static const double LENGTH_M = 3, MOVED_M[3] = { 10, -20, 5 };

/* Writes a model of a cylinder surface with open ends and radius 1, whose axis extends along z from z = 0. Returns its number
   of vertices. */
static size_t write_cylinder(struct prep_case *c, struct cad_random *random)
{
    struct cad *cad = test_cad();
    cad_cylinder(cad, random, AROUND, ALONG, LENGTH_M, 0.5);
    maker_write_cad(c->folder, "model.glb", "cylinder", cad);
    size_t vertices = cad->vertex_count;
    return vertices;
}

/* Returns the exact distance along the cylinder. a, b: angle about the axis, and height. On the unrolled cylinder the distance
   is a straight line. */
static double along_surface(const double a[2], const double b[2])
{
    double turn = fabs(remainder(a[0] - b[0], 2 * M_PI));
    return hypot(turn, a[1] - b[1]);
}

/* Compares the printed distances from one sensor to all vertices with the exact ones. */
static void check(struct prep_case *c, const char *tag, const double sensor[2], size_t vertices)
{
    char *arguments = test_printf("distances $PLANT --asset A --sensor %s", tag);
    double sum_m = 0, worst_m = 0, worst_straight_m = 0, longest_m = 0;
    size_t lines = 0;
    prep_case_expect(c, arguments, 0);
    prep_case_says(&c->out, "x,y,z,geodesic_m,euclidean_m\n");
    for (char *line = strchr(c->out.at, '\n') + 1; *line; line = strchr(line, '\n') + 1) {
        double at[3], geodesic_m, euclidean_m;
        assert_int_equal(sscanf(line, "%lf,%lf,%lf,%lf,%lf", &at[0], &at[1], &at[2], &geodesic_m, &euclidean_m), 5);
        for (int k = 0; k < 3; k++)
            at[k] -= MOVED_M[k];
        double want_m = along_surface(sensor, (double[2]){ atan2(at[1], at[0]), at[2] }), error_m = fabs(geodesic_m - want_m);
        double x = at[0] - cos(sensor[0]), y = at[1] - sin(sensor[0]), z = at[2] - sensor[1];
        worst_straight_m = fmax(worst_straight_m, fabs(euclidean_m - sqrt(x * x + y * y + z * z)));
        worst_m = fmax(worst_m, error_m);
        longest_m = fmax(longest_m, want_m);
        sum_m += error_m;
        lines++;
    }
    print_message("# %s: %.3f %% in the mean, %.3f %% at worst, straight %.6f m\n", tag, 100 * sum_m / (double)lines / longest_m,
                  100 * worst_m / longest_m, worst_straight_m);
    assert_int_equal(lines, vertices);
    assert_true(sum_m / (double)lines <= 0.006 * longest_m && worst_m <= 0.03 * longest_m);
    /* error of the straight-line distances: the sensor lies on a flat triangle instead of on the cylinder */
    assert_true(worst_straight_m < 0.002);
}

TEST_ON(struct prep_case *c, round_a_cylinder, prep_case_set_up, prep_case_tear_down)
{
    struct cad_random random;
    cad_random_start(&random);
    size_t vertices = write_cylinder(c, &random);
    const double sensors[2][2] = { { 6.283 * cad_random(&random), LENGTH_M * (0.1 + 0.8 * cad_random(&random)) }, { 0.3, 0 } };
    struct text *tags = test_text();
    for (int i = 0; i < 2; i++)
        text_add(tags, "T%d,%d,Float,plc,t,A,,%.6f,%.6f,%.6f\n", i + 1, 400001 + 2 * i, MOVED_M[0] + cos(sensors[i][0]),
                 MOVED_M[1] + sin(sensors[i][0]), MOVED_M[2] + sensors[i][1]);
    prep_case_plant(c, "plant: { name: Cylinder }\n"
                       "assets: [{ id: A, model: model.glb, up: z, placement: { translate: [10, -20, 5] } }]\n"
                       "groups: [{ id: t, unit: K, min: 0, max: 1 }]\n"
                       "sources: [{ id: plc, type: modbus, host: 127.0.0.1, byte_order: CDAB, address_base: 1 }]\ntags: tags.csv\n");
    prep_case_tags(c, tags->at);
    for (int i = 0; i < 2; i++)
        check(c, i ? "T2" : "T1", sensors[i], vertices);
}
