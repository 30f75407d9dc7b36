/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A session without a socket, clock or render service: its frame requests, the messages that it sends, and how it handles answers. */
#include "session/session.h"

#include "tests/support/test.h"
#include <jansson.h>

#include "base/clock.h"
#include "plant/colormaps.h"
#include "base/mem.h"
#include "session/reply/reply.h"
#include "session/session_impl.h"
#include "render/depth_grid.h"
#include "tests/support/session_case.h"
#include "tests/support/small_scene.h"
#include "value/quality.h"

#define CASE(name) TEST_ON(struct session_case *f, name, session_case_set_up, session_case_tear_down)

#define HELLO "{\"type\":\"hello\",\"width\":640,\"height\":360,\"codecs\":[\"jpeg\"]}"
static const int64_t MS = NS_PER_MS;

static void say(struct session_case *f, const char *text)
{
    session_on_message(f->session, text, strlen(text), f->now_ns, f->now_ns);
}

/* Returns the session's next text message to the client, or NULL if it has none to send now. */
static json_t *hear(struct session_case *f)
{
    struct text *text = test_text();
    json_t *message = NULL;
    bool due = session_has_text(f->session, f->now_ns);
    assert_int_equal(session_next_text(f->session, f->now_ns, f->now_ns, text), due);
    if (due)
        assert_non_null(message = test_json(json_loads(text->at, 0, NULL)));
    return message;
}

static const char *type_of(const json_t *message)
{
    return message ? json_string_value(json_object_get(message, "type")) : "(nothing)";
}

/* Takes all due messages and asserts their types, in this order. */
static void expect(struct session_case *f, const char *types)
{
    char got[256] = "";
    for (const json_t *message; (message = hear(f));)
        snprintf(got + strlen(got), sizeof(got) - strlen(got), "%s ", type_of(message));
    assert_string_equal(got, types);
}

static void expect_error(struct session_case *f, const char *code)
{
    json_t *message = hear(f);
    assert_string_equal(type_of(message), "error");
    assert_string_equal(json_string_value(json_object_get(message, "code")), code);
}

static void greet(struct session_case *f)
{
    say(f, HELLO);
    expect(f, "welcome status tags ");
}

/* Takes the session's next request for a frame, like the render service. Returns false if there is none, or if it may only
   replace an earlier request: none is waiting here, so the render service would decline it. */
static bool ask(struct session_case *f, struct frame_request *request)
{
    if (!session_next_request(f->session, f->now_ns, request) || request->only_replace)
        return false;
    session_requested(f->session, request, false);
    return true;
}

static struct encoded_frame *empty_picture(struct session_case *f, const struct frame_request *request)
{
    struct encoded_frame *encoded = mem_new(sizeof(*encoded));
    *encoded = (struct encoded_frame){ .client = 7, .number = ++f->number, .absence = FRAME_UNCHANGED, .request = *request };
    return encoded;
}

static void paint_nothing(struct session_case *f, const struct frame_request *request)
{
    struct encoded_frame *encoded = empty_picture(f, request);
    encoded->absence = FRAME_FAILED;
    session_on_frame(f->session, encoded);
}

static void paint(struct session_case *f, const struct frame_request *request, bool same)
{
    struct encoded_frame *encoded = empty_picture(f, request);
    if (!same) {
        struct frame *frame = frame_create(NULL, 16, 16);
        frame->view = request->view;
        encoded->packet = packet_create(frame, WIRE_CODEC_JPEG, true, "jpeg", 4);
        frame_unref(&frame);
    }
    session_on_frame(f->session, encoded);
}

static uint32_t send_picture(struct session_case *f)
{
    uint32_t seq = 0;
    enum session_depth depth;
    struct encoded_frame *encoded = session_next_frame(f->session, f->now_ns, &seq, &depth);
    if (encoded)
        session_wrote(f->session, true, f->now_ns);
    encoded_frame_destroy(&encoded);
    return seq;
}

static void ack(struct session_case *f, uint32_t seq)
{
    say(f, test_printf("{\"type\":\"ack\",\"seq\":%u}", seq));
}

/* Answers the request with a frame of `bytes` bytes and sends it; the client's acknowledgement arrives way_ns later. */
static void carry(struct session_case *f, const struct frame_request *request, size_t bytes, int64_t way_ns)
{
    struct encoded_frame *encoded = empty_picture(f, request);
    struct frame *frame = frame_create(NULL, 16, 16);
    uint8_t *payload = mem_array(bytes, 1);
    frame->view = request->view;
    encoded->packet = packet_create(frame, WIRE_CODEC_JPEG, true, payload, bytes);
    frame_unref(&frame);
    mem_free(payload);
    session_on_frame(f->session, encoded);
    uint32_t seq = send_picture(f);
    f->now_ns += way_ns;
    ack(f, seq);
}

/* Requests, draws, sends and acknowledges one frame. */
static struct frame_request show(struct session_case *f)
{
    struct frame_request request = { 0 };
    if (!ask(f, &request))
        fail_msg("no picture is wanted");
    paint(f, &request, false);
    ack(f, send_picture(f));
    return request;
}

/* The client says hello and gets a preview, and after one second a refined picture. */
static void get_refined(struct session_case *f)
{
    greet(f);
    show(f);
    f->now_ns += NS_PER_S;
    assert_true(show(f).view.tier == TIER_REFINED);
}

/* New readings arrive: takes the session's request, draws and acknowledges the frame. quick: the render thread can recolour the
   refined frame in time; otherwise it draws the preview that the request allows instead. Returns the request. */
static struct frame_request show_data(struct session_case *f, bool quick)
{
    struct frame_request request = { 0 };
    session_on_data(f->session, f->now_ns);
    if (!ask(f, &request))
        fail_msg("no picture is wanted");
    if (request.or_moving && !quick)
        request.view.tier = TIER_PREVIEW;
    paint(f, &request, false);
    ack(f, send_picture(f));
    return request;
}

static struct depth_grid *grid_of(int width_px)
{
    struct depth_cell cells[16] = { { 0.5f, 0.5f, 0 } };
    return depth_grid_create(cells, &(struct depth_lens){ .factor = 1, .step = 0.01f }, width_px, 8);
}

/* Answers the request with a frame and these depth grids, sends and acknowledges it. Returns whether the session sends the
   grids. The caller keeps its references to them. */
static enum session_depth show_depth(struct session_case *f, const struct frame_request *request, struct depth_grid *grids[2])
{
    struct encoded_frame *encoded = empty_picture(f, request);
    struct frame *frame = frame_create(NULL, 16, 16);
    enum session_depth depth = SESSION_DEPTH_NONE;
    uint32_t seq = 0;
    frame->view = request->view;
    session_requested(f->session, request, false);
    for (int i = 0; i < 2; i++)
        frame->depth[i] = depth_grid_ref(grids[i]);
    encoded->packet = packet_create(frame, WIRE_CODEC_JPEG, true, "jpeg", 4);
    frame_unref(&frame);
    session_on_frame(f->session, encoded);
    encoded = session_next_frame(f->session, f->now_ns, &seq, &depth);
    session_wrote(f->session, true, f->now_ns);
    encoded_frame_destroy(&encoded);
    ack(f, seq);
    return depth;
}

#define DEPTH_HELLO "{\"type\":\"hello\",\"width\":640,\"height\":360,\"codecs\":[\"jpeg\",\"png\"],\"depth\":true}"

CASE(depth_is_sent_when_it_changes)
{
    struct frame_request request;
    struct depth_grid *first[2] = { grid_of(16) }, *equal[2] = { grid_of(16) }, *split[2] = { grid_of(8), grid_of(8) }, *none[2] = { NULL };
    say(f, DEPTH_HELLO);
    assert_true(session_gets_depth(f->session));
    assert_true(ask(f, &request) && request.depth);
    assert_int_equal(show_depth(f, &request, first), SESSION_DEPTH_NEW);
    assert_int_equal(show_depth(f, &request, equal), SESSION_DEPTH_SENT);
    assert_int_equal(show_depth(f, &request, none), SESSION_DEPTH_NONE);
    assert_int_equal(show_depth(f, &request, split), SESSION_DEPTH_NEW);
    assert_int_equal(show_depth(f, &request, first), SESSION_DEPTH_NEW);
    /* a frame requested without depth, e.g. because the session followed another one then: no grid is sent with it */
    request.depth = false;
    assert_int_equal(show_depth(f, &request, first), SESSION_DEPTH_NONE);
    for (int i = 0; i < 2; i++) {
        depth_grid_unref(&first[i]);
        depth_grid_unref(&equal[i]);
        depth_grid_unref(&split[i]);
    }
}

