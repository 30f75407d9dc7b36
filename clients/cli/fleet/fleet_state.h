/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is known of a plant's server, from its /metrics; and all of a fleet as JSON and as metrics. Pure. Thread: any. */
#ifndef CLI_FLEET_FLEET_STATE_H
#define CLI_FLEET_FLEET_STATE_H
#include <stdbool.h>
#include <stdint.h>

#include "base/text/text.h"
#include "fleet_file.h"

enum { FLEET_PRIORITIES = 4, FLEET_TEXT_BYTES = 64 };

struct fleet_state {
    int64_t alarms[FLEET_PRIORITIES], unacknowledged, links, links_down, sessions;
    int64_t certificate_s, backup_s, free_bytes; /* seconds since 1970; 0: not known */
    bool recorded;                               /* history and alarms can be written */
    bool reloaded;                               /* the plant file has no errors since it was loaded */
    char version[FLEET_TEXT_BYTES];
};

/* Reads the metrics of a plantcastd. Returns false if they are none. */
bool fleet_state_read(const char *metrics, struct fleet_state *out);

struct fleet_plant_state {
    struct fleet_state state;   /* as it last was */
    bool answers;
    int64_t answered_us;        /* when it last did; 0: never */
    int64_t silent_us;          /* since when it does not; 0: it does */
    uint64_t picture;           /* number of its picture; 0: none, or the last request for one failed */
    char why[256];              /* it does not answer */
    int64_t asked;              /* how often it was */
};

/* Return JSON and the text of Prometheus. states: one for each plant of the file, in its order. */
char *fleet_json(const struct fleet_file *file, const struct fleet_plant_state *states, int64_t now_us);
void fleet_metrics(const struct fleet_file *file, const struct fleet_plant_state *states, struct text *out);

#endif
