/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Modbus source with its device and its store, and assertions on them. For cmocka tests. */
#ifndef TESTS_MODBUS_CASE_H
#define TESTS_MODBUS_CASE_H
#include "tests/support/modbus_device.h"
#include "value/source.h"

struct modbus_case {
    struct modbus_device device;
    struct plant *plant;
    struct log *log;
    struct counters *counters;
    struct store *store;
    struct snapshot *snapshot;
    struct source *source;
};

int modbus_case_set_up(void **state); /* set-up for cmocka: *state is a struct modbus_case, whose store has room for 300 tags */
int modbus_case_tear_down(void **state);
void modbus_case_be_impatient(struct modbus_case *c);              /* shortens timeouts, for devices that make the source wait */
void modbus_case_add_registers(struct modbus_case *c, int count);  /* adds holding registers 0, 1, ... as INT16 tags */
void modbus_case_start(struct modbus_case *c); /* starts the source */
void modbus_case_serve(struct modbus_case *c); /* starts the device, then the source */
void modbus_case_assert_stops_soon(struct modbus_case *c);
const struct reading *modbus_case_look(struct modbus_case *c, int tag);
/* Waits until the tag has this quality. */
void modbus_case_expect(struct modbus_case *c, int tag, uint32_t quality, double timeout_s);

#endif