CASE(depth_is_only_for_clients_that_ask)
{
    struct frame_request request;
    greet(f);
    assert_false(session_gets_depth(f->session));
    assert_true(ask(f, &request) && !request.depth);
}

CASE(signed_frames_and_followers_get_no_depth)
{
    struct frame_request request;
    f->context.signing_key = "0123456789abcdef";
    say(f, DEPTH_HELLO);
    say(f, "{\"type\":\"sign\",\"frames\":\"all\"}");
    assert_true(session_wants(f->session, f->now_ns, &request) && request.record && !request.depth);
    say(f, "{\"type\":\"sign\",\"frames\":\"none\"}");
    assert_true(session_wants(f->session, f->now_ns, &request) && request.depth);
    f->session->following.leader = f->session;
    session_wants(f->session, f->now_ns, &request);
    assert_false(request.depth);
    f->session->following.leader = NULL;
}

CASE(tiles_of_a_wall_get_no_depth)
{
    struct frame_request request;
    say(f, DEPTH_HELLO);
    f->session->tile.place.display = 1;
    assert_false(session_gets_depth(f->session));
    f->session->tile.place.display = 0;
    assert_true(session_gets_depth(f->session));
    assert_true(ask(f, &request) && request.depth);
}

CASE(a_plant_may_give_no_depth_away)
{
    struct frame_request request;
    struct plant closed = *f->context.plant;
    closed.display.no_reprojection = true;
    f->context.plant = &closed;
    say(f, DEPTH_HELLO);
    assert_false(session_gets_depth(f->session));
    assert_true(ask(f, &request) && !request.depth && !f->session->delivery.pacer.ladder.reprojects);
}

CASE(the_quality_ladder_knows_that_the_client_reprojects)
{
    struct frame_request request;
    say(f, DEPTH_HELLO);
    assert_true(ask(f, &request) && request.depth && f->session->delivery.pacer.ladder.reprojects);
}

#define SIGNED_HELLO "{\"type\":\"hello\",\"width\":640,\"height\":360,\"codecs\":[\"jpeg\",\"png\"],\"signed\":\"refined\"}"

CASE(refined_frames_are_asked_for_signed)
{
    f->context.signing_key = "0123456789abcdef";
    say(f, SIGNED_HELLO);
    expect(f, "welcome status tags ");
    struct frame_request preview = show(f);
    assert_true(preview.view.tier == TIER_PREVIEW && !preview.record && preview.codec == WIRE_CODEC_JPEG);
    f->now_ns += NS_PER_S;
    struct frame_request refined = show(f);
    assert_true(refined.view.tier == TIER_REFINED && refined.record && refined.codec == WIRE_CODEC_PNG && !refined.draft);
    /* readings changed: the session requests a recoloured refined frame as PNG, to be signed, and allows a JPEG preview if that
       would take long */
    struct frame_request data = show_data(f, true);
    assert_true(data.record && data.codec == WIRE_CODEC_PNG && (!data.or_moving || data.moving_codec == WIRE_CODEC_JPEG));
    say(f, "{\"type\":\"sign\",\"frames\":\"all\"}");
    preview = show(f);
    assert_true(preview.view.tier == TIER_PREVIEW && preview.record && preview.always);
    say(f, "{\"type\":\"sign\",\"frames\":\"none\"}");
    preview = show(f);
    assert_true(!preview.record && preview.codec == WIRE_CODEC_JPEG);
    say(f, "{\"type\":\"sign\",\"frames\":\"all\"}");
    /* the client can no longer decode PNG, which signed frames require, so none may be signed */
    say(f, "{\"type\":\"codecs\",\"codecs\":[\"jpeg\"]}");
    assert_false(show(f).record);
}

CASE(what_cannot_be_signed_is_refused)
{
    struct message_error why = { 0 };
    say(f, SIGNED_HELLO); /* this server has no key */
    expect_error(f, "bad_field");
    f->context.signing_key = "0123456789abcdef";
    say(f, "{\"type\":\"hello\",\"width\":640,\"height\":360,\"codecs\":[\"jpeg\"],\"signed\":\"all\"}");
    expect_error(f, "bad_field");
    greet(f);
    say(f, "{\"type\":\"sign\",\"frames\":\"all\"}");
    expect_error(f, "bad_field");
    message_fail(&why, "not_signed", "a reason");
    session_not_signed(f->session, &why);
    session_not_signed(f->session, &why); /* once */
    expect_error(f, "not_signed");
    expect(f, "");
}

CASE(nothing_before_hello)
{
    struct frame_request request;
    assert_false(session_next_request(f->session, f->now_ns, &request));
    session_on_data(f->session, f->now_ns);
    expect(f, "");
    say(f, "{\"type\":\"resize\",\"width\":640,\"height\":360}");
    expect_error(f, "hello_first");
    assert_false(session_next_request(f->session, f->now_ns, &request));
    say(f, HELLO);
    say(f, HELLO);
    expect(f, "welcome error status tags ");
}

CASE(welcome_tells_the_plant_and_no_addresses)
{
    struct text *text = test_text();
    say(f, HELLO);
    assert_true(session_next_text(f->session, f->now_ns, f->now_ns, text));
    assert_null(strstr(text->at, "10.20.30.40"));
    assert_null(strstr(text->at, "400123"));
    json_t *welcome = test_json(json_loads(text->at, 0, NULL)), *tag, *limits, *rgb;
    assert_non_null(welcome);
    assert_int_equal(json_array_size(json_object_get(welcome, "groups")), 2);
    tag = json_array_get(json_object_get(welcome, "tags"), 0);
    assert_true(json_number_value(json_array_get(json_object_get(tag, "position"), 2)) == 2.375);
    assert_true(json_is_object(json_object_get(tag, "limits")) && json_object_size(json_object_get(tag, "limits")) == 4);
    assert_true(json_is_null(json_object_get(json_array_get(json_object_get(welcome, "tags"), 2), "position")));
    limits = json_object_get(json_array_get(json_object_get(welcome, "groups"), 0), "limits");
    assert_true(json_is_null(json_object_get(limits, "LL")) && json_number_value(json_object_get(limits, "H")) == 150);
    rgb = json_object_get(json_array_get(json_object_get(welcome, "colormaps"), 0), "rgb");
    assert_int_equal(json_string_length(rgb), 1024);
    assert_string_equal(json_string_value(json_object_get(json_object_get(welcome, "view"), "group")), "temperature");
}

static void assert_axis(const json_t *welcome, int axis)
{
    const json_t *up = json_object_get(json_object_get(welcome, "plant"), "up");
    assert_int_equal(json_array_size(up), 3);
    for (int i = 0; i < 3; i++)
        assert_true(json_number_value(json_array_get(up, (size_t)i)) == (i == axis));
}

CASE(welcome_tells_the_vertical_and_the_initial_quantity_of_the_plant)
{
    struct plant other = *f->context.plant;
    struct text *text = test_text();
    say(f, HELLO);
    assert_true(session_next_text(f->session, f->now_ns, f->now_ns, text));
    json_t *welcome = test_json(json_loads(text->at, 0, NULL));
    assert_axis(welcome, 2);
    assert_null(json_object_get(json_object_get(welcome, "plant"), "show"));
    other.up = AXIS_Y;
    other.display.show = PLANT_SHOW_OPERATOR;
    f->context.plant = &other;
    char *again = reply_welcome_text(f->session, f->now_ns);
    welcome = test_json(json_loads(again, 0, NULL));
    mem_free(again);
    assert_axis(welcome, 1);
    assert_string_equal(json_string_value(json_object_get(json_object_get(welcome, "plant"), "show")), "operator");
}

