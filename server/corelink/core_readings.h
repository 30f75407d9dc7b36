/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Readings from a core to its renderers, as bytes: of each tag value, quality, source time and age as the core
   has them. Pure. Thread: any. */
#ifndef CORELINK_CORE_READINGS_H
#define CORELINK_CORE_READINGS_H
#include "base/text/text.h"
#include "value/snapshot.h"
#include "value/store.h"

enum { CORE_READINGS_HEAD_BYTES = 24, CORE_READING_BYTES = 32 };

/* What one renderer was sent last of each tag. */
struct core_sent {
    size_t count;
    struct core_sent_reading {
        uint32_t changes;
        int64_t received_utc_ns;
        bool sent;
    } *at;
};

void core_sent_init(struct core_sent *sent, size_t tag_count);
void core_sent_finish(struct core_sent *sent);
/* Appends the message with the readings of the snapshot that are others than were sent, perhaps none: then it only says that the core is
   there. Notes them as sent. */
void core_readings_write(struct text *out, const struct snapshot *snapshot, struct core_sent *sent);

struct core_readings {
    int64_t utc_ns;   /* the core's clock, when it took them */
    int64_t least_ns; /* kept from message to message: by how much our monotonic clock was ahead of the core's, at least. Begins with
                         INT64_MAX for each connection */
    int64_t at_ns;    /* kept likewise: when the last one came. Begins with 0 */
    int64_t late_ns;  /* by so much longer than the quickest message of the connection this one took; ages have it in them */
    size_t count;
    struct mirrored *at; /* room for all tags; */
};

/* Reads a message that came at now_mono_ns into out->at, which has room for tag_count. Returns NULL, or what is wrong with it (static). */
const char *core_readings_read(struct core_readings *out, size_t tag_count, const void *bytes, size_t count, int64_t now_mono_ns);

#endif
