/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests pacing, which decides when a client gets its next frame and in what quality. It limits the number of frames that the
   client has not acknowledged, and must adapt to simulated slow networks and slow decoders. */
#include "session/pacing/pacer.h"

#include "tests/support/test.h"

#include "base/clock.h"

static const int64_t MS = NS_PER_MS;

static struct pacer fresh(void)
{
    struct pacer pacer;
    pacer_init(&pacer);
    return pacer;
}

static uint32_t send_one(struct pacer *pacer, size_t bytes, int64_t now_ns)
{
    struct pacer_note note = { .moving = true, .step = pacer->ladder.step };
    note.scale = quality_ladder_rung(&pacer->ladder, note.step).scale;
    pacer_asked(pacer, false, now_ns);
    uint32_t seq = pacer_sent(pacer, bytes, &note, now_ns);
    pacer_wrote(pacer, true, now_ns);
    return seq;
}

TEST(window_closes_until_acknowledged)
{
    struct pacer pacer = fresh();
    assert_true(pacer_may_ask(&pacer, 0));
    assert_int_equal(send_one(&pacer, 100, 1 * MS), 1);
    assert_true(pacer_may_ask(&pacer, 2 * MS));
    assert_int_equal(send_one(&pacer, 50, 2 * MS), 2);
    assert_false(pacer_may_ask(&pacer, 3 * MS));
    assert_int_equal(pacer_acked(&pacer, 1, -1, 5 * MS), PACER_ACK_NEW);
    assert_true(pacer.acked.seq == 1 && pacer.acked.bytes == 100);
    assert_true(pacer_may_ask(&pacer, 6 * MS));
}

TEST(what_is_asked_for_counts)
{
    struct pacer pacer = fresh();
    for (int i = 0; i < PACER_LEAST; i++)
        pacer_asked(&pacer, false, 0);
    assert_false(pacer_may_ask(&pacer, 0));
    pacer_dropped(&pacer, false);
    assert_true(pacer_may_ask(&pacer, 0));
}

TEST(nothing_is_asked_for_while_the_socket_is_full)
{
    struct pacer pacer = fresh();
    struct pacer_note note = { 0 };
    pacer_asked(&pacer, false, 0);
    pacer_sent(&pacer, 1000, &note, MS);
    assert_false(pacer_may_ask(&pacer, 2 * MS));
    pacer_wrote(&pacer, false, 3 * MS);
    assert_int_equal(pacer_acked(&pacer, 1, -1, 3 * MS), PACER_ACK_NEVER_SENT);
    assert_false(pacer_may_ask(&pacer, 4 * MS));
    pacer_wrote(&pacer, true, 5 * MS);
    assert_true(pacer_may_ask(&pacer, 6 * MS));
}

TEST(a_picture_cut_short_is_not_waited_for)
{
    struct pacer pacer = fresh();
    struct pacer_note note = { 0 };
    pacer_asked(&pacer, false, 0);
    pacer_sent(&pacer, 1000, &note, MS);
    pacer_gave_up(&pacer);
    /* the frame was given up while being sent: no other one may be requested before its remaining bytes are gone */
    assert_false(pacer_may_ask(&pacer, 2 * MS));
    assert_int_equal(pacer_state(&pacer, 2100 * MS), PACER_STALLS);
    pacer_wrote(&pacer, true, 2200 * MS);
    assert_true(pacer_may_ask(&pacer, 2201 * MS));
    assert_int_equal(pacer_state(&pacer, 60 * NS_PER_S), PACER_FLOWS);
    assert_int_equal(send_one(&pacer, 1, 60 * NS_PER_S), 2);
}

TEST(a_newer_ack_stands_for_older_frames)
{
    struct pacer pacer = fresh();
    send_one(&pacer, 1, 0);
    send_one(&pacer, 1, 0);
    assert_int_equal(pacer_acked(&pacer, 2, -1, 0), PACER_ACK_NEW);
    assert_int_equal(pacer.flight_count, 0);
    assert_int_equal(pacer_acked(&pacer, 1, -1, 0), PACER_ACK_OLD);
    assert_int_equal(pacer_acked(&pacer, 2, -1, 0), PACER_ACK_OLD);
}