CASE(first_picture_comes_at_once_then_refined_then_nothing)
{
    struct frame_request request;
    greet(f);
    assert_true(ask(f, &request));
    assert_true(request.always && request.urgency == URGENCY_INPUT && request.view.tier == TIER_PREVIEW && !request.quality.full_chroma);
    paint(f, &request, false);
    assert_int_equal(send_picture(f), 1);
    ack(f, 1);
    f->now_ns += 100 * MS;
    assert_false(ask(f, &request));
    f->now_ns += 150 * MS;
    assert_true(ask(f, &request));
    assert_true(request.urgency == URGENCY_REFINE && request.view.tier == TIER_REFINED && request.quality.full_chroma &&
                request.quality.quality >= 90);
    paint(f, &request, false);
    ack(f, send_picture(f));
    f->now_ns += 60 * NS_PER_S;
    assert_false(ask(f, &request));
}

CASE(rests_once_nothing_waits_for_time)
{
    struct frame_request request;
    assert_true(session_rests(f->session, f->now_ns)); /* no hello yet */
    greet(f);
    assert_false(session_rests(f->session, f->now_ns)); /* a frame is wanted */
    assert_true(ask(f, &request));
    assert_false(session_rests(f->session, f->now_ns)); /* drawn, */
    paint(f, &request, false);
    assert_false(session_rests(f->session, f->now_ns));
    uint32_t seq = send_picture(f);
    assert_false(session_rests(f->session, f->now_ns)); /* the frame is under way */
    ack(f, seq);
    assert_false(session_rests(f->session, f->now_ns)); /* the preview was acknowledged, but its refined frame is still missing */
    f->now_ns += 250 * MS;
    show(f);
    assert_false(session_rests(f->session, f->now_ns)); /* counts as moving */
    f->now_ns += NS_PER_S;
    assert_true(session_rests(f->session, f->now_ns));
    session_on_data(f->session, f->now_ns);
    assert_false(session_rests(f->session, f->now_ns));
    show(f);
    /* the frame arrived, but the message with the changed readings has not been sent yet */
    assert_false(session_rests(f->session, f->now_ns));
    expect(f, "tags ");
    assert_true(session_rests(f->session, f->now_ns));
    session_on_data(f->session, f->now_ns);
    say(f, "{\"type\":\"visible\",\"visible\":false}");
    assert_true(session_rests(f->session, f->now_ns));
    say(f, "{\"type\":\"visible\",\"visible\":true}");
    assert_false(session_rests(f->session, f->now_ns));
}

CASE(readings_that_are_rare_do_not_make_what_is_shown_old)
{
    greet(f);
    show(f);
    f->now_ns += 250 * MS;
    show(f);
    for (int s = 0; s < 60; s++) { /* no reading changes for a minute, and the client only sends pings: the shown frame stays fresh */
        f->now_ns += NS_PER_S;
        say(f, "{\"type\":\"ping\",\"t\":1}");
        expect(f, "pong ");
        session_on_tick(f->session, f->now_ns);
    }
    assert_int_equal(session_fresh_ns(f->session), f->now_ns);
    int64_t then_ns = f->now_ns;
    f->now_ns += 100 * MS;
    session_on_data(f->session, f->now_ns); /* new readings: the shown frame was true until the last tick, and is outdated from then on */
    session_on_tick(f->session, f->now_ns);
    assert_int_equal(session_fresh_ns(f->session), then_ns);
    f->now_ns += NS_PER_S;
    session_on_tick(f->session, f->now_ns);
    assert_int_equal(session_fresh_ns(f->session), then_ns);
    show(f);
    assert_true(session_fresh_ns(f->session) > then_ns);
}

CASE(newest_camera_wins_and_the_last_state_arrives)
{
    struct frame_request request;
    greet(f);
    show(f);
    /* moves the camera 50 times but acknowledges nothing: after two frames the session must stop requesting */
    for (uint32_t seq = 1; seq <= 50; seq++) {
        say(f, test_printf("{\"type\":\"camera\",\"seq\":%u,\"eye\":[%u,-9,4],\"target\":[0,0,1]}", seq, seq + 5));
        if (ask(f, &request)) {
            paint(f, &request, false);
            send_picture(f);
        }
    }
    assert_int_equal(f->session->delivery.pacer.flight_count, PACER_LEAST);
    assert_int_equal(request.only_replace ? 2 : request.view.camera_seq, 2);
    ack(f, f->session->delivery.pacer.last_seq);
    assert_true(ask(f, &request));
    assert_int_equal(request.view.camera_seq, 50);
    assert_true(request.view.camera.eye_m[0] == 55);
}

CASE(a_full_window_only_replaces)
{
    struct frame_request request;
    greet(f);
    assert_true(ask(f, &request));
    say(f, "{\"type\":\"camera\",\"seq\":1,\"eye\":[9,9,9],\"target\":[0,0,1]}");
    assert_true(ask(f, &request));
    say(f, "{\"type\":\"camera\",\"seq\":2,\"eye\":[8,9,9],\"target\":[0,0,1]}");
    assert_true(session_next_request(f->session, f->now_ns, &request));
    assert_true(request.only_replace && request.view.camera_seq == 2);
    session_requested(f->session, &request, true);
    assert_int_equal(f->session->delivery.pacer.asked, 2);
    assert_false(session_next_request(f->session, f->now_ns, &request));
}

/* A request for a refined frame waits while other cameras move. The time of the preview that replaces it begins later. */
CASE(a_preview_that_replaces_a_refined_frame_is_timed_from_its_own_request)
{
    struct frame_request request;
    const struct pacer *pacer = &f->session->delivery.pacer;
    greet(f);
    assert_true(ask(f, &request));
    paint(f, &request, true);
    f->now_ns += NS_PER_S;
    assert_true(ask(f, &request));
    assert_int_equal(request.view.tier, TIER_REFINED);
    assert_int_equal(pacer->previews, 0);
    f->now_ns += NS_PER_S;
    say(f, "{\"type\":\"camera\",\"seq\":1,\"eye\":[9,9,9],\"target\":[0,0,1]}");
    assert_true(session_next_request(f->session, f->now_ns, &request));
    session_requested(f->session, &request, true);
    assert_true(pacer->asked == 1 && pacer->previews == 1);
    assert_int_equal(pacer->owed_since_ns, f->now_ns);
    f->now_ns += NS_PER_S;
    say(f, "{\"type\":\"camera\",\"seq\":2,\"eye\":[8,9,9],\"target\":[0,0,1]}");
    assert_true(session_next_request(f->session, f->now_ns, &request));
    session_requested(f->session, &request, true);
    assert_int_equal(pacer->owed_since_ns, f->now_ns - NS_PER_S);
}

CASE(equal_pictures_free_their_place)
{
    struct frame_request request;
    greet(f);
    for (int i = 0; i < 10; i++) {
        say(f, "{\"type\":\"camera\",\"seq\":1,\"eye\":[9,9,9],\"target\":[0,0,1]}");
        assert_true(ask(f, &request));
        paint(f, &request, true);
    }
    assert_int_equal(f->session->delivery.pacer.asked, 0);
    assert_int_equal(send_picture(f), 0);
}

CASE(without_a_first_picture_a_session_is_refused)
{
    struct frame_request request;
    greet(f);
    assert_true(ask(f, &request));
    paint_nothing(f, &request);
    assert_int_equal(f->session->close.code, 1013);
    assert_int_equal(f->session->delivery.pacer.asked, 0);
}

CASE(a_view_that_cannot_be_drawn_is_said_once)
{
    struct frame_request request;
    greet(f);
    show(f);
    for (int camera = 1; camera <= 2; camera++) {
        say(f, test_printf("{\"type\":\"camera\",\"seq\":%d,\"eye\":[9,9,%d],\"target\":[0,0,1]}", camera, camera + 5));
        assert_true(ask(f, &request));
        paint_nothing(f, &request);
        expect_error(f, "no_picture");
        f->now_ns += 150 * MS;
        session_on_data(f->session, f->now_ns);
        assert_true(ask(f, &request));
        paint_nothing(f, &request);
        assert_int_equal(f->session->close.code, 0);
    }
    f->now_ns += 3 * NS_PER_S;
    show(f);
}

