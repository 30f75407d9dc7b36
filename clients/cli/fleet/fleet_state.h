/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of a plant's server, parsed from its /metrics, and the state of a whole fleet as JSON and as metrics. No side effects.
   Call from any thread. */
#ifndef CLI_FLEET_FLEET_STATE_H
#define CLI_FLEET_FLEET_STATE_H
#include <stdbool.h>
#include <stdint.h>

#include "base/text/text.h"
#include "fleet_file.h"

enum { FLEET_PRIORITIES = 4, FLEET_TEXT_BYTES = 64 };

struct fleet_state {
    int64_t alarms[FLEET_PRIORITIES], unacknowledged, links, links_down, sessions;
    int64_t certificate_s, backup_s, free_bytes; /* certificate_s: when the certificate expires, backup_s: when the newest backup
                                                    was made, both in seconds since 1970; free_bytes: free disk space; 0: unknown */
    bool recorded;                               /* true: the server can write history and alarms to disk */
    bool reloaded;                               /* true: the plant file had no errors at the last reload */
    char version[FLEET_TEXT_BYTES];
};

/* Parses the text of a daemon's /metrics. Returns false if the text is not from a plantcastd. */
bool fleet_state_read(const char *metrics, struct fleet_state *out);

struct fleet_plant_state {
    struct fleet_state state; /* from the last answer */
    bool answers;
    int64_t answered_us; /* time of the server's last answer, microseconds since 1970; 0: never */
    int64_t silent_us;   /* time of the first failed request since the last answer, microseconds since 1970; 0: the server answers */
    uint64_t picture;    /* id of the server's newest picture; 0: none, or the last request for a picture failed */
    char why[256];       /* why the server does not answer */
    int64_t asked;       /* number of requests so far */
};

/* Returns the fleet's state as JSON; fleet_metrics() returns it as Prometheus metrics. states: one per plant, in the fleet file's order. */
char *fleet_json(const struct fleet_file *file, const struct fleet_plant_state *states, int64_t now_us);
void fleet_metrics(const struct fleet_file *file, const struct fleet_plant_state *states, struct text *out);

#endif
