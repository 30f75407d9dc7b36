/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The render service, which draws and encodes frames for all clients on its own threads. Frames of a moving client are drawn
   between the steps of another client's refined frame, and abandoned requests are not drawn. */
#include "tests/support/test.h"
#include <pthread.h>
#include <stdatomic.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "service/render_service.h"
#include "tests/support/sleep.h"
#include "tests/support/toy.h"
#include "value/quality.h"

#define ENCODES "plantcast_encodes_total{codec=\"jpeg\"}"
enum { REFINER = 1, MOVER = 2, PICKER = 3, VIEWERS = 100 };
/* age at which a drawn frame is no longer given to other clients that request the same view */
static const int64_t RECENT_NS = 600 * NS_PER_MS;
/* maximum wait of a test for a frame; far longer than any frame takes, also under sanitizers */
static const int64_t PATIENCE_NS = 100 * NS_PER_S;

static struct toy *toy;
static struct log *logger;
static struct workers *workers;
static struct counters *counters;
static struct store *store;
static struct render_service *service;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t came = PTHREAD_COND_INITIALIZER;
static int notices;
/* true: a GPU draws. Tests of refinement in steps are skipped then, because a GPU draws a refined frame in a single step */
static bool hardware;

static void on_pictures(void *arg)
{
    (void)arg;
    pthread_mutex_lock(&lock);
    notices++;
    pthread_cond_signal(&came);
    pthread_mutex_unlock(&lock);
}

/* Waits for the next encoded frame of any client. The caller destroys it. */
static struct encoded_frame *next(void)
{
    static struct encoded_frame *waiting;
    int64_t until_ns = clock_utc_ns() + PATIENCE_NS;
    struct timespec until = { .tv_sec = until_ns / NS_PER_S };
    pthread_mutex_lock(&lock);
    while (!waiting) {
        while (notices == 0)
            if (pthread_cond_timedwait(&came, &lock, &until) != 0)
                fail_msg("no picture came");
        notices--;
        waiting = render_service_collect(service);
    }
    pthread_mutex_unlock(&lock);
    struct encoded_frame *encoded = waiting;
    waiting = encoded->next;
    return encoded;
}

static void ask_sized(uint64_t client, enum urgency urgency, double turn, int width_px, int height_px)
{
    int64_t now_ns = clock_mono_ns();
    struct frame_request request = {
        .codec = WIRE_CODEC_JPEG, .quality = { .quality = 80 }, .urgency = urgency, .asked_ns = now_ns, .always = true
    };
    view_default(&toy->scene, width_px, height_px, &request.view);
    request.view.tier = urgency == URGENCY_REFINE ? TIER_REFINED : TIER_PREVIEW;
    request.view.camera.eye_m[0] += turn;
    request.view.input_ns = now_ns;
    assert_int_equal(render_service_request(service, client, &request), REQUEST_ADDED);
    render_service_wake(service);
}

/* Requests a frame for a client: with URGENCY_REFINE a refined one of 2400 x 1600 pixels, otherwise one of 320 x 180. turn: how
   far the camera is moved, so that different values give different views. */
static void ask(uint64_t client, enum urgency urgency, double turn)
{
    bool still = urgency == URGENCY_REFINE;
    ask_sized(client, urgency, turn, still ? 2400 : 320, still ? 1600 : 180);
}

/* Returns the counter's current value. */
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

TEST(test_mover_is_served_during_a_refinement)
{
    if (hardware)
        skip();
    int64_t steps = count_of("plantcast_render_steps_total");
    ask(REFINER, URGENCY_REFINE, 0);
    await_step(steps + 1);
    for (int i = 1; i <= 8; i++) {
        ask(MOVER, URGENCY_INPUT, 0.1 * i);
        struct encoded_frame *encoded = next();
        assert_int_equal(encoded->client, MOVER);
        assert_true(encoded->packet != NULL);
        encoded_frame_destroy(&encoded);
    }
    struct encoded_frame *refined = next();
    assert_int_equal(refined->client, REFINER);
    assert_true(refined->packet && refined->packet->frame->view.tier == TIER_REFINED);
    assert_true(refined->packet->frame->width_px == 2400);
    encoded_frame_destroy(&refined);
    assert_true(count_of("plantcast_render_steps_total") > steps + 4);
}

/* A large and then a small snapshot are requested for one address, and a small one for another address. The other address's
   small frame must be delivered before the large frame. */
TEST(test_a_small_picture_overtakes_a_large_one_of_another)
{
    if (hardware)
        skip();
    int64_t steps = count_of("plantcast_render_steps_total");
    struct frame_request request = { .codec = WIRE_CODEC_JPEG, .quality = { .quality = 80 }, .urgency = URGENCY_SNAPSHOT, .always = true };
    const struct {
        uint64_t client, account;
        int width_px, height_px;
    } asked[] = { { REFINER, 1, 2400, 1600 }, { PICKER, 1, 320, 200 }, { MOVER, 2, 320, 200 } };
    for (int i = 0; i < 3; i++) {
        request.asked_ns = clock_mono_ns();
        request.account = asked[i].account;
        view_default(&toy->scene, asked[i].width_px, asked[i].height_px, &request.view);
        request.view.tier = TIER_REFINED;
        request.view.camera.eye_m[0] += 7 + i;
        assert_int_equal(render_service_request(service, asked[i].client, &request), REQUEST_ADDED);
        render_service_wake(service);
        if (i == 0)
            await_step(steps + 2);
    }
    static const uint64_t query[] = { MOVER, REFINER, PICKER };
    for (int i = 0; i < 3; i++) {
        struct encoded_frame *encoded = next();
        assert_true(encoded->packet && encoded->client == query[i]);
        encoded_frame_destroy(&encoded);
    }
    for (int i = 0; i < 3; i++)
        render_service_forget(service, asked[i].client);
}

