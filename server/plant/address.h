/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Modbus addresses, data types and byte orders as tag lists write them (PLANT.md). Thread: any. */
#ifndef PLANT_ADDRESS_H
#define PLANT_ADDRESS_H
#include <stdbool.h>

#include "plant/plant.h"

struct modbus_address {
    int unit;                   /* -1: not stated */
    enum register_table table;
    int index;                  /* from 0, as on the wire */
    int bit;                    /* 0..15, or -1 */
    enum byte_order byte_order; /* NONE: not stated */
};

/* address_base: what the first register is called in plain addresses, 0 or 1. False: why[] says what was expected. */
bool address_parse(const char *text, int address_base, struct modbus_address *out, char why[200]);

bool data_type_parse(const char *text, enum data_type *out); /* ours and Kepware's names; not "Default" */
extern const char data_type_all[];                           /* "bool, int16, ...", for messages */
const char *data_type_suggest(const char *text);             /* the nearest name, or NULL */
const char *data_type_name(enum data_type type);             /* ours: "int16", "float32", ... */
int data_type_registers(enum data_type type);                /* 1, 2 or 4 */
bool byte_order_parse(const char *text, enum byte_order *out);

#endif