/* A frame could not be drawn for lack of memory: although nothing changes, the session must request it again at intervals. */
CASE(a_view_that_cannot_be_drawn_is_tried_again)
{
    struct frame_request request;
    greet(f);
    show(f);
    say(f, "{\"type\":\"camera\",\"seq\":1,\"eye\":[9,9,5],\"target\":[0,0,1]}");
    assert_true(ask(f, &request));
    paint_nothing(f, &request);
    int tries = 0;
    for (int tenth = 0; tenth < 100; tenth++) {
        f->now_ns += 100 * MS;
        if (!ask(f, &request))
            continue;
        assert_true(request.view.tier == TIER_REFINED && request.view.camera_seq == 1);
        paint_nothing(f, &request);
        tries++;
    }
    assert_in_range(tries, 3, 6);
    f->now_ns += 3 * NS_PER_S;
    assert_int_equal(show(f).view.tier, TIER_REFINED);
    f->now_ns += 10 * NS_PER_S;
    assert_false(ask(f, &request));
}

CASE(overtaken_pictures_are_not_sent)
{
    struct frame_request request;
    greet(f);
    assert_true(ask(f, &request));
    say(f, "{\"type\":\"camera\",\"seq\":1,\"eye\":[9,9,9],\"target\":[0,0,1]}");
    struct frame_request first = request;
    assert_true(ask(f, &request));
    f->number = 1;
    paint(f, &request, false); /* this frame gets number 2 */
    f->number = 0;
    paint(f, &first, false); /* number 1 comes later */
    uint32_t seq;
    enum session_depth depth;
    struct encoded_frame *encoded = session_next_frame(f->session, f->now_ns, &seq, &depth);
    assert_int_equal(encoded->request.view.camera_seq, 1);
    encoded_frame_destroy(&encoded);
    assert_null(session_next_frame(f->session, f->now_ns, &seq, &depth));
    assert_int_equal(f->session->delivery.pacer.asked, 0);
    assert_int_equal(f->session->stats.dropped, 1);
}

CASE(data_under_a_still_view_is_drawn_once_and_refined)
{
    struct frame_request request;
    get_refined(f);
    session_on_data(f->session, f->now_ns);
    assert_true(ask(f, &request));
    assert_true(!request.always && request.view.tier == TIER_REFINED && request.view.input_ns == f->now_ns);
    paint(f, &request, true);
    assert_false(ask(f, &request));
}

CASE(readings_come_with_the_next_camera_of_a_slow_drag)
{
    struct frame_request request;
    greet(f);
    show(f);
    for (int camera = 1; camera <= 5; camera++) {
        say(f, test_printf("{\"type\":\"camera\",\"seq\":%d,\"eye\":[9,9,%d],\"target\":[0,0,1]}", camera, camera + 5));
        f->context.readings.changed_ns = f->now_ns;
        request = show(f);
        assert_true(request.urgency == URGENCY_INPUT && request.read_ns == f->now_ns);
        f->now_ns += 50 * MS;
        session_on_data(f->session, f->now_ns);
        assert_false(ask(f, &request));
        f->now_ns += 50 * MS;
    }
    f->now_ns += 50 * MS; /* it was the last */
    assert_true(ask(f, &request));
    assert_true(request.of_data && request.urgency == URGENCY_DATA);
}

CASE(nobody_is_refined_while_another_moves)
{
    struct frame_request request;
    greet(f);
    show(f);
    for (int i = 0; i < 9; i++) {
        f->now_ns += NS_PER_S;
        f->context.load.moving_until_ns = f->now_ns + 200 * MS;
        assert_false(ask(f, &request));
        session_on_data(f->session, f->now_ns);
        assert_true(show(f).view.tier == TIER_PREVIEW);
    }
    f->now_ns += 250 * MS;
    assert_true(ask(f, &request));
    assert_true(request.view.tier == TIER_REFINED);
}

CASE(others_may_move_for_a_while_not_for_ever)
{
    struct frame_request request;
    greet(f);
    show(f);
    f->now_ns += 11 * NS_PER_S;
    f->context.load.moving_until_ns = f->now_ns + 200 * MS;
    assert_true(ask(f, &request));
    assert_true(request.view.tier == TIER_REFINED);
}

CASE(data_on_a_loaded_server_is_not_refined_at_once)
{
    struct frame_request request;
    get_refined(f);
    f->context.load.overloaded = true;
    request = show_data(f, false);
    assert_true(request.view.tier == TIER_PREVIEW && request.urgency == URGENCY_DATA);
    f->now_ns += 900 * MS;
    assert_false(ask(f, &request));
    f->now_ns += 200 * MS;
    assert_true(ask(f, &request));
    assert_true(request.view.tier == TIER_REFINED);
}

CASE(data_on_a_loaded_server_does_not_put_refinement_off_for_ever)
{
    int refined = 0;
    get_refined(f);
    f->context.load.overloaded = true;
    for (int i = 0; i < 20; i++) { /* 10 s */
        f->now_ns += 500 * MS;
        refined += show_data(f, false).view.tier == TIER_REFINED;
    }
    assert_in_range(refined, 2, 4);
}

/* A refinement is abandoned in favour of new readings, but these turn out to change no pixel. The preview on the client's
   screen must then be refined after all. */
CASE(data_that_changes_nothing_does_not_end_a_refinement_that_it_overtook)
{
    struct frame_request refined, data;
    greet(f);
    show(f);
    f->now_ns += NS_PER_S;
    f->context.load.overloaded = true;
    assert_true(ask(f, &refined) && refined.view.tier == TIER_REFINED);
    session_on_data(f->session, f->now_ns += 1500 * MS);
    assert_true(ask(f, &data) && data.or_moving);
    assert_true(data.scale == 1); /* the preview that may be drawn instead has the view's full size */
    paint(f, &refined, true); /* abandoned: no frame */
    data.view.tier = TIER_PREVIEW;
    paint(f, &data, true); /* the preview that is shown */
    f->now_ns += 4 * NS_PER_S;
    assert_true(ask(f, &refined) && refined.view.tier == TIER_REFINED);
}

/* The render service says that the client has the refined frame already, but the client's copy was lost. After a pause the
   session must request the complete frame. */
CASE(a_refined_picture_that_is_lost_is_asked_for_again)
{
    struct frame_request refined;
    greet(f);
    show(f);
    f->now_ns += NS_PER_S;
    assert_true(ask(f, &refined) && refined.view.tier == TIER_REFINED && !refined.always);
    paint(f, &refined, true);
    f->now_ns += NS_PER_S;
    assert_false(ask(f, &refined));
    f->now_ns += 2 * NS_PER_S;
    assert_true(ask(f, &refined) && refined.view.tier == TIER_REFINED && refined.always && refined.alone);
    paint(f, &refined, false);
    ack(f, send_picture(f));
    f->now_ns += 10 * NS_PER_S;
    assert_false(ask(f, &refined));
}

/* The session does not know yet how long refining takes, so it must not let changed readings wait for it: the first refinement
   takes a minute here. */
CASE(data_does_not_wait_for_the_first_refined_picture)
{
    struct frame_request refined, data, preview;
    greet(f);
    show(f);
    f->now_ns += NS_PER_S;
    assert_true(ask(f, &refined) && refined.view.tier == TIER_REFINED);
    for (int i = 0; i < 5; i++) { /* the link is so slow that one frame of 20 kB fills the window, so no further frame may be requested */
        session_on_data(f->session, f->now_ns += 3 * NS_PER_S);
        assert_true(ask(f, &data) && (i > 0 || (data.view.tier == TIER_REFINED && data.or_moving)));
        session_on_data(f->session, f->now_ns += 100 * MS);
        assert_false(ask(f, &preview));
        data.view.tier = TIER_PREVIEW;
        carry(f, &data, 20000, 800 * MS);
    }
    paint(f, &refined, false);
    ack(f, send_picture(f));
    f->now_ns += NS_PER_S;
    session_on_data(f->session, f->now_ns);
    /* later changes of readings are to be shown by recolouring the refined frame */
    assert_true(ask(f, &data) && data.view.tier == TIER_REFINED && !data.or_moving);
}

/* A preview is requested while a refined frame is being drawn, and arrives after it. The session must then request another
   refined frame. The preview has two causes: delayed readings, and a changed codec. */