/* While a large frame for another address is drawn, an address requests a snapshot and later a refined frame. The snapshot must
   be delivered before the refined frame. */
TEST(test_a_snapshot_goes_before_a_later_refinement)
{
    if (hardware)
        skip();
    int64_t steps = count_of("plantcast_render_steps_total");
    static const uint64_t clients[] = { REFINER, PICKER, MOVER };
    struct frame_request requests[3];
    enum request_outcome outcomes[3];
    for (int i = 0; i < 3; i++) {
        requests[i] = (struct frame_request){ .codec = WIRE_CODEC_JPEG,
                                              .quality = { .quality = 80 },
                                              .urgency = i == 2 ? URGENCY_REFINE : URGENCY_SNAPSHOT,
                                              .asked_ns = clock_mono_ns() + i,
                                              .account = i > 0 ? 2 : 1,
                                              .always = true };
        view_default(&toy->scene, i > 0 ? 320 : 2400, i > 0 ? 200 : 1600, &requests[i].view);
        requests[i].view.tier = TIER_REFINED;
        requests[i].view.camera.eye_m[0] += 17 + i;
    }
    render_service_request_all(service, 1, clients, requests, outcomes);
    render_service_wake(service);
    await_step(steps + 2);
    render_service_request_all(service, 2, clients + 1, requests + 1, outcomes + 1);
    render_service_wake(service);
    uint64_t sum = 0;
    for (int i = 0; i < 3; i++) {
        struct encoded_frame *encoded = next();
        assert_true(encoded->packet && (i > 0 || encoded->client == PICKER));
        sum += encoded->client;
        encoded_frame_destroy(&encoded);
    }
    /* all three frames arrive: the large one was continued although no client requested anything meanwhile */
    assert_int_equal(sum, REFINER + MOVER + PICKER);
    for (int i = 0; i < 3; i++)
        render_service_forget(service, clients[i]);
}

TEST(test_mover_gives_its_own_refinement_up)
{
    if (hardware)
        skip();
    int64_t steps = count_of("plantcast_render_steps_total"), abandoned = count_of("plantcast_renders_abandoned_total");
    ask(REFINER, URGENCY_REFINE, 1);
    await_step(steps + 1);
    ask(REFINER, URGENCY_INPUT, 2);
    int empty = 0, moving = 0;
    for (int i = 0; i < 2; i++) {
        struct encoded_frame *encoded = next();
        assert_int_equal(encoded->client, REFINER);
        assert_true(encoded->packet || encoded->absence != FRAME_FAILED);
        empty += encoded->packet == NULL && encoded->request.urgency == URGENCY_REFINE;
        moving += encoded->packet != NULL && encoded->request.urgency == URGENCY_INPUT;
        encoded_frame_destroy(&encoded);
    }
    assert_true(empty == 1 && moving == 1);
    assert_true(count_of("plantcast_renders_abandoned_total") == abandoned + 1);
}

TEST(test_refinement_ends_while_others_go_on_moving)
{
    int moved = 0;
    ask(REFINER, URGENCY_REFINE, 3);
    ask(MOVER, URGENCY_INPUT, -1);
    for (bool refined = false; !refined;) {
        struct encoded_frame *encoded = next();
        assert_true(encoded->packet != NULL);
        refined = encoded->client == REFINER;
        encoded_frame_destroy(&encoded);
        if (!refined)
            ask(MOVER, URGENCY_INPUT, -1 - 0.01 * ++moved);
    }
    assert_true(moved > 8);
    struct encoded_frame *last = next();
    assert_int_equal(last->client, MOVER);
    encoded_frame_destroy(&last);
}

/* Measures how long a client's 40 previews take alone, and while another client's frame is refined. Returns whether the number
   of refinement steps that ran in between is within the expected bound. */
static bool refining_costs_little(int attempt)
{
    enum { PICTURES = 40 };
    int64_t took_ns[2], steps = 0;
    bool refined = false;
    for (int with = 0; with < 2; with++) {
        if (with) {
            steps = count_of("plantcast_render_steps_total");
            ask(REFINER, URGENCY_REFINE, 11 + 0.1 * attempt);
            await_step(++steps);
        }
        int64_t begin_ns = clock_mono_ns();
        for (int i = 0; i < PICTURES;) {
            ask(MOVER, URGENCY_INPUT, 20 + 2 * attempt + with + 0.01 * i);
            for (bool moved = false; !moved;) {
                struct encoded_frame *encoded = next();
                moved = encoded->client == MOVER;
                refined |= !moved;
                i += moved;
                encoded_frame_destroy(&encoded);
            }
        }
        took_ns[with] = clock_mono_ns() - begin_ns;
    }
    print_message("# %d pictures: %.1f ms alone, %.1f ms beside a refinement\n", PICTURES, (double)took_ns[0] / NS_PER_MS,
                  (double)took_ns[1] / NS_PER_MS);
    /* expected bound: one refinement step per 150 ms without a preview, plus two */
    bool little = count_of("plantcast_render_steps_total") - steps <= 2 + took_ns[1] / (150 * NS_PER_MS);
    while (!refined) {
        struct encoded_frame *encoded = next();
        refined = encoded->client == REFINER && encoded->packet;
        encoded_frame_destroy(&encoded);
    }
    return little;
}

/* Previews of one client must hardly be delayed by the refinement of another client's frame. Repeated up to some attempts: if
   this thread is delayed by 150 ms, refinement steps run although a preview would be requested. */
