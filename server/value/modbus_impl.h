/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Modbus source in its parts: its thread (modbus.c), who answers (modbus_units.c), what an answer brings (modbus_answers.c). Thread:
   the source's own. */
#ifndef VALUE_MODBUS_IMPL_H
#define VALUE_MODBUS_IMPL_H
#include <pthread.h>

#include "value/backoff.h"
#include "value/modbus_link.h"
#include "value/read_plan.h"
#include "value/source.h"

enum unit_state { UNIT_UNKNOWN, UNIT_UP, UNIT_DOWN };

struct unit { /* a device behind the address; several behind a gateway or on a line */
    int id;
    enum unit_state state;
    struct backoff backoff;
    int64_t retry_ns;
};

struct modbus_source {
    struct source base;
    struct log *log;
    const struct plant *plant;
    const struct plant_source *config;
    int index;
    struct store *store;
    counter *reads_ok, *reads_failed, *connects, *up, *host;
    int stop_fd;
    pthread_t thread;
    bool has_thread;
    struct modbus_link *link;
    /* --- below: the thread's own */
    struct read_plan plan;
    bool plan_cut; /* blocks were cut at what was refused */
    struct unit *units;
    struct backoff backoff; /* of connecting */
    int64_t connect_ns;     /* not before */
    int64_t asked_ns;       /* the last request's end */
    bool link_up, link_known;
    bool *refused;          /* by index in plant->tags: the device has said no to it */
    struct sample *samples; /* room for all tags */
    int *lost;              /* likewise */
};

struct unit *modbus_unit_of(const struct modbus_source *modbus, const struct read_plan_block *block);
void modbus_unit_is_up(struct modbus_source *modbus, struct unit *unit);
void modbus_unit_is_down(struct modbus_source *modbus, struct unit *unit, const char *why);
bool modbus_connect_link(struct modbus_source *modbus); /* false: it is known when to try again */

void modbus_take_values(struct modbus_source *modbus, struct read_plan_block *block, const uint16_t *words);
void modbus_take_exception(struct modbus_source *modbus, size_t block, int code, int64_t now_ns);
/* Forgets what was refused and asks for everything anew: a device may have been repaired or replaced. */
void modbus_replan(struct modbus_source *modbus);

#endif
