/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of a Modbus source share: its thread (modbus.c), which units answer (modbus_units.c), and what is done with a response
   (modbus_answers.c). Thread: the source's own. */
#ifndef VALUE_MODBUS_IMPL_H
#define VALUE_MODBUS_IMPL_H
#include "value/backoff.h"
#include "value/modbus_link.h"
#include "value/read_plan.h"
#include "value/source_impl.h"

enum unit_state { UNIT_UNKNOWN, UNIT_UP, UNIT_DOWN };

struct unit { /* a device behind the address; a gateway or a serial line has several */
    int id;
    enum unit_state state;
    struct backoff backoff;
    int64_t retry_ns;
};

struct modbus_source {
    struct source base;
    counter *reads_ok, *reads_failed, *connects, *up, *host;
    struct modbus_link *link;
    /* --- below: used by the source's thread only */
    struct read_plan plan;
    bool plan_cut;              /* blocks were split around addresses that the device refused */
    struct unit *units;
    struct backoff backoff;     /* of connecting */
    int64_t connect_ns;         /* do not connect before */
    int64_t asked_ns;           /* when the last request ended */
    bool link_up, link_known;
    bool *refused;              /* by index in plant->tags: the device refuses to read it */
    struct sample *samples;     /* room for all tags */
    int *lost;                  /* likewise */
};

/* Returns the unit that a block is read from. */
struct unit *modbus_unit_of(const struct modbus_source *modbus, const struct read_plan_block *block);
/* Records that a unit answered; logs it if it had not before. */
void modbus_unit_is_up(struct modbus_source *modbus, struct unit *unit);
/* Records that a unit does not answer: its tags lose their link, and it is left alone for a while. */
void modbus_unit_is_down(struct modbus_source *modbus, struct unit *unit, const char *why);
/* Opens the link if it is closed. Returns false if it cannot be opened now; connect_ns says when to try again. */
bool modbus_connect_link(struct modbus_source *modbus);

/* Decodes the response to a block and writes its tags to the store. */
void modbus_take_values(struct modbus_source *modbus, struct read_plan_block *block, const uint16_t *words);
/* Handles a Modbus exception: retries a busy device, splits a refused block, and marks refused tags as Bad. */
void modbus_take_exception(struct modbus_source *modbus, size_t block, int code, int64_t now_ns);
/* Makes the read plan anew, with the addresses that were refused before: a device may have been repaired or replaced. */
void modbus_replan(struct modbus_source *modbus);

#endif