TEST(test_refining_one_costs_a_mover_little)
{
    if (hardware)
        skip();
    bool little = false;
    for (int attempt = 0; attempt < 5 && !little; attempt++)
        little = refining_costs_little(attempt);
    assert_true(little);
}

/* A hundred clients request the same view, half of them at once, the others when they get their frame. All must share one
   rendered and encoded frame; another quality requires only another encoding. */
TEST(test_a_hundred_viewers_cost_one_picture)
{
    int64_t renders = count_of("plantcast_renders_total"), encodes = count_of(ENCODES);
    const struct packet *shared = NULL;
    struct frame_request request = {
        .codec = WIRE_CODEC_JPEG, .quality = { .quality = 80 }, .urgency = URGENCY_INPUT, .asked_ns = clock_mono_ns()
    };
    view_default(&toy->scene, 640, 360, &request.view);
    request.view.camera.eye_m[0] += 30;
    for (int i = 0; i < VIEWERS / 2; i++)
        render_service_request(service, 1000 + (uint64_t)i, &request);
    render_service_wake(service);
    for (int i = 0; i < VIEWERS; i++) {
        if (i >= VIEWERS / 2) {
            render_service_request(service, 1000 + (uint64_t)i, &request);
            render_service_wake(service);
        }
        struct encoded_frame *encoded = next();
        assert_non_null(encoded->packet);
        assert_true(!shared || encoded->packet == shared);
        shared = encoded->packet;
        encoded_frame_destroy(&encoded);
    }
    assert_int_equal(count_of("plantcast_renders_total") - renders, 1);
    assert_int_equal(count_of(ENCODES) - encodes, 1);
    request.quality.quality = 42; /* with another quality the rendered frame is shared, and only the encoding is done again */
    request.always = true;
    render_service_request(service, 1000, &request);
    render_service_wake(service);
    struct encoded_frame *poorer = next();
    assert_true(poorer->packet && poorer->packet != shared);
    assert_int_equal(count_of("plantcast_renders_total") - renders, 1);
    assert_int_equal(count_of(ENCODES) - encodes, 2);
    encoded_frame_destroy(&poorer);
    for (uint64_t i = 0; i < VIEWERS; i++)
        render_service_forget(service, 1000 + i);
}

static void ask_with_depth(uint64_t client, bool depth, double turn)
{
    struct frame_request request = {
        .codec = WIRE_CODEC_JPEG, .quality = { .quality = 80 }, .urgency = URGENCY_INPUT, .asked_ns = clock_mono_ns(), .depth = depth
    };
    view_default(&toy->scene, 320, 200, &request.view);
    request.view.tier = TIER_PREVIEW;
    request.view.camera.eye_m[0] += turn;
    assert_int_equal(render_service_request(service, client, &request), REQUEST_ADDED);
    render_service_wake(service);
}

/* Requests a new view for a client, with or without the wish for a depth grid. Returns whether the frame that it gets has a
   depth grid. */
static bool gets_depth(uint64_t client, bool depth, double turn)
{
    ask_with_depth(client, depth, turn);
    struct encoded_frame *encoded = next();
    assert_true(encoded->packet && encoded->client == client);
    bool gets = encoded->packet->frame->depth[0] != NULL;
    encoded_frame_destroy(&encoded);
    return gets;
}

TEST(test_depth_is_drawn_while_a_client_that_wants_it_is_present)
{
    assert_false(gets_depth(MOVER, false, 60));
    assert_true(gets_depth(PICKER, true, 61));
    assert_true(gets_depth(MOVER, false, 62));
    assert_false(gets_depth(PICKER, false, 63));
    assert_false(gets_depth(MOVER, false, 64));
    assert_true(gets_depth(PICKER, true, 65));
    render_service_forget(service, PICKER);
    assert_false(gets_depth(MOVER, false, 66));
    render_service_forget(service, MOVER);
}

/* Requests that a client withdraws before they are drawn must be answered with FRAME_SKIPPED. The second request still waits
   when it is withdrawn, because the service refines one frame at a time and the first refinement is under way. */
TEST(test_withdrawn_requests_are_not_drawn)
{
    if (hardware)
        skip();
    int64_t steps = count_of("plantcast_render_steps_total");
    ask(REFINER, URGENCY_REFINE, 70);
    await_step(steps + 1);
    ask(MOVER, URGENCY_REFINE, 71);
    render_service_withdraw(service, MOVER);
    render_service_withdraw(service, REFINER);
    render_service_withdraw(service, PICKER); /* withdrawing for a client without a request must have no effect */
    for (int i = 0; i < 2; i++) {
        struct encoded_frame *encoded = next();
        if (encoded->client == MOVER)
            assert_true(!encoded->packet && encoded->absence == FRAME_SKIPPED);
        encoded_frame_destroy(&encoded);
    }
    ask(MOVER, URGENCY_INPUT, 72); /* requests a frame again after the withdrawal, as a client does when its hidden page is shown */
    struct encoded_frame *encoded = next();
    assert_true(encoded->packet && encoded->client == MOVER);
    encoded_frame_destroy(&encoded);
    render_service_forget(service, MOVER);
    render_service_forget(service, REFINER);
}

/* Two clients request frames all the time, one of 2560 x 1440 and the other of 320 x 180 pixels. Returns whether the second
   client got more than twice as many frames. */
