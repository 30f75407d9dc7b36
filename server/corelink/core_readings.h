/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Readings sent by a core to its renderers, as bytes: value, quality, source time and age of each tag, as the core has them.
   Pure. Call from any thread. */
#ifndef CORELINK_CORE_READINGS_H
#define CORELINK_CORE_READINGS_H
#include "base/text/text.h"
#include "value/snapshot.h"
#include "value/store.h"

enum { CORE_READINGS_HEAD_BYTES = 24, CORE_READING_BYTES = 32 };

/* The readings that one renderer was sent last, one for each tag. */
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
/* Appends a message with the readings that differ from those sent last (*sent), and updates *sent. If no reading differs, the
   message has no readings and only shows that the core is alive. */
void core_readings_write(struct text *out, const struct snapshot *snapshot, struct core_sent *sent);

struct core_readings {
    int64_t utc_ns; /* the core's UTC clock when the snapshot of the readings was taken */
    /* smallest difference between this machine's monotonic clock and the core's over all messages of this connection; the
       caller sets it to INT64_MAX for a new connection */
    int64_t least_ns;
    int64_t at_ns;   /* monotonic time when this connection's previous message arrived; the caller sets it to 0 for a new connection */
    /* nanoseconds by which this message was delayed more than the fastest message of the connection; already included in the
       ages of the readings */
    int64_t late_ns;
    size_t count;
    struct mirrored *at; /* array with room for one reading of each tag, provided by the caller */
};

/* Parses a message that arrived at now_mono_ns into out->at, which has room for tag_count readings. Returns NULL, or what is
   wrong with the message (static text). */
const char *core_readings_read(struct core_readings *out, size_t tag_count, const void *bytes, size_t count, int64_t now_mono_ns);

#endif
