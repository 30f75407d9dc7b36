/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests the Modbus source with a simulated device on TCP, on a serial line, and with RTU frames over TCP. No value may come
   from a late or wrong answer. A second host must replace a failed one, and requests must respect the device's limits. */
#include "tests/support/test.h"

#include "base/clock.h"
#include "tests/support/modbus_case.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/sleep.h"
#include "tests/support/sweep.h"
#include "value/quality.h"

#define CASE(name) TEST_ON(struct modbus_case *s, name, modbus_case_set_up, modbus_case_tear_down)

static void use_wire(struct modbus_case *s, enum device_wire wire)
{
    s->device.wire = wire;
    device_start(&s->device);
    struct plant_source *source = &s->plant->sources[0];
    source->transport = wire == DEVICE_LINE ? TRANSPORT_RTU : wire == DEVICE_RTU_TCP ? TRANSPORT_RTU_TCP : TRANSPORT_TCP;
    source->device = s->device.line;
    modbus_case_be_impatient(s);
}

static void check_rtu(struct modbus_case *s, enum device_wire wire)
{
    modbus_case_add_registers(s, 3);
    plant_by_hand_tag(s->plant, "wide", TABLE_INPUT, 100, DATA_UINT32);
    plant_by_hand_tag(s->plant, "coil", TABLE_COIL, 3, DATA_BIT);
    plant_by_hand_tag(s->plant, "contact", TABLE_DISCRETE, 4, DATA_BIT);
    use_wire(s, wire);
    modbus_case_start(s);
    const double wanted[] = { 0, 1, 2, 10100 * 65536.0 + 10101, 1, 1 };
    for (int i = 0; i < 6; i++) {
        modbus_case_expect(s, i, QUALITY_GOOD, 3);
        assert_true(modbus_case_look(s, i)->value == wanted[i]);
    }
    assert_int_equal(s->device.functions, 1 << 1 | 1 << 2 | 1 << 3 | 1 << 4);
    s->device.manner = DEVICE_SILENT;
    modbus_case_expect(s, 0, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE, 3);
    s->device.manner = DEVICE_GOOD;
    modbus_case_expect(s, 2, QUALITY_GOOD, 8);
}

CASE(rtu_over_tcp_is_read)
{
    check_rtu(s, DEVICE_RTU_TCP);
}

CASE(a_serial_line_is_read)
{
    check_rtu(s, DEVICE_LINE);
}

/* RTU frames have no transaction number: the source must not take a late answer for that of its next request. */
static void check_late_rtu(struct modbus_case *s, enum device_wire wire)
{
    modbus_case_add_registers(s, 1);
    plant_by_hand_tag(s->plant, "far", TABLE_HOLDING, 500, DATA_INT16);
    use_wire(s, wire);
    s->plant->sources[0].timeout_ms = 200;
    /* an answer comes 1 s late, after the next request: that is sent after a timeout of 0.2 s and a backoff of at most 0.75 s
       */
    s->device.late_ms = 1000;
    modbus_case_start(s);
    modbus_case_expect(s, 1, QUALITY_GOOD, 3);
    s->device.manner = DEVICE_LATE;
    modbus_case_expect(s, 1, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE, 3);
    s->device.manner = DEVICE_GOOD;
    for (int64_t end_ns = clock_mono_ns() + 4 * NS_PER_S; clock_mono_ns() < end_ns;) {
        for (int tag = 0; tag < 2; tag++)
            if (!quality_is_bad(modbus_case_look(s, tag)->quality))
                assert_true(modbus_case_look(s, tag)->value == tag * 500);
        if (modbus_case_look(s, 0)->quality == QUALITY_GOOD && modbus_case_look(s, 1)->quality == QUALITY_GOOD)
            break;
        sleep_ns(2 * NS_PER_MS);
    }
    modbus_case_expect(s, 1, QUALITY_GOOD, 4);
}

CASE(late_replies_do_not_poison_rtu_over_tcp)
{
    check_late_rtu(s, DEVICE_RTU_TCP);
}

CASE(late_replies_do_not_poison_a_serial_line)
{
    check_late_rtu(s, DEVICE_LINE);
}

/* After a timeout the source connects again and requests another block. A serial device server then sends the answer to the
   first request over the new connection: it must not be taken for the new block. */
