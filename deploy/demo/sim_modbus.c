/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Processes one Modbus request at a time: this file checks it, libmodbus makes the reply. */
#include "sim_modbus.h"

enum { HEADER_BYTES = 7, LENGTH_AT = 4, UNIT_AT = 6, FUNCTION_AT = 7, FIRST_AT = 8, COUNT_AT = 10, READ_BYTES = 12 };

bool sim_modbus_init(struct sim_modbus *device)
{
    /* this context only makes replies and never connects */
    *device = (struct sim_modbus){ .modbus = modbus_new_tcp("127.0.0.1", MODBUS_TCP_DEFAULT_PORT) };
    return device->modbus != NULL;
}

void sim_modbus_finish(struct sim_modbus *device)
{
    if (device->modbus)
        modbus_free(device->modbus);
    device->modbus = NULL;
    sim_image_finish(&device->image);
}

static int word_at(const uint8_t *bytes, int at)
{
    return bytes[at] << 8 | bytes[at + 1];
}

static bool is_write(int function)
{
    return function == MODBUS_FC_WRITE_SINGLE_COIL || function == MODBUS_FC_WRITE_SINGLE_REGISTER ||
           function == MODBUS_FC_WRITE_MULTIPLE_COILS || function == MODBUS_FC_WRITE_MULTIPLE_REGISTERS ||
           function == MODBUS_FC_MASK_WRITE_REGISTER || function == MODBUS_FC_WRITE_AND_READ_REGISTERS;
}

static int refusal(struct sim_modbus *device, const uint8_t *request, size_t bytes)
{
    static const enum register_table tables[] = { [1] = TABLE_COIL, [2] = TABLE_DISCRETE, [3] = TABLE_HOLDING, [4] = TABLE_INPUT };
    int function = request[FUNCTION_AT];
    device->writes_refused += is_write(function);
    if (function < 1 || function > 4)
        return MODBUS_EXCEPTION_ILLEGAL_FUNCTION;
    if (bytes != READ_BYTES)
        return MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
    return sim_image_refusal(&device->image, request[UNIT_AT], tables[function], word_at(request, FIRST_AT), word_at(request, COUNT_AT));
}

static int answer(struct sim_modbus *device, int fd, const uint8_t *request, size_t bytes)
{
    int code = refusal(device, request, bytes);
    modbus_set_socket(device->modbus, fd);
    if (code) {
        device->refusals++;
        return modbus_reply_exception(device->modbus, request, (unsigned)code);
    }
    device->reads++;
    return modbus_reply(device->modbus, request, (int)bytes, sim_image_mapping(&device->image, request[UNIT_AT]));
}

ssize_t sim_modbus_take(void *arg, int fd, const uint8_t *bytes, size_t count)
{
    struct sim_modbus *device = arg;
    if (count < HEADER_BYTES)
        return 0;
    size_t length = 6 + (size_t)word_at(bytes, LENGTH_AT);
    if (word_at(bytes, 2) != 0 || length <= HEADER_BYTES || length > MODBUS_TCP_MAX_ADU_LENGTH)
        return -1; /* close the connection: the bytes are not Modbus TCP */
    if (count < length)
        return 0;
    if (!device->paused && answer(device, fd, bytes, length) < 0)
        return -1;
    return (ssize_t)length;
}
