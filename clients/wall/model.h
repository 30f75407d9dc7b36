/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the server says of the plant: tags with their readings, alarms, views with names, and what desks sent to walls. The plant has the
   server's own structs, as far as markers and legends need them; it has no geometry. Thread: any one at a time. */
#ifndef WALL_MODEL_H
#define WALL_MODEL_H
#include <jansson.h>

#include "scene/scene.h"
#include "value/alarm.h"
#include "value/snapshot.h"

struct model_alarm {
    int tag;            /* -1: of a device */
    const char *device; /* its name, else NULL */
    enum alarm_kind kind;
    enum alarm_status status;
    int priority;
    int64_t raised_us;
    double value, limit; /* NAN: none */
    bool waiting;        /* for somebody to acknowledge it, or another one of its tag */
};

struct model {
    struct plant plant; /* its texts belong to `welcome` */
    struct scene scene;
    struct snapshot *snapshot;
    int64_t *read_ns;         /* by tag: when its reading was taken, monotonic; 0: never */
    json_t *welcome;          /* NULL: nothing was said yet */
    json_t *rows;             /* alarms that are not normal, by "index/kind" */
    struct model_alarm *list; /* those to be seen, one for each tag: those that wait first, then what is there, then by priority, the newest
                                 first */
    size_t list_count;
    json_t *views, *orders, *notes;   /* lists; NULL: none */
    int64_t offset_us; /* the server's clock less our monotonic one, which nobody sets, by the shortest round trip of about a minute */
    int64_t round_trip_ns, timed_ns; /* that one; when it came */
    bool live, clock_set, simulated;  /* simulated: some of it was not measured */
};

void model_init(struct model *model);
void model_finish(struct model *model);
/* Takes in a message of the server, which came at now_ns (monotonic); others than it knows are passed over. Returns whether it was
   understood:
   a `welcome` that makes no sense is not. */
bool model_hear(struct model *model, const json_t *message, int64_t now_ns);
/* Takes in a pong, whose `t` is when its ping was sent, monotonic, in nanoseconds. */
void model_pong(struct model *model, const json_t *message, int64_t now_ns);
/* Returns the server's clock, microseconds UTC. */
int64_t model_now_us(const struct model *model);
/* Returns how long ago the oldest reading was taken that is not bad, of those tags, or of a group (tags NULL); -1: none. */
int64_t model_oldest_ns(const struct model *model, const int *tags, size_t count, int group, int64_t now_ns);
/* Returns the gravest alarm of a tag that is to be seen, or NULL. */
const struct model_alarm *model_gravest(const struct model *model, int tag);
/* Returns a named view, {id, title, view}, or NULL. */
const json_t *model_view(const struct model *model, const char *id);
/* Returns the name of an alarm's tag or device. */
const char *model_alarm_name(const struct model *model, const struct model_alarm *alarm);

#endif
