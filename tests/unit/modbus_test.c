/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Modbus source with a simulated Modbus TCP device: which readings the store has while the device appears, disappears and
   misbehaves. */
#include "tests/support/test.h"
#include <arpa/inet.h>
#include <limits.h>
#include <netdb.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/text/text.h"
#include "tests/support/modbus_case.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/sleep.h"
#include "value/quality.h"

#define CASE(name) TEST_ON(struct modbus_case *s, name, modbus_case_set_up, modbus_case_tear_down)

static int64_t count_of(struct modbus_case *s, const char *line_start)
{
    struct text *text = test_text();
    long long count = -1;
    counters_print(s->counters, text);
    const char *at = strstr(text->at, line_start);
    if (at)
        sscanf(at + strlen(line_start), "%lld", &count);
    return count;
}

CASE(values_arrive)
{
    modbus_case_add_registers(s, 3);
    plant_by_hand_tag(s->plant, "input", TABLE_INPUT, 7, DATA_UINT16);
    plant_by_hand_tag(s->plant, "coil", TABLE_COIL, 3, DATA_BIT);
    plant_by_hand_tag(s->plant, "no coil", TABLE_COIL, 4, DATA_BIT);
    plant_by_hand_tag(s->plant, "contact", TABLE_DISCRETE, 4, DATA_BIT);
    plant_by_hand_tag(s->plant, "wide", TABLE_HOLDING, 100, DATA_UINT32);
    plant_by_hand_tag(s->plant, "other unit", TABLE_HOLDING, 5, DATA_UINT16)->signal.modbus_unit = 9;
    modbus_case_serve(s);
    const double wanted[] = { 0, 1, 2, 10007, 1, 0, 1, 100 * 65536.0 + 101, 5 };
    for (int i = 0; i < 9; i++) {
        modbus_case_expect(s, i, QUALITY_GOOD, 3);
        assert_true(modbus_case_look(s, i)->value == wanted[i]);
    }
    assert_true(store_link_is_up(s->store, 0));
    assert_true(llabs(modbus_case_look(s, 0)->received_utc_ns - clock_utc_ns()) < 3 * NS_PER_S);
    assert_int_equal(s->device.functions, 1 << 1 | 1 << 2 | 1 << 3 | 1 << 4);
    assert_true(count_of(s, "plantcast_source_reads_total{source=\"plc\",result=\"ok\"} ") >= 6);
    assert_int_equal(count_of(s, "plantcast_source_connects_total{source=\"plc\"} "), 1);
    assert_int_equal(count_of(s, "plantcast_source_up{source=\"plc\"} "), 1);
}

CASE(many_tags_take_few_requests)
{
    modbus_case_add_registers(s, 300);
    s->plant->sources[0].poll_ms = 60000;
    modbus_case_serve(s);
    for (int i = 0; i < 300; i++) {
        modbus_case_expect(s, i, QUALITY_GOOD, 3);
        assert_true(modbus_case_look(s, i)->value == i);
    }
    assert_int_equal(s->device.requests, 3);
}

enum { LONGEST_S = 60 };

/* Waits until the device has received `count` more requests; fails after LONGEST_S. */
static void await_requests(const struct modbus_case *s, int count)
{
    const int64_t end_ns = clock_mono_ns() + LONGEST_S * NS_PER_S;
    const int end = s->device.requests + count;
    while (s->device.requests < end && clock_mono_ns() < end_ns)
        sleep_ns(5 * NS_PER_MS);
    assert_in_range(s->device.requests, end, INT_MAX);
}

CASE(is_asked_at_its_scan_time)
{
    modbus_case_add_registers(s, 1); /* each 100 ms */
    modbus_case_serve(s);
    modbus_case_expect(s, 0, QUALITY_GOOD, 3);
    int before = s->device.requests;
    int64_t began_ns = clock_mono_ns();
    await_requests(s, 8);
    int asked = s->device.requests - before;
    assert_in_range(asked, 1, (clock_mono_ns() - began_ns) / (100 * NS_PER_MS) + 2);
}

