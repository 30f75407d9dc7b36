/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One read request and its response in Modbus TCP frames. libmodbus checks neither the unit nor the length in the header of a response,
   hence this implementation. Source: MODBUS Messaging on TCP/IP Implementation Guide V1.0b, 3.1.3. Thread: one. */
#ifndef VALUE_MODBUS_TCP_H
#define VALUE_MODBUS_TCP_H
#include <stdint.h>

#include "plant/plant.h"

struct modbus_question {
    uint16_t number; /* transaction identifier */
    uint8_t unit;
    enum register_table table;
    int first, count;
};

/* Sends a request and receives its response; words as in modbus_link_read(). Returns 0, a Modbus exception code, or -errno. -EBADMSG: the
   response has another transaction identifier. -EPROTO: its header, unit, function or size does not match the request; returned at once,
   without waiting for the length that the header announces. */
int modbus_tcp_ask(int fd, int stop_fd, int64_t deadline_mono_ns, const struct modbus_question *question, uint16_t *words);

#endif
