/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Readings from a core to its renderers, as bytes: value, quality, source time and age of each tag as the core has them. Pure. Thread:
   any. */
#ifndef CORELINK_CORE_READINGS_H
#define CORELINK_CORE_READINGS_H
#include "base/text/text.h"
#include "value/snapshot.h"
#include "value/store.h"

enum { CORE_READINGS_HEAD_BYTES = 24, CORE_READING_BYTES = 32 };

/* For each tag, the reading that one renderer was sent last. */
struct core_sent {
    size_t count;
    struct core_sent_reading {
        uint32_t changes;
        int64_t received_utc_ns;
        bool sent;
    } * at;
};

void core_sent_init(struct core_sent *sent, size_t tag_count);
void core_sent_finish(struct core_sent *sent);
/* Appends a message with the readings that differ from those in *sent, and stores them there. If no reading differs, the message only shows
   that the core is alive. */
void core_readings_write(struct text *out, const struct snapshot *snapshot, struct core_sent *sent);

struct core_readings {
    int64_t utc_ns; /* the core's UTC clock when it took the readings */
    /* smallest difference between this machine's monotonic clock and the core's clock in a message, over all messages of this connection;
       the caller sets it to INT64_MAX for a new connection */
    int64_t least_ns;
    int64_t at_ns;   /* arrival time of this connection's previous message; the caller sets it to 0 for a new connection */
    /* time by which this message was slower than the connection's fastest message; the ages of the readings already include it */
    int64_t late_ns;
    size_t count;
    struct mirrored *at; /* array for one reading of each tag, which the caller provides */
};

/* Reads a message that arrived at now_mono_ns into out->at, which has room for tag_count readings. Returns NULL, or what is wrong with
   the message (static). */
const char *core_readings_read(struct core_readings *out, size_t tag_count, const void *bytes, size_t count, int64_t now_mono_ns);

#endif