CASE(absent_at_start_then_appears)
{
    modbus_case_add_registers(s, 2);
    modbus_case_start(s);
    modbus_case_expect(s, 0, QUALITY_BAD_NO_COMMUNICATION, 3);
    assert_false(store_link_is_up(s->store, 0));
    device_start(&s->device);
    modbus_case_expect(s, 1, QUALITY_GOOD, 8);
    assert_true(store_link_is_up(s->store, 0));
}

CASE(dies_and_returns)
{
    modbus_case_add_registers(s, 2);
    s->plant->tags[0].validity.stale_s = s->plant->tags[1].validity.stale_s = 1.0;
    modbus_case_serve(s);
    modbus_case_expect(s, 1, QUALITY_GOOD, 3);
    device_stop(&s->device);
    modbus_case_expect(s, 1, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE, 2);
    assert_true(modbus_case_look(s, 1)->value == 1);
    assert_false(store_link_is_up(s->store, 0));
    modbus_case_expect(s, 1, QUALITY_BAD_COMMUNICATION_ERROR, 2);
    device_start(&s->device);
    modbus_case_expect(s, 1, QUALITY_GOOD, 8);
    assert_true(store_link_is_up(s->store, 0));
    assert_int_equal(count_of(s, "plantcast_source_connects_total{source=\"plc\"} "), 2);
}

CASE(silent_device_loses_the_link_though_it_accepts)
{
    modbus_case_be_impatient(s);
    modbus_case_add_registers(s, 2);
    modbus_case_serve(s);
    modbus_case_expect(s, 1, QUALITY_GOOD, 3);
    s->device.manner = DEVICE_SILENT;
    modbus_case_expect(s, 1, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE, 3);
    assert_false(store_link_is_up(s->store, 0));
    await_requests(s, 2);
    /* the device accepts the connection but does not answer: the source's link must not count as up */
    assert_false(store_link_is_up(s->store, 0));
    s->device.manner = DEVICE_GOOD;
    modbus_case_expect(s, 1, QUALITY_GOOD, 8);
}

CASE(resets_do_no_harm)
{
    modbus_case_add_registers(s, 2);
    s->device.manner = DEVICE_RESETTING;
    int64_t began_ns = clock_mono_ns();
    modbus_case_serve(s);
    modbus_case_expect(s, 1, QUALITY_BAD_NO_COMMUNICATION, 3);
    while (s->device.connections < 3 && clock_mono_ns() - began_ns < LONGEST_S * NS_PER_S)
        sleep_ns(5 * NS_PER_MS);
    assert_in_range(s->device.connections, 3, INT_MAX);
    assert_true(clock_mono_ns() - began_ns >= NS_PER_S); /* reconnecting backs off: at least 0.5 s before each connection */
    s->device.manner = DEVICE_GOOD;
    modbus_case_expect(s, 1, QUALITY_GOOD, 8);
}

CASE(dripping_device_holds_no_longer_than_the_deadline)
{
    modbus_case_add_registers(s, 20);
    /* the device sends its answer byte by byte, 49 x 0.3 s in total: the source must give up after the timeout, although bytes
       keep arriving */
    s->plant->sources[0].timeout_ms = 1000;
    s->device.manner = DEVICE_DRIPPING;
    device_start(&s->device);
    int64_t begin_ns = clock_mono_ns();
    modbus_case_start(s);
    modbus_case_expect(s, 0, QUALITY_BAD_NO_COMMUNICATION, 3);
    int64_t took_ns = clock_mono_ns() - begin_ns;
    print_message("# gave up after %.3f s\n", (double)took_ns / 1e9);
    assert_in_range(took_ns, 900 * NS_PER_MS, 3000 * NS_PER_MS);
}

CASE(late_reply_does_not_poison)
{
    modbus_case_be_impatient(s);
    modbus_case_add_registers(s, 1);
    /* a second block of the same size, so that a late answer to one request could be taken for that of the other */
    plant_by_hand_tag(s->plant, "far", TABLE_HOLDING, 500, DATA_INT16);
    s->device.late_ms = 400;                                            /* the timeout is 300 */
    modbus_case_serve(s);
    modbus_case_expect(s, 1, QUALITY_GOOD, 3);
    for (int round = 0; round < 2; round++) {
        s->device.manner = DEVICE_LATE;
        modbus_case_expect(s, 1, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE, 3);
        s->device.manner = DEVICE_GOOD;
        for (int tag = 0; tag < 2; tag++) {
            modbus_case_expect(s, tag, QUALITY_GOOD, 8);
            assert_true(modbus_case_look(s, tag)->value == tag * 500);
        }
    }
}