CASE(a_preview_that_comes_after_a_refined_picture_does_not_stay)
{
    struct frame_request refined, preview;
    greet(f);
    show(f);
    f->context.load.overloaded = true;
    for (int of_codec = 0; of_codec < 2; of_codec++) {
        f->now_ns += 2 * NS_PER_S;
        assert_true(ask(f, &refined) && refined.view.tier == TIER_REFINED);
        if (of_codec)
            say(f, "{\"type\":\"codecs\",\"codecs\":[\"png\"]}");
        else
            show_data(f, false); /* show_data() has the readings drawn as a preview, which arrives before the refined frame */
        session_on_data(f->session, f->now_ns += 500 * MS);
        assert_true(ask(f, &preview) && preview.view.tier == TIER_PREVIEW);
        paint(f, &refined, false);
        ack(f, send_picture(f));
        paint(f, &preview, false);
        ack(f, send_picture(f));
    }
    f->now_ns += 2 * NS_PER_S;
    assert_true(ask(f, &refined) && refined.view.tier == TIER_REFINED);
    paint(f, &refined, false);
    ack(f, send_picture(f));
    f->now_ns += 2 * NS_PER_S;
    assert_false(ask(f, &preview));
}

/* Readings change twice a second for a minute. As the refined frame can be recoloured quickly, it must stay refined, however
   busy the server is. */
CASE(data_leaves_a_refined_picture_that_is_quick_to_color)
{
    struct frame_request request;
    get_refined(f);
    f->context.load.overloaded = true;
    for (int i = 0; i < 120; i++) {
        f->now_ns += 500 * MS;
        request = show_data(f, true);
        assert_true(request.view.tier == TIER_REFINED && request.urgency == URGENCY_DATA && request.quality.full_chroma);
    }
    f->now_ns += 5 * NS_PER_S;
    assert_false(ask(f, &request));
}

/* A client on a link of 125 kB/s: while the camera moves, previews become smaller; when it stops, the view is refined in two
   stages, a draft first. */
CASE(a_slow_client_gets_less_and_everything_in_the_end)
{
    struct frame_request request;
    greet(f);
    for (int i = 1; i <= 40; i++) {
        say(f, test_printf("{\"type\":\"camera\",\"seq\":%d,\"eye\":[9,9,%d],\"target\":[0,0,1]}", i, i + 5));
        assert_true(ask(f, &request));
        assert_true(fabs(request.view.height_px * 16.0 / 9 - request.view.width_px) <= 1 + 16.0 / 9); /* the shape of the view */
        size_t bytes = (size_t)(200e3 * request.quality.quality / 78 * request.view.width_px / 640 * request.view.width_px / 640);
        carry(f, &request, bytes, (int64_t)bytes * 8000);
    }
    assert_true(request.quality.quality < 50 && request.view.width_px < 400 && request.view.height_px < 250);
    assert_int_equal(f->session->view.width_px, 640);
    f->now_ns += 300 * MS;
    assert_true(ask(f, &request));
    assert_true(request.view.tier == TIER_REFINED && request.view.width_px == 640 && !request.quality.full_chroma);
    carry(f, &request, 100000, 800 * MS);
    f->now_ns += 1100 * MS;
    assert_true(ask(f, &request));
    assert_true(request.always && request.view.width_px == 640 && request.quality.full_chroma && request.quality.quality >= 90);
    carry(f, &request, 500000, 4000 * MS);
    f->now_ns += 60 * NS_PER_S;
    assert_false(ask(f, &request));
}

CASE(a_refined_picture_that_is_out_of_date_is_not_sent_on)
{
    struct frame_request request;
    uint32_t seq;
    greet(f);
    assert_true(ask(f, &request));
    carry(f, &request, 50000, 400 * MS);
    f->now_ns += 300 * MS;
    assert_true(ask(f, &request));
    assert_true(request.view.tier == TIER_REFINED);
    paint(f, &request, false);
    enum session_depth depth;
    struct encoded_frame *sending = session_next_frame(f->session, f->now_ns, &seq, &depth);
    assert_false(session_gives_up(f->session, sending, 400000, f->now_ns));
    say(f, "{\"type\":\"camera\",\"seq\":1,\"eye\":[9,9,9],\"target\":[0,0,1]}");
    assert_false(session_gives_up(f->session, sending, 1000, f->now_ns));
    assert_true(session_gives_up(f->session, sending, 400000, f->now_ns));
    session_gave_up(f->session);
    assert_false(ask(f, &request));
    session_wrote(f->session, true, f->now_ns);
    assert_true(ask(f, &request));
    assert_true(request.always && request.view.camera_seq == 1);
    encoded_frame_destroy(&sending);
}

CASE(who_takes_nothing_is_paused_and_costs_nothing)
{
    struct frame_request request;
    greet(f);
    assert_true(ask(f, &request));
    paint(f, &request, false);
    assert_int_equal(send_picture(f), 1);
    say(f, "{\"type\":\"camera\",\"seq\":1,\"eye\":[9,9,9],\"target\":[0,0,1]}");
    assert_true(ask(f, &request));
    paint(f, &request, false);
    assert_non_null(f->session->delivery.ready);
    f->now_ns += 2100 * MS;
    session_on_tick(f->session, f->now_ns);
    assert_null(f->session->delivery.ready);
    assert_int_equal(session_state(f->session, f->now_ns), PACER_STALLS);
    assert_false(ask(f, &request));
    ack(f, 1);
    assert_int_equal(session_state(f->session, f->now_ns), PACER_FLOWS);
    assert_true(ask(f, &request));
    assert_true(request.always && request.view.camera_seq == 1);
    paint(f, &request, false);
    send_picture(f);
    f->now_ns += 15100 * MS;
    assert_int_equal(session_state(f->session, f->now_ns), PACER_DEAD);
}

CASE(hidden_pages_get_nothing)
{
    struct frame_request request;
    greet(f);
    show(f);
    say(f, "{\"type\":\"visible\",\"visible\":false}");
    f->now_ns += 10 * NS_PER_S;
    session_on_data(f->session, f->now_ns);
    say(f, "{\"type\":\"camera\",\"seq\":1,\"eye\":[9,9,9],\"target\":[0,0,1]}");
    assert_false(ask(f, &request));
    expect(f, "");
    say(f, "{\"type\":\"visible\",\"visible\":true}");
    assert_true(ask(f, &request));
    assert_true(request.always && request.view.camera_seq == 1);
}

/* A client that hides and shows its view again and again causes a new frame each time, so from the second time on it must be
   admitted like a new session. */
CASE(views_shown_again_and_again_are_admitted_as_new_ones)
{
    static const char HIDE[] = "{\"type\":\"visible\",\"visible\":false}", SHOW[] = "{\"type\":\"visible\",\"visible\":true}";
    struct frame_request request;
    greet(f);
    show(f);
    /* pretends that the render thread is busy all the time and readings are delayed: new sessions are refused */
    for (int i = 0; i < 3; i++)
        f->admission.windows[i] = (struct admission_window){ .drawing_ns = NS_PER_S, .data_wait_ns = 2 * NS_PER_S };
    f->now_ns += NS_PER_S;
    say(f, HIDE);
    say(f, SHOW);
    assert_true(ask(f, &request)); /* the view was hidden only for a moment and keeps its place: no new admission is needed */
    assert_true(session_has_pixels(f->session));
    say(f, HIDE);
    say(f, SHOW);
    expect_error(f, "limit");
    assert_false(session_has_pixels(f->session) || ask(f, &request));
    memset(f->admission.windows, 0, sizeof(f->admission.windows));
    session_keep_pixels(f->session, f->now_ns);
    assert_true(session_has_pixels(f->session) && ask(f, &request));
}

CASE(tags_come_whole_then_by_change_then_nothing)
{
    greet(f);
    f->snapshot->readings[1] = (struct reading){ .value = 3.25, .quality = QUALITY_GOOD, .changes = 5, .age_ns = 40 * MS };
    session_on_data(f->session, f->now_ns);
    expect(f, ""); /* at most twice a second */
    f->now_ns += 600 * MS;
    json_t *tags = hear(f), *values = json_object_get(tags, "values"), *row = json_array_get(values, 0);
    assert_string_equal(type_of(tags), "tags");
    assert_int_equal(json_array_size(values), 1);
    assert_int_equal(json_integer_value(json_array_get(row, 0)), 1);
    assert_true(json_number_value(json_array_get(row, 1)) == 3.25);
    assert_int_equal(json_array_size(row), 2); /* a row is [tag, value]: a good reading without an alarm needs no further members */
    assert_int_equal(json_integer_value(json_object_get(tags, "age_ms")), 40);
    f->now_ns += 3600 * NS_PER_S;
    expect(f, "");
    f->snapshot->readings[1].quality = QUALITY_BAD_COMMUNICATION_ERROR;
    f->snapshot->readings[1].changes++;
    session_on_data(f->session, f->now_ns);
    tags = hear(f);
    values = json_object_get(tags, "values");
    assert_int_equal(json_array_size(values), 1);
    row = json_array_get(values, 0);
    assert_true(json_is_null(json_array_get(row, 1)));
    assert_string_equal(json_string_value(json_array_get(row, 2)), "bad");
    assert_int_equal(json_integer_value(json_array_get(row, 4)), 40);
    expect(f, "");
}