TEST(an_ack_for_nothing_opens_nothing)
{
    struct pacer pacer = fresh();
    assert_int_equal(pacer_acked(&pacer, 1, -1, 0), PACER_ACK_NEVER_SENT);
    send_one(&pacer, 1, 1);
    send_one(&pacer, 1, 1);
    static const uint32_t never[] = { 0, 3, 4, 1000, UINT32_MAX, 0x80000002 };
    for (size_t i = 0; i < sizeof(never) / sizeof(never[0]); i++)
        assert_int_equal(pacer_acked(&pacer, never[i], -1, 1), PACER_ACK_NEVER_SENT);
    assert_false(pacer_may_ask(&pacer, 1));
}

TEST(numbers_go_round_and_leave_out_zero)
{
    struct pacer pacer = fresh();
    pacer.last_seq = UINT32_MAX;
    assert_int_equal(send_one(&pacer, 1, 0), 1);
    assert_int_equal(pacer_acked(&pacer, 1, -1, 0), PACER_ACK_NEW);
}

TEST(silence_is_a_stall_and_then_the_end)
{
    struct pacer pacer = fresh();
    assert_int_equal(pacer_state(&pacer, 3600 * NS_PER_S), PACER_FLOWS); /* nothing is under way */
    send_one(&pacer, 100, 3600 * NS_PER_S);
    assert_int_equal(pacer_state(&pacer, 3601900 * MS), PACER_FLOWS);
    assert_int_equal(pacer_state(&pacer, 3602000 * MS), PACER_STALLS);
    assert_false(pacer_may_ask(&pacer, 3602000 * MS));
    assert_int_equal(pacer_state(&pacer, 3615000 * MS), PACER_DEAD);
    pacer_acked(&pacer, 1, -1, 3615000 * MS);
    assert_int_equal(pacer_state(&pacer, 3615000 * MS), PACER_FLOWS);
}

/* a simulated network that sends one message after the other, and a client that decodes one frame after the other */
struct pacer_world {
    double bytes_per_s;
    int64_t rtt_ns, decode_ns;
    double pixels; /* pixels per frame at full size; the simulation derives the size in bytes and the decoding time from them */
    int64_t now_ns, link_free_ns, decoder_free_ns;
    int64_t draw_ns;       /* time that the simulated server takes to draw a frame; 0: 20 ms */
    int64_t busy_until_ns; /* until this time the simulated client is busy with other work and acknowledges nothing */
    struct {
        uint32_t seq;
        int64_t at_ns, decode_ns;
    } acks[PACER_MOST];
    int ack_count;
    /* counts since the last measure() */
    int frames;
    int64_t begin_ns, oldest_ns;
    size_t most_bytes;
};

static void deliver(struct pacer_world *world, struct pacer *pacer)
{
    struct rung rung = quality_ladder_rung(&pacer->ladder, pacer->ladder.step);
    double area = rung.scale * rung.scale;
    size_t bytes = (size_t)(world->pixels * 0.12 * area * rung.quality / 78);
    int64_t made_ns = world->now_ns;
    uint32_t seq = send_one(pacer, bytes, world->now_ns);
    int64_t gone_ns = (world->link_free_ns > made_ns ? world->link_free_ns : made_ns) + (int64_t)((double)bytes / world->bytes_per_s * 1e9);
    int64_t there_ns = gone_ns + world->rtt_ns / 2, decode_ns = (int64_t)((double)world->decode_ns * area);
    int64_t begun_ns = there_ns > world->busy_until_ns ? there_ns : world->busy_until_ns;
    int64_t drawn_ns = (world->decoder_free_ns > begun_ns ? world->decoder_free_ns : begun_ns) + decode_ns;
    world->link_free_ns = gone_ns;
    world->decoder_free_ns = drawn_ns;
    world->acks[world->ack_count].seq = seq;
    world->acks[world->ack_count].decode_ns = decode_ns;
    world->acks[world->ack_count++].at_ns = drawn_ns + world->rtt_ns / 2;
    world->oldest_ns = drawn_ns - made_ns > world->oldest_ns ? drawn_ns - made_ns : world->oldest_ns;
    world->most_bytes = bytes > world->most_bytes ? bytes : world->most_bytes;
    world->frames++;
}

