/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which client gets which encoded packet. Video packets depend on earlier ones, so the test simulates decoders: a packet can be
   decoded only right after the packet that it continues. */
#include "service/encode_streams.h"

#include "tests/support/test.h"

#include "base/clock.h"
#include "render/depth_grid.h"

enum { CLIENTS = 12, WIDTH = 64, HEIGHT = 36 };
static const int64_t MS = NS_PER_MS;

/* Content of a simulated packet: the decoder state that it requires (needs), and the one that decoding it produces (leaves). */
struct chain_state {
    uint64_t needs, leaves;
};

struct encode_streams_fixture {
    struct encode_streams streams;
    struct encode_plan plan;
    struct request_group rest;
    uint64_t shown[CLIENTS]; /* what each client's decoder holds */
    uint64_t last_state;
    int64_t now_ns;
    int encodes, keys;
    bool gives_depth; /* frames have depth grids */
    unsigned wants;   /* clients that want a depth grid, as a bit mask */
    enum wire_codec codec;
};

struct chain_head { /* simulated encoder of one stream (stream->work); state: what a decoder holds after the stream's newest packet */
    uint64_t state;
};

static void begin(struct encode_streams_fixture *f)
{
    f->now_ns = 1000 * NS_PER_S;
    f->codec = WIRE_CODEC_H264;
}

static bool never_busy(const struct encode_stream *stream)
{
    (void)stream;
    return false;
}

static void destroy_empty(struct encode_streams_fixture *f)
{
    for (struct encode_stream *stream; (stream = encode_streams_take_empty(&f->streams, never_busy));) {
        mem_free(stream->work);
        encode_stream_destroy(&stream);
    }
}

static void end(struct encode_streams_fixture *f)
{
    for (uint64_t client = 0; client < CLIENTS; client++)
        encode_streams_forget(&f->streams, client);
    destroy_empty(f);
    assert_null(f->streams.first);
    mem_free(f->streams.links);
    mem_free(f->plan.from);
    request_group_finish(&f->rest);
}

TEST_FIXTURE(struct encode_streams_fixture, begin, end)

#define CASE(name) TEST_ON(struct encode_streams_fixture *f, name, set_up, tear_down)

static struct request_ticket order_of(const struct encode_streams_fixture *f, uint64_t client, const struct view *view)
{
    struct request_ticket ticket = { .client = client, .request = { .view = *view, .codec = f->codec, .quality = { .quality = 80 } } };
    return ticket;
}

/* Simulates the encoder: returns the packet that continues the stream, or a key frame. */
static struct packet *encode(struct encode_streams_fixture *f, struct encode_stream *stream, const struct frame *frame, bool key)
{
    struct chain_head *head = stream->work ? stream->work : (stream->work = mem_new(sizeof(*head)));
    struct chain_state made = { .needs = key ? 0 : head->state, .leaves = ++f->last_state };
    uint8_t bytes[512] = { 0 };
    memcpy(bytes, &made, sizeof(made));
    head->state = made.leaves;
    f->encodes++;
    f->keys += key;
    return packet_create(frame, f->codec, key, bytes, key ? sizeof(bytes) : 64);
}

static void decode(struct encode_streams_fixture *f, uint64_t client, const struct packet *packet)
{
    struct chain_state made;
    memcpy(&made, packet->bytes, sizeof(made));
    if (made.needs)
        assert_int_equal(f->shown[client], made.needs);
    f->shown[client] = made.leaves;
}

static uint64_t least_needed(const struct encode_streams_fixture *f, const struct request_group *tickets)
{
    uint64_t least = UINT64_MAX;
    for (size_t i = 0; i < tickets->count; i++)
        least = f->plan.from[i] < least ? f->plan.from[i] : least;
    return least;
}