CASE(large_readings_keep_all_digits)
{
    f->snapshot->readings[1] = (struct reading){ .value = 12345678.531, .quality = QUALITY_GOOD };
    char *text = reply_api_tags_text(&f->context, 1, 1);
    assert_non_null(strstr(text, "\"value\":12345678.531,"));
    mem_free(text);
    /* session_scope_text() removes tags that a display's token does not cover from a message; the digits of the other numbers
       must stay as they are */
    f->session->identity.holder.display = 1;
    f->session->scope.tags = mem_array(f->context.plant->tag_count + 1, sizeof(*f->session->scope.tags));
    f->session->scope.tags[1] = true;
    text = session_scope_text(f->session, mem_strdup("{\"type\":\"tags\",\"values\":[[0,5.0],[1,12345678.531]]}"));
    assert_string_equal(text, "{\"type\":\"tags\",\"values\":[[1,12345678.531]]}");
    mem_free(text);
}

CASE(a_viewer_opens_saved_views_and_keeps_no_baseline)
{
    json_t *list = test_json(json_array());
    static const char *const views[][2] = { { "own", "power=3" }, { "now", "show=difference&baseline=now" } };
    for (size_t i = 0; i < 2; i++)
        json_array_append_new(list, json_pack("{s:s,s:s,s:s,s:s,s:i,s:[]}", "id", views[i][0], "title", "View", "view", views[i][1], "by",
                                              "kim", "time_us", 5, "before"));
    greet(f);
    assert_true(named_views_mirror(f->services.named_views, list));
    f->session->identity.role = ROLE_VIEWER;
    say(f, "{\"type\":\"params\",\"seq\":1,\"named\":\"own\"}");
    assert_true(f->session->view.field.power == 3);
    while (hear(f)) /* the views and the parameters */
        ;
    say(f, "{\"type\":\"params\",\"seq\":2,\"named\":\"own\",\"power\":4}");
    expect_error(f, "not_allowed");
    say(f, "{\"type\":\"look\",\"seq\":3,\"named\":\"now\"}");
    expect_error(f, "bad_field");
    assert_true(f->session->view.field.power == 3);
    const double power = f->context.plant->groups[0].power;
    const struct view *view = &f->session->view;
    say(f, "{\"type\":\"camera\",\"seq\":1,\"eye\":[40,2,3],\"target\":[0,0,0]}");
    say(f, "{\"type\":\"params\",\"seq\":4,\"backdrop\":\"dark\",\"look\":\"flat\"}");
    const struct view before = *view;
    assert_true(before.dark && before.look == LOOK_FLAT && before.camera.eye_m[0] == 40);
    say(f, "{\"type\":\"params\",\"seq\":5,\"named\":null}");
    assert_true(power != 3 && view->field.power == power && view->look == LOOK_DEFAULT && view->dark);
    assert_memory_equal(&view->camera, &before.camera, sizeof(before.camera));
    say(f, "{\"type\":\"params\",\"seq\":6,\"named\":\"own\",\"look\":\"flat\"}");
    assert_true(view->field.power == 3 && view->look == LOOK_FLAT && view->dark);
    assert_memory_equal(&view->camera, &before.camera, sizeof(before.camera));
}

CASE(what_is_shown_is_confirmed)
{
    greet(f);
    f->snapshot->taken_utc_ns = 5000;
    say(f, "{\"type\":\"params\",\"seq\":1,\"show\":\"difference\",\"baseline\":{\"set\":\"calm\"},"
           "\"sensors\":{\"TI-1\":{\"strength\":2}}}");
    json_t *params = hear(f), *want = test_json(json_pack("{s:s,s:i}", "name", "calm", "time_us", 5)),
           *sensors = test_json(json_pack("{s:{s:f}}", "TI-1", "strength", 2.0));
    assert_string_equal(json_string_value(json_object_get(params, "show")), "difference");
    assert_true(json_equal(json_object_get(params, "baseline"), want));
    assert_true(json_equal(json_array_get(json_object_get(params, "baselines"), 0), want));
    assert_true(json_equal(json_object_get(params, "sensors"), sensors));
    assert_string_equal(json_string_value(json_object_get(params, "colormap")), "diverging");
    say(f, "{\"type\":\"params\",\"seq\":2,\"show\":\"distance\",\"sensor\":\"TI-1\",\"baseline\":null}");
    params = hear(f);
    assert_string_equal(json_string_value(json_object_get(params, "sensor")), "TI-1");
    assert_string_equal(json_string_value(json_object_get(params, "unit")), "m");
    assert_true(json_is_null(json_object_get(params, "baseline")));
}

CASE(params_are_confirmed_and_bad_ones_change_nothing)
{
    greet(f);
    say(f, "{\"type\":\"params\",\"seq\":4,\"group\":\"pressure\",\"ramp_interval\":2}");
    json_t *params = hear(f);
    assert_string_equal(type_of(params), "params");
    assert_int_equal(json_integer_value(json_object_get(params, "seq")), 4);
    assert_string_equal(json_string_value(json_object_get(params, "group")), "pressure");
    assert_true(json_number_value(json_object_get(params, "ramp_interval")) == 2);
    struct view before = f->session->view;
    say(f, "{\"type\":\"params\",\"seq\":5,\"ramp_interval\":3,\"power\":0}");
    expect_error(f, "bad_field");
    assert_memory_equal(&before, &f->session->view, sizeof(before));
    assert_int_equal(f->session->view.params_seq, 4);
}

CASE(a_client_that_does_not_read_costs_a_bounded_list)
{
    greet(f);
    for (int i = 0; i < 10000; i++)
        say(f, "{\"type\":\"ping\",\"t\":1.5}");
    assert_true(f->session->owed.reply_count <= SESSION_MAX_REPLIES);
}

CASE(too_many_messages_are_put_off)
{
    greet(f);
    for (int i = 0; i < f->quotas.at[QUOTA_MESSAGES]; i++)
        say(f, "{\"type\":\"camera\",\"seq\":1,\"eye\":[9,9,9],\"target\":[0,0,1]}");
    assert_true(f->session->rate.exceeded);
    expect_error(f, "too_fast");
    expect(f, "");
    f->now_ns += 500 * MS;
    session_on_tick(f->session, f->now_ns);
    assert_true(f->session->rate.exceeded);
    f->now_ns += 600 * MS;
    session_on_tick(f->session, f->now_ns);
    assert_false(f->session->rate.exceeded);
}

/* When the session tells the client to stop, some messages are already under way. They are read, but count for the following
   seconds. */
CASE(messages_beyond_a_second_count_for_the_next)
{
    const int most = (int)f->quotas.at[QUOTA_MESSAGES], beyond = most / 4, seconds = 12;
    int read = 0;
    greet(f);
    for (int tick = 0; tick < 10 * seconds; tick++, f->now_ns += 100 * MS) {
        session_on_tick(f->session, f->now_ns);
        for (int left = f->session->rate.exceeded ? 0 : most + beyond; left > 0; left--, read++) {
            left = f->session->rate.exceeded && left > beyond ? beyond : left;
            say(f, "{\"type\":\"camera\",\"seq\":1,\"eye\":[9,9,9],\"target\":[0,0,1]}");
        }
    }
    assert_in_range(read, (seconds - 1) * most, seconds * most + beyond);
}

CASE(acks_for_nothing_are_errors)
{
    greet(f);
    ack(f, 1);
    expect_error(f, "bad_field");
    show(f);
    ack(f, 1);
    expect(f, "");
    ack(f, 4000000000u);
    expect_error(f, "bad_field");
}

