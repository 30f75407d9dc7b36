/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads from a tag's row the address of the value in the device, its data type, and its conversion to engineering units. */
#include "plant/tags/tag_wire.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "plant/parse/number.h"
#include "plant/plant_impl.h"
#include "plant/sources/address.h"
#include "plant/sources/mqtt_address.h"
#include "plant/sources/opcua_address.h"
#include "plant/tags/tag_links.h"

struct tag_wire {
    const struct plant *plant;
    struct tag_columns *columns;
    struct plant_tag *tag;
};

/* --- address and type ------------------------------------------------------------------------------------------------------------ */

/* Reads the byte order that a tag's row states in a column or in the address. Returns false after an error (reported). */
static bool read_stated_order(struct tag_wire *wire, const struct modbus_address *address, enum byte_order *out)
{
    const char *text = cell_text(wire->columns, COL_BYTE_ORDER);
    *out = address->byte_order;
    if (!*text)
        return true;
    if (!byte_order_parse(text, out)) {
        cell_error(wire->columns, COL_BYTE_ORDER, "Byte Order: expected ABCD, CDAB, BADC or DCBA, found '%.60s'", text);
        return false;
    }
    if (address->byte_order && *out != address->byte_order) {
        cell_error(wire->columns, COL_BYTE_ORDER, "Byte Order: '%s' contradicts the address '%.60s'", text, wire->tag->signal.address);
        return false;
    }
    return true;
}

static void read_byte_order(struct tag_wire *wire, const struct modbus_address *address)
{
    struct plant_tag *tag = wire->tag;
    enum byte_order order;
    if (!read_stated_order(wire, address, &order))
        return;
    int registers = tag->signal.type == DATA_BIT ? 1 : data_type_registers(tag->signal.type);
    if (!order && registers > 1 && tag->source >= 0)
        order = wire->plant->sources[tag->source].byte_order;
    tag->signal.byte_order = order;
    if (order || registers == 1)
        return;
    enum tag_column column = wire->columns->at[COL_BYTE_ORDER] >= 0 ? COL_BYTE_ORDER : COL_DATA_TYPE;
    cell_error(wire->columns, column,
               "Byte Order: %s has %d bits, so a byte order is required: ABCD, CDAB, BADC or DCBA here, or byte_order in the tag's source",
               data_type_name(tag->signal.type), registers * 16);
}

/* Reads the data type. Kepware's "Default" means Word, or Boolean if the address is one bit. Returns false after an error (reported). */
static bool read_type(struct tag_wire *wire, const struct modbus_address *address)
{
    struct plant_tag *tag = wire->tag;
    const char *text = cell_text(wire->columns, COL_DATA_TYPE);
    bool one_bit = address->table == TABLE_COIL || address->table == TABLE_DISCRETE || address->bit >= 0;
    tag->signal.type = one_bit ? DATA_BIT : DATA_UINT16;
    if (!*text || !strcasecmp(text, "Default"))
        return true;
    if (!data_type_parse(text, &tag->signal.type)) {
        const char *near = data_type_suggest(text);
        if (near)
            cell_error(wire->columns, COL_DATA_TYPE, "Data Type: unknown type '%.60s'; did you mean '%s'?", text, near);
        else
            cell_error(wire->columns, COL_DATA_TYPE, "Data Type: unknown type '%.60s'; expected one of: %s", text, data_type_all);
        return false;
    }
    if (one_bit && tag->signal.type != DATA_BIT)
        cell_error(wire->columns, COL_DATA_TYPE, "Data Type: expected Boolean, because '%.60s' is a single bit, found '%s'",
                   tag->signal.address, text);
    else if (!one_bit && tag->signal.type == DATA_BIT)
        cell_error(wire->columns, COL_ADDRESS, "Address: expected a bit such as %.60s.0, because the type is %s", tag->signal.address,
                   text);
    return one_bit == (tag->signal.type == DATA_BIT);
}

/* Returns true if the value at the tag's address is already a number in engineering units, because it comes from a file or is computed from
   other tags. */