static void run_world(struct pacer_world *world, struct pacer *pacer, double seconds)
{
    for (int64_t end_ns = world->now_ns + (int64_t)(seconds * 1e9); world->now_ns < end_ns; world->now_ns += MS) {
        while (world->ack_count > 0 && world->acks[0].at_ns <= world->now_ns) {
            assert_int_equal(pacer_acked(pacer, world->acks[0].seq, world->acks[0].decode_ns, world->now_ns), PACER_ACK_NEW);
            for (int i = 1; i < world->ack_count; i++)
                world->acks[i - 1] = world->acks[i];
            world->ack_count--;
        }
        if (pacer->flight_count == 0)
            channel_on_pong(&pacer->channel, world->rtt_ns, world->now_ns);
        if (world->now_ns % (world->draw_ns ? world->draw_ns : 20 * MS) < MS && pacer_may_ask(pacer, world->now_ns))
            deliver(world, pacer);
    }
}

static void measure(struct pacer_world *world)
{
    world->frames = 0;
    world->oldest_ns = 0;
    world->most_bytes = 0;
    world->begin_ns = world->now_ns;
}

static double rate(const struct pacer_world *world)
{
    return world->frames * 1e9 / (double)(world->now_ns - world->begin_ns);
}

TEST(a_fast_network_gets_the_best)
{
    struct pacer pacer = fresh();
    struct pacer_world world = { .bytes_per_s = 100e6, .rtt_ns = MS, .decode_ns = 8 * MS, .pixels = 1920 * 1080, .now_ns = NS_PER_S };
    run_world(&world, &pacer, 1);
    measure(&world);
    run_world(&world, &pacer, 5);
    assert_int_equal(pacer.ladder.step, 0);
    assert_true(rate(&world) > 45 && world.oldest_ns < 30 * MS);
}

TEST(a_long_way_does_not_cost_rate)
{
    struct pacer pacer = fresh();
    struct pacer_world world = { .bytes_per_s = 50e6, .rtt_ns = 200 * MS, .decode_ns = 5 * MS, .pixels = 1280 * 720, .now_ns = NS_PER_S };
    run_world(&world, &pacer, 3);
    measure(&world);
    run_world(&world, &pacer, 5);
    assert_int_equal(pacer.ladder.step, 0);
    assert_true(rate(&world) > 25 && world.oldest_ns < 150 * MS);
}

/* The network has a throughput of 1 Mbit/s and a round trip of 200 ms. */
TEST(a_slow_network_gets_small_pictures_in_time)
{
    struct pacer pacer = fresh();
    struct pacer_world world = { .bytes_per_s = 125e3, .rtt_ns = 200 * MS, .decode_ns = 8 * MS, .pixels = 1280 * 720, .now_ns = NS_PER_S };
    run_world(&world, &pacer, 5);
    measure(&world);
    run_world(&world, &pacer, 60);
    assert_true(world.oldest_ns < 600 * MS);
    assert_true(rate(&world) > 3);
    assert_true(pacer.ladder.decoded.index == 0); /* the network, not the decoder, is slow, so frames keep their full number of pixels */
}

/* A client that reprojects (moves the last picture until the next arrives) needs fewer pictures, so it gets fewer and better
   ones. */
TEST(a_client_that_reprojects_gets_better_pictures)
{
    double rates[2], bytes[2];
    for (int reprojects = 0; reprojects < 2; reprojects++) {
        struct pacer pacer = fresh();
        struct pacer_world world = { .bytes_per_s = 1.7e6, .rtt_ns = 200 * MS, .pixels = 1280 * 720, .now_ns = NS_PER_S };
        world.decode_ns = 8 * MS;
        pacer.ladder.reprojects = reprojects;
        run_world(&world, &pacer, 5);
        measure(&world);
        run_world(&world, &pacer, 60);
        rates[reprojects] = rate(&world);
        bytes[reprojects] = (double)world.most_bytes;
        print_message("%.1f pictures a second of at most %.0f bytes\n", rates[reprojects], bytes[reprojects]);
    }
    assert_true(bytes[1] > 1.2 * bytes[0] && rates[1] < rates[0] && rates[1] > 8);
}

/* Decoding takes 150 ms: the pacer reduces pixels, not quality, and at most one frame waits at the decoder. */
TEST(a_slow_decoder_gets_fewer_pixels)
{
    struct pacer pacer = fresh();
    struct pacer_world world = { .bytes_per_s = 100e6, .rtt_ns = 2 * MS, .decode_ns = 150 * MS, .pixels = 1920 * 1080, .now_ns = NS_PER_S };
    run_world(&world, &pacer, 10);
    measure(&world);
    run_world(&world, &pacer, 20);
    assert_true(pacer.ladder.decoded.index >= 2 && pacer.ladder.step == 0);
    assert_true(rate(&world) > 12 && world.oldest_ns < 200 * MS);
}