CASE(a_fit_is_answered_with_a_camera_and_moves_nothing)
{
    greet(f);
    struct camera before = f->session->view.camera;
    say(f, "{\"type\":\"fit\",\"seq\":9,\"id\":\"P-101A\",\"side\":\"top\",\"projection\":\"orthographic\"}");
    json_t *answer = hear(f);
    assert_string_equal(type_of(answer), "camera");
    assert_int_equal(json_integer_value(json_object_get(answer, "seq")), 9);
    assert_string_equal(json_string_value(json_object_get(answer, "projection")), "orthographic");
    json_t *target = json_object_get(answer, "target");
    assert_float_equal(json_number_value(json_array_get(target, 0)), 5.75, 1e-6);
    assert_true(json_number_value(json_object_get(answer, "height_m")) >= 2);
    assert_memory_equal(&before, &f->session->view.camera, sizeof(before));
    say(f, "{\"type\":\"fit\",\"seq\":10}");
    answer = hear(f);
    assert_true(json_number_value(json_object_get(answer, "fov")) == 45 && !json_object_get(answer, "height_m"));
}

TEST_WITH(a_pick_is_asked_once_and_answered, session_case_set_up, session_case_tear_down)
{
    struct session_case *f = *state;
    struct pick_query query;
    greet(f);
    assert_false(session_next_pick(f->session, &query));
    say(f, "{\"type\":\"pick\",\"seq\":5,\"x\":10.5,\"y\":20}");
    say(f, "{\"type\":\"pick\",\"seq\":6,\"x\":11,\"y\":20,\"camera\":{\"eye\":[1,2,3],\"target\":[4,5,6]}}");
    assert_true(session_next_pick(f->session, &query));
    assert_true(query.client == f->session->id && query.seq == 6 && query.x_px == 11 && query.view.camera.eye_m[2] == 3);
    assert_true(f->session->view.camera.eye_m[2] != 3);
    assert_false(session_next_pick(f->session, &query));
    struct pick_answer answer = { .query = query, .pick = { .asset = 0, .state = PICK_MEASURED, .value = 30.5, .sensor = 0 } };
    answer.pick.nearest_count = 1;
    answer.pick.nearest[0] = (struct pick_sensor){ .tag = 0, .distance_m = 0.25, .value = 30.5 };
    session_on_pick(f->session, &answer);
    json_t *said = hear(f);
    assert_string_equal(type_of(said), "picked");
    assert_int_equal(json_integer_value(json_object_get(said, "seq")), 6);
    assert_string_equal(json_string_value(json_object_get(said, "asset")), "E-101");
    assert_string_equal(json_string_value(json_object_get(said, "state")), "measured");
    assert_string_equal(json_string_value(json_object_get(said, "sensor")), "TI-1");
    assert_string_equal(json_string_value(json_object_get(said, "unit")), "\302\260C");
    assert_true(json_number_value(json_object_get(said, "value")) == 30.5);
    json_t *nearest = json_array_get(json_object_get(said, "nearest"), 0);
    assert_string_equal(json_string_value(json_object_get(nearest, "tag")), "TI-1");
    assert_string_equal(json_string_value(json_object_get(nearest, "quality")), "good");
    answer.pick = (struct pick){ .asset = -1, .sensor = -1, .value = 0 };
    session_on_pick(f->session, &answer);
    said = hear(f);
    assert_true(json_is_null(json_object_get(said, "asset")) && json_is_null(json_object_get(said, "value")));
}

CASE(a_follower_is_shown_its_leaders_view)
{
    struct frame_request request;
    struct session *leader = session_create(&f->context, 8, f->now_ns);
    static const char hello[] = "{\"type\":\"hello\",\"width\":800,\"height\":600,\"codecs\":[\"jpeg\"]}";
    static const char camera[] = "{\"type\":\"camera\",\"seq\":77,\"eye\":[3,4,5],\"target\":[0,0,1]}";
    static const char params[] = "{\"type\":\"params\",\"seq\":5,\"group\":\"pressure\"}";
    session_on_message(leader, hello, sizeof(hello) - 1, f->now_ns, f->now_ns);
    greet(f);
    show(f);
    say(f, "{\"type\":\"camera\",\"seq\":1,\"eye\":[9,9,9],\"target\":[0,0,1]}");
    show(f);
    say(f, "{\"type\":\"follow\",\"session\":8}");
    assert_true(f->session->following.asked && f->session->following.wanted == 8);
    session_follow(f->session, leader, f->now_ns);
    json_t *following = hear(f);
    assert_string_equal(type_of(following), "following");
    assert_int_equal(json_integer_value(json_object_get(following, "session")), 8);
    assert_int_equal(json_integer_value(json_object_get(following, "height")), 600);
    assert_string_equal(json_string_value(json_object_get(following, "group")), "temperature");
    assert_int_equal(show(f).view.width_px, 800);
    session_on_message(leader, camera, sizeof(camera) - 1, f->now_ns, f->now_ns);
    session_on_message(leader, params, sizeof(params) - 1, f->now_ns, f->now_ns);
    session_on_leader(f->session, f->now_ns);
    request = show(f);
    assert_true(request.view.camera.eye_m[0] == 3 && request.view.field.group == leader->view.field.group);
    /* the frame has the number of the camera that this client sent last, not that of the leader's camera, which it shows */
    assert_int_equal(request.view.camera_seq, 1);
    following = hear(f);
    assert_string_equal(json_string_value(json_object_get(following, "group")), "pressure");
    /* frame and message have the number of the leader's parameters, by which the client tells them from earlier ones */
    assert_int_equal(request.view.params_seq, 5);
    assert_int_equal(json_integer_value(json_object_get(following, "params_seq")), 5);
    leader->delivery.pacer.ladder.made.index = 2; /* a loaded server: both get the view in the same smaller size */
    session_choose_step(f->session);
    session_on_leader(f->session, f->now_ns);
    assert_int_equal(show(f).view.width_px, 400);
    leader->delivery.pacer.ladder.made.index = 0;
    session_choose_step(f->session);
    say(f, "{\"type\":\"resize\",\"width\":320,\"height\":200}");
    assert_int_equal(show(f).view.width_px, 800);
    say(f, "{\"type\":\"follow\",\"session\":null}");
    assert_true(f->session->following.asked && f->session->following.wanted == 0);
    session_follow(f->session, NULL, f->now_ns);
    following = hear(f);
    assert_true(json_is_null(json_object_get(following, "session")));
    assert_int_equal(json_integer_value(json_object_get(following, "width")), 320);
    request = show(f);
    assert_true(request.view.width_px == 320 && request.view.camera.eye_m[0] == 9);
    session_follow(f->session, leader, f->now_ns);
    /* the session that this one follows ends: the last frame keeps its size, and the client is told that the leader is gone
       */
    session_leader_gone(f->session, f->now_ns);
    following = hear(f);
    assert_int_equal(json_integer_value(json_object_get(following, "session")), 8);
    assert_true(json_is_true(json_object_get(following, "gone")));
    assert_string_equal(json_string_value(json_object_get(following, "group")), "pressure");
    request = show(f);
    assert_true(request.view.width_px == 320 && request.view.camera.eye_m[0] == 3);
    session_follow(f->session, leader, f->now_ns); /* the leader is back */
    following = hear(f);
    assert_null(json_object_get(following, "gone"));
    session_leader_gone(f->session, f->now_ns);
    say(f, "{\"type\":\"follow\",\"session\":null}");
    session_follow(f->session, NULL, f->now_ns);
    hear(f);
    assert_true(show(f).view.camera.eye_m[0] == 9); /* after following, the session shows its own view again, which it has kept */
    session_destroy(&leader);
}

