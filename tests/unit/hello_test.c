/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The first message of a session (hello): which user its token identifies, which view a returning client gets back, and whether
   the session is admitted. */
#include "session/session.h"

#include "tests/support/test.h"
#include <jansson.h>
#include <sys/stat.h>

#include "base/clock.h"
#include "base/files/atomic_file.h"
#include "session/view/resume.h"
#include "tests/support/small_scene.h"

#define SIZE "\"width\":640,\"height\":360,\"codecs\":[\"jpeg\"]"
#define HELLO "{\"type\":\"hello\"," SIZE "}"

struct hello_fixture {
    struct session_context context;
    struct plant_services services;
    struct quotas quotas;
    struct admission admission;
    struct log *log;
    struct tokens *tokens;
    char *folder, *path;
    int64_t now_ns;
    uint64_t next_id;
};

static void write_tokens(struct hello_fixture *f, bool with_bob)
{
    struct text *text = test_text();
    struct token_holder alice = { .role = ROLE_ENGINEER, .name = "alice", .until_utc_ns = INT64_MAX };
    struct token_holder bob = { .role = ROLE_VIEWER, .name = "bob", .until_utc_ns = INT64_MAX };
    tokens_hash("pc_alice", alice.hash);
    tokens_hash("pc_bob", bob.hash);
    tokens_print_line(text, &alice);
    if (with_bob)
        tokens_print_line(text, &bob);
    assert_int_equal(atomic_file_put(f->path, text->at, text->length), 0);
    assert_int_equal(chmod(f->path, 0600), 0);
}

static void begin(struct hello_fixture *f)
{
    f->folder = temp_folder();
    f->path = temp_path(f->folder, "tokens");
    f->log = test_log();
    write_tokens(f, true);
    f->tokens = tokens_create(f->log, f->path);
    assert_non_null(f->tokens);
    f->quotas = quotas_default();
    f->admission.quotas = &f->quotas;
    f->now_ns = 1000 * NS_PER_S;
    f->services = (struct plant_services){ .scene = (struct scene *)small_scene(), .baselines = baselines_create() };
    f->context = (struct session_context){ .plant = small_scene()->plant,
                                           .services = &f->services,
                                           .readings.snapshot = test_snapshot(small_scene()->plant->tag_count),
                                           .readings.links_up = (const bool[]){ true },
                                           .version = "1.2.3",
                                           .quotas = &f->quotas,
                                           .sign_in.tokens = f->tokens,
                                           .resumes = resumes_create(),
                                           .admission = &f->admission };
}

static void end(struct hello_fixture *f)
{
    assert_int_equal(f->admission.pixels, 0);
    baselines_destroy(&f->services.baselines);
    resumes_destroy(&f->context.resumes);
    tokens_destroy(&f->tokens);
}

TEST_FIXTURE(struct hello_fixture, begin, end)

#define CASE(name) TEST_ON(struct hello_fixture *f, name, set_up, tear_down)

static void say(struct hello_fixture *f, struct session *session, const char *text)
{
    session_on_message(session, text, strlen(text), f->now_ns, f->now_ns);
}

static struct session *open_session(struct hello_fixture *f, enum role role, const char *text)
{
    struct session *session = session_create(&f->context, ++f->next_id, f->now_ns);
    session->identity.role = role;
    say(f, session, text);
    return session;
}

static void leave(struct hello_fixture *f, struct session **session)
{
    session_leave(*session, true, f->now_ns);
    session_destroy(session);
}

/* Asserts that the session has a text message to send now, and returns it parsed. */
static json_t *hear(struct hello_fixture *f, struct session *session)
{
    struct text *text = test_text();
    assert_true(session_next_text(session, f->now_ns, f->now_ns, text));
    json_t *message = test_json(json_loads(text->at, 0, NULL));
    return message;
}

static void expect_error(struct hello_fixture *f, struct session *session, const char *code, int close_code)
{
    json_t *message = hear(f, session);
    assert_string_equal(json_string_value(json_object_get(message, "type")), "error");
    assert_string_equal(json_string_value(json_object_get(message, "code")), code);
    assert_int_equal(json_integer_value(json_object_get(message, "retry_after_s")) > 0, close_code == 1013);
    assert_int_equal(session->close.code, close_code);
}

static void expect_welcome(struct hello_fixture *f, struct session *session, const char *role, bool resumed)
{
    json_t *message = hear(f, session);
    assert_string_equal(json_string_value(json_object_get(message, "type")), "welcome");
    assert_string_equal(json_string_value(json_object_get(message, "role")), role);
    assert_int_equal(strlen(json_string_value(json_object_get(message, "resume"))), RESUME_CHARS);
    assert_int_equal(json_is_true(json_object_get(message, "resumed")), resumed);
}