static void deliver(struct encode_streams_fixture *f, const struct request_group *tickets)
{
    struct packet *run[ENCODE_STREAM_KEPT];
    const struct chain_head *head = f->plan.stream->work;
    for (size_t i = 0; i < tickets->count; i++) {
        int count = encode_stream_catch_up(f->plan.stream, f->plan.from[i], f->plan.number, run);
        assert_true(count >= 0);
        for (int p = 0; p < count; p++)
            decode(f, tickets->tickets[i].client, run[p]);
        assert_int_equal(f->shown[tickets->tickets[i].client], head->state);
    }
}

static struct depth_grid *grid_create(void)
{
    const struct depth_cell cells[(WIDTH / DEPTH_CELL_PX) * (HEIGHT / DEPTH_CELL_PX + 1)] = { { 0 } };
    const struct depth_lens lens = { .factor = 1 };
    struct depth_grid *grid = depth_grid_create(cells, &lens, WIDTH, HEIGHT);
    assert_non_null(grid);
    return grid;
}

/* Asserts that those clients of the group that want a depth grid get one with the newest packet. */
static void check_depth(const struct encode_streams_fixture *f, const struct request_group *tickets)
{
    const struct encode_stream *stream = f->plan.stream;
    const struct packet *newest = stream->kept[stream->kept_count - 1];
    if (f->gives_depth && request_group_wants_depth(tickets))
        assert_true(newest->frame->depth[0]);
}

/* Encodes a frame with this view and content for `clients` (a bit mask). Asserts that each of these clients can decode its
   packet and then displays the content. */
static void show(struct encode_streams_fixture *f, unsigned clients, int view_number, uint64_t content, bool alone)
{
    struct frame *frame = frame_create(NULL, WIDTH, HEIGHT);
    struct request_group tickets = { 0 };
    frame->view = (struct view){ .width_px = WIDTH, .height_px = HEIGHT, .camera = { .fov_deg = 30 + view_number } };
    frame->content = content;
    frame->depth[0] = f->gives_depth ? grid_create() : NULL;
    for (uint64_t client = 0; client < CLIENTS; client++)
        if (clients & 1u << client) {
            struct request_ticket ticket = order_of(f, client, &frame->view);
            ticket.request.always = ticket.request.alone = alone;
            ticket.request.depth = (f->wants & 1u << client) != 0;
            request_group_add(&tickets, &ticket);
        }
    while (tickets.count > 0) {
        encode_streams_plan(&f->streams, frame, &tickets, f->now_ns, &f->plan, &f->rest);
        if (f->plan.encode) {
            struct packet *packet = encode(f, f->plan.stream, frame, f->plan.key);
            encode_stream_keep(f->plan.stream, packet, least_needed(f, &tickets));
            packet_unref(&packet);
        }
        deliver(f, &tickets);
        check_depth(f, &tickets);
        struct request_group done = tickets;
        tickets = f->rest;
        f->rest = (struct request_group){ 0 };
        request_group_finish(&done);
    }
    request_group_finish(&tickets);
    frame_unref(&frame);
    destroy_empty(f);
    f->now_ns += 50 * MS;
}

static size_t chain_count(const struct encode_streams_fixture *f)
{
    size_t count = 0;
    for (const struct encode_stream *stream = f->streams.first; stream; stream = stream->next)
        count++;
    return count;
}

CASE(one_client_has_one_key_frame)
{
    for (int i = 0; i < 100; i++)
        show(f, 1, i, (uint64_t)i + 1, false);
    assert_true(f->encodes == 100 && f->keys == 1 && chain_count(f) == 1);
    show(f, 1, 99, 100, true); /* the client's decoder was reset */
    assert_true(f->keys <= 2);
}

CASE(viewers_of_one_view_cost_one_encode)
{
    for (int i = 0; i < 20; i++)
        show(f, 0xfff, i, (uint64_t)i + 1, false);
    assert_true(f->encodes == 20 && f->keys == 1 && chain_count(f) == 1);
}

CASE(who_joins_a_still_view_is_given_what_is_there)
{
    show(f, 1, 0, 1, false);
    show(f, 1, 0, 2, false);
    for (unsigned client = 1; client < CLIENTS; client++)
        show(f, 1u << client, 0, 2, true);
    assert_true(f->encodes == 2 && f->keys == 1 && chain_count(f) == 1);
    show(f, 0xfff, 0, 3, false);
    assert_true(f->encodes == 3 && f->keys == 1);
}

