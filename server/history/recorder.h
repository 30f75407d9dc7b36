/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Selects the samples that are recorded: one swinging-door filter for each tag. Does no input or output. Thread: one. */
#ifndef HISTORY_RECORDER_H
#define HISTORY_RECORDER_H
#include "history/month_file.h"
#include "plant/plant.h"

struct recorder_rows { /* rows to be recorded; zero-initialise; free `at` with mem_free() */
    struct history_row *at;
    size_t count, capacity;
};

struct recorder;
/* begin_us: time from which samples are recorded. Earlier recordings end before it with a point without a value, so a sample that states
   an earlier time does not tell the quality from begin_us on. INT64_MIN: the samples are imported, and no value is assumed to hold. */
struct recorder *recorder_create(const struct plant *plant, int64_t begin_us);
void recorder_destroy(struct recorder **recorder); /* Frees the recorder and sets *recorder to NULL; accepts a pointer to NULL. */
/* Passes a sample to its tag's filter, and appends to `kept` the rows that must now be recorded. If the sample comes after the previous
   one became stale, the time between has no value. After a shorter silence, the last value held until one sampling interval before the
   sample (HISTORY.md, "Recorded data"). */
void recorder_put(struct recorder *recorder, int tag, const struct history_point *sample, struct recorder_rows *kept);
/* *out receives a tag's newest sample. Returns false if the tag has none yet. */
bool recorder_newest(const struct recorder *recorder, int tag, struct history_point *out);
/* Returns the quality that the recorded line has from now on: that of the sample that is latest in time; Bad_WaitingForInitialData if there
   is none yet. */
uint32_t recorder_quality(const struct recorder *recorder, int tag);
/* Sets the time and the quality that recorder_quality() returns, although a sample with a later time exists: the clock was set back. */
void recorder_set_quality(struct recorder *recorder, int tag, int64_t t_us, uint32_t quality);
/* Appends the held rows: for each tag that had a sample since the last call, its newest sample, which may not be recorded yet. */
void recorder_held(struct recorder *recorder, struct recorder_rows *held);
/* Makes the next recorder_held() append the newest samples of all tags. Call it if the rows of an earlier recorder_held() could not be
   written. */
void recorder_hold_again(struct recorder *recorder);
/* Records the newest sample of a tag if the filter has not recorded it yet, as if the override period (longest time between two recorded
   points) were over. */
void recorder_end_tag(struct recorder *recorder, int tag, struct recorder_rows *kept);
/* ends the recording of all tags; calls recorder_end_tag() for each */
void recorder_end(struct recorder *recorder, struct recorder_rows *kept);

#endif
