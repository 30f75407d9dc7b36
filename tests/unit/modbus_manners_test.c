/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Modbus devices that answer only a limited number of requests per connection, or misbehave in other common ways. The source
   must detect this by itself and read all blocks without configuration. */
#include "tests/support/test.h"
#include <unistd.h>

#include "base/clock.h"
#include "tests/support/modbus_case.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/sleep.h"
#include "value/quality.h"

enum { POLL_MS = 100, BLOCKS = 3 };

/* --- capturing what the log writes ------------------------------------------------------------------------------------------- */

static FILE *said;
static int kept_stderr;

static int set_up(void **state)
{
    int status = modbus_case_set_up(state);
    struct modbus_case *s = *state;
    s->log = log_create(LOG_INFO);
    said = tmpfile();
    fflush(stderr);
    kept_stderr = dup(2);
    dup2(fileno(said), 2);
    return status;
}

static int tear_down(void **state)
{
    struct log *log = ((struct modbus_case *)*state)->log;
    int status = modbus_case_tear_down(state);
    log_destroy(&log);
    dup2(kept_stderr, 2);
    close(kept_stderr);
    fclose(said);
    return status;
}

#define CASE(name) TEST_ON(struct modbus_case *s, name, set_up, tear_down)

static int lines_with(const char *words)
{
    char line[1000];
    int count = 0;
    rewind(said);
    while (fgets(line, sizeof(line), said))
        count += strstr(line, words) != NULL;
    return count;
}

static void await_line(const char *words, double timeout_s)
{
    for (int64_t end_ns = clock_mono_ns() + (int64_t)(timeout_s * 1e9); lines_with(words) == 0 && clock_mono_ns() < end_ns;)
        sleep_ns(20 * NS_PER_MS);
    if (lines_with(words) != 1)
        fail_msg("%d lines with: %s", lines_with(words), words);
}

/* --- a device with three blocks (ranges read by one request), at registers 0, 500 and 1000
   ------------------------------------------- */

static void add_blocks(struct modbus_case *s)
{
    for (int i = 0; i < BLOCKS; i++) {
        plant_by_hand_tag(s->plant, test_printf("B%d", i), TABLE_HOLDING, 500 * i, DATA_INT16);
        s->plant->tags[i].validity.stale_s = 30;
    }
    s->plant->sources[0].poll_ms = POLL_MS;
    modbus_case_be_impatient(s);
}

static void start(struct modbus_case *s)
{
    add_blocks(s);
    modbus_case_serve(s);
}

static bool all_good(struct modbus_case *s)
{
    bool good = true;
    for (int i = 0; i < BLOCKS; i++) {
        const struct reading *reading = modbus_case_look(s, i);
        good &= reading->quality == QUALITY_GOOD;
        if (reading->quality == QUALITY_GOOD)
            assert_true(reading->value == 500 * i);
    }
    return good;
}

enum { LONGEST_TURN = 20 }; /* largest number of requests to the device after which each of its three blocks must have been read again */

/* Number of requests that the device has received since a block's last reading. Counting requests instead of time makes the
   test independent of the machine's load. */
struct turn {
    int64_t received_ns;
    int requests;
};

static void expect_new(struct modbus_case *s, int tag, struct turn *turn)
{
    int requests = s->device.requests;
    int64_t received_ns = modbus_case_look(s, tag)->received_utc_ns;
    if (received_ns != turn->received_ns)
        *turn = (struct turn){ received_ns, requests };
    assert_true(requests - turn->requests <= LONGEST_TURN);
}

/* Waits at most within_s until all blocks are Good. Then asserts that they stay Good and are read regularly, until the device
   has received `requests` more requests. */
static void expect_steady(struct modbus_case *s, double within_s, int requests)
{
    for (int i = 0; i < BLOCKS; i++)
        modbus_case_expect(s, i, QUALITY_GOOD, within_s);
    struct turn turns[BLOCKS] = { 0 };
    for (int end = s->device.requests + requests; s->device.requests < end; sleep_ns(5 * NS_PER_MS)) {
        assert_true(all_good(s));
        for (int i = 0; i < BLOCKS; i++)
            expect_new(s, i, &turns[i]);
    }
}