CASE(who_missed_some_catches_up_without_a_key_frame)
{
    for (int i = 0; i < 12; i++)
        show(f, i % 4 == 3 ? 0xfff : 0xffe, 0, (uint64_t)i + 1, false);
    assert_true(f->encodes == 12 && f->keys == 1 && chain_count(f) == 1);
}

CASE(who_looks_elsewhere_gets_a_stream_of_its_own)
{
    show(f, 0xfff, 0, 1, false);
    show(f, 1, 1, 2, false);
    show(f, 0xffe, 0, 3, false);
    show(f, 1, 2, 4, false);
    assert_true(f->encodes == 4 && f->keys == 2 && chain_count(f) == 2);
    /* client 0, which had another view, returns to the view of the others: at most two streams must remain */
    show(f, 0xfff, 0, 5, false);
    assert_true(chain_count(f) <= 2);
}

CASE(a_slow_one_does_not_cost_the_others_key_frames)
{
    int before = 0;
    /* 100 s at 20 frames per second. Client 0 is slow and gets only every 50th frame; the others get all frames. */
    for (int i = 0; i < 2000; i++) {
        show(f, i % 50 == 49 ? 0xfff : 0xffe, i, (uint64_t)i + 1, false);
        before = i == 999 ? f->keys : before;
    }
    assert_in_range(f->keys - before, 0, 24); /* in the last 50 s only the slow client needs key frames, one for each of its 20 frames */
    assert_in_range(chain_count(f), 1, 2);
}

CASE(depth_that_packets_lack_is_sent_to_clients_that_want_it)
{
    f->codec = WIRE_CODEC_JPEG;
    f->wants = 2;
    show(f, 1, 0, 1, false);
    f->gives_depth = true;
    show(f, 1, 0, 1, false);
    assert_int_equal(f->encodes, 1); /* client 0 wants no depth grid, so the packet that was encoded without one is used again */
    show(f, 2, 0, 1, false);
    assert_true(f->encodes == 2 && f->plan.again);
    show(f, 2, 0, 1, true);
    assert_int_equal(f->encodes, 2); /* client 1 gets the packet that was encoded once with a depth grid */
}

/* Clients acknowledge frames one by one, so some request the next view while others still wait for the previous one. Each
   picture must be encoded only once all the same. */
CASE(whole_pictures_are_made_once_however_it_is_asked_for)
{
    f->codec = WIRE_CODEC_JPEG;
    show(f, 0xfff, 0, 1, false);
    for (int i = 1; i < 50; i++) {
        unsigned first = i % 3 == 0 ? 0x001u : i % 3 == 1 ? 0x807u : 0x0ffu;
        show(f, first, i, (uint64_t)i + 1, false);
        show(f, 0xfffu & ~first, i, (uint64_t)i + 1, false);
    }
    assert_int_equal(f->encodes, 50);
}

CASE(what_broke_starts_anew)
{
    show(f, 3, 0, 1, false);
    struct encode_stream *stream = f->streams.first;
    stream->planned++; /* counts a frame as planned without encoding it, as if encoding had failed */
    encode_stream_break(stream);
    show(f, 3, 0, 9, false);
    assert_int_equal(f->keys, 2);
}

CASE(whoever_asks_whenever_decodes_it)
{
    unsigned seed = (unsigned)sweep_seed();
    srand(seed);
    for (int i = 0; i < 20000; i++) {
        unsigned clients = (unsigned)rand() & (rand() % 3 ? 0xfffu : 0x00fu);
        if (rand() % 40 == 0)
            encode_streams_forget(&f->streams, (uint64_t)(rand() % CLIENTS));
        if (rand() % 100 == 0)
            f->now_ns += 3 * NS_PER_S;
        show(f, clients, rand() % 4, (uint64_t)(rand() % 6) + 1, rand() % 30 == 0);
        assert_in_range(chain_count(f), 0, CLIENTS);
    }
}
