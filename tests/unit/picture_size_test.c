/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests how the size of previews follows the time that a picture costs, and that a client's previews follow the load of a
   simulated server that draws for several clients in turn. */
#include "session/pacing/pacer.h"

#include "tests/support/test.h"

#include "base/clock.h"

static const int64_t MS = NS_PER_MS;

/* Reports one picture every 50 ms, each of which took cost_ms. Returns the size chosen afterwards (0: full size). */
static int size_after(struct picture_size *size, int64_t cost_ms, int64_t from_ms, int64_t to_ms)
{
    const struct picture_cost cost = { .cost_ns = cost_ms * MS, .hard_ns = 130 * MS, .easy_ns = 90 * MS };
    for (int64_t ms = from_ms; ms <= to_ms; ms += 50)
        picture_size_follow(size, &cost, ms * MS);
    return size->index;
}

TEST(pictures_that_cost_too_much_get_smaller)
{
    struct picture_size size = { 0 };
    assert_int_equal(size_after(&size, 120, 1000, 9000), 0);
    assert_int_equal(size_after(&size, 220, 10000, 10400), 0);
    /* pictures took 220 ms for half a second, which is too long: the next smaller size */
    assert_int_equal(size_after(&size, 220, 10450, 10600), 1);
    /* 125 ms at this size: short enough to stay, but too long to try the larger size */
    assert_int_equal(size_after(&size, 125, 11000, 19000), 1);
    /* 60 ms at this size would be 107 ms at the larger one, so the size stays */
    assert_int_equal(size_after(&size, 60, 20000, 29000), 1);
    assert_int_equal(size_after(&size, 40, 30000, 32900), 1);
    assert_int_equal(size_after(&size, 40, 32950, 33100), 0);
    assert_int_equal(size_after(&size, 900, 40000, 60000), PICTURE_SIZES - 1);
}

enum { CLIENTS = 12 };

/* A server that makes one picture at a time for clients in turn. The clients acknowledge at once and always want another. */
struct busy_server {
    struct pacer pacers[CLIENTS];
    int count;
    double full_ns; /* time for a picture of full size; a third of it does not depend on the size */
    int64_t now_ns;
};

static void set_up(struct busy_server *server, int count, double full_ms, bool reprojects)
{
    *server = (struct busy_server){ .count = count, .full_ns = full_ms * 1e6, .now_ns = NS_PER_S };
    for (int i = 0; i < CLIENTS; i++) {
        pacer_init(&server->pacers[i]);
        server->pacers[i].ladder.reprojects = reprojects;
    }
}

/* Returns the number of pictures a second that each client gets. */
static double run(struct busy_server *server, double seconds)
{
    int64_t begin_ns = server->now_ns;
    int pictures = 0;
    while ((double)(server->now_ns - begin_ns) < seconds * 1e9)
        for (int i = 0; i < server->count; i++, pictures++) {
            struct pacer *pacer = &server->pacers[i];
            double scale = quality_ladder_rung(&pacer->ladder, 0).scale;
            struct pacer_note note = { .moving = true, .preview = true, .counts = true };
            while (pacer->asked < 2)
                pacer_asked(pacer, true, server->now_ns);
            server->now_ns += (int64_t)(server->full_ns * (1 + 2 * scale * scale) / 3);
            note.made_ns = server->now_ns;
            uint32_t seq = pacer_sent(pacer, 1000, &note, server->now_ns);
            pacer_wrote(pacer, true, server->now_ns);
            pacer_acked(pacer, seq, MS, server->now_ns);
        }
    return pictures / (double)server->count / ((double)(server->now_ns - begin_ns) / 1e9);
}

/* The clients stop moving: their last requests are answered by nothing. */
static void rest(struct busy_server *server, int64_t ns)
{
    for (int i = 0; i < server->count; i++)
        while (server->pacers[i].asked > 0)
            pacer_dropped(&server->pacers[i], true);
    server->now_ns += ns;
}