static bool shares_time(void)
{
    enum { LARGE = 2000, SMALL = 2001, LARGES = 5, PICTURES = 5000 };
    int counts[2] = { 0, 0 };
    ask_sized(LARGE, URGENCY_INPUT, 40, 2560, 1440);
    ask_sized(SMALL, URGENCY_INPUT, 50, 320, 180);
    for (int i = 0; i < PICTURES && counts[0] < LARGES; i++) {
        struct encoded_frame *encoded = next();
        int which = encoded->client == SMALL;
        counts[which]++;
        ask_sized(encoded->client, URGENCY_INPUT, (which ? 50 : 40) + 0.01 * i, which ? 320 : 2560, which ? 180 : 1440);
        encoded_frame_destroy(&encoded);
    }
    for (int i = 0; i < 2; i++) {
        struct encoded_frame *encoded = next();
        encoded_frame_destroy(&encoded);
    }
    assert_int_equal(counts[0], LARGES);
    print_message("# %d large pictures, %d small ones\n", counts[0], counts[1]);
    return counts[1] > 2 * counts[0];
}

/* The service shares its drawing time equally among clients, so a client with small frames gets more of them. Repeated if it
   fails, because this thread may have requested the small frames too late. */
TEST(test_time_is_shared_not_pictures)
{
    bool shared = false;
    for (int attempt = 0; attempt < 5 && !shared; attempt++)
        shared = shares_time();
    assert_true(shared);
}

static void assert_same_bytes(const struct packet *a, const struct packet *b)
{
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->bytes, b->bytes, a->count);
}

/* Requests a frame for a client with the camera moved by `turn`, and returns that frame. */
static struct encoded_frame *picture_of(uint64_t client, enum urgency urgency, double turn)
{
    ask(client, urgency, turn);
    struct encoded_frame *encoded = next();
    assert_int_equal(encoded->client, client);
    assert_true(encoded->packet != NULL);
    return encoded;
}

/* Requests a refined frame that is large enough for a GL context loss to happen while it is drawn. */
static void ask_for_still(double turn)
{
    ask_sized(REFINER, URGENCY_REFINE, turn, sweep(2400, 1200), sweep(1600, 800));
}

static struct encoded_frame *refined_of(double turn)
{
    ask_for_still(turn);
    struct encoded_frame *encoded = next();
    assert_true(encoded->client == REFINER && encoded->packet);
    return encoded;
}

/* The GL context is lost repeatedly while large refined frames and small ones are drawn. Every request must get its frame, and
   each must equal the frame drawn before the losses. */
TEST(test_lost_context_is_made_again_under_load)
{
    enum { LOSSES = 3, MOVES = 4 };
    const int tried = sweep(LOSSES, 2); /* in short runs two losses: one while the service is idle, one during a refinement */
    int64_t losses = count_of("plantcast_gl_losses_total"), failures = count_of("plantcast_render_failures_total");
    struct encoded_frame *refined[LOSSES], *moved[MOVES];
    for (int i = 0; i < tried; i++) /* each frame has another view, because frames of a repeated view are cached */
        refined[i] = refined_of(5 + 0.1 * i);
    for (int i = 0; i < MOVES; i++)
        moved[i] = picture_of(MOVER, URGENCY_INPUT, 6 + i);
    for (int loss = 0; loss < tried; loss++) {
        sleep_ns(RECENT_NS);
        int64_t steps = count_of("plantcast_render_steps_total");
        int refinements = 0;
        ask_for_still(5 + 0.1 * loss);
        if (loss > 0 && !hardware)
            await_step(steps + 1);
        render_service_lose_context(service);
        for (int i = 0; i < MOVES;) {
            ask(MOVER, URGENCY_INPUT, 6 + i);
            for (bool answered = false; !answered;) {
                struct encoded_frame *encoded = next();
                assert_true(encoded->packet);
                answered = encoded->client == MOVER;
                refinements += !answered;
                assert_same_bytes(encoded->packet, answered ? moved[i++]->packet : refined[loss]->packet);
                encoded_frame_destroy(&encoded);
            }
        }
        if (refinements == 0) {
            struct encoded_frame *encoded = next();
            assert_true(encoded->client == REFINER && encoded->packet);
            assert_same_bytes(encoded->packet, refined[loss]->packet);
            encoded_frame_destroy(&encoded);
        }
        assert_true(render_service_ready(service));
    }
    assert_true(count_of("plantcast_gl_losses_total") == losses + tried);
    assert_true(count_of("plantcast_render_failures_total") == failures);
    for (int i = 0; i < tried; i++)
        encoded_frame_destroy(&refined[i]);
    for (int i = 0; i < MOVES; i++)
        encoded_frame_destroy(&moved[i]);
}

static size_t address_space_bytes(void)
{
    unsigned long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    assert_true(file && fscanf(file, "%lu", &pages) == 1);
    fclose(file);
    return pages * (size_t)sysconf(_SC_PAGESIZE);
}

/* The address space is limited so that a frame itself can be allocated, but not the buffers from which it is computed. Only
   that frame may fail; later frames must be drawn as before. */
TEST(test_no_memory_fails_that_picture_alone)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    skip(); /* under sanitizers, a failed allocation ends the program */
#endif
    enum { BIG_PX = 4096, ROOM_BYTES = 160 << 20 };
    struct rlimit all, tight;
    struct encoded_frame *before = picture_of(MOVER, URGENCY_INPUT, 7);
    int64_t failures = count_of("plantcast_render_failures_total");
    getrlimit(RLIMIT_AS, &all);
    tight = (struct rlimit){ .rlim_cur = address_space_bytes() + ROOM_BYTES, .rlim_max = all.rlim_max };
    assert_int_equal(setrlimit(RLIMIT_AS, &tight), 0);
    ask_sized(REFINER, URGENCY_REFINE, 0, BIG_PX, BIG_PX);
    struct encoded_frame *failed = next();
    setrlimit(RLIMIT_AS, &all);
    assert_true(failed->client == REFINER && failed->absence == FRAME_FAILED && !failed->packet);
    assert_true(count_of("plantcast_render_failures_total") == failures + 1);
    struct encoded_frame *after = picture_of(MOVER, URGENCY_INPUT, 7);
    assert_same_bytes(after->packet, before->packet);
    encoded_frame_destroy(&before);
    encoded_frame_destroy(&failed);
    encoded_frame_destroy(&after);
}

