/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creates, copies and frees snapshots (readings of all tags at one time). */
#include "value/snapshot.h"

#include <string.h>

#include "base/mem.h"
#include "value/quality.h"

struct snapshot *snapshot_create(size_t tag_count)
{
    struct snapshot *snapshot = mem_new(sizeof(*snapshot));
    snapshot->count = tag_count;
    snapshot->readings = mem_array(tag_count, sizeof(*snapshot->readings));
    for (size_t i = 0; i < tag_count; i++)
        snapshot->readings[i] = (struct reading){ .quality = QUALITY_BAD_WAITING, .age_ns = INT64_MAX };
    return snapshot;
}

struct reading *snapshot_copy_readings(const struct snapshot *snapshot)
{
    struct reading *copy = mem_array(snapshot->count, sizeof(*copy));
    if (snapshot->count)
        memcpy(copy, snapshot->readings, snapshot->count * sizeof(*copy));
    return copy;
}

struct snapshot *snapshot_copy(const struct snapshot *snapshot)
{
    struct snapshot *copy = mem_new(sizeof(*copy));
    *copy = *snapshot;
    copy->readings = snapshot_copy_readings(snapshot);
    return copy;
}

void snapshot_assign(struct snapshot *into, const struct snapshot *from)
{
    into->taken_mono_ns = from->taken_mono_ns;
    into->taken_utc_ns = from->taken_utc_ns;
    if (from->count)
        memcpy(into->readings, from->readings, from->count * sizeof(*into->readings));
}

void snapshot_destroy(struct snapshot **snapshot)
{
    if (!*snapshot)
        return;
    mem_free((*snapshot)->readings);
    mem_free(*snapshot);
    *snapshot = NULL;
}