static int largest_index(const struct busy_server *server)
{
    int index = 0;
    for (int i = 0; i < server->count; i++)
        index = server->pacers[i].ladder.made.index > index ? server->pacers[i].ladder.made.index : index;
    return index;
}

TEST(clients_of_a_loaded_server_get_smaller_pictures_and_ten_a_second)
{
    struct busy_server server;
    set_up(&server, CLIENTS, 11, false); /* 7.6 pictures a second in full size */
    run(&server, 3);
    assert_true(run(&server, 20) >= 10);
    assert_int_equal(largest_index(&server), 1);
    /* two are left: full size again after a few seconds, without another change */
    server.count = 2;
    run(&server, 4);
    for (int i = 0; i < 100; i++) {
        assert_int_equal(largest_index(&server), 0);
        run(&server, 0.2);
    }
}

/* Half the size is cheap, but three quarters cost more than expected: the larger size is tried more and more rarely. */
TEST(a_larger_picture_that_does_not_hold_is_tried_more_rarely)
{
    struct quality_ladder ladder = { .made.index = 2 };
    int ups = 0, before = 2;
    for (int64_t now_ns = NS_PER_S; now_ns < 120 * NS_PER_S; now_ns += 60 * MS) {
        quality_ladder_on_made(&ladder, (ladder.made.index == 2 ? 55 : 115) * MS, now_ns);
        ups += ladder.made.index < before;
        before = ladder.made.index;
    }
    assert_in_range(ups, 2, 7); /* without the longer waits: more than 20 */
}

/* A user changes the quantity once a second, and each picture waits for the new field. */
TEST(single_slow_pictures_change_nothing)
{
    struct pacer pacer;
    pacer_init(&pacer);
    for (int64_t now_ns = NS_PER_S; now_ns < 60 * NS_PER_S; now_ns += NS_PER_S) {
        struct pacer_note note = { .moving = true, .preview = true, .counts = true, .made_ns = now_ns + 400 * MS };
        pacer_asked(&pacer, true, now_ns);
        uint32_t seq = pacer_sent(&pacer, 1000, &note, note.made_ns);
        pacer_wrote(&pacer, true, note.made_ns);
        pacer_acked(&pacer, seq, MS, note.made_ns + MS);
        assert_int_equal(pacer.ladder.made.index, 0);
    }
}

/* Frames that are no previews of a camera that this client moves do not count, and neither does a request that was dropped. In
   the last way, frames count. */
TEST(what_does_not_count_changes_nothing)
{
    for (int way = 0; way < 3; way++) {
        struct pacer pacer;
        pacer_init(&pacer);
        pacer_asked(&pacer, true, NS_PER_S);
        for (int64_t now_ns = NS_PER_S; now_ns < 20 * NS_PER_S; now_ns += 200 * MS) {
            struct pacer_note note = { .moving = true, .preview = true, .counts = way > 0, .made_ns = now_ns };
            pacer_asked(&pacer, true, now_ns);
            if (way == 1) {
                pacer_dropped(&pacer, true);
                pacer_asked(&pacer, true, now_ns);
            }
            uint32_t seq = pacer_sent(&pacer, 1000, &note, now_ns);
            pacer_wrote(&pacer, true, now_ns);
            pacer_acked(&pacer, seq, MS, now_ns);
        }
        assert_true(way < 2 ? pacer.ladder.made.index == 0 : pacer.ladder.made.index > 0);
    }
}

/* A frame of another kind waits for 500 ms before the camera moves. The preview replaces that frame, or is requested while the frame
   is drawn; then it takes 20 ms. In the last way, the frame that waits is a preview itself, so its time counts. */