CASE(reply_sent_twice_does_not_poison)
{
    modbus_case_add_registers(s, 1);
    plant_by_hand_tag(s->plant, "far", TABLE_HOLDING, 500, DATA_INT16);
    s->device.manner = DEVICE_TWICE;
    modbus_case_serve(s);
    modbus_case_expect(s, 1, QUALITY_GOOD, 3);
    int before = s->device.requests;
    while (s->device.requests < before + 12) {
        for (int tag = 0; tag < 2; tag++)
            if (!quality_is_bad(modbus_case_look(s, tag)->quality))
                assert_true(modbus_case_look(s, tag)->value == tag * 500);
        sleep_ns(5 * NS_PER_MS);
    }
}

/* The device sends each answer twice. The second copy arrives after the next request and has the previous request's transaction
   number; the source must ignore it and stay connected. */
CASE(late_twin_of_a_reply_does_not_disconnect)
{
    modbus_case_add_registers(s, 1);
    plant_by_hand_tag(s->plant, "far", TABLE_HOLDING, 500, DATA_INT16);
    s->device.manner = DEVICE_TWICE;
    s->device.late_ms = 10;
    modbus_case_serve(s);
    modbus_case_expect(s, 1, QUALITY_GOOD, 3);
    assert_true(modbus_case_look(s, 0)->value == 0 && modbus_case_look(s, 1)->value == 500);
    assert_int_equal(count_of(s, "plantcast_source_connects_total{source=\"plc\"} "), 1);
}

CASE(reply_to_an_older_request_is_never_taken)
{
    modbus_case_add_registers(s, 1);
    s->device.manner = DEVICE_BEHIND;
    modbus_case_serve(s);
    modbus_case_expect(s, 0, QUALITY_BAD_NO_COMMUNICATION, 3);
    while (s->device.requests < 3) {
        assert_true(quality_is_bad(modbus_case_look(s, 0)->quality));
        sleep_ns(5 * NS_PER_MS);
    }
    s->device.manner = DEVICE_GOOD;
    modbus_case_expect(s, 0, QUALITY_GOOD, 8);
    assert_true(modbus_case_look(s, 0)->value == 0);
}

CASE(one_bad_register_does_not_lose_the_rest)
{
    modbus_case_add_registers(s, 120);
    s->device.bad_register = 57;
    s->device.bad_code = 2;
    modbus_case_serve(s);
    modbus_case_expect(s, 57, QUALITY_BAD_CONFIGURATION, 3);
    for (int i = 0; i < 120; i++)
        if (i != 57) {
            modbus_case_expect(s, i, QUALITY_GOOD, 3);
            assert_true(modbus_case_look(s, i)->value == i);
        }
    int refused = s->device.refused;
    assert_in_range(refused, 1, 8);
    await_requests(s, 5);
    assert_int_equal(s->device.refused, refused); /* remembered */
    modbus_case_expect(s, 0, QUALITY_GOOD, 1);
    assert_true(modbus_case_look(s, 0)->age_ns < NS_PER_S);
    assert_true(store_link_is_up(s->store, 0));
}

CASE(what_was_refused_is_asked_anew_when_the_link_is_back)
{
    modbus_case_add_registers(s, 20);
    s->device.bad_register = 7;
    s->device.bad_code = 2;
    modbus_case_serve(s);
    modbus_case_expect(s, 7, QUALITY_BAD_CONFIGURATION, 3);
    device_stop(&s->device);
    modbus_case_expect(s, 7, QUALITY_BAD_NO_COMMUNICATION, 3);
    device_start(&s->device);
    modbus_case_expect(s, 7, QUALITY_BAD_CONFIGURATION, 8);
    modbus_case_expect(s, 8, QUALITY_GOOD, 3);
    device_stop(&s->device);
    modbus_case_expect(s, 7, QUALITY_BAD_NO_COMMUNICATION, 3);
    s->device.bad_code = 0; /* the device was repaired meanwhile */
    device_start(&s->device);
    modbus_case_expect(s, 7, QUALITY_GOOD, 8);
}

