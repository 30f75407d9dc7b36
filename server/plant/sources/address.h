/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses Modbus addresses, data types and byte orders in the notation of tag lists (TAGS.md). Call from any thread. */
#ifndef PLANT_SOURCES_ADDRESS_H
#define PLANT_SOURCES_ADDRESS_H
#include <stdbool.h>

#include "plant/plant.h"

struct modbus_address {
    int unit; /* Modbus unit identifier in the address; -1: not stated */
    enum register_table table;
    int index;                  /* number of the first register, counted from 0 as in Modbus messages */
    int bit;                    /* bit number 0 to 15; -1: the whole register */
    enum byte_order byte_order; /* byte order; NONE: not stated */
};

/* Parses an address. address_base: the number of the first register in plain addresses, 0 or 1. Returns false on errors, with the
   expected form in `why`. */
bool address_parse(const char *text, int address_base, struct modbus_address *out, char why[200]);

/* Parses the name of a data type: ours, or Kepware's except "Default". Returns false for other texts. */
bool data_type_parse(const char *text, enum data_type *out);
extern const char data_type_all[];               /* names of all data types, "bool, int16, ...", for error messages */
const char *data_type_suggest(const char *text); /* Returns the name of the data type most similar to a wrong name, or NULL. */
const char *data_type_name(enum data_type type); /* Returns our name of a type, such as "int16" or "float32". */
int data_type_registers(enum data_type type);    /* Returns the number of registers of a type: 1, 2 or 4. */
bool byte_order_parse(const char *text, enum byte_order *out);

#endif