TEST(the_wait_of_another_frame_is_not_that_of_a_preview)
{
    for (int way = 0; way < 3; way++) {
        struct pacer pacer;
        pacer_init(&pacer);
        for (int64_t now_ns = NS_PER_S; now_ns < 20 * NS_PER_S; now_ns += 600 * MS) {
            struct pacer_note note = { .moving = true, .preview = true, .counts = true, .made_ns = now_ns + 520 * MS };
            pacer_asked(&pacer, way == 2, now_ns);
            if (way == 1)
                pacer_asked(&pacer, true, now_ns + 500 * MS);
            else
                pacer_replaced(&pacer, true, now_ns + 500 * MS);
            uint32_t seq = pacer_sent(&pacer, 1000, &note, note.made_ns);
            pacer_wrote(&pacer, true, note.made_ns);
            pacer_acked(&pacer, seq, MS, note.made_ns + MS);
            if (way == 1)
                pacer_dropped(&pacer, false);
        }
        assert_true(way < 2 ? pacer.ladder.made.index == 0 : pacer.ladder.made.index > 0);
    }
}

TEST(a_client_that_reprojects_keeps_its_size_for_longer)
{
    struct busy_server server;
    set_up(&server, CLIENTS, 10, true); /* 8.3 pictures a second */
    run(&server, 20);
    assert_int_equal(largest_index(&server), 0);
    set_up(&server, CLIENTS, 10, false);
    run(&server, 20);
    assert_int_equal(largest_index(&server), 1);
}

/* After a pause of all clients, one of them moves again: its next picture but one has the full size, not one after seconds. */
TEST(a_pause_ends_a_load_of_the_past)
{
    struct busy_server server;
    set_up(&server, CLIENTS, 25, false);
    run(&server, 10);
    rest(&server, 10 * NS_PER_S);
    server.count = 1;
    assert_true(server.pacers[0].ladder.made.index > 1);
    run(&server, 0.01);
    assert_int_equal(server.pacers[0].ladder.made.index, 0);
}

/* One long step of the server, such as an update of the field, is no reason for smaller pictures. */
TEST(one_long_step_changes_nothing)
{
    struct busy_server server;
    set_up(&server, 1, 60, false);
    run(&server, 5);
    server.now_ns += 5 * NS_PER_S;
    run(&server, 2);
    assert_int_equal(largest_index(&server), 0);
}

TEST(a_network_that_limits_the_rate_is_not_a_slow_server)
{
    struct pacer pacer;
    pacer_init(&pacer);
    for (int64_t now_ns = NS_PER_S; now_ns < 60 * NS_PER_S; now_ns += 500 * MS) {
        struct pacer_note note = { .moving = true, .preview = true, .counts = true, .made_ns = now_ns + 20 * MS };
        pacer_asked(&pacer, true, now_ns);
        uint32_t seq = pacer_sent(&pacer, 1000, &note, note.made_ns);
        pacer_wrote(&pacer, true, note.made_ns);
        pacer_acked(&pacer, seq, MS, now_ns + 490 * MS);
    }
    assert_int_equal(pacer.ladder.made.index, 0);
}

/* A network that carries one picture at a time: the next request comes 50 ms after the last picture. */
TEST(a_slow_server_behind_a_slow_network_makes_smaller_pictures)
{
    struct pacer pacer;
    pacer_init(&pacer);
    for (int64_t now_ns = NS_PER_S; now_ns < 10 * NS_PER_S; now_ns += 450 * MS) {
        struct pacer_note note = { .moving = true, .preview = true, .counts = true, .made_ns = now_ns + 400 * MS };
        pacer_asked(&pacer, true, now_ns);
        uint32_t seq = pacer_sent(&pacer, 1000, &note, note.made_ns);
        pacer_wrote(&pacer, true, note.made_ns);
        pacer_acked(&pacer, seq, MS, note.made_ns + 40 * MS);
    }
    assert_true(pacer.ladder.made.index > 0);
}

/* A plant whose pictures take seconds: the size goes down, although seconds pass between two pictures. */
TEST(pictures_that_take_seconds_get_smaller)
{
    struct busy_server server;
    set_up(&server, 1, 3000, false);
    run(&server, 60);
    assert_int_equal(largest_index(&server), PICTURE_SIZES - 1);
}