/* Only what the user chose survives a reload; everything else is as the new plant file says, in both halves of a split view. */
CASE(after_a_reload_the_new_plants_settings_apply)
{
    struct plant_group *groups = small_scene()->plant->groups;
    const struct plant_group before[2] = { groups[0], groups[1] };
    greet(f);
    say(f, "{\"type\":\"params\",\"seq\":1,\"power\":3,\"range\":[30,60],\"colormap\":\"viridis\",\"split\":"
           "{\"group\":\"pressure\",\"radius_m\":1}}");
    char *carried = session_carry(f->session);
    groups[0].reach_m = groups[1].reach_m = 2;
    groups[0].power = groups[1].power = 4;
    groups[0].max = groups[1].max = 100;
    groups[1].radius_m = 7;
    groups[1].fill = FILL_NONE;
    session_take_plant(f->session, carried);
    mem_free(carried);
    struct view left, right;
    view_half(&f->session->view, 0, &left);
    view_half(&f->session->view, 1, &right);
    groups[0] = before[0];
    groups[1] = before[1];
    assert_true(left.field.power == 3 && left.range_min == 30 && left.range_max == 60 && left.colormap == right.colormap);
    assert_true(left.field.reach_m == 2 && left.field.group == 0);
    assert_true(right.field.group == 1 && right.field.radius_m == 1 && right.colormap != 0);
    assert_true(right.field.reach_m == 2 && right.field.power == 4 && right.field.fill == FILL_NONE && right.range_max == 100);
}

/* The range of distances depends on their kind. A default range does not survive a reload, even if the kind is not the group's. */
CASE(a_default_range_of_distances_is_not_carried)
{
    greet(f);
    say(f, "{\"type\":\"params\",\"seq\":1,\"show\":\"distance\",\"sensor\":\"TI-1\",\"split\":{\"distance\":\"euclidean\"}}");
    assert_true(f->session->view.range_max == 7 && f->session->view.right.range_max == 5);
    for (int chosen = 0; chosen < 2; chosen++) {
        char *text = test_memory(session_carried_text(&f->context, &f->session->view));
        json_t *o = test_json(json_loads(text, 0, NULL)), *split = json_object_get(o, "split");
        assert_string_equal(json_string_value(json_object_get(split, "distance")), "euclidean");
        assert_int_equal(json_object_get(o, "range") != NULL, chosen);
        assert_int_equal(json_object_get(split, "range") != NULL, chosen);
        say(f, "{\"type\":\"params\",\"seq\":2,\"range\":[0,3],\"split\":{\"distance\":\"euclidean\",\"range\":[0,4]}}");
    }
}

CASE(a_default_range_of_the_whole_view_is_not_carried)
{
    greet(f);
    say(f, "{\"type\":\"params\",\"seq\":1,\"show\":\"distance\",\"sensor\":\"TI-1\",\"distance\":\"euclidean\"}");
    json_t *o = test_json(json_loads(test_memory(session_carried_text(&f->context, &f->session->view)), 0, NULL));
    assert_string_equal(json_string_value(json_object_get(o, "distance")), "euclidean");
    assert_null(json_object_get(o, "range"));
}

/* A reload forgets readings saved without a name. A view that compared with them then shows values in the group's own colours. */
CASE(a_difference_from_forgotten_readings_becomes_values)
{
    greet(f);
    f->session->view.field.show = SHOW_DIFFERENCE;
    f->session->view.field.baseline = 1;
    f->session->view.colormap = colormap_find(small_scene()->plant, "diverging");
    view_default_scale(small_scene(), &f->session->view);
    assert_true(f->session->view.range_min < 0);
    char *carried = session_carry(f->session);
    session_take_plant(f->session, carried);
    mem_free(carried);
    const struct view *view = &f->session->view;
    assert_true(view->field.show == SHOW_VALUE && view->range_min == 20 && view->range_max == 180 && view->colormap == 0);
}

CASE(a_follower_without_leader_has_its_own_view_after_a_reload)
{
    struct session *leader = session_create(&f->context, 8, f->now_ns);
    session_on_message(leader, HELLO, sizeof(HELLO) - 1, f->now_ns, f->now_ns);
    greet(f);
    say(f, "{\"type\":\"camera\",\"seq\":1,\"eye\":[9,4,5],\"target\":[0,0,1]}");
    session_follow(f->session, leader, f->now_ns);
    session_leader_gone(f->session, f->now_ns);
    session_destroy(&leader);
    assert_true(f->session->view.camera.eye_m[0] != 9);
    char *carried = session_carry(f->session);
    session_take_plant(f->session, carried);
    mem_free(carried);
    assert_true(f->session->view.camera.eye_m[0] == 9 && f->session->owed.following);
}

/* A follower's previews do not count for the size of pictures, but each one that is sent is no longer owed. Otherwise the first
   preview after following would be timed from the request of an old one. */
CASE(previews_sent_to_a_follower_are_no_longer_owed)
{
    struct session *leader = session_create(&f->context, 8, f->now_ns);
    const struct pacer *pacer = &f->session->delivery.pacer;
    struct frame_request requests[2];
    session_on_message(leader, HELLO, sizeof(HELLO) - 1, f->now_ns, f->now_ns);
    greet(f);
    show(f);
    session_follow(f->session, leader, f->now_ns);
    for (int i = 0; i < 2; i++) {
        const char *camera = test_printf("{\"type\":\"camera\",\"seq\":%d,\"eye\":[%d,4,5],\"target\":[0,0,1]}", i + 1, i + 3);
        session_on_message(leader, camera, strlen(camera), f->now_ns, f->now_ns);
        session_on_leader(f->session, f->now_ns);
        assert_true(ask(f, &requests[i]));
    }
    assert_true(pacer->asked == 2 && pacer->previews == 2);
    paint(f, &requests[0], false);
    ack(f, send_picture(f));
    assert_true(pacer->asked == 1 && pacer->previews == 1);
    session_leader_gone(f->session, f->now_ns);
    session_destroy(&leader);
}

CASE(pings_come_back_exactly)
{
    say(f, "{\"type\":\"ping\",\"t\":123456.78901234567}");
    json_t *pong = hear(f);
    assert_string_equal(type_of(pong), "pong");
    assert_true(json_number_value(json_object_get(pong, "t")) == 123456.78901234567);
    assert_int_equal(json_integer_value(json_object_get(pong, "time_us")), f->now_ns / 1000);
    assert_true(json_is_null(json_object_get(pong, "oldest_age_ms"))); /* nothing was read yet */
    f->snapshot->readings[0] = (struct reading){ .quality = QUALITY_GOOD, .age_ns = 40 * MS };
    f->snapshot->readings[1] = (struct reading){ .quality = QUALITY_GOOD, .age_ns = 250 * MS };
    f->snapshot->readings[2] = (struct reading){ .quality = QUALITY_BAD_COMMUNICATION_ERROR, .age_ns = 9000 * MS };
    say(f, "{\"type\":\"ping\",\"t\":1}");
    pong = hear(f);
    assert_int_equal(json_integer_value(json_object_get(pong, "oldest_age_ms")), 250);
}

CASE(codecs_are_chosen_and_chosen_again)
{
    struct frame_request request;
    f->context.codecs = 1u << WIRE_CODEC_JPEG | 1u << WIRE_CODEC_H264;
    say(f, "{\"type\":\"hello\",\"width\":640,\"height\":360,\"codecs\":[\"auto\",\"h264\",\"jpeg\"]}");
    expect(f, "welcome status tags ");
    assert_true(ask(f, &request) && request.codec == WIRE_CODEC_H264 && request.alone);
    paint_nothing(f, &request);
    f->session->delivery.pacer.channel.ns_per_byte = 1;
    f->context.load.cpu_used = 1;
    for (int i = 0; i < 60; i++, f->now_ns += 100 * MS)
        session_on_tick(f->session, f->now_ns);
    assert_int_equal(f->session->codec.current, WIRE_CODEC_JPEG);
    say(f, "{\"type\":\"codecs\",\"codecs\":[\"h264\"]}");
    session_on_tick(f->session, f->now_ns);
    assert_int_equal(f->session->codec.current, WIRE_CODEC_H264);
    assert_true(ask(f, &request) && request.codec == WIRE_CODEC_H264 && request.alone && request.always);
    paint_nothing(f, &request);
    say(f, "{\"type\":\"key_frame\"}");
    assert_true(ask(f, &request) && request.alone && request.always);
    paint_nothing(f, &request);
    f->context.codecs = 0;
    say(f, "{\"type\":\"codecs\",\"codecs\":[\"h264\"]}"); /* refused: this server has no H.264 encoder */
    expect_error(f, "bad_field");
    assert_int_equal(f->session->codec.current, WIRE_CODEC_H264);
}