/* --- connections that end ---------------------------------------------------------------------------------------------------- */

CASE(a_device_that_closes_after_each_answer)
{
    s->device.answers_per_connection = 1;
    start(s);
    expect_steady(s, 5, 30);
    await_line("closes the connection after each answer, so each request gets a new connection; set `close_between_polls: yes` to do so "
               "from the start",
               5);
    assert_int_equal(lines_with("no readings"), 0);
    /* apart from the line that names the detected limit, one line contains "reading": the line that says that reading works */
    assert_int_equal(lines_with("reading"), 1);
}

CASE(a_device_that_resets_after_each_answer)
{
    s->device.answers_per_connection = 1;
    s->device.resets = true;
    start(s);
    expect_steady(s, 5, 30);
}

CASE(a_device_that_closes_after_two_answers)
{
    s->device.answers_per_connection = 2;
    start(s);
    expect_steady(s, 5, 30);
    assert_int_equal(lines_with("closes connections after some answers"), 1);
}

CASE(a_device_that_is_silent_after_one_answer)
{
    s->device.answers_per_connection = 1;
    s->device.hushes = true;
    start(s);
    await_line("closes the connection after each answer", 20);
    expect_steady(s, 5, 30);
}

CASE(a_device_that_closes_in_rtu_over_tcp)
{
    s->device.answers_per_connection = 1;
    s->device.wire = DEVICE_RTU_TCP;
    s->plant->sources[0].transport = TRANSPORT_RTU_TCP;
    start(s);
    expect_steady(s, 5, 30);
}

CASE(a_device_that_frees_its_connection_late)
{
    s->device.answers_per_connection = 1;
    s->device.away_ms = 120;
    start(s);
    await_line("closes the connection after each answer", 20);
    expect_steady(s, 20, 20);
}

CASE(a_device_that_closes_idle_connections)
{
    s->device.idle_ms = 40;
    start(s);
    expect_steady(s, 5, 30);
    assert_int_equal(lines_with("no readings"), 0);
}

CASE(one_request_per_connection_by_key)
{
    add_blocks(s);
    s->plant->sources[0].close_between_polls = true;
    modbus_case_serve(s);
    expect_steady(s, 5, 10);
    source_stop(&s->source);
    /* number of connections on which no request came; 1 if the source was stopped right after connecting */
    int unused = s->device.connections - s->device.requests;
    assert_in_range(unused, 0, 1);
    assert_int_equal(lines_with(" from the start"), 0);
}

/* --- slow starts ------------------------------------------------------------------------------------------------------------- */

CASE(a_device_that_drops_what_comes_at_once)
{
    s->device.deaf_ms = 1000;
    start(s);
    expect_steady(s, 15, 15);
    await_line("`connect_delay_ms: ", 5);
}

CASE(a_delay_by_key)
{
    add_blocks(s);
    s->device.deaf_ms = 400;
    s->plant->sources[0].connect_delay_ms = 500;
    modbus_case_serve(s);
    expect_steady(s, 5, 15);
    assert_int_equal(lines_with(" from the start"), 0);
    assert_int_equal(s->device.connections, 1);
}

CASE(a_device_in_rtu_over_tcp_that_drops_what_comes_at_once)
{
    s->device.deaf_ms = 400;
    s->device.wire = DEVICE_RTU_TCP;
    s->plant->sources[0].transport = TRANSPORT_RTU_TCP;
    start(s);
    expect_steady(s, 15, 15);
}

CASE(a_slow_first_answer)
{
    s->device.first_late_ms = 1000;
    start(s);
    expect_steady(s, 20, 15);
    await_line("after connecting for its first answer, so the first request waits that long", 5);
}