CASE(exceptions_become_qualities)
{
    const struct {
        int code;
        uint32_t quality;
    } cases[] = {
        { 1, QUALITY_BAD_CONFIGURATION },  { 2, QUALITY_BAD_CONFIGURATION },    { 3, QUALITY_BAD_CONFIGURATION },
        { 4, QUALITY_BAD_DEVICE_FAILURE }, { 10, QUALITY_BAD_NO_COMMUNICATION }, { 11, QUALITY_BAD_NO_COMMUNICATION },
    };
    modbus_case_add_registers(s, 1);
    device_start(&s->device);
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        s->device.bad_code = cases[i].code;
        modbus_case_start(s);
        modbus_case_expect(s, 0, cases[i].quality, 3);
        assert_false(store_link_is_up(s->store, 0));
        source_stop(&s->source);
    }
}

/* The device refuses a single request, like a controller that restarts a task. No reading may become Bad. */
CASE(one_refusal_loses_nothing)
{
    modbus_case_add_registers(s, 10);
    modbus_case_serve(s);
    for (int code = 1; code <= 4; code++) {
        modbus_case_expect(s, 9, QUALITY_GOOD, 3);
        s->device.bad_times = 1;
        s->device.bad_code = code;
        for (int after = s->device.requests + 4; s->device.requests < after || s->device.bad_code;) {
            for (int tag = 0; tag < 10; tag++)
                assert_int_equal(modbus_case_look(s, tag)->quality, QUALITY_GOOD);
            sleep_ns(2 * NS_PER_MS);
        }
    }
    assert_int_equal(s->device.refused, 4);
    /* the source still reads all 10 registers with one request: a single refusal must not split the block */
    assert_int_equal(s->device.most, 10);
}

CASE(what_was_refused_is_asked_again_after_seconds)
{
    modbus_case_add_registers(s, 10);
    s->device.bad_code = 1;
    modbus_case_serve(s);
    modbus_case_expect(s, 9, QUALITY_BAD_CONFIGURATION, 3);
    s->device.bad_code = 0;
    modbus_case_expect(s, 9, QUALITY_GOOD, 4);
}

CASE(device_failure_is_asked_again)
{
    modbus_case_add_registers(s, 10);
    s->device.bad_register = 4;
    s->device.bad_code = 4;
    modbus_case_serve(s);
    modbus_case_expect(s, 4, QUALITY_BAD_DEVICE_FAILURE, 3);
    modbus_case_expect(s, 3, QUALITY_GOOD, 3);
    s->device.bad_code = 0;
    modbus_case_expect(s, 4, QUALITY_GOOD, 3);
}

CASE(busy_is_no_verdict)
{
    modbus_case_add_registers(s, 2);
    s->plant->tags[0].validity.stale_s = s->plant->tags[1].validity.stale_s = 0.6;
    modbus_case_serve(s);
    modbus_case_expect(s, 0, QUALITY_GOOD, 3);
    for (int code = 5; code <= 6; code++) { /* acknowledge, busy */
        s->device.bad_code = code;
        int64_t received_ns = modbus_case_look(s, 0)->received_utc_ns;
        /* the reading becomes Bad because it is too old: a refused read must not refresh its age */
        modbus_case_expect(s, 0, QUALITY_BAD_COMMUNICATION_ERROR, 2);
        assert_true(modbus_case_look(s, 0)->received_utc_ns - received_ns < NS_PER_S);
        s->device.bad_code = 0;
        modbus_case_expect(s, 0, QUALITY_GOOD, 3);
    }
}

static void check_other_unit_lives(struct modbus_case *s)
{
    modbus_case_expect(s, 0, QUALITY_GOOD, 3);
    modbus_case_expect(s, 1, QUALITY_BAD_NO_COMMUNICATION, 3);
    for (int i = 0; i < 100; i++) {
        assert_int_equal(modbus_case_look(s, 0)->quality, QUALITY_GOOD);
        assert_true(modbus_case_look(s, 0)->age_ns < 2 * NS_PER_S);
        assert_true(store_link_is_up(s->store, 0));
        sleep_ns(20 * NS_PER_MS);
    }
    s->device.dead_unit = s->device.silent_unit = 0;
    modbus_case_expect(s, 1, QUALITY_GOOD, 12);
}