TEST(what_recovers_gets_its_quality_back)
{
    struct pacer pacer = fresh();
    struct pacer_world world = { .bytes_per_s = 20e6, .rtt_ns = 20 * MS, .decode_ns = 8 * MS, .pixels = 1280 * 720, .now_ns = NS_PER_S };
    run_world(&world, &pacer, 5);
    assert_int_equal(pacer.ladder.step, 0);
    world.bytes_per_s = 200e3;
    run_world(&world, &pacer, 3);
    assert_true(pacer.ladder.step >= 4);
    measure(&world);
    run_world(&world, &pacer, 10);
    assert_true(world.oldest_ns < 500 * MS);
    world.bytes_per_s = 20e6;
    run_world(&world, &pacer, 40);
    assert_int_equal(pacer.ladder.step, 0);
}

static void run_busy(struct pacer_world *world, struct pacer *pacer, int64_t busy_ns, double seconds)
{
    world->busy_until_ns = world->now_ns + busy_ns;
    run_world(world, pacer, seconds);
}

/* A client that acknowledges late because its page is busy loading modules: the pacer must not conclude that its network or
   decoder is slow and reduce the quality. */
TEST(a_client_that_is_busy_for_a_moment_keeps_its_quality)
{
    struct pacer pacer = fresh();
    struct pacer_world world = { .bytes_per_s = 100e6, .rtt_ns = MS, .decode_ns = 4 * MS, .pixels = 1280 * 720, .now_ns = NS_PER_S };
    channel_on_bytes(&pacer.channel, 1000000, 2500 * MS); /* 1 MB of text messages, sent while the page starts */
    quality_ladder_begin(&pacer.ladder, &pacer.channel, world.pixels);
    run_busy(&world, &pacer, 700 * MS, 0.75);
    run_world(&world, &pacer, 0.1); /* carries two or three pictures */
    world.now_ns += 12 * NS_PER_S;
    for (int i = 0; i < 3; i++) { /* the first move */
        run_busy(&world, &pacer, 600 * MS, 0.7);
        assert_true(pacer.ladder.step == 0 && pacer.ladder.decoded.index == 0);
        run_world(&world, &pacer, 0.3);
        assert_true(pacer.ladder.step == 0 && pacer.ladder.decoded.index == 0);
    }
}

/* The first frame of a new codec takes long to decode: the pacer must not conclude that the decoder is slow. Few other frames
   arrive meanwhile, so there is little else to measure. */
TEST(a_decoder_that_begins_is_not_slow)
{
    struct pacer pacer = fresh();
    struct pacer_world world = { .bytes_per_s = 100e6, .rtt_ns = MS, .pixels = 1280 * 720, .draw_ns = 200 * MS };
    world.now_ns = NS_PER_S + MS;
    world.decode_ns = 8 * MS;
    run_world(&world, &pacer, 2);
    world.decode_ns = 500 * MS;
    run_world(&world, &pacer, 0.2);
    world.decode_ns = 8 * MS;
    for (int i = 0; i < 30; i++) {
        run_world(&world, &pacer, 0.1);
        assert_true(pacer.ladder.step == 0 && pacer.ladder.decoded.index == 0);
    }
}

/* At the threshold between two quality steps, the pacer must not oscillate. */
TEST(steps_do_not_swing)
{
    for (int kbit_per_s = 500; kbit_per_s <= 64000; kbit_per_s = kbit_per_s * 5 / 4) {
        struct pacer pacer = fresh();
        struct pacer_world world = { .bytes_per_s = kbit_per_s * 125.0, .rtt_ns = 40 * MS, .decode_ns = 5 * MS, .pixels = 1280 * 720 };
        int changes = 0, before;
        world.now_ns = NS_PER_S;
        run_world(&world, &pacer, 20);
        before = pacer.ladder.step;
        for (int i = 0; i < 600; i++) {
            run_world(&world, &pacer, 0.1);
            changes += pacer.ladder.step != before;
            before = pacer.ladder.step;
        }
        assert_in_range(changes, 0, 6);
    }
}

/* Smaller pictures have fewer bytes. When the picture gets its size back, the ladder must expect the bytes of the larger one. The
   picture of step 3 in half size is the same as that of step 5. A preview drawn in place of a refined frame has full size at any
   step: that of step 5 in full size is the same as that of step 3. */
