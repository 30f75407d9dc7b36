/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses Modbus addresses of the form [UNIT!]ADDRESS[.BIT][#ORDER], and the names of data types. */
#include "plant/sources/address.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "plant/parse/suggest.h"

#define COUNT(array) (sizeof(array) / sizeof(*(array)))

struct type_name {
    const char *name;
    enum data_type type;
};

/* Names of data types: for each type, our own name and then Kepware's, if its tag lists use another. */
static const struct type_name type_names[] = {
    { "bool", DATA_BIT },      { "boolean", DATA_BIT },     { "bit", DATA_BIT },        { "int16", DATA_INT16 },
    { "short", DATA_INT16 },   { "uint16", DATA_UINT16 },   { "word", DATA_UINT16 },    { "int32", DATA_INT32 },
    { "long", DATA_INT32 },    { "uint32", DATA_UINT32 },   { "dword", DATA_UINT32 },   { "float32", DATA_FLOAT32 },
    { "float", DATA_FLOAT32 }, { "int64", DATA_INT64 },     { "llong", DATA_INT64 },    { "uint64", DATA_UINT64 },
    { "qword", DATA_UINT64 },  { "float64", DATA_FLOAT64 }, { "double", DATA_FLOAT64 }, { "bcd", DATA_BCD },
    { "lbcd", DATA_LBCD },
};

const char data_type_all[] = "bool, int16, uint16, int32, uint32, float32, int64, uint64, float64, bcd, lbcd, or Kepware's names";

bool data_type_parse(const char *text, enum data_type *out)
{
    for (size_t i = 0; i < COUNT(type_names); i++)
        if (!strcasecmp(text, type_names[i].name)) {
            *out = type_names[i].type;
            return true;
        }
    return false;
}

const char *data_type_suggest(const char *text)
{
    return suggest_nearest(text, type_names, COUNT(type_names), sizeof(*type_names));
}

const char *data_type_name(enum data_type type)
{
    for (size_t i = 0; i < COUNT(type_names); i++)
        if (type_names[i].type == type)
            return type_names[i].name;
    return "unknown";
}

int data_type_registers(enum data_type type)
{
    switch (type) {
    case DATA_INT32:
    case DATA_UINT32:
    case DATA_FLOAT32:
    case DATA_LBCD: return 2;
    case DATA_INT64:
    case DATA_UINT64:
    case DATA_FLOAT64: return 4;
    case DATA_BIT:
    case DATA_INT16:
    case DATA_UINT16:
    case DATA_BCD: break;
    }
    return 1;
}

bool byte_order_parse(const char *text, enum byte_order *out)
{
    static const struct {
        const char *name, *suffix; /* name of the byte order, and the letters after # that state it in a Modbus address */
        enum byte_order order;
    } orders[] = {
        { "ABCD", "LL", BYTE_ORDER_ABCD },
        { "CDAB", "BL", BYTE_ORDER_CDAB },
        { "BADC", "LB", BYTE_ORDER_BADC },
        { "DCBA", "BB", BYTE_ORDER_DCBA },
    };
    for (size_t i = 0; i < COUNT(orders); i++)
        if (!strcasecmp(text, orders[i].name) || !strcasecmp(text, orders[i].suffix)) {
            *out = orders[i].order;
            return true;
        }
    return false;
}

/* Reads decimal digits, at most 6. Returns their number, or 7 if there are more than 6. */
static int read_digits(const char **p, long *value)
{
    int count = 0;
    *value = 0;
    for (; **p >= '0' && **p <= '9'; (*p)++) {
        if (count < 7)
            count++;
        if (count <= 6)
            *value = *value * 10 + (**p - '0');
    }
    return count;
}

/* Parses an address that names its Modbus table, such as hr:0 for holding registers. Its register number counts from 0, as in
   Modbus messages. Returns false with the reason in `why` if the text is not such an address. */
static bool read_named_table(const char **p, struct modbus_address *out, char why[200])
{
    static const struct {
        const char *prefix;
        enum register_table table;
    } names[] = { { "co:", TABLE_COIL }, { "di:", TABLE_DISCRETE }, { "ir:", TABLE_INPUT }, { "hr:", TABLE_HOLDING } };
    size_t i = 0;
    while (i < COUNT(names) && strncasecmp(*p, names[i].prefix, 3) != 0)
        i++;
    if (i == COUNT(names)) {
        snprintf(why, 200,
                 "expected a Modbus address of 5 or 6 digits such as 40001 or 400001, or co:, di:, ir: or hr: and a number from 0");
        return false;
    }
    long index;
    *p += 3;
    int digits = read_digits(p, &index);
    if (digits == 0 || digits > 6 || index > 65535) {
        snprintf(why, 200, "expected the number of a Modbus register or bit, 0 to 65535, after %s", names[i].prefix);
        return false;
    }
    out->table = names[i].table;
    out->index = (int)index;
    return true;
}

/* Parses 40001 and 400001: the first digit selects the Modbus table, the other digits are the register number, counted from
   address_base. Returns false with the reason in `why` if the text is not such an address. */
static bool read_digit_table(const char **p, int address_base, struct modbus_address *out, char why[200])
{
    static const enum register_table tables[] = { TABLE_COIL, TABLE_DISCRETE, 0, TABLE_INPUT, TABLE_HOLDING }; /* by first digit */
    char first = **p;
    long number;
    int digits = read_digits(p, &number);
    if (digits != 5 && digits != 6) {
        snprintf(why, 200, "this Modbus address has %d%s digit%s; expected 5 or 6 such as 40001 or 400001 (or hr:0, counted from 0)",
                 digits > 6 ? 6 : digits, digits > 6 ? " and more" : "", digits == 1 ? "" : "s");
        return false;
    }
    if (!strchr("0134", first)) {
        snprintf(why, 200,
                 "this Modbus address begins with %c; expected 0 (coil), 1 (discrete input), 3 (input register) or 4 (holding register)",
                 first);
        return false;
    }
    long index = number - (first - '0') * (digits == 5 ? 10000L : 100000L) - address_base;
    if (index < 0 || index > 65535) {
        snprintf(why, 200, "expected a register number from %d to %d after the first digit of this Modbus address (address_base is %d)",
                 address_base, 65535 + address_base, address_base);
        return false;
    }
    out->table = tables[first - '0'];
    out->index = (int)index;
    return true;
}

static bool read_unit(const char **p, struct modbus_address *out, char why[200])
{
    const char *end = *p;
    long unit;
    if (!strchr(*p, '!'))
        return true;
    int digits = read_digits(&end, &unit);
    if (digits == 0 || *end != '!' || unit > 255 || digits > 6) {
        snprintf(why, 200, "expected a Modbus unit number from 0 to 255 before the character !");
        return false;
    }
    out->unit = (int)unit;
    *p = end + 1;
    return true;
}

static bool read_bit(const char **p, struct modbus_address *out, char why[200])
{
    long bit;
    if (**p != '.')
        return true;
    (*p)++;
    int digits = read_digits(p, &bit);
    if (digits == 0 || digits > 6 || bit > 15) {
        snprintf(why, 200, "expected the number of a bit in the register, 0 to 15, after the point of this Modbus address");
        return false;
    }
    if (out->table == TABLE_COIL || out->table == TABLE_DISCRETE) {
        snprintf(why, 200, "a %s is a single bit: omit .%ld, which would select a bit of a register",
                 out->table == TABLE_COIL ? "coil" : "discrete input", bit);
        return false;
    }
    out->bit = (int)bit;
    return true;
}

static bool read_order(const char **p, struct modbus_address *out, char why[200])
{
    if (**p != '#')
        return true;
    if (!byte_order_parse(*p + 1, &out->byte_order)) {
        snprintf(why, 200, "expected the byte order #LL (ABCD), #BL (CDAB), #LB (BADC) or #BB (DCBA) at the end of this Modbus address");
        return false;
    }
    *p += strlen(*p);
    return true;
}

bool address_parse(const char *text, int address_base, struct modbus_address *out, char why[200])
{
    const char *p = text;
    *out = (struct modbus_address){ .unit = -1, .bit = -1 };
    if (!read_unit(&p, out, why))
        return false;
    if (!(*p >= '0' && *p <= '9' ? read_digit_table(&p, address_base, out, why) : read_named_table(&p, out, why)))
        return false;
    if (!read_bit(&p, out, why) || !read_order(&p, out, why))
        return false;
    if (*p) {
        snprintf(why, 200, "this Modbus address is complete after '%.*s', but '%.40s' follows", p - text > 40 ? 40 : (int)(p - text), text,
                 p);
        return false;
    }
    return true;
}