/* Every answer takes longer than timeout_ms. The log must say so and name a timeout that would suffice. */
static void check_slow(struct modbus_case *s, enum device_wire wire)
{
    s->device.wire = wire;
    s->plant->sources[0].transport = wire == DEVICE_TCP ? TRANSPORT_TCP : TRANSPORT_RTU_TCP;
    s->device.manner = DEVICE_LATE;
    s->device.late_ms = 450;
    start(s);
    await_line("later than `timeout_ms: 300`", 30);
    assert_int_equal(lines_with("close_between_polls"), 0);
    all_good(s); /* late answers must be assigned to the right requests, so that no value is wrong */
}

CASE(a_slow_device)
{
    check_slow(s, DEVICE_TCP);
}

CASE(a_slow_device_in_rtu_over_tcp)
{
    check_slow(s, DEVICE_RTU_TCP);
}

/* --- units and addresses ----------------------------------------------------------------------------------------------------- */

CASE(an_answer_that_names_unit_0)
{
    s->device.manner = DEVICE_RENAMED;
    start(s);
    expect_steady(s, 5, 60);
    assert_int_equal(lines_with("answers as unit 0 to requests for unit 1"), 1); /* of more than 60 */
}

CASE(unit_0_is_nobody_s_where_several_units_are_read)
{
    s->device.manner = DEVICE_RENAMED;
    add_blocks(s);
    s->plant->tags[2].signal.modbus_unit = 7;
    modbus_case_serve(s);
    while (s->device.requests < 8)
        sleep_ns(10 * NS_PER_MS);
    for (int i = 0; i < BLOCKS; i++)
        assert_true(quality_is_bad(modbus_case_look(s, i)->quality));
    assert_int_equal(lines_with("no readings"), 1); /* repeated failures must give a single log line */
}

CASE(an_address_that_is_never_answered_leaves_the_others_alone)
{
    add_blocks(s);
    plant_by_hand_tag(s->plant, "mute neighbour", TABLE_HOLDING, 501, DATA_INT16);
    s->device.mute_register = 501;
    modbus_case_serve(s);
    await_line("mute neighbour (1 from address 501): the device does not answer for these addresses, although it answers for others", 30);
    expect_steady(s, 10, 40);
    assert_true(quality_is_bad(modbus_case_look(s, BLOCKS)->quality));
    s->device.mute_register = 0;
    modbus_case_expect(s, BLOCKS, QUALITY_GOOD, 15);
}

/* Asserts that the blocks 0 and 1 stay Good although unit 7, which has the third block, does not answer, and that one log line
   reports unit 7. */
static void expect_two_units_live(struct modbus_case *s)
{
    struct turn turns[2] = { 0 };
    for (int i = 0; i < 2; i++)
        modbus_case_expect(s, i, QUALITY_GOOD, 10);
    for (int end = s->device.requests + 40; s->device.requests < end; sleep_ns(5 * NS_PER_MS))
        for (int i = 0; i < 2; i++) {
            assert_true(modbus_case_look(s, i)->quality == QUALITY_GOOD);
            expect_new(s, i, &turns[i]);
        }
    assert_true(quality_is_bad(modbus_case_look(s, 2)->quality));
    assert_int_equal(lines_with("unit 7 does not answer"), 1);
}

/* A gateway to several units, of which unit 7 does not answer. The gateway closes its connection after each answer. The other
   units must be read nevertheless. */
CASE(a_dead_unit_at_a_closing_gateway)
{
    s->device.answers_per_connection = 1;
    s->device.silent_unit = 7;
    add_blocks(s);
    s->plant->tags[2].signal.modbus_unit = 7;
    modbus_case_serve(s);
    await_line("unit 7 does not answer", 10);
    expect_two_units_live(s);
}

/* A device with a single unit stops answering. It must not be treated like a gateway, at which other units might still answer:
   after two timeouts it must be reported. */
