/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One connection to a Modbus device or line, read only (function codes 1 to 4): TCP, RTU frames over TCP, or a serial line. Every
   call ends by its deadline. Thread: one, except modbus_link_interrupt. */
#ifndef VALUE_MODBUS_LINK_H
#define VALUE_MODBUS_LINK_H
#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "plant/plant.h"

struct modbus_link;

/* stop_fd: an eventfd that becomes readable when everything shall end. NULL on failure, logged. source must outlive it. */
struct modbus_link *modbus_link_create(struct log *log, const struct plant_source *source, int stop_fd);
void modbus_link_destroy(struct modbus_link **link); /* &NULL is fine; leaves NULL */

bool modbus_link_is_open(const struct modbus_link *link);
/* To where it goes now, or would: "10.0.0.1:502", "/dev/ttyS0". Valid until the next call. */
const char *modbus_link_name(const struct modbus_link *link);
int modbus_link_host(const struct modbus_link *link); /* which of the source's hosts that is; 0: the first */
/* Within the source's timeout_ms. 0 or -errno; -ECANCELED: stopping. */
int modbus_link_open(struct modbus_link *link);
/* The present host is of no use: the next one of the source's is opened next. True: that was the last, and the first is next. */
bool modbus_link_next_host(struct modbus_link *link);
/* Within the source's timeout_ms, however slowly the device drips. words: `count` registers, or bits as 0 and 1.
   0; a Modbus exception code (> 0: the device answered, the link stays open); or -errno: the link is closed, so that a late
   or foreign reply can never be taken for the next one. */
int modbus_link_read(struct modbus_link *link, int unit, enum register_table table, int first, int count, uint16_t *words);
/* From another thread, after stop_fd was made readable: ends a read that is under way, but for one on a serial line, which ends by
   its deadline. */
void modbus_link_interrupt(struct modbus_link *link);

#endif