CASE(who_needs_a_token_is_told_and_sent_away)
{
    struct session *none = open_session(f, ROLE_NOBODY, HELLO);
    expect_error(f, none, "token_needed", 1008);
    leave(f, &none);
    struct session *wrong = open_session(f, ROLE_NOBODY, "{\"type\":\"hello\",\"token\":\"pc_mallory\"," SIZE "}");
    expect_error(f, wrong, "bad_token", 1008);
    leave(f, &wrong);
    struct session *local = open_session(f, ROLE_ENGINEER, "{\"type\":\"hello\",\"token\":\"pc_mallory\"," SIZE "}");
    expect_error(f, local, "bad_token", 1008);
    leave(f, &local);
    struct session *early = open_session(f, ROLE_NOBODY, "{\"type\":\"pick\",\"seq\":1,\"x\":1,\"y\":1}");
    expect_error(f, early, "hello_first", 0);
    leave(f, &early);
}

CASE(a_token_stands_for_its_role)
{
    struct session *bob = open_session(f, ROLE_NOBODY, "{\"type\":\"hello\",\"token\":\"pc_bob\"," SIZE "}");
    expect_welcome(f, bob, "viewer", false);
    say(f, bob, "{\"type\":\"params\",\"seq\":1,\"power\":3}");
    expect_error(f, bob, "not_allowed", 0);
    leave(f, &bob);
    struct session *local = open_session(f, ROLE_ENGINEER, "{\"type\":\"hello\",\"token\":\"pc_bob\"," SIZE "}");
    /* a token determines the role even where none is needed: the local connection has the role engineer without it */
    expect_welcome(f, local, "viewer", false);
    leave(f, &local);
    struct session *open = open_session(f, ROLE_OPEN, HELLO);
    expect_welcome(f, open, "open", false);
    leave(f, &open);
    struct session *pushy =
        open_session(f, ROLE_NOBODY, "{\"type\":\"hello\",\"token\":\"pc_bob\"," SIZE ",\"params\":{\"seq\":1,\"power\":3}}");
    expect_error(f, pushy, "not_allowed", 0);
    leave(f, &pushy);
}

CASE(a_revoked_token_ends_its_sessions_and_no_others)
{
    struct session *bob = open_session(f, ROLE_NOBODY, "{\"type\":\"hello\",\"token\":\"pc_bob\"," SIZE "}");
    struct session *alice = open_session(f, ROLE_NOBODY, "{\"type\":\"hello\",\"token\":\"pc_alice\"," SIZE "}");
    struct session *local = open_session(f, ROLE_ENGINEER, HELLO);
    write_tokens(f, false);
    tokens_look(f->tokens);
    assert_true(tokens_look(f->tokens));
    session_check_token(bob, f->now_ns, f->now_ns);
    session_check_token(alice, f->now_ns, f->now_ns);
    session_check_token(local, f->now_ns, f->now_ns);
    assert_int_equal(bob->close.code, 1008);
    assert_int_equal(alice->close.code | local->close.code, 0);
    /* until the connection is closed, the session no longer acts on messages */
    double before = bob->view.ramp_interval;
    say(f, bob, "{\"type\":\"params\",\"seq\":1,\"ramp_interval\":7}");
    say(f, alice, "{\"type\":\"params\",\"seq\":1,\"ramp_interval\":7}");
    assert_true(bob->view.ramp_interval == before && before != 7 && alice->view.ramp_interval == 7);
    leave(f, &bob);
    leave(f, &alice);
    leave(f, &local);
}

/* After too many failures the login throttle delays even a valid token. The session must not be given the rights of that
   token's holder, because the token was not checked. */
CASE(a_login_that_is_held_up_keeps_no_holder)
{
    struct login_throttle *throttle = f->context.sign_in.login_throttle = login_throttle_create();
    struct session *session;
    for (int i = 0; i < LOGIN_FAILURES + 1; i++) {
        session = open_session(f, ROLE_NOBODY, "{\"type\":\"hello\",\"token\":\"pc_wrong\"," SIZE "}");
        leave(f, &session);
    }
    session = open_session(f, ROLE_NOBODY, "{\"type\":\"hello\",\"token\":\"pc_alice\"," SIZE "}");
    expect_error(f, session, "full", 1013);
    assert_int_equal(session->identity.login, LOGIN_HELD);
    assert_int_equal(session->identity.holder.role, ROLE_NOBODY);
    leave(f, &session);
    f->context.sign_in.login_throttle = NULL;
    login_throttle_destroy(&throttle);
}

#define VIEW                                                                                                                               \
    "{\"type\":\"hello\"," SIZE ",\"pixel_ratio\":2,\"camera\":{\"seq\":4,\"eye\":[7,8,9],\"target\":[0,0,1]},"                            \
    "\"params\":{\"seq\":5,\"group\":\"pressure\",\"ramp_interval\":2}}"