CASE(a_device_that_falls_silent_is_not_waited_for)
{
    start(s);
    for (int i = 0; i < BLOCKS; i++)
        modbus_case_expect(s, i, QUALITY_GOOD, 10);
    s->device.silent_unit = 1;
    int requests = s->device.requests;
    await_line("no readings", 20);
    /* at most 8 requests: two timeouts and some reconnections. If the device were treated like a gateway, the second request
       would be repeated 16 times */
    assert_true(s->device.requests - requests <= 8);
    assert_false(quality_is_good(modbus_case_look(s, 0)->quality));
}

/* A gateway that waits for its silent unit three times as long as the source's timeout, and accepts no other request meanwhile.
   The other units must still be read. */
CASE(a_dead_unit_that_blocks_its_gateway)
{
    add_blocks(s);
    s->device.dead_unit = 7;
    s->device.dead_late_ms = 3 * s->plant->sources[0].timeout_ms;
    s->plant->tags[2].signal.modbus_unit = 7;
    modbus_case_serve(s);
    await_line("unit 7 does not answer", 20);
    expect_two_units_live(s);
    assert_int_equal(lines_with("no readings"), 0);
    assert_int_equal(lines_with("after connecting for its first answer"), 0);
    assert_int_equal(lines_with("unit 1 does not answer"), 0);
}

/* --- gateways that are lost with all their units ----------------------------------------------------------------------------- */

enum { UNITS = 12 };

static void start_gateway(struct modbus_case *s)
{
    for (int i = 0; i < UNITS; i++) {
        plant_by_hand_tag(s->plant, test_printf("U%d", i), TABLE_HOLDING, i, DATA_INT16)->signal.modbus_unit = i + 1;
        s->plant->tags[i].validity.stale_s = 300;
    }
    s->plant->sources[0].poll_ms = POLL_MS;
    modbus_case_be_impatient(s);
    modbus_case_serve(s);
    for (int i = 0; i < UNITS; i++)
        modbus_case_expect(s, i, QUALITY_GOOD, 10);
}

/* Asserts that all units of a gateway become Bad together. The log must have one line for the gateway and one for each of the
   two units that were tried before. Afterwards all units must become Good again. */
static void expect_lost_together(struct modbus_case *s)
{
    await_line("the gateway counts as lost, because 3 of its units stopped answering one after the other", 60);
    for (int i = 0; i < UNITS; i++)
        modbus_case_expect(s, i, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE, 10);
    assert_int_equal(lines_with("does not answer"), 2);
    s->device.manner = DEVICE_GOOD;
    s->device.dead_unit = 0;
    for (int i = 0; i < UNITS; i++)
        modbus_case_expect(s, i, QUALITY_GOOD, 30);
    assert_int_equal(lines_with("no readings"), 1);
    assert_int_equal(lines_with("answers again"), 2);
}

CASE(a_gateway_that_falls_silent_is_told_once_for_all_units)
{
    start_gateway(s);
    int requests = s->device.requests;
    s->device.manner = DEVICE_SILENT;
    await_line("the gateway counts as lost", 60);
    /* the second unit is tried for 5 s, as long as a gateway may block; without this limit, each of the eleven other units
       would be tried as long, with more than 60 requests */
    assert_in_range(s->device.requests - requests, 3, 60);
    expect_lost_together(s);
}

CASE(a_gateway_that_reaches_no_unit_is_told_once_for_all_units)
{
    start_gateway(s);
    s->device.dead_unit = -1;
    expect_lost_together(s);
}

/* Two of a gateway's twelve units stop answering: the ten others must stay Good all the time. */
CASE(two_dead_units_are_no_lost_gateway)
{
    start_gateway(s);
    s->device.silent_unit = 4;
    s->device.dead_unit = 9;
    await_line("unit 4 does not answer", 30);
    await_line("unit 9 does not answer", 30);
    for (int end = s->device.requests + 60; s->device.requests < end; sleep_ns(5 * NS_PER_MS))
        for (int i = 0; i < UNITS; i++)
            assert_true(i == 3 || i == 8 || modbus_case_look(s, i)->quality == QUALITY_GOOD);
    assert_int_equal(lines_with("no readings"), 0);
    assert_int_equal(lines_with("the gateway counts as lost"), 0);
}
