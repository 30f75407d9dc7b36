/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Snapshot: the readings of all tags at one time, used to compute the field. A plain copy, owned by its creator. */
#ifndef VALUE_SNAPSHOT_H
#define VALUE_SNAPSHOT_H
#include <stddef.h>
#include <stdint.h>

struct reading {
    double value;     /* value in engineering units; never NaN unless the quality is Bad */
    uint32_t quality; /* quality of the reading as an OPC UA status code; takes the reading's age into account */
    uint32_t changes; /* counter that increases with each change of value, quality or alarm */
    /* alarm: kind of the alarm shown for the tag (enum alarm_kind); alarm_status: its state (enum alarm_status) */
    uint8_t alarm, alarm_status;
    int64_t received_utc_ns; /* time when the value arrived (UTC); 0: no value ever arrived */
    int64_t age_ns;          /* age at the time of the snapshot, by the monotonic clock; INT64_MAX: no value was ever received */
};

struct snapshot {
    int64_t taken_mono_ns, taken_utc_ns;
    size_t count;             /* = plant->tag_count */
    struct reading *readings; /* by tag index */
};

/* Creates a snapshot in which all readings are Bad_WaitingForInitialData. Never returns NULL. */
struct snapshot *snapshot_create(size_t tag_count);
/* snapshot_copy_readings() copies the array of readings, snapshot_copy() the whole snapshot. The caller frees the copy. Neither returns
 * NULL. */
struct reading *snapshot_copy_readings(const struct snapshot *snapshot);
struct snapshot *snapshot_copy(const struct snapshot *snapshot);
/* Copies the content of a snapshot into another one of the same plant. */
void snapshot_assign(struct snapshot *into, const struct snapshot *from);
void snapshot_destroy(struct snapshot **snapshot);

#endif