static bool is_number(const struct tag_wire *wire)
{
    const char *kind = wire->tag->source >= 0 ? wire->plant->sources[wire->tag->source].kind : NULL;
    return tag_is_derived(wire->columns) || (kind && !strcmp(kind, "replay"));
}

/* Reports a plain address of a multi-register value if its source does not state address_base. A value read from the next
   register by mistake may still look plausible. */
static void check_base(struct tag_wire *wire, int registers)
{
    struct plant_tag *tag = wire->tag;
    const char *bang = strchr(tag->signal.address, '!'), *place = bang ? bang + 1 : tag->signal.address;
    if (registers == 1 || !(*place >= '0' && *place <= '9') || tag->source < 0 || wire->plant->sources[tag->source].base_stated)
        return;
    cell_error(wire->columns, COL_ADDRESS,
               "Address: '%.60s': %s has %d bits, so state whether registers are counted from 0 or 1: by address_base in the source, or "
               "here by %s:%d (from 0, as on the wire; %s:%d if registers are counted from 0)",
               tag->signal.address, data_type_name(tag->signal.type), registers * 16, tag->signal.table == TABLE_INPUT ? "ir" : "hr",
               tag->signal.register_index, tag->signal.table == TABLE_INPUT ? "ir" : "hr", tag->signal.register_index + 1);
}

static bool comes_from(const struct tag_wire *wire, const char *kind)
{
    const char *its_kind = wire->tag->source >= 0 ? wire->plant->sources[wire->tag->source].kind : NULL;
    return !tag_is_derived(wire->columns) && its_kind && !strcmp(its_kind, kind);
}

/* Reads type and address of a value published over MQTT or OPC UA. The type is a number, unless the row states bool. */
static void read_published(struct tag_wire *wire)
{
    struct plant_tag *tag = wire->tag;
    const char *text = cell_text(wire->columns, COL_DATA_TYPE);
    char why[200];
    tag->signal.type = DATA_FLOAT64;
    if (*text && strcasecmp(text, "Default") != 0 && !data_type_parse(text, &tag->signal.type))
        cell_error(wire->columns, COL_DATA_TYPE, "Data Type: unknown type '%.60s'; expected one of: %s", text, data_type_all);
    bool is_opcua = comes_from(wire, "opcua");
    if (is_opcua ? !opcua_address_resolve(wire->plant, tag, why) : !mqtt_address_resolve(wire->plant, tag, why))
        cell_error(wire->columns, COL_ADDRESS, "Address: '%.60s': %s", tag->signal.address, why);
}

static void read_address(struct tag_wire *wire)
{
    struct plant_tag *tag = wire->tag;
    struct modbus_address address;
    char why[200];
    tag->signal.address = mem_strdup(cell_text(wire->columns, COL_ADDRESS));
    if (is_number(wire)) {
        tag->signal.type = DATA_FLOAT64;
        return;
    }
    if (comes_from(wire, "mqtt") || comes_from(wire, "opcua")) {
        read_published(wire);
        return;
    }
    if (!*tag->signal.address) {
        if (tag->source >= 0 && wire->columns->at[COL_ADDRESS] >= 0)
            cell_error(wire->columns, COL_ADDRESS, "Address: expected the address of a register, such as 400001 or hr:0");
        return;
    }
    int base = tag->source >= 0 ? wire->plant->sources[tag->source].address_base : 1;
    if (!address_parse(tag->signal.address, base, &address, why)) {
        cell_error(wire->columns, COL_ADDRESS, "Address: '%.60s': %s", tag->signal.address, why);
        return;
    }
    tag->signal.modbus_unit = address.unit;
    tag->signal.table = address.table;
    tag->signal.register_index = address.index;
    tag->signal.bit = address.bit;
    if (!read_type(wire, &address))
        return;
    read_byte_order(wire, &address);
    int registers = data_type_registers(tag->signal.type);
    check_base(wire, registers);
    if (address.index + registers > 65536)
        cell_error(wire->columns, COL_ADDRESS, "Address: '%.60s': %s needs %d registers, but the last register is 65535",
                   tag->signal.address, data_type_name(tag->signal.type), registers);
}

