/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One read request and its response in Modbus TCP frames. libmodbus checks neither the unit nor the length in the header of a response,
   hence this implementation. Source: MODBUS Messaging on TCP/IP Implementation Guide V1.0b, 3.1.3. Thread: one. */
#ifndef VALUE_MODBUS_TCP_H
#define VALUE_MODBUS_TCP_H
#include <stdbool.h>
#include <stdint.h>

#include "plant/plant.h"

struct modbus_question {
    uint16_t number; /* transaction identifier */
    uint8_t unit;
    bool any_unit;   /* an answer may name unit 0 or 255 in place of the one asked, or any one in place of these */
    uint16_t oldest; /* transaction identifier of the first of the same requests on this connection; `number` if there is one */
    enum register_table table;
    int first, count;
};

struct modbus_answered {
    uint16_t number;
    uint8_t unit;
    bool began; /* at least one byte of the response came */
};

/* Sends a request and receives its response; words as in modbus_link_read(). answered: the response's number and unit. Returns 0, a Modbus
   exception code, or -errno. -EBADMSG: the response has another transaction identifier. -EPROTO: its header, unit, function or size does
   not match the request; returned at once, without waiting for the length that the header announces. */
int modbus_tcp_ask(int fd, int stop_fd, int64_t deadline_mono_ns, const struct modbus_question *question, uint16_t *words,
                   struct modbus_answered *answered);

#endif
