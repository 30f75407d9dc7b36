/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cmocka fixture with a simulated Modbus device, the source that polls it, and the store that gets the readings. */
#include "modbus_case.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

#include "base/clock.h"
#include "base/mem.h"
#include "tests/support/owned.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/ports.h"
#include "tests/support/sleep.h"
#include "value/quality.h"

int modbus_case_set_up(void **state)
{
    struct modbus_case *c = mem_new(sizeof(*c));
    c->plant = plant_by_hand_create(300);
    c->device.port = free_port();
    plant_by_hand_source(c->plant, "plc", c->device.port);
    c->log = test_log();
    c->counters = test_counters();
    *state = c;
    return 0;
}

int modbus_case_tear_down(void **state)
{
    struct modbus_case *c = *state;
    source_stop(&c->source);
    if (c->device.thread)
        device_stop(&c->device);
    mem_free(c);
    return 0;
}

void modbus_case_be_impatient(struct modbus_case *c)
{
    c->plant->sources[0].timeout_ms = 300;
}

void modbus_case_add_registers(struct modbus_case *c, int count)
{
    for (int i = 0; i < count; i++) {
        char name[20];
        snprintf(name, sizeof(name), "R%d", i);
        plant_by_hand_tag(c->plant, name, TABLE_HOLDING, i, DATA_INT16);
    }
}

void modbus_case_start(struct modbus_case *c)
{
    c->store = test_store(c->plant);
    c->snapshot = test_snapshot(c->plant->tag_count);
    c->source = source_start(c->log, c->plant, 0, c->store, c->counters);
    assert_non_null(c->source);
}

void modbus_case_serve(struct modbus_case *c)
{
    device_start(&c->device);
    modbus_case_start(c);
}

const struct reading *modbus_case_look(struct modbus_case *c, int tag)
{
    store_snapshot(c->store, clock_mono_ns(), clock_utc_ns(), c->snapshot);
    return &c->snapshot->readings[tag];
}

#define LOADED 4 /* factor on the time limits given by tests, because a loaded machine is slower */

void modbus_case_expect(struct modbus_case *c, int tag, uint32_t quality, double timeout_s)
{
    int64_t end_ns = clock_mono_ns() + (int64_t)(LOADED * timeout_s * 1e9);
    while (modbus_case_look(c, tag)->quality != quality && clock_mono_ns() < end_ns)
        sleep_ns(10 * NS_PER_MS);
    assert_string_equal(quality_name(modbus_case_look(c, tag)->quality), quality_name(quality));
}

void modbus_case_assert_stops_soon(struct modbus_case *c)
{
    int64_t begin_ns = clock_mono_ns();
    source_stop(&c->source);
    assert_null(c->source);
    assert_true(clock_mono_ns() - begin_ns < 2 * NS_PER_S);
}
