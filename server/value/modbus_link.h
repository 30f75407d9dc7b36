/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One TCP connection to a Modbus device, read only (function codes 1 to 4). Every call ends by its deadline.
   Thread: one, except modbus_link_interrupt. */
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
/* Within the source's timeout_ms. 0 or -errno; -ECANCELED: stopping. */
int modbus_link_open(struct modbus_link *link);
void modbus_link_close(struct modbus_link *link);
/* Within the source's timeout_ms, however slowly the device drips. words: `count` registers, or bits as 0 and 1.
   0; a Modbus exception code (> 0: the device answered, the link stays open); or -errno: the link is closed, so that a late
   or foreign reply can never be taken for the next one. */
int modbus_link_read(struct modbus_link *link, int unit, enum register_table table, int first, int count, uint16_t *words);
/* From another thread, after stop_fd was made readable: ends a read that is under way. */
void modbus_link_interrupt(struct modbus_link *link);

#endif