CASE(dead_unit_behind_a_gateway_leaves_the_others_alone)
{
    modbus_case_add_registers(s, 2);
    s->plant->tags[1].signal.modbus_unit = 7;
    s->device.dead_unit = 7;
    modbus_case_serve(s);
    check_other_unit_lives(s);
}

CASE(silent_unit_behind_a_gateway_leaves_the_others_alone)
{
    modbus_case_be_impatient(s);
    modbus_case_add_registers(s, 2);
    s->plant->tags[1].signal.modbus_unit = 7;
    s->device.silent_unit = 7;
    modbus_case_serve(s);
    check_other_unit_lives(s);
}

CASE(stops_while_the_device_hangs)
{
    modbus_case_add_registers(s, 2);
    s->plant->sources[0].timeout_ms = 20000;
    s->device.manner = DEVICE_SILENT;
    modbus_case_serve(s);
    while (s->device.requests == 0)
        sleep_ns(5 * NS_PER_MS);
    modbus_case_assert_stops_soon(s);
}

struct full { /* a listening socket whose backlog is full, so that further connections stay pending */
    int listener, clients[4];
};

static void full_open(struct full *full, const char *address, int port)
{
    struct sockaddr_in at = { .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = inet_addr(address) };
    int on = 1;
    full->listener = socket(AF_INET, SOCK_STREAM, 0);
    setsockopt(full->listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
    assert_int_equal(bind(full->listener, (struct sockaddr *)&at, sizeof(at)), 0);
    assert_int_equal(listen(full->listener, 0), 0);
    for (int i = 0; i < 4; i++) {
        full->clients[i] = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0);
        connect(full->clients[i], (struct sockaddr *)&at, sizeof(at));
    }
}

static void full_close(struct full *full)
{
    for (int i = 0; i < 4; i++)
        close(full->clients[i]);
    close(full->listener);
}

CASE(stops_while_a_connection_hangs)
{
    struct full full;
    full_open(&full, "127.0.0.1", s->device.port);
    modbus_case_add_registers(s, 1);
    s->plant->sources[0].timeout_ms = 20000;
    modbus_case_start(s);
    sleep_ns(300 * NS_PER_MS);
    assert_int_equal(modbus_case_look(s, 0)->quality, QUALITY_BAD_WAITING); /* still connecting */
    modbus_case_assert_stops_soon(s);
    full_close(&full);
}

CASE(connecting_ends_by_its_deadline)
{
    struct full full;
    full_open(&full, "127.0.0.1", s->device.port);
    modbus_case_be_impatient(s);
    modbus_case_add_registers(s, 1);
    modbus_case_start(s);
    /* the source must give up soon: without its own limit, connecting would take two minutes until the system's timeout */
    modbus_case_expect(s, 0, QUALITY_BAD_NO_COMMUNICATION, 2.5);
    full_close(&full);
}

CASE(names_are_looked_up)
{
    modbus_case_add_registers(s, 1);
    mem_free(s->plant->sources[0].hosts[0]);
    s->plant->sources[0].hosts[0] = mem_strdup("localhost");
    modbus_case_serve(s);
    modbus_case_expect(s, 0, QUALITY_GOOD, 5);
}

/* --- host names with several addresses */

static const char TWO_ADDRESSES[] = "two.test"; /* a host name with the addresses 127.0.0.2 and 127.0.0.1, in this order */
int __real_getaddrinfo(const char *host, const char *port, const struct addrinfo *hints, struct addrinfo **out);
int __wrap_getaddrinfo(const char *host, const char *port, const struct addrinfo *hints, struct addrinfo **out);

int __wrap_getaddrinfo(const char *host, const char *port, const struct addrinfo *hints, struct addrinfo **out)
{
    if (strcmp(host, TWO_ADDRESSES) != 0)
        return __real_getaddrinfo(host, port, hints, out);
    if (__real_getaddrinfo("127.0.0.2", port, hints, out) != 0)
        return EAI_FAIL;
    return __real_getaddrinfo("127.0.0.1", port, hints, &(*out)->ai_next);
}