static const char *kind_of_number(const struct tag_wire *wire)
{
    return tag_is_derived(wire->columns) ? "derived" : "replayed";
}

/* --- scaling ---------------------------------------------------------------------------------------------------------------- */

static void read_range(struct tag_wire *wire, enum tag_column low, enum tag_column high, double *out_low, double *out_high)
{
    int errors = wire->columns->csv.diag->errors;
    bool has_low = cell_number(wire->columns, low, -PLANT_MAX_VALUE, PLANT_MAX_VALUE, out_low);
    bool has_high = cell_number(wire->columns, high, -PLANT_MAX_VALUE, PLANT_MAX_VALUE, out_high);
    if (errors != wire->columns->csv.diag->errors)
        return;
    enum tag_column missing = has_low ? high : low;
    if ((!has_low || !has_high) && wire->tag->scale.kind == SCALING_NONE)
        cell_error(wire->columns, missing, "%s: expected a number, because %s is given", tag_column_name(missing),
                   tag_column_name(has_low ? low : high));
    else if (!has_low || !has_high)
        cell_error(wire->columns, missing, "%s: expected a number, because Scaling is %s", tag_column_name(missing),
                   cell_text(wire->columns, COL_SCALING));
    else if (*out_low >= *out_high)
        cell_error(wire->columns, low, "%s: expected less than %s, which is %.9g, found %.9g", tag_column_name(low), tag_column_name(high),
                   *out_high, *out_low);
}

static void read_scaling(struct tag_wire *wire)
{
    struct plant_tag *tag = wire->tag;
    const char *text = cell_text(wire->columns, COL_SCALING);
    if (!strcasecmp(text, "Linear"))
        tag->scale.kind = SCALING_LINEAR;
    else if (!strcasecmp(text, "Square Root"))
        tag->scale.kind = SCALING_SQUARE_ROOT;
    else if (*text && strcasecmp(text, "None") != 0)
        cell_error(wire->columns, COL_SCALING, "Scaling: expected None, Linear or Square Root, found '%.60s'", text);
    if (tag->scale.kind != SCALING_NONE && is_number(wire))
        cell_error(wire->columns, COL_SCALING, "Scaling: expected None, because the value is already in engineering units");
    tag->scale.has_range =
        tag->scale.kind != SCALING_NONE || cell_given(wire->columns, COL_SCALED_LOW) || cell_given(wire->columns, COL_SCALED_HIGH);
    if (tag->scale.kind != SCALING_NONE)
        read_range(wire, COL_RAW_LOW, COL_RAW_HIGH, &tag->scale.raw_low, &tag->scale.raw_high);
    else if (!*text && cell_given(wire->columns, COL_RAW_LOW) && cell_given(wire->columns, COL_SCALED_LOW))
        cell_warning(wire->columns, COL_RAW_LOW, "Scaling is blank, so the raw range has no effect; write Linear or None");
    if (tag->scale.has_range)
        read_range(wire, COL_SCALED_LOW, COL_SCALED_HIGH, &tag->scale.scaled_low, &tag->scale.scaled_high);
    tag->scale.negate = cell_flag(wire->columns, COL_NEGATE);
    if (tag->scale.negate && is_number(wire))
        cell_warning(wire->columns, COL_NEGATE, "Negate Value has no effect on '%.60s': the value of a %s tag is in engineering units",
                     tag->name, kind_of_number(wire));
    for (enum tag_column clamp = COL_CLAMP_LOW; clamp <= COL_CLAMP_HIGH; clamp++)
        if (cell_flag(wire->columns, clamp))
            cell_warning(wire->columns, clamp, "%s has no effect: values beyond the range are marked as out of range",
                         tag_column_name(clamp));
}

/* --- values that mean "no sensor" ------------------------------------------------------------------------------------------- */

