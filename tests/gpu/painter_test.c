/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The render thread itself: who moves is served while another is refined; who moves on gets no more of what it wanted. */
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include <cmocka.h>

#include "base/clock.h"
#include "net/painter.h"
#include "tests/support/toy.h"

enum { REFINER = 1, MOVER = 2 };
static const int64_t PATIENCE_NS = 100 * NS_PER_S; /* far beyond any picture, under sanitizers too */

static struct toy *toy;
static struct log *logger;
static struct workers *workers;
static struct counters *counters;
static struct store *store;
static struct painter *painter;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t came = PTHREAD_COND_INITIALIZER;
static int notices;

static void on_pictures(void *arg)
{
    (void)arg;
    pthread_mutex_lock(&lock);
    notices++;
    pthread_cond_signal(&came);
    pthread_mutex_unlock(&lock);
}

/* The next picture; the caller owns it. */
static struct picture *next(void)
{
    static struct picture *waiting;
    int64_t until_ns = clock_utc_ns() + PATIENCE_NS;
    struct timespec until = { .tv_sec = until_ns / NS_PER_S };
    pthread_mutex_lock(&lock);
    while (!waiting) {
        while (notices == 0)
            if (pthread_cond_timedwait(&came, &lock, &until) != 0)
                fail_msg("no picture came");
        notices--;
        waiting = painter_collect(painter);
    }
    pthread_mutex_unlock(&lock);
    struct picture *picture = waiting;
    waiting = picture->next;
    return picture;
}

/* turn: of the camera. */
static void ask(uint64_t client, enum urgency urgency, double turn)
{
    int64_t now_ns = clock_mono_ns();
    struct wish wish = { .codec = WIRE_CODEC_JPEG, .quality = { .quality = 80 }, .urgency = urgency, .asked_ns = now_ns };
    bool still = urgency == URGENCY_REFINE;
    view_default(&toy->scene, still ? 2400 : 320, still ? 1600 : 180, &wish.view);
    wish.view.tier = still ? TIER_STILL : TIER_MOVING;
    wish.view.camera.eye_m[0] += turn;
    wish.view.input_ns = now_ns;
    assert_int_equal(painter_ask(painter, client, &wish), PAINTER_ADDED);
    painter_go(painter);
}

/* The value of a counter now. */
static int64_t count_of(const char *name)
{
    return *counters_add(counters, name, "counter", "");
}

static void await_step(int64_t steps)
{
    int64_t end_ns = clock_mono_ns() + PATIENCE_NS;
    while (count_of("plantcast_render_steps_total") < steps) {
        if (clock_mono_ns() > end_ns)
            fail_msg("no refinement was begun");
        nanosleep(&(struct timespec){ .tv_nsec = 100000 }, NULL);
    }
}

static void test_mover_is_served_during_a_refinement(void **state)
{
    (void)state;
    int64_t steps = count_of("plantcast_render_steps_total");
    ask(REFINER, URGENCY_REFINE, 0);
    await_step(steps + 1);
    for (int i = 1; i <= 8; i++) {
        ask(MOVER, URGENCY_INPUT, 0.1 * i);
        struct picture *picture = next();
        assert_int_equal(picture->client, MOVER);
        assert_true(picture->packet != NULL);
        picture_destroy(&picture);
    }
    struct picture *refined = next();
    assert_int_equal(refined->client, REFINER);
    assert_true(refined->packet && refined->packet->frame->view.tier == TIER_STILL);
    assert_true(refined->packet->frame->width_px == 2400);
    picture_destroy(&refined);
    assert_true(count_of("plantcast_render_steps_total") > steps + 4);
}

static void test_mover_gives_its_own_refinement_up(void **state)
{
    (void)state;
    int64_t steps = count_of("plantcast_render_steps_total"), abandoned = count_of("plantcast_renders_abandoned_total");
    ask(REFINER, URGENCY_REFINE, 1);
    await_step(steps + 1);
    ask(REFINER, URGENCY_INPUT, 2);
    int empty = 0, moving = 0;
    for (int i = 0; i < 2; i++) {
        struct picture *picture = next();
        assert_int_equal(picture->client, REFINER);
        assert_false(picture->failed);
        empty += picture->packet == NULL && picture->wish.urgency == URGENCY_REFINE;
        moving += picture->packet != NULL && picture->wish.urgency == URGENCY_INPUT;
        picture_destroy(&picture);
    }
    assert_true(empty == 1 && moving == 1);
    assert_true(count_of("plantcast_renders_abandoned_total") == abandoned + 1);
}

static void test_refinement_ends_while_others_go_on_moving(void **state)
{
    (void)state;
    int moved = 0;
    ask(REFINER, URGENCY_REFINE, 3);
    ask(MOVER, URGENCY_INPUT, -1);
    for (bool refined = false; !refined;) {
        struct picture *picture = next();
        assert_true(picture->packet != NULL);
        refined = picture->client == REFINER;
        picture_destroy(&picture);
        if (!refined)
            ask(MOVER, URGENCY_INPUT, -1 - 0.01 * ++moved);
    }
    assert_true(moved > 8);
    struct picture *last = next();
    assert_int_equal(last->client, MOVER);
    picture_destroy(&last);
}

/* The daemon goes down in the midst of it. */
static void test_stop_waits_for_no_refinement(void **state)
{
    (void)state;
    int64_t steps = count_of("plantcast_render_steps_total"), renders = count_of("plantcast_renders_total");
    ask(REFINER, URGENCY_REFINE, 4);
    await_step(steps + 1);
    painter_destroy(&painter);
    assert_true(count_of("plantcast_renders_total") == renders);
}

static bool start(void)
{
    const char *name = getenv("PLANTCAST_GL");
    enum gl_kind kind = GL_EGL_SURFACELESS;
    if (name && !gl_kind_parse(name, &kind))
        abort();
    toy = toy_unit();
    logger = log_create(LOG_INFO);
    workers = workers_create(2);
    counters = counters_create();
    store = store_create(&toy->plant);
    painter = painter_create(&(struct painter_params){ .log = logger, .gl = kind, .scene = &toy->scene, .store = store,
                                                       .workers = workers, .counters = counters, .notify = on_pictures });
    if (!painter)
        printf("TAP version 13\n1..1\nok 1 - painter_test # SKIP no %s context on this machine\n", gl_kind_name(kind));
    return painter != NULL;
}

static void stop(void)
{
    painter_destroy(&painter);
    store_destroy(&store);
    counters_destroy(&counters);
    workers_destroy(&workers);
    log_destroy(&logger);
    toy_destroy(&toy);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mover_is_served_during_a_refinement),
        cmocka_unit_test(test_mover_gives_its_own_refinement_up),
        cmocka_unit_test(test_refinement_ends_while_others_go_on_moving),
        cmocka_unit_test(test_stop_waits_for_no_refinement),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    int failed = start() ? cmocka_run_group_tests(tests, NULL, NULL) : 0;
    stop();
    return failed;
}
