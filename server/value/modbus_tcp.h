/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One read request and its response in Modbus TCP frames. Written by hand because libmodbus checks neither the unit nor the
   length in the header of a response. Source: MODBUS Messaging on TCP/IP Implementation Guide V1.0b, 3.1.3. Call from one
   thread only. */
#ifndef VALUE_MODBUS_TCP_H
#define VALUE_MODBUS_TCP_H
#include <stdbool.h>
#include <stdint.h>

#include "plant/plant.h"

struct modbus_question {
    uint16_t number; /* transaction identifier */
    uint8_t unit;
    /* true: a response may state unit 0 or 255 instead of the requested unit; and if unit 0 or 255 was requested, it may state any unit */
    bool any_unit;
    /* transaction identifier of the first copy of this request, if it was repeated on this connection; equal to `number` if it was sent
       once */
    uint16_t oldest;
    enum register_table table;
    int first, count;
};

struct modbus_answered {
    uint16_t number;
    uint8_t unit;
    bool began; /* true: at least one byte of the response has arrived */
};

/* Sends a request and receives its response; `words` as in modbus_link_read(). *answered receives the response's transaction
 * identifier and unit. Returns 0, a Modbus exception code, or -errno. -EBADMSG: the response has another transaction
 * identifier. -EPROTO: header, unit, function or size of the response do not match the request. It is returned immediately,
 * without waiting for all the bytes that the header announces. */
int modbus_tcp_ask(int fd, int stop_fd, int64_t deadline_mono_ns, const struct modbus_question *question, uint16_t *words,
                   struct modbus_answered *answered);

#endif