/* A frame that was drawn but could not be encoded was not shown to the client. If the client repeats the request with another
   codec, it must get the frame, not the answer "unchanged". */
TEST(test_what_could_not_be_encoded_is_drawn_again)
{
    /* the first codec has no encoder in this test, so encoding fails */
    const enum wire_codec codecs[] = { WIRE_CODEC_H264, WIRE_CODEC_JPEG };
    for (int i = 0; i < 2; i++) {
        struct frame_request request = {
            .codec = codecs[i], .quality = { .quality = 80 }, .urgency = URGENCY_INPUT, .asked_ns = clock_mono_ns()
        };
        view_default(&toy->scene, 320, 180, &request.view);
        request.view.tier = TIER_PREVIEW;
        request.view.camera.eye_m[0] += 11;
        assert_int_equal(render_service_request(service, MOVER, &request), REQUEST_ADDED);
        render_service_wake(service);
        struct encoded_frame *encoded = next();
        assert_true(!encoded->packet == (i == 0) && (i > 0 || encoded->absence == FRAME_FAILED));
        encoded_frame_destroy(&encoded);
    }
}

static struct pick_answer *next_pick(void)
{
    int64_t until_ns = clock_utc_ns() + PATIENCE_NS;
    struct timespec until = { .tv_sec = until_ns / NS_PER_S };
    struct pick_answer *answer;
    pthread_mutex_lock(&lock);
    while (!(answer = render_service_collect_picks(service)))
        if (pthread_cond_timedwait(&came, &lock, &until) != 0)
            fail_msg("no answer came");
    pthread_mutex_unlock(&lock);
    return answer;
}

/* A pick is answered between two steps of a slow frame: it does not wait for the frame, and delays it by at most one step. */
TEST(test_picks_are_answered_between_steps)
{
    if (hardware)
        skip();
    struct pick_query query = { .client = PICKER, .x_px = 320, .y_px = 180 };
    view_default(&toy->scene, 640, 360, &query.view);
    int64_t steps = count_of("plantcast_render_steps_total");
    ask(REFINER, URGENCY_REFINE, 2);
    await_step(steps + 1);
    for (uint32_t i = 1; i <= 20; i++) {
        query.seq = i;
        render_service_pick(service, &query);
        struct pick_answer *answer = next_pick();
        assert_int_equal(answer->query.seq, i);
        assert_true(answer->pick.asset >= 0 && !answer->next);
        mem_free(answer);
    }
    render_service_forget(service, PICKER);
    struct encoded_frame *refined = next();
    assert_true(refined->client == REFINER && refined->packet);
    encoded_frame_destroy(&refined);
}

/* If a client sends several picks before the first is answered, only the newest must be answered. */
TEST(test_newest_pick_wins)
{
    struct pick_query query = { .client = PICKER, .x_px = 320, .y_px = 180 };
    view_default(&toy->scene, 640, 360, &query.view);
    uint32_t last = 0;
    int answers = 0;
    for (query.seq = 1; query.seq <= 500; query.seq++)
        render_service_pick(service, &query);
    while (last < 500) {
        for (struct pick_answer *answer = next_pick(), *after; answer; answer = after) {
            after = answer->next;
            assert_true(answer->query.seq > last);
            last = answer->query.seq;
            answers++;
            mem_free(answer);
        }
    }
    print_message("# %d of 500 answered\n", answers);
}

static bool make_service(bool by_gl, size_t memory_bytes)
{
    const char *name = getenv("PLANTCAST_GL");
    enum gl_kind kind = GL_EGL_SURFACELESS;
    if (name && !gl_kind_parse(name, &kind))
        abort();
    struct gl *gl = gl_create(logger, kind, NULL);
    hardware = gl && !gl->software;
    gl_destroy(&gl);
    service = render_service_create(&(struct render_service_params){ .log = logger,
                                                                     .gl = kind,
                                                                     .scene = &toy->scene,
                                                                     .store = store,
                                                                     .workers = workers,
                                                                     .counters = counters,
                                                                     .notify = on_pictures,
                                                                     .h264_library = "none",
                                                                     .by_gl = by_gl,
                                                                     .memory_bytes = memory_bytes });
    if (!service)
        printf("TAP version 13\n1..1\nok 1 - render_service_test # SKIP no %s context on this machine\n", gl_kind_name(kind));
    return service != NULL;
}

static void remake(bool by_gl, size_t memory_bytes)
{
    render_service_destroy(&service);
    assert_true(make_service(by_gl, memory_bytes));
}

/* Writes readings to the store without passing them to the service, as if the event loop had not yet read them. */
static void write_readings(double value)
{
    for (int tag = 0; tag < (int)toy->plant.tag_count; tag++) {
        struct sample sample = { .tag = tag, .value = value + tag, .quality = QUALITY_GOOD };
        store_write(store, &sample, 1, clock_mono_ns(), clock_utc_ns());
    }
}

/* Passes a snapshot of the store's readings to the service, as the event loop does. ahead_ns: how much later than now the
   snapshot is dated. */
