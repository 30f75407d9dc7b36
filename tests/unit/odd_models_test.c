/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plantcast-prep on models that are far away, tiny, narrow or repeated many times; also, that a signal stops it. */
#include "tests/support/test.h"
#include <fcntl.h>
#include <jansson.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/text/text.h"
#include "tests/support/model_maker.h"
#include "tests/support/prep_case.h"

#define CASE(name) TEST_ON(struct prep_case *c, name, prep_case_set_up, prep_case_tear_down)

#define PLANT(asset)                                                                                                                       \
    "plant: { name: Odd }\n"                                                                                                               \
    "assets:\n"                                                                                                                            \
    "  - { id: A, model: model.glb, up: z, " asset " }\n"                                                                                  \
    "groups: [{ id: temperature, unit: K, min: 0, max: 1 }]\n"                                                                             \
    "sources: [{ id: plc, type: modbus, host: 127.0.0.1, byte_order: CDAB, address_base: 1 }]\n"                                           \
    "tags: tags.csv\n"

enum {
    /* limit in seconds for building levels of detail: reached only if a step that should take milliseconds takes minutes */
    LEVELS_S = 15,
    WELL_BEGUN_S = 3, /* seconds of processor time, more than reading a model takes */
    ENDS_S = 30,      /* limit for ending after a signal, in seconds; plantcast-prep promises 5, but a machine may be busy */
};

/* kinds of stray triangle that a test adds at the origin, far away from the plate */
enum expected_stray { STRAY_NONE, STRAY_VERTEX, STRAY_NEEDLE, STRAY_TRIANGLE };

/* Adds a node with one stray triangle: STRAY_VERTEX: all corners at the origin; STRAY_NEEDLE: a long thin one from the plate to
   the origin; STRAY_TRIANGLE: a small one at the origin. */
static void add_stray(struct model_maker *maker, enum expected_stray stray, const double at_m[3])
{
    static const uint32_t corners[3] = { 0, 1, 2 };
    const double *from_m = stray == STRAY_NEEDLE ? at_m : (const double[3]){ 0, 0, 0 };
    float places[3][3] = { { 0, 0, 0 }, { 0.2f, 0, 0 }, { 0, 0.2f, 0 } };
    if (stray == STRAY_VERTEX)
        memset(places, 0, sizeof(places));
    for (int i = 0; stray == STRAY_NEEDLE && i < 3; i++)
        places[2][i] = (float)-at_m[i];
    int mesh = maker_triangles(maker, (const float(*)[3])places, 3, corners, 3);
    maker_node(maker, "stray", mesh, json_pack("{s:[f,f,f]}", "translation", from_m[0], from_m[1], from_m[2]));
}

/* Writes model.glb: a plate of squares, `copies` times in the same place, and a stray triangle. */
static void write_plates_and(struct prep_case *c, uint32_t across, uint32_t up, const double size_m[2], uint32_t copies,
                             const double at_m[3], enum expected_stray stray)
{
    struct model_maker maker;
    struct text *places = test_text(), *corners = test_text();
    for (uint32_t y = 0; y <= up; y++)
        for (uint32_t x = 0; x <= across; x++) {
            const float p[3] = { (float)(size_m[0] * x / across), (float)(size_m[1] * y / up), 0 };
            text_add_bytes(places, p, sizeof(p));
        }
    for (uint32_t y = 0; y < up; y++)
        for (uint32_t x = 0; x < across; x++) {
            uint32_t a = y * (across + 1) + x, b = a + across + 1;
            const uint32_t six[6] = { a, a + 1, b, b, a + 1, b + 1 };
            text_add_bytes(corners, six, sizeof(six));
        }
    maker_init(&maker);
    int mesh = maker_triangles(&maker, (const float(*)[3])(void *)places->at, (size_t)(across + 1) * (up + 1),
                               (const uint32_t *)(void *)corners->at, (size_t)across * up * 6);
    for (uint32_t i = 0; i < copies; i++)
        maker_node(&maker, "plate", mesh, json_pack("{s:[f,f,f]}", "translation", at_m[0], at_m[1], at_m[2]));
    if (stray != STRAY_NONE)
        add_stray(&maker, stray, at_m);
    maker_write(&maker, c->folder, "model.glb");
}

static void write_plates(struct prep_case *c, uint32_t across, uint32_t up, const double size_m[2], uint32_t copies, const double at_m[3])
{
    write_plates_and(c, across, up, size_m, copies, at_m, STRAY_NONE);
}

static const double here[3] = { 0, 0, 0 };

/* --- far away --------------------------------------------------------------------------------------------------------------- */

struct distance_row {
    double place_m[3], geodesic_m, euclidean_m;
};

