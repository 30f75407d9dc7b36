/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A connection to a Modbus device or serial line, read only (function codes 1 to 4): Modbus TCP, RTU frames over TCP, or RTU. Every
   call returns by its deadline. Thread: one, except modbus_link_interrupt(). */
#ifndef VALUE_MODBUS_LINK_H
#define VALUE_MODBUS_LINK_H
#include <stdbool.h>
#include <stdint.h>

#include "base/log/log.h"
#include "plant/plant.h"

struct modbus_link;

/* Creates a link, closed. stop_fd: an eventfd that becomes readable to end all waiting. source must outlive the link. Returns NULL on
   failure (logged). */
struct modbus_link *modbus_link_create(struct log *log, const struct plant_source *source, int stop_fd);
void modbus_link_destroy(struct modbus_link **link); /* &NULL is fine; leaves NULL */

bool modbus_link_is_open(const struct modbus_link *link);
/* Returns the address of the present host, such as "10.0.0.1:502" or "/dev/ttyS0", valid until the next call. */
const char *modbus_link_name(const struct modbus_link *link);
/* Returns the index of the present host among the source's hosts. */
int modbus_link_host(const struct modbus_link *link);
/* Connects within the source's timeout_ms. Returns 0 or -errno; -ECANCELED: stopping. */
int modbus_link_open(struct modbus_link *link);
/* Makes the next of the source's hosts the present one. Returns true after the last one, when it is the first again. */
bool modbus_link_next_host(struct modbus_link *link);
/* Reads `count` registers, or bits as 0 and 1, into words, within the source's timeout_ms however slowly the device sends. Returns 0; a
   Modbus exception code (> 0; the link stays open); or -errno, with the link closed, so that a late or foreign response is never taken
   for the next one. */
int modbus_link_read(struct modbus_link *link, int unit, enum register_table table, int first, int count, uint16_t *words);
/* Closes the connection; modbus_link_open() makes a new one. */
void modbus_link_close(struct modbus_link *link);
/* Has answers taken that name unit 0 or 255 in place of the unit that was asked: the device is known to be the only one there. */
void modbus_link_allow_any_unit(struct modbus_link *link, bool any);
/* Returns the unit that the last answer named. */
int modbus_link_answered_unit(const struct modbus_link *link);
/* Modbus TCP: the first request of each connection is repeated every timeout_ms until patience_ns have passed without an answer. 0: not. */
void modbus_link_set_patience(struct modbus_link *link, int64_t patience_ns);
/* Returns how many requests the present connection has answered, or the last one had, if there is none. */
int modbus_link_answers(const struct modbus_link *link);
/* Returns how long after connecting the request was sent that was answered first; *answered_ns: when its answer came. */
int64_t modbus_link_first_ns(const struct modbus_link *link, int64_t *answered_ns);
/* Called from another thread once stop_fd is readable: ends a read in progress. A read on a serial line ends by its deadline. */
void modbus_link_interrupt(struct modbus_link *link);

#endif