static void pass_readings(int64_t ahead_ns)
{
    struct snapshot *snapshot = test_snapshot(toy->plant.tag_count);
    store_snapshot(store, clock_mono_ns(), clock_utc_ns(), snapshot);
    snapshot->taken_mono_ns += ahead_ns;
    render_service_set_readings(service, snapshot);
}

static void change_readings(double value)
{
    write_readings(value);
    pass_readings(0);
}

/* Sessions get the readings of the event loop's snapshot as text. Frames must show the readings of the same snapshot, even if
   the store already has newer ones. */
TEST(test_frames_show_the_readings_of_the_texts)
{
    remake(false, 0);
    for (double value = 20; value <= 30; value += 10) {
        write_readings(value);
        pass_readings(value < 30 ? PATIENCE_NS : 2 * PATIENCE_NS);
        write_readings(90);
        ask(MOVER, URGENCY_INPUT, value);
        struct encoded_frame *encoded = next();
        const struct frame *frame = encoded->packet->frame;
        assert_true(frame->marker_count > 0);
        for (size_t i = 0; i < frame->marker_count; i++)
            assert_true(frame->markers[i].value == value + frame->markers[i].tag);
        encoded_frame_destroy(&encoded);
    }
    remake(false, 0);
}

/* One client requests a frame without a depth grid, and another requests the same view with one. The pauses between the
   requests vary, so that the second arrives before, while or after GL draws the first frame. The second client must always get
   a depth grid. */
TEST(test_a_frame_that_gl_draws_without_depth_does_not_answer_a_client_that_wants_it)
{
    remake(true, 0);
    for (int i = 0; i < 12; i++) {
        ask_with_depth(MOVER, false, 70 + i);
        sleep_ns(i * NS_PER_MS);
        ask_with_depth(PICKER, true, 70 + i);
        for (int left = 2; left > 0; left--) {
            struct encoded_frame *encoded = next();
            assert_true(encoded->packet && (encoded->client == MOVER || encoded->packet->frame->depth[0]));
            encoded_frame_destroy(&encoded);
        }
        render_service_forget(service, PICKER);
    }
    remake(false, 0);
}

static int refined_width_px; /* width in pixels of refined frames while readings change */

static void refined_of_look(enum look look, struct view *view)
{
    view_default(&toy->scene, refined_width_px, refined_width_px * 2 / 3, view);
    view->tier = TIER_REFINED;
    view->look = look;
    view->camera.eye_m[0] += 0.05;
}

static void ask_for_refined(uint64_t client, enum look look)
{
    struct frame_request request = {
        .codec = WIRE_CODEC_JPEG, .quality = { .quality = 80 }, .urgency = URGENCY_REFINE, .asked_ns = clock_mono_ns(), .always = true
    };
    refined_of_look(look, &request.view);
    assert_int_equal(render_service_request(service, client, &request), REQUEST_ADDED);
    render_service_wake(service);
}

/* Requests a frame because of changed readings, as a session does that shows a refined frame. waited_ns: how long the changed
   readings have already waited. Returns the number of additional answers that the service will send: 1, or 0 if the request
   replaced a waiting one. */
static int ask_for_data(uint64_t client, enum look look, int64_t waited_ns)
{
    struct frame_request request = { .codec = WIRE_CODEC_JPEG,
                                     .quality = { .quality = 80 },
                                     .moving_quality = { .quality = 80 },
                                     .urgency = URGENCY_DATA,
                                     .or_moving = true,
                                     .of_data = true,
                                     .asked_ns = clock_mono_ns() - waited_ns };
    refined_of_look(look, &request.view);
    enum request_outcome answer = render_service_request(service, client, &request);
    render_service_wake(service);
    return answer == REQUEST_ADDED;
}

/* Changes readings after every frame while a refined frame is being drawn. Asserts that the refined frame arrives all the same,
   and that no frame shows older readings than the one before. Returns whether no frame was abandoned meanwhile. */
static bool refined_comes(enum look look, int64_t waited_ns)
{
    int64_t steps = count_of("plantcast_render_steps_total"), abandoned = count_of("plantcast_renders_abandoned_total");
    bool refined = false;
    int64_t shown_ns = 0;
    int owed = 1;
    change_readings(20);
    ask_for_refined(REFINER, look);
    if (!hardware)
        await_step(steps + 1);
    for (int i = 0; i < 8 || !refined; i++, owed--) {
        assert_true(i < 1000);
        change_readings(30 + i % 40);
        owed += ask_for_data(REFINER, look, waited_ns);
        struct encoded_frame *encoded = next();
        assert_true(encoded->client == REFINER && (encoded->packet || encoded->absence != FRAME_FAILED));
        if (encoded->packet) {
            refined |= encoded->packet->frame->view.tier == TIER_REFINED;
            assert_true(encoded->packet->frame->data_utc_ns >= shown_ns);
            shown_ns = encoded->packet->frame->data_utc_ns;
        }
        encoded_frame_destroy(&encoded);
    }
    for (; owed > 0; owed--) {
        struct encoded_frame *last = next();
        encoded_frame_destroy(&last);
    }
    return count_of("plantcast_renders_abandoned_total") == abandoned;
}

/* Asserts that the refined frame arrives although readings change, and that afterwards each change yields a refined frame by
   recolouring alone, without refinement steps. */