static size_t read_distances(struct prep_case *c, struct distance_row *rows, size_t most)
{
    size_t count = 0;
    prep_case_expect(c, "distances $PLANT --asset A --sensor T1", 0);
    for (char *line = strchr(c->out.at, '\n') + 1; *line && count < most; line = strchr(line, '\n') + 1, count++) {
        struct distance_row *r = &rows[count];
        int got = sscanf(line, "%lf,%lf,%lf,%lf,%lf", &r->place_m[0], &r->place_m[1], &r->place_m[2], &r->geodesic_m, &r->euclidean_m);
        assert_int_equal(got, 5);
    }
    return count;
}

CASE(where_a_survey_has_it_distances_are_as_at_the_origin)
{
    static const double far_off_m[3] = { 412345, 5512345, 120 };
    struct distance_row near[66], far[66], home[66];
    write_plates(c, 10, 5, (double[]){ 2, 1 }, 1, here);
    prep_case_plant(c, PLANT("tag: A"));
    prep_case_tags(c, "T1,400001,Float,plc,temperature,A,,0.5,0.5,0\n");
    assert_int_equal(read_distances(c, near, 66), 66);
    write_plates(c, 10, 5, (double[]){ 2, 1 }, 1, far_off_m);
    prep_case_tags(c, "T1,400001,Float,plc,temperature,A,,412345.5,5512345.5,120\n");
    assert_int_equal(read_distances(c, far, 66), 66);
    prep_case_plant(c, PLANT("placement: { translate: [-412345, -5512345, -120] }"));
    prep_case_tags(c, "T1,400001,Float,plc,temperature,A,,0.5,0.5,0\n");
    assert_int_equal(read_distances(c, home, 66), 66);
    for (int i = 0; i < 66; i++) {
        assert_float_equal(far[i].geodesic_m, near[i].geodesic_m, 1e-3);
        assert_float_equal(far[i].euclidean_m, near[i].euclidean_m, 1e-3);
        assert_float_equal(home[i].geodesic_m, near[i].geodesic_m, 1e-3);
        for (int axis = 0; axis < 3; axis++) {
            assert_float_equal(far[i].place_m[axis], near[i].place_m[axis] + far_off_m[axis], 1e-3);
            assert_float_equal(home[i].place_m[axis], near[i].place_m[axis], 1e-3);
        }
    }
}

/* Returns the distances stored for the vertex at place_m (within 2 cm), or NULL if there is no such vertex. */
static const struct distance_row *row_at(const struct distance_row *rows, size_t count, const double place_m[3])
{
    for (size_t k = 0; k < count; k++)
        if (hypot(place_m[0] - rows[k].place_m[0], place_m[1] - rows[k].place_m[1]) < 0.02)
            return &rows[k];
    return NULL;
}

CASE(a_stray_piece_at_the_origin_changes_no_distance)
{
    static const double far_off_m[3] = { 412345, 5512345, 120 };
    struct distance_row plain[66], with[72];
    prep_case_plant(c, PLANT("tag: A"));
    prep_case_tags(c, "T1,400001,Float,plc,temperature,A,,412345.5,5512345.5,120\n");
    write_plates(c, 10, 5, (double[]){ 2, 1 }, 1, far_off_m);
    assert_int_equal(read_distances(c, plain, 66), 66);
    for (enum expected_stray stray = STRAY_VERTEX; stray <= STRAY_TRIANGLE; stray++) {
        write_plates_and(c, 10, 5, (double[]){ 2, 1 }, 1, far_off_m, stray);
        prep_case_expect(c, "$PLANT", 0);
        prep_case_says(&c->out, "(node 'stray')");
        size_t count = read_distances(c, with, 72);
        for (size_t i = 0; i < 66; i++) {
            const struct distance_row *row = row_at(with, count, plain[i].place_m);
            assert_non_null(row);
            assert_float_equal(plain[i].geodesic_m, row->geodesic_m, 1e-3);
            assert_float_equal(plain[i].euclidean_m, row->euclidean_m, 1e-3);
        }
    }
}

/* --- tiny, narrow ----------------------------------------------------------------------------------------------------------- */

CASE(a_speck_is_refused)
{
    static const double sizes_m[] = { 1e-30, 1e-24, 1e-7 };
    prep_case_plant(c, PLANT("tag: A"));
    prep_case_tags(c, "T1,400001,Float,plc,temperature,A,,0,0,0\n");
    for (size_t i = 0; i < sizeof(sizes_m) / sizeof(sizes_m[0]); i++) {
        char words[100];
        write_plates(c, 10, 10, (double[]){ sizes_m[i], sizes_m[i] }, 1, here);
        prep_case_expect(c, "$PLANT", 1);
        snprintf(words, sizeof(words), "the asset is only %g m in size, less than the minimum of 1e-06 m", sizes_m[i]);
        prep_case_says(&c->err, "plant.yaml:3: error: asset A: ");
        prep_case_says(&c->err, words);
    }
    write_plates(c, 10, 10, (double[]){ 2e-6, 2e-6 }, 1, here);
    prep_case_expect(c, "$PLANT", 0);
}

