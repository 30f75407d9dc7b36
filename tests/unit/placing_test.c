/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trial positions of sensors: a new trial is available at once, and is replaced by one with distances along the surface when these are
   computed. If one position of a trial is invalid, the whole trial is refused. */
#include "placing/placing.h"

#include "tests/support/test.h"
#include <pthread.h>

#include "tests/support/toy.h"
#include "value/quality.h"

enum { TAGS = 2 };
struct placing_fixture {
    struct log *log;
    struct workers *workers;
    struct toy *toy;
    struct snapshot *snapshot;
    struct placing *placing;
    struct place_set *set;
    char *folder;
    pthread_mutex_t lock;
    pthread_cond_t came;
    int count; /* number of notifications that an answer is available; protected by `lock` */
};

static void notify(void *arg)
{
    struct placing_fixture *f = arg;
    pthread_mutex_lock(&f->lock);
    f->count++;
    pthread_cond_broadcast(&f->came);
    pthread_mutex_unlock(&f->lock);
}

static void begin(struct placing_fixture *f)
{
    struct test_shape shape = { 0 };
    pthread_mutex_init(&f->lock, NULL);
    pthread_cond_init(&f->came, NULL);
    f->log = test_log();
    f->workers = test_workers(2);
    f->toy = toy_create();
    shape_box(&shape, TOY_STEEL, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 });
    toy_add(f->toy, "BOX", &shape, (double[3]){ 10, 0, 0 }, (const double[TAGS][3]){ { 0, 0.5, 0.5 }, { 1, 0.5, 0.5 } }, TAGS);
    f->snapshot = toy_snapshot(f->toy);
    for (int i = 0; i < TAGS; i++)
        toy_set(f->snapshot, i, 50, QUALITY_GOOD);
    f->folder = temp_folder(); /* nothing is prepared there */
    f->placing = placing_create(&(struct placing_params){
        .log = f->log, .workers = f->workers, .scene = &f->toy->scene, .folder = f->folder, .notify = notify, .notify_arg = f });
    f->set = place_set_create(f->placing);
}

static void end(struct placing_fixture *f)
{
    place_set_destroy(&f->set);
    placing_destroy(&f->placing);
    snapshot_destroy(&f->snapshot);
    toy_destroy(&f->toy);
    pthread_cond_destroy(&f->came);
    pthread_mutex_destroy(&f->lock);
}

TEST_FIXTURE(struct placing_fixture, begin, end)

#define CASE(name) TEST_ON(struct placing_fixture *f, name, set_up, tear_down)

/* Waits for the next answer. gaps: an answer about areas far from any sensor; otherwise returns NULL once no distances of the
   trial's positions are being computed. */
static struct sensor_coverage_answer *collect(struct placing_fixture *f, bool gaps)
{
    for (int seen = 0;;) {
        struct sensor_coverage_answer *answer = placing_collect(f->placing);
        const struct placed *placed;
        bool waits = false;
        for (size_t i = place_set_get(f->set, &placed); i-- > 0;)
            waits = waits || placed[i].state == PLACED_WAITING;
        if (answer || (!gaps && !waits))
            return answer;
        pthread_mutex_lock(&f->lock);
        while (f->count == seen)
            pthread_cond_wait(&f->came, &f->lock);
        seen = f->count;
        pthread_mutex_unlock(&f->lock);
    }
}

static bool move(struct placing_fixture *f, const struct place_move *moves, size_t count, enum refusal_code why_not)
{
    struct refusal why;
    bool moved = place_set_moves(f->set, moves, count, &why);
    assert_int_equal(moved, why_not == REFUSAL_NONE);
    if (why_not)
        assert_int_equal(why.code, why_not);
    return moved;
}

