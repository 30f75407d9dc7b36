/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All readings at one instant: what the field is computed from. A plain copy; belongs to whoever took it. */
#ifndef VALUE_SNAPSHOT_H
#define VALUE_SNAPSHOT_H
#include <stddef.h>
#include <stdint.h>

struct reading {
    double value;                /* engineering units; never NaN while quality is not Bad */
    uint32_t quality;            /* OPC UA, staleness already applied */
    uint32_t changes;            /* counts every change of value, quality or alarm: equal means nothing to do */
    uint8_t alarm, alarm_status; /* its gravest (enum alarm_kind) of those that are to be seen, and how that is (enum alarm_status) */
    int64_t received_utc_ns;     /* when the value came in; 0 = never */
    int64_t age_ns;              /* at the snapshot, by the monotonic clock; INT64_MAX = never */
};

struct snapshot {
    int64_t taken_mono_ns, taken_utc_ns;
    size_t count;             /* = plant->tag_count */
    struct reading *readings; /* by tag index */
};

struct snapshot *snapshot_create(size_t tag_count); /* all Bad_WaitingForInitialData */
void snapshot_destroy(struct snapshot **snapshot);

#endif
