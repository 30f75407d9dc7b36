/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One question and its answer in Modbus TCP frames, read only. libmodbus looks at neither the unit nor the length in the header of an
   answer, so this is ours. Source: MODBUS Messaging on TCP/IP Implementation Guide V1.0b, 3.1.3. Thread: one. */
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

/* words: as in modbus_link_read. 0; a Modbus exception code; or -errno, -EBADMSG: an answer with another number than this one's.
   An answer whose header, unit, function or size is not what was asked for is -EPROTO at once: nothing waits for what it promises. */
int modbus_tcp_ask(int fd, int stop_fd, int64_t deadline_mono_ns, const struct modbus_question *question, uint16_t *words);

#endif
