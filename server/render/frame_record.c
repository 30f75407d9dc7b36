/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creates and releases frame records: copies of the readings that a frame was drawn from. */
#include "render/frame_record.h"

#include <stdatomic.h>

#include "base/mem.h"

static void add_baseline(struct frame_record *record, struct baselines *baselines, uint32_t id)
{
    for (int i = 0; i < record->baseline_count; i++)
        if (record->baselines[i].what.id == id)
            return;
    const struct snapshot *snapshot = id && baselines ? baselines_take(baselines, id) : NULL;
    if (snapshot && baselines_describe(baselines, id, &record->baselines[record->baseline_count].what))
        record->baselines[record->baseline_count++].readings = snapshot_copy(snapshot);
    if (snapshot)
        baselines_give(baselines, &snapshot);
}

/* Takes ownership of the readings. */
static struct frame_record *make(struct snapshot *readings)
{
    struct frame_record *record = mem_new(sizeof(*record));
    atomic_init(&record->refs, 1);
    record->readings = readings;
    record->unproven = mem_array(readings->count, sizeof(*record->unproven));
    return record;
}

struct frame_record *frame_record_empty(size_t tag_count)
{
    return make(snapshot_create(tag_count));
}

struct frame_record *frame_record_create(const struct view *view, const struct snapshot *readings, struct baselines *baselines,
                                         const struct loop_checks *loop_checks)
{
    struct frame_record *record = make(snapshot_copy(readings));
    for (size_t i = 0; i < readings->count; i++)
        record->unproven[i] = loop_checks && loop_checks_unproven(loop_checks, (int)i);
    add_baseline(record, baselines, view->field.baseline);
    if (view->split)
        add_baseline(record, baselines, view->right.field.baseline);
    return record;
}

struct frame_record *frame_record_ref(struct frame_record *record)
{
    if (record)
        atomic_fetch_add_explicit(&record->refs, 1, memory_order_relaxed);
    return record;
}

void frame_record_unref(struct frame_record **record_ptr)
{
    struct frame_record *record = *record_ptr;
    *record_ptr = NULL;
    if (!record || atomic_fetch_sub_explicit(&record->refs, 1, memory_order_acq_rel) != 1)
        return;
    for (int i = 0; i < record->baseline_count; i++)
        snapshot_destroy(&record->baselines[i].readings);
    snapshot_destroy(&record->readings);
    mem_free(record->unproven);
    mem_free(record);
}