static void assert_refined_comes(enum look look, int64_t waited_ns)
{
    assert_true(refined_comes(look, waited_ns));
    int64_t steps = count_of("plantcast_render_steps_total");
    for (int i = 0; i < 8; i++) {
        change_readings(80 - 5 * i);
        assert_int_equal(ask_for_data(REFINER, look, 0), 1);
        struct encoded_frame *encoded = next();
        assert_true(encoded->packet && encoded->packet->frame->view.tier == TIER_REFINED);
        assert_int_equal(encoded->packet->frame->width_px, refined_width_px);
        encoded_frame_destroy(&encoded);
    }
    assert_int_equal(count_of("plantcast_render_steps_total"), steps);
    render_service_forget(service, REFINER);
}

TEST(test_changing_readings_leave_refined_pictures)
{
    if (hardware)
        skip();
    assert_refined_comes(LOOK_DEFAULT, 0);
}

/* A refinement that takes longer than changed readings may wait, simulated by requests that have already waited 2 s: the
   refined frame must still be completed. */
TEST(test_changing_readings_leave_slow_pictures)
{
    if (hardware)
        skip();
    assert_refined_comes(LOOK_FLAT, 2 * NS_PER_S);
    assert_refined_comes(LOOK_GLOSSY, 2 * NS_PER_S);
}

/* The data for recolouring a refined frame exceeds the cache limit of 64 MiB: the refined frame must still be completed. */
TEST(test_changing_readings_leave_pictures_without_room)
{
    if (hardware)
        skip();
    remake(false, (size_t)64 << 20);
    assert_true(refined_comes(LOOK_GLOSSY, 2 * NS_PER_S));
}

/* GL keeps no data for recolouring, so changed readings abandon a refined frame that is being drawn. Each repetition may run
   longer before it is abandoned, and one of the first 12 must be completed. */
TEST(test_what_takes_long_by_gl_comes_in_the_end)
{
    if (hardware)
        skip();
    remake(true, 0);
    bool refined = false;
    for (int i = 0; i < 12 && !refined; i++) {
        int64_t steps = count_of("plantcast_render_steps_total");
        ask_for_refined(REFINER, LOOK_DEFAULT);
        await_step(steps + 1);
        change_readings(30 + i);
        for (int owed = 1 + ask_for_data(REFINER, LOOK_DEFAULT, (int64_t)1100 * NS_PER_MS); owed > 0; owed--) {
            struct encoded_frame *encoded = next();
            refined |= encoded->packet && encoded->packet->frame->view.tier == TIER_REFINED;
            encoded_frame_destroy(&encoded);
        }
    }
    assert_true(refined);
    remake(false, 0);
}

static void ask_view(uint64_t client, enum urgency urgency, enum tier tier, double turn)
{
    struct frame_request request = { .codec = WIRE_CODEC_JPEG, .quality = { .quality = 90 }, .urgency = urgency };
    request.asked_ns = clock_mono_ns();
    view_default(&toy->scene, 640, 360, &request.view);
    request.view.tier = tier;
    request.view.camera.eye_m[0] += turn;
    assert_int_equal(render_service_request(service, client, &request), REQUEST_ADDED);
    render_service_wake(service);
}

/* A client's refined frame waits for another client's frame, and a preview of the same view, requested later, is delivered
   first. The refined frame is then skipped as outdated. If the client requests it again, it must be delivered. */
TEST(test_an_overtaken_refinement_comes_when_it_is_asked_for_again)
{
    enum { OVERTAKEN = 201, LATER = 202 };
    uint64_t preview_number = 0, refined_number = 0;
    if (hardware)
        skip();
    /* draws with GL, because the software renderer would recolour the refined frame with newer readings and give it the newest
       number */
    remake(true, 0);
    int64_t steps = count_of("plantcast_render_steps_total");
    ask(REFINER, URGENCY_REFINE, 31);
    await_step(steps + 1);
    ask_view(OVERTAKEN, URGENCY_DATA, TIER_REFINED, 33);
    /* the answer to this request shows that the service has begun the request before it and deferred it */
    ask_view(LATER, URGENCY_DATA, TIER_PREVIEW, 35);
    for (int left = 4; left > 0; left--) {
        struct encoded_frame *encoded = next();
        if (encoded->client == LATER)
            ask_view(OVERTAKEN, URGENCY_INPUT, TIER_PREVIEW, 33);
        if (encoded->client == OVERTAKEN && encoded->request.urgency == URGENCY_INPUT) {
            assert_int_equal(refined_number, 0);
            assert_non_null(encoded->packet);
            preview_number = encoded->number;
        } else if (encoded->client == OVERTAKEN) {
            assert_true(!encoded->packet && encoded->absence == FRAME_SKIPPED);
            refined_number = encoded->number;
        }
        encoded_frame_destroy(&encoded);
    }
    assert_true(refined_number > 0 && refined_number < preview_number);
    ask_view(OVERTAKEN, URGENCY_REFINE, TIER_REFINED, 33);
    struct encoded_frame *again = next();
    assert_true(again->client == OVERTAKEN && again->packet && again->packet->frame->view.tier == TIER_REFINED);
    encoded_frame_destroy(&again);
    remake(false, 0);
}

/* A picture with colour bands cannot be recoloured quickly. When readings change, the refined frame must be drawn again and
   delivered, and not abandoned for a preview. */
TEST(test_readings_change_pictures_that_are_not_quick)
{
    int64_t abandoned = count_of("plantcast_renders_abandoned_total");
    for (int i = 0; i < 4; i++) {
        struct frame_request request = {
            .codec = WIRE_CODEC_JPEG, .quality = { .quality = 80 }, .of_data = i > 0, .asked_ns = clock_mono_ns()
        };
        change_readings(20 + 15 * i);
        request.urgency = i ? URGENCY_DATA : URGENCY_REFINE;
        view_default(&toy->scene, 640, 480, &request.view);
        request.view.tier = TIER_REFINED;
        request.view.ramp_interval = 10;
        assert_int_equal(render_service_request(service, REFINER, &request), REQUEST_ADDED);
        render_service_wake(service);
        struct encoded_frame *encoded = next();
        assert_true(encoded->client == REFINER && encoded->packet);
        assert_int_equal(encoded->packet->frame->view.tier, TIER_REFINED);
        encoded_frame_destroy(&encoded);
    }
    assert_int_equal(count_of("plantcast_renders_abandoned_total"), abandoned);
}

