/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses Modbus addresses, data types and byte orders as tag lists write them (PLANT.md). Thread: any. */
#ifndef PLANT_SOURCES_ADDRESS_H
#define PLANT_SOURCES_ADDRESS_H
#include <stdbool.h>

#include "plant/plant.h"

struct modbus_address {
    int unit;                   /* -1: not stated */
    enum register_table table;
    int index;                  /* from 0, as on the wire */
    int bit;                    /* 0..15, or -1 */
    enum byte_order byte_order; /* NONE: not stated */
};

/* Parses an address. address_base: the number of the first register in plain addresses, 0 or 1. Returns false on errors, with what was
   expected in why. */
bool address_parse(const char *text, int address_base, struct modbus_address *out, char why[200]);

bool data_type_parse(const char *text, enum data_type *out); /* accepts our names and those of Kepware, not "Default" */
extern const char data_type_all[];                           /* "bool, int16, ...", for messages */
const char *data_type_suggest(const char *text);             /* returns the most similar name, or NULL */
const char *data_type_name(enum data_type type);             /* returns our name: "int16", "float32", ... */
int data_type_registers(enum data_type type);                /* returns how many registers it takes: 1, 2 or 4 */
bool byte_order_parse(const char *text, enum byte_order *out);

#endif