CASE(late_replies_do_not_poison_the_next_connection)
{
    modbus_case_add_registers(s, 1);
    plant_by_hand_tag(s->plant, "far", TABLE_HOLDING, 500, DATA_INT16);
    use_wire(s, DEVICE_RTU_TCP);
    s->plant->sources[0].timeout_ms = 200;
    s->device.late_ms = 300;
    modbus_case_start(s);
    modbus_case_expect(s, 1, QUALITY_GOOD, 3);
    for (int round = 0; round < 5; round++) {
        int before = s->device.requests;
        s->device.manner = DEVICE_LATE;
        while (s->device.requests == before)
            sleep_ns(NS_PER_MS);
        s->device.manner = DEVICE_GOOD;
        while (s->device.requests < before + 8) {
            for (int tag = 0; tag < 2; tag++)
                if (!quality_is_bad(modbus_case_look(s, tag)->quality))
                    assert_true(modbus_case_look(s, tag)->value == tag * 500);
            sleep_ns(NS_PER_MS);
        }
    }
    for (int tag = 0; tag < 2; tag++)
        modbus_case_expect(s, tag, QUALITY_GOOD, 8);
}

/* A device whose answers all come after the timeout: its tags become Bad, and no answer is taken for that of another request.
   */
static void check_always_late(struct modbus_case *s, enum device_wire wire)
{
    modbus_case_add_registers(s, 1);
    plant_by_hand_tag(s->plant, "far", TABLE_HOLDING, 500, DATA_INT16);
    use_wire(s, wire);
    s->plant->sources[0].timeout_ms = 200;
    s->plant->sources[0].pause_ms = 200;
    s->device.late_ms = 300;
    modbus_case_start(s);
    for (int tag = 0; tag < 2; tag++)
        modbus_case_expect(s, tag, QUALITY_GOOD, 3);
    s->device.manner = DEVICE_LATE;
    for (int before = s->device.requests; s->device.requests < before + sweep(16, 7); sleep_ns(NS_PER_MS))
        for (int tag = 0; tag < 2; tag++)
            if (!quality_is_bad(modbus_case_look(s, tag)->quality))
                assert_true(modbus_case_look(s, tag)->value == tag * 500);
    for (int tag = 0; tag < 2; tag++)
        assert_false(quality_is_good(modbus_case_look(s, tag)->quality));
    s->device.manner = DEVICE_GOOD;
    for (int tag = 0; tag < 2; tag++) {
        modbus_case_expect(s, tag, QUALITY_GOOD, 60);
        assert_true(modbus_case_look(s, tag)->value == tag * 500);
    }
}

CASE(a_slow_device_on_rtu_over_tcp_is_lost)
{
    check_always_late(s, DEVICE_RTU_TCP);
}

CASE(a_slow_device_on_a_serial_line_is_lost)
{
    check_always_late(s, DEVICE_LINE);
}

CASE(an_absent_line_is_tried_again)
{
    modbus_case_add_registers(s, 1);
    s->plant->sources[0].transport = TRANSPORT_RTU;
    s->plant->sources[0].device = "/dev/plantcast-no-such-line";
    modbus_case_start(s);
    modbus_case_expect(s, 0, QUALITY_BAD_NO_COMMUNICATION, 3);
    modbus_case_assert_stops_soon(s);
}

static int host_of(struct modbus_case *s)
{
    return (int)*counters_add(s->counters, "plantcast_source_host{source=\"plc\"}", "gauge", "");
}

CASE(the_second_host_stands_in)
{
    struct modbus_device second = { .address = "127.0.0.2", .port = s->device.port };
    struct plant_source *source = &s->plant->sources[0];
    modbus_case_add_registers(s, 1);
    source->hosts[source->host_count++] = mem_strdup("127.0.0.2");
    modbus_case_be_impatient(s);
    device_start(&s->device);
    device_start(&second);
    modbus_case_start(s);
    modbus_case_expect(s, 0, QUALITY_GOOD, 3);
    assert_int_equal(second.connections, 0); /* while the first host works, the source must not connect to the second */
    assert_int_equal(host_of(s), 1);
    device_stop(&s->device);
    int first_asked = s->device.requests;
    for (int64_t end_ns = clock_mono_ns() + 4 * NS_PER_S; second.requests == 0 && clock_mono_ns() < end_ns;)
        sleep_ns(10 * NS_PER_MS);
    modbus_case_expect(s, 0, QUALITY_GOOD, 2); /* immediately, without a backoff */
    assert_true(second.requests > 0);
    assert_int_equal(host_of(s), 2);
    device_start(&s->device); /* the first host works again, but the source must stay with the second one as long as that answers */
    for (int asked = second.requests + 10; second.requests < asked;)
        sleep_ns(10 * NS_PER_MS);
    assert_int_equal(s->device.requests, first_asked);
    assert_int_equal(host_of(s), 2);
    second.manner = DEVICE_SILENT; /* accepts connections and answers nothing */
    int before = s->device.requests;
    while (s->device.requests == before)
        sleep_ns(10 * NS_PER_MS);
    modbus_case_expect(s, 0, QUALITY_GOOD, 3);
    assert_int_equal(host_of(s), 1);
    device_stop(&second);
}