CASE(why_there_are_no_distances_is_said)
{
    prep_case_plant(c, PLANT("tag: A"));
    prep_case_tags(c, "T1,400001,Float,plc,temperature,A,,0,0,0\n");
    write_plates(c, 10, 1, (double[]){ 1, 1e-7 }, 1, here);
    prep_case_expect(c, "$PLANT", 1);
    prep_case_says(&c->err, "plant.yaml:3: error: asset A: ");
    prep_case_says(&c->err,
                   "model.glb: the asset's distances to 1 sensors cannot be computed: none of the asset's 20 triangles has an area "
                   "after points within 1e-06 m of each other are merged");
}

/* --- many times over -------------------------------------------------------------------------------------------------------- */

CASE(copies_in_one_place_are_counted_and_measured_once)
{
    prep_case_plant(c, PLANT("tag: A"));
    prep_case_tags(c, "");
    write_plates(c, 4, 4, (double[]){ 1, 1 }, 400, here);
    prep_case_expect(c, "$PLANT --report json", 0);
    json_t *report = prep_case_json(&c->out);
    assert_true(prep_case_number(report, "assets.0.model_triangles") == 400 * 32);
    assert_true(prep_case_number(report, "assets.0.repeated_triangles") == 399 * 32);
    assert_true(prep_case_number(report, "assets.0.stage_seconds.levels") < LEVELS_S); /* measured: 4 ms; before, minutes */
    write_plates(c, 4, 4, (double[]){ 1, 1 }, 1, here);
    prep_case_expect(c, "$PLANT --report json", 0);
    report = prep_case_json(&c->out);
    assert_true(prep_case_number(report, "assets.0.repeated_triangles") == 0);
}

/* --- told to end ------------------------------------------------------------------------------------------------------------ */

static pid_t start(struct prep_case *c)
{
    char *program = prep_case_program(), *err = temp_write_text(c->folder, "err", "");
    pid_t child = fork();
    if (child == 0) {
        dup2(open(err, O_WRONLY | O_APPEND), 2);
        dup2(2, 1);
        execl(program, program, c->plant, (char *)NULL);
        _exit(99);
    }
    return child;
}

/* Returns the processor time in seconds that the child has used; 0: no such process. */
static double seconds_of(pid_t child)
{
    char path[40], text[1000] = "";
    unsigned long user = 0, kernel = 0;
    snprintf(path, sizeof(path), "/proc/%ld/stat", (long)child);
    FILE *file = fopen(path, "r");
    size_t got = file ? fread(text, 1, sizeof(text) - 1, file) : 0;
    const char *rest = got ? strrchr(text, ')') : NULL;
    if (rest)
        sscanf(rest, ") %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu", &user, &kernel);
    if (file)
        fclose(file);
    return (double)(user + kernel) / (double)sysconf(_SC_CLK_TCK);
}

/* plantcast-prep gets a signal while it prepares two million triangles, which takes much longer than the time in which it must
   end. */
CASE(what_is_told_to_end_ends)
{
    static const int signals[] = { SIGTERM, SIGINT };
    prep_case_plant(c, PLANT("tag: A"));
    prep_case_tags(c, "T1,400001,Float,plc,temperature,A,,0,0,0\n");
    write_plates(c, 1200, 800, (double[]){ 12, 8 }, 1, here);
    for (int i = 0; i < sweep(2, 1); i++) {
        int status = 0;
        pid_t child = start(c), ended = 0;
        for (int tries = 0; tries < 12000 && seconds_of(child) < WELL_BEGUN_S; tries++)
            usleep(10000);
        kill(child, signals[i]);
        int64_t told_ns = clock_mono_ns();
        while (!ended && clock_mono_ns() - told_ns < ENDS_S * NS_PER_S) {
            usleep(10000);
            ended = waitpid(child, &status, WNOHANG);
        }
        if (!ended) {
            kill(child, SIGKILL);
            waitpid(child, &status, 0);
            fail_msg("it goes on %d s after a signal", ENDS_S);
        }
        assert_true(WIFEXITED(status));
        assert_int_equal(WEXITSTATUS(status), 1);
        prep_case_read(c, "err", &c->err);
        prep_case_says(&c->err, "interrupted");
    }
    write_plates(c, 10, 10, (double[]){ 1, 1 }, 1, here);
    prep_case_expect(c, "$PLANT", 0); /* the run after an interrupted one must succeed and leave no half-written files (*.new) */
    char *drafts = test_printf("ls '%s'/plant.prepared/*.new 2>/dev/null", c->folder);
    assert_int_not_equal(system(drafts), 0);
}