/* The first address of the host name never answers. The source must connect to the second one within one timeout, and at once when
   it connects again. */
CASE(each_address_of_a_name_is_tried)
{
    struct full full;
    full_open(&full, "127.0.0.2", s->device.port);
    modbus_case_add_registers(s, 1);
    struct plant_source *source = &s->plant->sources[0];
    mem_free(source->hosts[0]);
    source->hosts[0] = mem_strdup(TWO_ADDRESSES);
    source->timeout_ms = 3000;
    source->poll_ms = 20;
    source->close_between_polls = true;
    modbus_case_serve(s);
    modbus_case_expect(s, 0, QUALITY_GOOD, 5);
    int64_t began_ns = clock_mono_ns();
    while (s->device.connections < 21 && clock_mono_ns() - began_ns < 60 * NS_PER_S)
        sleep_ns(5 * NS_PER_MS);
    /* without remembering the second address, each of these connections would take 1.5 s, together at least 30 s */
    assert_true(clock_mono_ns() - began_ns < 15 * NS_PER_S);
    full_close(&full);
}

CASE(two_sources_may_name_one_device)
{
    modbus_case_add_registers(s, 1);
    plant_by_hand_source(s->plant, "again", s->device.port);
    plant_by_hand_tag(s->plant, "second", TABLE_HOLDING, 11, DATA_INT16);
    modbus_case_serve(s);
    struct source *second = source_start(s->log, s->plant, 1, s->store, s->counters);
    modbus_case_expect(s, 0, QUALITY_GOOD, 3);
    modbus_case_expect(s, 1, QUALITY_GOOD, 3);
    assert_true(modbus_case_look(s, 1)->value == 11);
    source_stop(&second);
    assert_int_equal(s->device.connections, 2);
}

/* The source must connect even if its socket has a descriptor of 1024 or more, as in a daemon with many viewers. libmodbus's
   own waiting by select() fails for such descriptors. */
CASE(reconnects_with_a_thousand_files_open)
{
    enum { FILES = 1100, LOW = 4 };
    struct rlimit limit;
    int files[FILES];
    getrlimit(RLIMIT_NOFILE, &limit);
    if (limit.rlim_max < FILES + 100)
        skip();
    limit.rlim_cur = FILES + 100;
    setrlimit(RLIMIT_NOFILE, &limit);
    modbus_case_add_registers(s, 1);
    modbus_case_start(s);
    modbus_case_expect(s, 0, QUALITY_BAD_NO_COMMUNICATION, 3);
    for (int i = 0; i < FILES; i++)
        files[i] = dup(2);
    assert_true(files[FILES - 1] >= 1024);
    device_start(&s->device);
    for (int i = 0; i < LOW; i++) /* frees low descriptors for the simulated device, which uses libmodbus's select() */
        close(files[i]);
    modbus_case_expect(s, 0, QUALITY_GOOD, 8);
    for (int i = LOW; i < FILES; i++)
        close(files[i]);
}

CASE(unknown_kind_is_refused)
{
    mem_free(s->plant->sources[0].kind);
    s->plant->sources[0].kind = mem_strdup("telepathy");
    s->store = test_store(s->plant);
    assert_null(source_start(s->log, s->plant, 0, s->store, s->counters));
}

/* The daemon must never write to a device: none of its object files may refer to a libmodbus function that writes. */
TEST(calls_nothing_that_writes)
{
    static const char *const writers[] = { "modbus_write", "modbus_mask_write", "modbus_send_raw" };
    const char *folder = getenv("PLANTCAST_OUT");
    size_t bytes;
    char *path = test_printf("%s/lib/value.a", folder ? folder : "build/release"), *archive = text_read_file(path, 64 << 20, &bytes);
    if (!archive) {
        print_message("# %s is not there\n", path);
        skip();
    }
    assert_non_null(memmem(archive, bytes, "modbus_read_registers", 21));
    for (int i = 0; i < 3; i++)
        assert_null(memmem(archive, bytes, writers[i], strlen(writers[i])));
    mem_free(archive);
}