/* Returns to a session with its resume secret. extra: further members of the hello message, or "". */
static void come_back(struct hello_fixture *f, enum role role, const char *secret, const char *extra, struct session **out)
{
    *out = open_session(f, role, test_printf("{\"type\":\"hello\",\"resume\":\"%s\"%s}", secret, extra));
}

static void expect_view_of_before(const struct session *session)
{
    assert_int_equal(session->view.width_px, 640);
    assert_int_equal(session->view.field.group, 1);
    assert_true(session->view.camera.eye_m[1] == 8 && session->view.ramp_interval == 2 && session->pixel_ratio == 2);
    assert_int_equal(session->view.camera_seq | session->view.params_seq, 0);
    assert_int_equal(session->codec.current, WIRE_CODEC_JPEG);
}

CASE(who_comes_back_in_time_has_its_view)
{
    char secret[RESUME_CHARS + 1];
    struct session *first = open_session(f, ROLE_ENGINEER, VIEW), *again, *late;
    strcpy(secret, first->identity.resume_secret);
    leave(f, &first);
    f->now_ns += RESUME_KEPT_NS - 1;
    come_back(f, ROLE_ENGINEER, secret, "", &again);
    expect_welcome(f, again, "engineer", true);
    expect_view_of_before(again);
    assert_string_not_equal(again->identity.resume_secret, secret); /* a resume secret is valid once; the session gets a new one */
    come_back(f, ROLE_ENGINEER, secret, "," SIZE, &late);
    expect_welcome(f, late, "engineer", false);
    assert_int_equal(late->view.field.group, 0);
    leave(f, &late);
    strcpy(secret, again->identity.resume_secret);
    leave(f, &again);
    f->now_ns += RESUME_KEPT_NS;
    come_back(f, ROLE_ENGINEER, secret, "", &late);
    expect_error(f, late, "bad_field", 0);
    say(f, late, HELLO); /* it may say so */
    expect_welcome(f, late, "engineer", false);
    leave(f, &late);
}

CASE(what_is_said_comes_on_top_of_the_view_of_before)
{
    struct session *first = open_session(f, ROLE_ENGINEER, VIEW), *again;
    char secret[RESUME_CHARS + 1];
    strcpy(secret, first->identity.resume_secret);
    leave(f, &first);
    come_back(f, ROLE_ENGINEER, secret, ",\"width\":200,\"height\":100,\"codecs\":[\"png\"],\"params\":{\"seq\":1,\"ramp_interval\":4}",
              &again);
    expect_welcome(f, again, "engineer", true);
    assert_true(again->view.width_px == 200 && again->view.height_px == 100 && again->view.ramp_interval == 4);
    assert_true(again->view.field.group == 1 && again->view.camera.eye_m[0] == 7 && again->codec.current == WIRE_CODEC_PNG);
    leave(f, &again);
}

CASE(a_connection_that_only_seems_alive_gives_way)
{
    struct session *first = open_session(f, ROLE_ENGINEER, VIEW), *again;
    come_back(f, ROLE_ENGINEER, first->identity.resume_secret, "", &again);
    expect_welcome(f, again, "engineer", true);
    expect_view_of_before(again);
    assert_int_equal(first->close.code, 1000);
    leave(f, &first);
    leave(f, &again);
}

CASE(a_view_belongs_to_a_token)
{
    struct session *alice = open_session(f, ROLE_NOBODY, "{\"type\":\"hello\",\"token\":\"pc_alice\"," SIZE "}"), *bob, *again;
    char secret[RESUME_CHARS + 1];
    strcpy(secret, alice->identity.resume_secret);
    leave(f, &alice);
    come_back(f, ROLE_NOBODY, secret, ",\"token\":\"pc_bob\"," SIZE, &bob);
    expect_welcome(f, bob, "viewer", false);
    come_back(f, ROLE_NOBODY, secret, ",\"token\":\"pc_alice\"", &again);
    expect_welcome(f, again, "engineer", true);
    leave(f, &bob);
    leave(f, &again);
}

CASE(of_many_who_left_the_newest_are_kept)
{
    char first[RESUME_CHARS + 1], last[RESUME_CHARS + 1];
    for (int i = 0; i <= RESUME_MAX_KEPT; i++) {
        struct session *session = open_session(f, ROLE_ENGINEER, HELLO);
        strcpy(i == 0 ? first : last, session->identity.resume_secret);
        leave(f, &session);
    }
    struct session *forgotten, *kept;
    come_back(f, ROLE_ENGINEER, first, "", &forgotten);
    come_back(f, ROLE_ENGINEER, last, "", &kept);
    expect_error(f, forgotten, "bad_field", 0);
    expect_welcome(f, kept, "engineer", true);
    leave(f, &forgotten);
    leave(f, &kept);
}