TEST(the_expected_bytes_follow_the_size_of_pictures)
{
    enum { HALF = 2 };
    static const double FULL_BYTES = 106e3, HALF_BYTES = 38e3;
    for (int way = 0; way < 2; way++) {
        struct quality_ladder ladder = { .step = 3, .made.index = way == 0 ? HALF : 0 };
        struct channel channel = { 0 };
        double scale = quality_ladder_rung(&ladder, 3).scale;
        quality_ladder_on_ack(&ladder, &channel, 3, scale, (size_t)(way == 0 ? HALF_BYTES : FULL_BYTES), NS_PER_S);
        for (int index = 0; index <= HALF; index += HALF) {
            ladder.made.index = index;
            double expected = index == 0 ? FULL_BYTES : HALF_BYTES;
            assert_true(fabs(quality_ladder_bytes(&ladder) / expected - 1) < 0.05);
        }
        ladder.step = 5;
        assert_true(fabs(quality_ladder_bytes(&ladder) / HALF_BYTES - 1) < 0.05);
    }
    struct quality_ladder ladder = { .step = 5 };
    struct channel channel = { 0 };
    quality_ladder_on_ack(&ladder, &channel, 5, 1, (size_t)FULL_BYTES, NS_PER_S);
    assert_true(fabs(quality_ladder_bytes(&ladder) / HALF_BYTES - 1) < 0.05);
}

TEST(who_see_the_same_take_one_step)
{
    struct quality_ladder ladder = { .step = 1 }, seen = { 0 };
    assert_int_equal(quality_ladder_common(&seen, (int[QUALITY_LADDER_STEPS]){ 1, 0, 1 }), -1);
    int common = quality_ladder_common(&seen, (int[QUALITY_LADDER_STEPS]){ 60, 30, 5, 0, 0, 5 });
    /* 90 of 100 clients use the two best steps: the common step must be among these, whatever the other 10 use */
    assert_int_equal(common, 1);
    assert_int_equal(quality_ladder_common(&seen, (int[QUALITY_LADDER_STEPS]){ [QUALITY_LADDER_STEPS - 1] = 10 }),
                     QUALITY_LADDER_STEPS - 1);
    /* with frames of 90 kB the server has bandwidth for 100 clients, but not for 500, which must get a lower quality */
    seen.unit_bytes = 90e3;
    assert_int_equal(quality_ladder_common(&seen, (int[QUALITY_LADDER_STEPS]){ 100 }), 0);
    int crowd = quality_ladder_common(&seen, (int[QUALITY_LADDER_STEPS]){ 500 });
    assert_true(crowd > 0 && quality_ladder_rung(&seen, crowd).scale == 1);
    assert_int_equal(quality_ladder_step(&ladder, common), 1);
    assert_int_equal(quality_ladder_step(&ladder, -1), 1);
    ladder.step = 0;
    assert_int_equal(quality_ladder_step(&ladder, common), 1);
    ladder.step = 3;
    assert_int_equal(quality_ladder_step(&ladder, common), 1);
    ladder.step = 5;
    assert_int_equal(quality_ladder_step(&ladder, common), 5);
}

/* Random acknowledgements, right and wrong: there must never be more frames in flight than the window allows, and each valid
   acknowledgement must make room for another. */
TEST(random_clients)
{
    unsigned seed = (unsigned)sweep_seed();
    struct pacer pacer = fresh();
    pacer.last_seq = 100;
    for (int i = 0; i < 100000; i++) {
        if (pacer_may_ask(&pacer, i * MS) && rand_r(&seed) % 2)
            send_one(&pacer, 1, i * MS);
        else
            pacer_acked(&pacer, pacer.last_seq + (uint32_t)(rand_r(&seed) % 9) - 4, rand_r(&seed) - RAND_MAX / 2, i * MS);
        assert_true(pacer.flight_count >= 0 && pacer.flight_count <= PACER_MOST && pacer.asked == 0);
        assert_in_range(pacer.ladder.step, 0, QUALITY_LADDER_STEPS - 1);
    }
    pacer_acked(&pacer, pacer.last_seq, -1, 100000 * MS);
    assert_int_equal(pacer.flight_count, 0);
    assert_true(pacer_may_ask(&pacer, 100000 * MS));
}