/* Destroying the service during a refinement must not wait until the refined frame is complete. */
TEST(test_stop_waits_for_no_refinement)
{
    if (hardware)
        skip();
    int64_t steps = count_of("plantcast_render_steps_total"), renders = count_of("plantcast_renders_total");
    ask(REFINER, URGENCY_REFINE, 4);
    await_step(steps + 1);
    render_service_destroy(&service);
    assert_true(count_of("plantcast_renders_total") == renders);
}

/* With GL (a GPU or its software emulation), several frames are drawn at once. Each client must get the frame of the view that
   it requested, equal requests share a frame, and a context loss meanwhile must lose no frame. */
TEST(test_pictures_fly)
{
    enum { CLIENTS = 8, ROUNDS = 6, FIRST = 100 };
    int64_t renders = count_of("plantcast_renders_total"), losses = count_of("plantcast_gl_losses_total");
    remake(true, 0);
    int most = ROUNDS * CLIENTS * 3 / 4;
    for (int round = 0; round < ROUNDS; round++) {
        bool came_for[CLIENTS] = { false };
        int64_t begin_ns = clock_mono_ns();
        if (round == ROUNDS / 2)
            render_service_lose_context(service);
        for (int i = 0; i < CLIENTS; i++)
            ask((uint64_t)(FIRST + i), URGENCY_INPUT, round + 0.1 * (i % 4));
        for (int i = 0; i < CLIENTS; i++) {
            struct encoded_frame *encoded = next();
            int client = (int)encoded->client - FIRST;
            assert_true(client >= 0 && client < CLIENTS && !came_for[client] && encoded->packet);
            assert_true(encoded->packet->frame->view.camera.eye_m[0] == encoded->request.view.camera.eye_m[0]);
            came_for[client] = true;
            encoded_frame_destroy(&encoded);
        }
        if (clock_mono_ns() - begin_ns > RECENT_NS / 2)
            most += CLIENTS / 4; /* in a slow round, frames may become too old to be shared, so each request pair may be drawn twice */
    }
    assert_in_range(count_of("plantcast_renders_total") - renders, ROUNDS * CLIENTS / 2, most);
    assert_int_equal(count_of("plantcast_gl_losses_total"), losses + 1);
    struct encoded_frame *by_gl = picture_of(MOVER, URGENCY_INPUT, 7);
    assert_true(by_gl->packet->frame->marker_count > 0);
    encoded_frame_destroy(&by_gl);
    remake(false, 0);
}

/* Creates another render service while the first one is running, in the same process and driver. */
struct service_making {
    struct view first;
    struct render_service *made;
    _Atomic bool done;
};

static void *make_another(void *arg)
{
    struct service_making *making = arg;
    making->made = render_service_create(&(struct render_service_params){ .log = logger,
                                                                          .scene = &toy->scene,
                                                                          .store = store,
                                                                          .workers = workers,
                                                                          .counters = counters,
                                                                          .notify = on_pictures,
                                                                          .first = &making->first,
                                                                          .first_count = 1 });
    making->done = true;
    return NULL;
}

static void *unmake(void *arg)
{
    render_service_destroy(arg);
    return NULL;
}

static int move_while(const _Atomic bool *done, pthread_t thread)
{
    int drawn = 0;
    for (; !done || !*done || drawn == 0; drawn++) {
        struct encoded_frame *encoded = picture_of(MOVER, URGENCY_INPUT, 0.05 * (drawn % 20));
        encoded_frame_destroy(&encoded);
        if (!done && drawn == 20)
            break;
    }
    pthread_join(thread, NULL);
    return drawn;
}

TEST(test_another_is_made_and_the_first_destroyed_beside_it)
{
    struct service_making making = { .made = NULL };
    struct render_service *first = service;
    pthread_t thread;
    view_default(&toy->scene, 320, 180, &making.first);
    assert_int_equal(pthread_create(&thread, NULL, make_another, &making), 0);
    assert_true(move_while(&making.done, thread) > 0);
    assert_non_null(making.made);
    service = making.made;
    struct encoded_frame *by_other = picture_of(MOVER, URGENCY_INPUT, 3);
    assert_true(by_other->packet->frame->marker_count > 0);
    encoded_frame_destroy(&by_other);
    assert_int_equal(pthread_create(&thread, NULL, unmake, &first), 0);
    move_while(NULL, thread);
    assert_null(first);
}

static bool start(void)
{
    refined_width_px = sweep(2400, 1200);
    toy = toy_unit();
    logger = log_create(LOG_INFO);
    workers = workers_create(2);
    counters = counters_create();
    for (size_t i = 0; i < toy->plant.tag_count; i++)
        toy->plant.tags[i].validity.stale_s = 3600;
    store = store_create(&toy->plant);
    return make_service(false, 0);
}

static void stop(void)
{
    render_service_destroy(&service);
    store_destroy(&store);
    counters_destroy(&counters);
    workers_destroy(&workers);
    log_destroy(&logger);
    toy_destroy(&toy);
}

int main(void)
{
    int failed = start() ? tests_run(NULL) : 0;
    stop();
    return failed;
}
