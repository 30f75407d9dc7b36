/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A read-only connection to a Modbus device or serial line (function codes 1 to 4): Modbus TCP, RTU frames over TCP, or RTU.
   Every call returns by its deadline. Call from one thread only, except modbus_link_interrupt(). */
#ifndef VALUE_MODBUS_LINK_H
#define VALUE_MODBUS_LINK_H
#include <stdbool.h>
#include <stdint.h>

#include "base/log/log.h"
#include "plant/plant.h"

struct modbus_link;

/* Creates a link that is not connected. stop_fd: an eventfd; all calls that wait return when it becomes readable. `source` must outlive the
 * link. Returns NULL on failure (logged). */
struct modbus_link *modbus_link_create(struct log *log, const struct plant_source *source, int stop_fd);
void modbus_link_destroy(struct modbus_link **link); /* Closes the connection, frees the link and sets *link to NULL. *link may be NULL. */

bool modbus_link_is_open(const struct modbus_link *link);
/* Returns the address of the host in use, such as "10.0.0.1:502" or "/dev/ttyS0", valid until the next call. */
const char *modbus_link_name(const struct modbus_link *link);
/* Returns the index in source->hosts of the host in use. */
int modbus_link_host(const struct modbus_link *link);
/* Connects within the source's timeout_ms. Returns 0 or -errno; -ECANCELED: stop_fd became readable. */
int modbus_link_open(struct modbus_link *link);
/* Switches to the next of the source's hosts. Returns true if it switched from the last host back to the first. */
bool modbus_link_next_host(struct modbus_link *link);
/* Reads `count` registers, or bits as 0 and 1, into `words`, within the source's timeout_ms however slowly the device sends.
   Returns 0; a Modbus exception code (> 0), with the connection still open; or -errno, with the connection closed. Closing it
   prevents a late or foreign response from being mistaken for the response to the next request. */
int modbus_link_read(struct modbus_link *link, int unit, enum register_table table, int first, int count, uint16_t *words);
/* Closes the connection; modbus_link_open() makes a new one. */
void modbus_link_close(struct modbus_link *link);
/* Sets whether a response may state unit 0 or 255 instead of the unit requested. Allow this only if no other unit is read at this
   address. */
void modbus_link_allow_any_unit(struct modbus_link *link, bool any);
/* Returns the unit number that the last response states. */
int modbus_link_answered_unit(const struct modbus_link *link);
/* Modbus TCP: makes the link repeat the first request of each connection every timeout_ms, until an answer arrives or patience_ns have
   passed. 0: the request is sent once. RTU frames: makes the link wait for a late answer until patience_ns after the request, to measure
   how late it is. */
void modbus_link_set_patience(struct modbus_link *link, int64_t patience_ns);
/* Returns the number of requests that were answered on the current connection, or on the last one if none is open. */
int modbus_link_answers(const struct modbus_link *link);
/* For RTU frames: returns the time in nanoseconds that the device took to answer an abandoned request. 0: no late answer was
   seen since the last answer in time. */
int64_t modbus_link_late_ns(const struct modbus_link *link);
/* Returns the time in nanoseconds from connecting until the first answered request was sent. *answered_ns receives the time from
   connecting until its answer. */
int64_t modbus_link_first_ns(const struct modbus_link *link, int64_t *answered_ns);
/* Ends a read that is in progress. Called by another thread, after stop_fd became readable. A read on a serial line ends only at its
   deadline. */
void modbus_link_interrupt(struct modbus_link *link);

#endif
