/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Registers of a simulated device by Modbus unit identifier and register table, with a flag for each register that exists. */
#include "sim_image.h"

#include "base/mem.h"
#include "sim_encode.h"

enum { REGISTERS = 65536, TABLES = 4 };

struct sim_unit {
    modbus_mapping_t *mapping;
    uint8_t exists[TABLES][REGISTERS];
    uint8_t failing[TABLES][REGISTERS];
};

void sim_image_finish(struct sim_image *image)
{
    for (int i = 0; i < 256; i++) {
        if (image->units[i])
            modbus_mapping_free(image->units[i]->mapping);
        mem_free(image->units[i]);
        image->units[i] = NULL;
    }
}

void sim_image_add(struct sim_image *image, int unit, const struct plant_tag *tag)
{
    if (!image->units[unit]) {
        image->units[unit] = mem_new(sizeof(struct sim_unit));
        image->units[unit]->mapping = modbus_mapping_new(REGISTERS, REGISTERS, REGISTERS, REGISTERS);
    }
    for (int i = 0; i < sim_encode_width(tag); i++)
        image->units[unit]->exists[tag->signal.table][tag->signal.register_index + i] = 1;
}

bool sim_image_set(struct sim_image *image, int unit, const struct plant_tag *tag, double value)
{
    modbus_mapping_t *mapping = image->units[unit]->mapping;
    int at = tag->signal.register_index;
    uint16_t bit;
    uint8_t *bits = tag->signal.table == TABLE_COIL ? mapping->tab_bits : mapping->tab_input_bits;
    if (tag->signal.table == TABLE_INPUT)
        return sim_encode(tag, value, mapping->tab_input_registers + at);
    if (tag->signal.table == TABLE_HOLDING)
        return sim_encode(tag, value, mapping->tab_registers + at);
    bit = bits[at];
    bool held = sim_encode(tag, value, &bit);
    bits[at] = (uint8_t)bit;
    return held;
}

void sim_image_fail(struct sim_image *image, int unit, const struct plant_tag *tag, bool failing)
{
    for (int i = 0; i < sim_encode_width(tag); i++)
        image->units[unit]->failing[tag->signal.table][tag->signal.register_index + i] = failing;
}

int sim_image_refusal(const struct sim_image *image, int unit_id, enum register_table table, int first, int count)
{
    const struct sim_unit *unit = image->units[unit_id];
    int limit = table == TABLE_COIL || table == TABLE_DISCRETE ? MODBUS_MAX_READ_BITS : MODBUS_MAX_READ_REGISTERS;
    if (!unit)
        return MODBUS_EXCEPTION_GATEWAY_TARGET;
    if (count < 1 || count > limit)
        return MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
    if (first + count > REGISTERS)
        return MODBUS_EXCEPTION_ILLEGAL_DATA_ADDRESS;
    for (int i = first; i < first + count; i++)
        if (!unit->exists[table][i] || unit->failing[table][i])
            return MODBUS_EXCEPTION_ILLEGAL_DATA_ADDRESS;
    return 0;
}

modbus_mapping_t *sim_image_mapping(struct sim_image *image, int unit)
{
    return image->units[unit]->mapping;
}