CASE(without_room_a_session_is_told_when_to_come_again)
{
    quotas_parse(&f->quotas, "pixels=300000");
    struct session *first = open_session(f, ROLE_ENGINEER, HELLO), *second = open_session(f, ROLE_ENGINEER, HELLO);
    expect_welcome(f, first, "engineer", false);
    expect_error(f, second, "full", 1013);
    assert_false(second->hello);
    say(f, first, "{\"type\":\"resize\",\"width\":1000,\"height\":1000}");
    expect_error(f, first, "limit", 0);
    assert_int_equal(first->view.width_px, 640);
    say(f, first, "{\"type\":\"resize\",\"width\":500,\"height\":500}");
    assert_int_equal(f->admission.pixels, 250000);
    leave(f, &first);
    leave(f, &second);
}

static struct session *open_of(struct hello_fixture *f, struct address_share *share, const char *hello)
{
    struct session *session = session_create(&f->context, ++f->next_id, f->now_ns);
    session->room.share = share;
    admission_join(&f->admission, share);
    say(f, session, hello);
    return session;
}

static void leave_share(struct hello_fixture *f, struct session **session)
{
    struct address_share *share = (*session)->room.share;
    leave(f, session);
    admission_leave(&f->admission, share);
}

CASE(an_address_has_its_part_of_all_pixels)
{
    struct address_share share = { .account = 1 }, other = { .account = 2 };
    quotas_parse(&f->quotas, "pixels=1000000");
    quotas_parse(&f->quotas, "address-pixels=300000");
    struct session *first = open_of(f, &share, HELLO), *second = open_of(f, &share, HELLO), *third = open_of(f, &other, HELLO);
    expect_welcome(f, first, "engineer", false);
    expect_error(f, second, "full", 1013);
    expect_welcome(f, third, "engineer", false);
    assert_true(share.pixels == 230400 && other.pixels == 230400);
    leave_share(f, &first);
    leave_share(f, &second);
    leave_share(f, &third);
    assert_true(share.pixels == 0 && other.pixels == 0);
}

CASE(who_is_hidden_gives_its_place_back_and_takes_it_again)
{
    struct address_share share = { .account = 1 }, other = { .account = 2 };
    struct frame_request request;
    quotas_parse(&f->quotas, "pixels=300000");
    struct session *hidden = open_of(f, &share, HELLO);
    expect_welcome(f, hidden, "engineer", false);
    say(f, hidden, "{\"type\":\"visible\",\"visible\":false}");
    session_on_tick(hidden, f->now_ns += 14 * NS_PER_S);
    assert_int_equal(f->admission.pixels, 230400);
    session_on_tick(hidden, f->now_ns += NS_PER_S);
    assert_int_equal(f->admission.pixels, 0);
    struct session *second = open_of(f, &other, HELLO);
    expect_welcome(f, second, "engineer", false);
    say(f, hidden, "{\"type\":\"visible\",\"visible\":true}");
    expect_error(f, hidden, "limit", 0);
    assert_false(session_next_request(hidden, f->now_ns, &request));
    leave_share(f, &second);
    /* after another session has left, the hidden session is admitted at its next tick without a new request */
    session_on_tick(hidden, f->now_ns += NS_PER_S);
    assert_int_equal(share.pixels, 230400);
    assert_true(session_next_request(hidden, f->now_ns, &request) && request.account == 1);
    leave_share(f, &hidden);
}

CASE(a_view_has_its_own_limit)
{
    quotas_parse(&f->quotas, "session-pixels=100000");
    struct session *session = open_session(f, ROLE_ENGINEER, HELLO);
    expect_error(f, session, "limit", 0);
    say(f, session, "{\"type\":\"hello\",\"width\":320,\"height\":200,\"codecs\":[\"jpeg\"]}");
    expect_welcome(f, session, "engineer", false);
    leave(f, &session);
}

CASE(who_does_not_say_hello_is_sent_away)
{
    struct session *session = open_session(f, ROLE_ENGINEER, "{\"type\":\"ping\",\"t\":1}"), *other = open_session(f, ROLE_ENGINEER, HELLO);
    f->now_ns += 10 * NS_PER_S - 1;
    session_on_tick(session, f->now_ns);
    assert_int_equal(session->close.code, 0);
    f->now_ns++;
    session_on_tick(session, f->now_ns);
    session_on_tick(other, f->now_ns);
    assert_int_equal(session->close.code, 1008);
    assert_int_equal(other->close.code, 0);
    leave(f, &session);
    leave(f, &other);
}
