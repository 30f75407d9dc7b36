/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast tags --probe`: prints what a field device has at one address, in every type and byte order. It never writes to the device. */
#include <modbus.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/log/log.h"
#include "clients/cli/commands.h"
#include "plant/sources/address.h"
#include "value/decode.h"
#include "value/modbus_link.h"
#include "value/quality.h"

enum { MAX_REGISTERS = 4 }; /* number of registers that a 64-bit value takes */

static const enum byte_order orders[] = { BYTE_ORDER_ABCD, BYTE_ORDER_CDAB, BYTE_ORDER_BADC, BYTE_ORDER_DCBA };
static const char *const prefixes[] = { [TABLE_COIL] = "co", [TABLE_DISCRETE] = "di", [TABLE_INPUT] = "ir", [TABLE_HOLDING] = "hr" };

/* Parses HOST, HOST:PORT, [ADDRESS]:PORT or /dev/LINE. host: receives the host name. Returns false for other text. */
static bool read_device(const char *text, struct plant_source *source, char host[256])
{
    const char *colon = strrchr(text, ':'), *end = colon && strchr(text, ':') == colon ? colon : text + strlen(text);
    *source = (struct plant_source){
        .id = "probe", .port = 502, .unit = 1, .timeout_ms = 2000, .baud = 19200, .parity = 'E', .stop_bits = 1
    };
    source->transport = *text == '/' ? TRANSPORT_RTU : TRANSPORT_TCP;
    source->device = (char *)text;
    if (*text == '[' && colon && colon > text + 1 && colon[-1] == ']') {
        text++;
        end = colon - 1;
    }
    if (*end)
        source->port = atoi(colon + 1);
    snprintf(host, 256, "%.*s", (int)(end - text), text);
    source->hosts[0] = host;
    source->host_count = 1;
    return *host && source->port >= 1 && source->port <= 65535;
}

static void print_value(enum data_type type, enum byte_order order, const uint16_t *words, int width)
{
    struct plant_tag tag = { .signal.table = TABLE_HOLDING, .signal.bit = -1, .signal.type = type, .signal.byte_order = order };
    struct sample sample;
    decode_sample(&tag, words, &sample);
    if (quality_is_bad(sample.quality))
        printf(" %*s", width, "-");
    else
        printf(" %*.*g", width, type == DATA_FLOAT32 ? 8 : 17, sample.value);
}

static void print_registers(const uint16_t *words, int count)
{
    printf("registers");
    for (int i = 0; i < count; i++)
        printf(" %04X", words[i]);
    printf("\nbits 15-0");
    for (int bit = 15; bit >= 0; bit--)
        printf("%s%d", bit % 4 == 3 ? " " : "", words[0] >> bit & 1);
    printf("\n\n%-9s %24s %24s %24s %24s\n", "type", "ABCD", "CDAB", "BADC", "DCBA");
    for (enum data_type type = DATA_INT16; type <= DATA_LBCD; type++) {
        if (data_type_registers(type) > count)
            continue;
        printf("%-9s", data_type_name(type));
        for (int i = 0; i < 4; i++)
            print_value(type, orders[i], words, 24);
        putchar('\n');
    }
}

/* Returns how many registers (4, 2 or 1) the device returns at this address in one request; 0: none, with the reason in *status. */
static int read_most(struct modbus_link *link, int unit, const struct modbus_address *at, uint16_t words[MAX_REGISTERS], int *status)
{
    bool bits = at->table == TABLE_COIL || at->table == TABLE_DISCRETE;
    for (int count = bits ? 1 : MAX_REGISTERS; count > 0; count /= 2) {
        *status = at->index + count > 65536 ? MODBUS_EXCEPTION_ILLEGAL_DATA_ADDRESS
                                            : modbus_link_read(link, unit, at->table, at->index, count, words);
        /* reconnects and reads again, because some devices close the connection after an error */
        if (*status < 0 && modbus_link_answers(link) > 0 && modbus_link_open(link) == 0)
            *status = modbus_link_read(link, unit, at->table, at->index, count, words);
        if (*status == 0)
            return count;
        if (*status < 0)
            return 0;
    }
    return 0;
}

static int probe(struct log *log, const struct plant_source *source, const struct modbus_address *at, int stop_fd)
{
    uint16_t words[MAX_REGISTERS] = { 0 };
    int unit = at->unit >= 0 ? at->unit : source->unit;
    struct modbus_link *link = modbus_link_create(log, source, stop_fd);
    if (!link)
        return 1;
    modbus_link_allow_any_unit(link, true);
    int status = modbus_link_open(link), count = status ? 0 : read_most(link, unit, at, words, &status);
    if (status < 0)
        fprintf(stderr, "plantcast: %s: %s\n", modbus_link_name(link), strerror(-status));
    else if (status > 0)
        fprintf(stderr, "plantcast: device %s: unit %d refused the request to read address %s:%d: %s\n", modbus_link_name(link), unit,
                prefixes[at->table], at->index, modbus_strerror(MODBUS_ENOBASE + status));
    if (count > 0)
        printf("%s, unit %d, %s:%d\n", modbus_link_name(link), unit, prefixes[at->table], at->index);
    if (count > 0 && (at->table == TABLE_COIL || at->table == TABLE_DISCRETE))
        printf("bit       %d\n", words[0]);
    else if (count > 0)
        print_registers(words, count);
    modbus_link_destroy(&link);
    return count > 0 ? 0 : 1;
}

int tags_probe(const char *device, const char *address, int address_base)
{
    struct plant_source source;
    struct modbus_address at;
    char host[256], why[200];
    if (!read_device(device, &source, host)) {
        fprintf(stderr, "plantcast: %s: expected HOST, HOST:PORT or the path of a serial line\n", device);
        return 2;
    }
    if (!address_parse(address, address_base < 0 ? 1 : address_base, &at, why)) {
        fprintf(stderr, "plantcast: %s: %s\n", address, why);
        return 2;
    }
    const char *bang = strchr(address, '!'), *place = bang ? bang + 1 : address;
    if (address_base < 0 && *place >= '0' && *place <= '9') {
        fprintf(stderr,
                "plantcast: %s: this address is ambiguous: add --address-base 0 or 1, the number of the device's first register (1 would "
                "read %s:%d)\n",
                address, prefixes[at.table], at.index);
        return 2;
    }
    struct log *log = log_create(LOG_ERROR);
    int stop_fd = eventfd(0, EFD_CLOEXEC), status = probe(log, &source, &at, stop_fd);
    close(stop_fd);
    log_destroy(&log);
    return status;
}