CASE(requests_keep_to_the_device_s_limits)
{
    modbus_case_add_registers(s, 40);
    s->plant->sources[0].max_registers = 10;
    s->plant->sources[0].pause_ms = 30;
    modbus_case_serve(s);
    modbus_case_expect(s, 39, QUALITY_GOOD, 3);
    sleep_ns(300 * NS_PER_MS);
    assert_int_equal(s->device.most, 10);
    print_message("# shortest rest %.1f ms\n", (double)s->device.least_gap_ns / 1e6);
    assert_true(s->device.least_gap_ns > 29 * NS_PER_MS);
}

/* A small PLC refuses a request that spans a hole in its registers. The source finds the hole once, then reads the ranges on both sides. */
CASE(a_hole_is_refused_once)
{
    modbus_case_add_registers(s, 10);
    for (int i = 14; i < 20; i++)
        plant_by_hand_tag(s->plant, "beyond", TABLE_HOLDING, i, DATA_INT16);
    s->plant->sources[0].max_gap = 8;
    s->device.bad_register = 12;
    s->device.bad_code = 2;
    modbus_case_serve(s);
    for (int i = 0; i < 16; i++)
        modbus_case_expect(s, i, QUALITY_GOOD, 3);
    int refused = s->device.refused;
    sleep_ns(500 * NS_PER_MS);
    assert_int_equal(s->device.refused, refused);
    assert_in_range(refused, 1, 4);
    assert_true(modbus_case_look(s, 0)->age_ns < NS_PER_S && modbus_case_look(s, 15)->age_ns < NS_PER_S);
}

CASE(busy_is_asked_again_soon)
{
    modbus_case_add_registers(s, 1);
    s->plant->sources[0].poll_ms = 20000;
    s->device.bad_code = 6;
    modbus_case_serve(s);
    /* after a request was refused with exception 6 (busy), the next one must follow long before the poll interval has passed */
    while (s->device.requests < 2)
        sleep_ns(5 * NS_PER_MS);
    s->device.bad_code = 0;
    modbus_case_expect(s, 0, QUALITY_GOOD, 3);
}

/* The device answers wrongly in one `manner`: no value may be taken from such answers, and readings return when the device
   behaves well again. */
static void check_hostile(struct modbus_case *s, enum device_wire wire, int manner)
{
    modbus_case_add_registers(s, 20);
    plant_by_hand_tag(s->plant, "far", TABLE_HOLDING, 500, DATA_INT16);
    use_wire(s, wire);
    modbus_case_start(s);
    modbus_case_expect(s, 20, QUALITY_GOOD, 3);
    s->device.manner = manner;
    int before = s->device.requests;
    while (s->device.requests == before) {
        for (int tag = 0; tag < 21; tag++)
            assert_true(modbus_case_look(s, tag)->value == (tag == 20 ? 500 : tag));
        sleep_ns(5 * NS_PER_MS);
    }
    s->device.manner = DEVICE_GOOD;
    modbus_case_expect(s, 20, QUALITY_GOOD, 8);
    assert_true(modbus_case_look(s, 20)->value == 500);
}

/* Defines a test of one kind of wrong answer. length: for DEVICE_MEASURED, the wrong length that the answers' header states. */
#define HOSTILE(name, wire, manner, length)                                                                                                \
    CASE(name)                                                                                                                             \
    {                                                                                                                                      \
        s->device.said_length = length;                                                                                                    \
        check_hostile(s, wire, manner);                                                                                                    \
    }
HOSTILE(short_answers, DEVICE_TCP, DEVICE_SHORT, 0)
HOSTILE(short_answers_in_rtu_over_tcp, DEVICE_RTU_TCP, DEVICE_SHORT, 0)
HOSTILE(long_answers, DEVICE_TCP, DEVICE_LONG, 0)
HOSTILE(long_answers_in_rtu_over_tcp, DEVICE_RTU_TCP, DEVICE_LONG, 0)
HOSTILE(garbage, DEVICE_TCP, DEVICE_GARBAGE, 0)
HOSTILE(garbage_on_a_line, DEVICE_LINE, DEVICE_GARBAGE, 0)
HOSTILE(garbage_in_rtu_over_tcp, DEVICE_RTU_TCP, DEVICE_GARBAGE, 0)
HOSTILE(answers_of_other_units, DEVICE_TCP, DEVICE_FOREIGN, 0)
HOSTILE(answers_of_other_units_on_a_line, DEVICE_LINE, DEVICE_FOREIGN, 0)
HOSTILE(answers_of_other_units_in_rtu_over_tcp, DEVICE_RTU_TCP, DEVICE_FOREIGN, 0)
HOSTILE(answers_of_no_length, DEVICE_TCP, DEVICE_MEASURED, 0)
HOSTILE(answers_of_length_1, DEVICE_TCP, DEVICE_MEASURED, 1)
HOSTILE(answers_of_length_65535, DEVICE_TCP, DEVICE_MEASURED, 65535)