TEST_WITH(test_a_move_is_a_trial_at_once_and_a_better_one_later, set_up, tear_down)
{
    struct placing_fixture *f = *state;
    const struct placed *placed;
    move(f, &(struct place_move){ .tag = 0, .position_m = { 10.5, 0.5, 1.02 } }, 1, REFUSAL_NONE);
    uint32_t first = place_set_trial(f->set);
    assert_true(first != 0 && trials_live(placing_trials(f->placing), first));
    assert_int_equal(place_set_get(f->set, &placed), 1);
    assert_null(collect(f, false));
    assert_int_equal(placed[0].state, PLACED_READY);
    assert_true(place_set_changed(f->set) && !place_set_changed(f->set));
    assert_true(fabs(placed[0].surface_m[0] - 10.5) < 1e-3 && fabs(placed[0].surface_m[2] - 1) < 1e-3);
    assert_true(fabs(placed[0].distance_m - 0.02) < 1e-3 && placed[0].limit_m > placed[0].distance_m);
    uint32_t second = place_set_trial(f->set);
    assert_true(second != first && !trials_live(placing_trials(f->placing), first));
    const struct trial *trial = trials_take(placing_trials(f->placing), second);
    const struct trial_sensor *sensor = trial_find(trial, 0);
    const struct asset_view *view = &f->toy->scene.assets[0].file->view;
    double farthest_m = 0;
    for (uint32_t v = 0; v < view->header->vertex_count; v++) {
        const float *at_m = view->positions_m[v];
        double straight_m = hypot(hypot(at_m[0] - 0.5, at_m[1] - 0.5), at_m[2] - 1.0), along_m = (double)trial_distances(sensor)[v];
        farthest_m = fmax(farthest_m, along_m);
        /* the distance along the surface can be only slightly shorter than the straight line, by numerical error */
        assert_true(along_m > 0.94 * straight_m - 0.05);
    }
    /* farthest point: the middle of the box's bottom, 0.5 + 1 + 0.5 m along the surface from the sensor */
    assert_true(farthest_m > 1.85 && farthest_m < 2.4);
    trials_give(placing_trials(f->placing), &trial);
}

TEST_WITH(test_what_stays_keeps_its_distances, set_up, tear_down)
{
    struct placing_fixture *f = *state;
    struct place_move moves[TAGS] = { { .tag = 0, .position_m = { 10.5, 0.5, 1 } }, { .tag = 1, .position_m = { 10.5, 0.5, 0 } } };
    const struct placed *placed;
    move(f, moves, 1, REFUSAL_NONE);
    assert_null(collect(f, false));
    move(f, moves, TAGS, REFUSAL_NONE);
    place_set_get(f->set, &placed);
    assert_int_equal(placed[0].state, PLACED_READY);
    assert_null(collect(f, false));
    assert_int_equal(placed[1].state, PLACED_READY);
    move(f, NULL, 0, REFUSAL_NONE);
    assert_int_equal(place_set_trial(f->set), 0);
}

CASE(test_what_cannot_be_is_refused_and_nothing_moves)
{
    struct place_move here = { .tag = 0, .position_m = { 10.5, 0.5, 1 } }, far = { .tag = 1, .position_m = { 60, 0, 0 } };
    const struct placed *placed;
    move(f, &here, 1, REFUSAL_NONE);
    uint32_t trial = place_set_trial(f->set);
    move(f, (struct place_move[]){ here, far }, 2, REFUSAL_FAR);
    move(f, (struct place_move[]){ here, here }, 2, REFUSAL_TWICE);
    f->toy->plant.tags[1].group = -1;
    far.position_m[0] = 11;
    move(f, &far, 1, REFUSAL_GROUPLESS);
    assert_int_equal(place_set_get(f->set, &placed), 1);
    assert_int_equal(placed[0].move.tag, 0);
    assert_int_equal(place_set_trial(f->set), trial);
}

CASE(test_gaps_are_of_what_the_set_has_moved)
{
    move(f, &(struct place_move){ .tag = 0, .position_m = { 11, 0.5, 0.4 } }, 1, REFUSAL_NONE); /* next to the other asset */
    collect(f, false);
    for (int moved = 0; moved < 2; moved++) {
        placing_request_coverage(f->placing, moved ? f->set : NULL, 0, 0.8, f->snapshot, 7, 3 + (uint32_t)moved);
        struct sensor_coverage_answer *answer = collect(f, true);
        assert_non_null(answer);
        assert_true(answer->client == 7 && answer->seq == 3 + (uint32_t)moved && answer->count == 1);
        assert_int_equal(answer->assets[0].coverage.sensors, TAGS);
        assert_true(moved ? answer->assets[0].coverage.next_m < 0.2 : answer->assets[0].coverage.next_m >= 1);
        assert_true(moved ? answer->assets[0].coverage.far_share > 0.3 : answer->assets[0].coverage.far_share < 0.2);
        sensor_coverage_answer_free(answer);
    }
}

/* A client's set of trial positions is destroyed while its request is being computed. The destruction must not wait for the
   result, and no answer may be delivered. */
CASE(test_a_set_that_goes_takes_its_questions_along)
{
    for (int i = 0; i < 20; i++) {
        struct place_set *other = place_set_create(f->placing);
        struct refusal why;
        assert_true(place_set_moves(other, &(struct place_move){ .tag = 0, .position_m = { 10.5, 0.05 * i, 1 } }, 1, &why));
        placing_request_coverage(f->placing, other, 0, 0, f->snapshot, 1, 1);
        place_set_destroy(&other);
        assert_null(other);
    }
    int answers = 0;
    while (answers < 20)
        for (struct sensor_coverage_answer *answer = collect(f, true), *next; answer; answer = next) {
            next = answer->next;
            sensor_coverage_answer_free(answer);
            answers++;
        }
}