static void read_ne43(struct tag_wire *wire)
{
    struct plant_tag *tag = wire->tag;
    tag->scale.ne43 = cell_flag(wire->columns, COL_NE43);
    if (tag->scale.ne43 && tag->scale.kind == SCALING_NONE)
        cell_error(wire->columns, COL_NE43, "NE 43: requires Scaling to be Linear or Square Root, with Raw Low 4 mA and Raw High 20 mA");
}

/* Parses a sentinel: 0x8000 is compared bit by bit, -32768 or 1.5e3 as a number. Returns false if the text is neither. */
static bool read_sentinel(const char *text, struct plant_sentinel *out)
{
    char *end;
    out->is_bits = !strncasecmp(text, "0x", 2);
    if (!out->is_bits)
        return number_parse(text, &out->number) == NUMBER_GOOD;
    out->bits = strtoull(text + 2, &end, 16);
    return text[2] && !*end && strspn(text + 2, "0123456789abcdefABCDEF") <= 16;
}

static void read_sentinels(struct tag_wire *wire)
{
    char *texts = mem_strdup(cell_text(wire->columns, COL_OPEN_CIRCUIT)), *rest = texts;
    struct plant_tag *tag = wire->tag;
    for (const char *text; (text = strtok_r(rest, " |", &rest));)
        if (tag->scale.sentinel_count == PLANT_SENTINELS || !read_sentinel(text, &tag->scale.sentinels[tag->scale.sentinel_count++])) {
            cell_error(wire->columns, COL_OPEN_CIRCUIT,
                       "Open Circuit: expected at most %d raw values such as 0x8000 or -32768, found '%.60s'", PLANT_SENTINELS, text);
            break;
        }
    if (tag->scale.sentinel_count && is_number(wire))
        cell_warning(wire->columns, COL_OPEN_CIRCUIT, "Open Circuit has no effect on '%.60s': a %s tag has no raw value", tag->name,
                     kind_of_number(wire));
    mem_free(texts);
}

/* --- deadbands of OPC UA nodes ------------------------------------------------------------------------------------------------ */

/* Reads a deadband: 0.5 (in the node's unit) or 2% (of the node's EURange). */
static void read_opc_deadband(struct tag_wire *wire)
{
    struct plant_tag *tag = wire->tag;
    struct opcua_deadband deadband = { .value = NAN };
    const char *text = cell_text(wire->columns, COL_OPC_DEADBAND);
    size_t length = strlen(text);
    tag->signal.opcua_deadband = deadband;
    if (length == 0)
        return;
    if (!comes_from(wire, "opcua")) {
        cell_warning(wire->columns, COL_OPC_DEADBAND, "OPC Deadband has no effect on '%.60s': the tag's source is not of type opcua",
                     tag->name);
        return;
    }
    deadband.percent = text[length - 1] == '%';
    length -= deadband.percent;
    while (length > 0 && text[length - 1] == ' ')
        length--;
    char *number = mem_printf("%.*s", (int)length, text);
    bool good = number_parse(number, &deadband.value) == NUMBER_GOOD && deadband.value >= 0 &&
                deadband.value <= (deadband.percent ? 100 : PLANT_MAX_VALUE);
    mem_free(number);
    if (!good)
        cell_error(wire->columns, COL_OPC_DEADBAND,
                   "OPC Deadband: expected a number from 0 in the node's unit, such as 0.5, or a percentage of its EURange, such as 2%%; "
                   "found '%.60s'",
                   text);
    else if (deadband.value > 0 && tag->signal.type == DATA_BIT)
        cell_error(wire->columns, COL_OPC_DEADBAND, "OPC Deadband: a value of Data Type bool cannot have a deadband");
    else
        tag->signal.opcua_deadband = deadband;
}

void tag_wire_read(struct tag_columns *columns, const struct plant *plant, struct plant_tag *tag)
{
    struct tag_wire wire = { plant, columns, tag };
    read_address(&wire);
    read_scaling(&wire);
    read_ne43(&wire);
    read_sentinels(&wire);
    read_opc_deadband(&wire);
}
