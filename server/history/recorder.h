/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Selects the samples to record, with one swinging-door filter per tag. No input or output. Call from one thread only. */
#ifndef HISTORY_RECORDER_H
#define HISTORY_RECORDER_H
#include "history/month_file.h"
#include "plant/plant.h"

struct recorder_rows { /* rows to be recorded; zero-initialise; free `at` with mem_free() */
    struct history_row *at;
    size_t count, capacity;
};

struct recorder;
/* Creates a recorder. begin_us: time from which samples are recorded. Until a tag has a sample later than begin_us, its quality
   counts as unknown, because recordings of earlier runs end with a point without a value. INT64_MIN: the recorder is for
   imported samples; for these, a value never counts as unchanged during a silence between two samples. */
struct recorder *recorder_create(const struct plant *plant, int64_t begin_us);
void recorder_destroy(struct recorder **recorder); /* Frees the recorder and sets *recorder to NULL; accepts a pointer to NULL. */
/* Passes a sample to its tag's filter, and appends to `kept` the rows that must now be recorded. If the previous sample had
   become stale, the time in between has no value. After a shorter silence, the last value holds until one sampling interval
   before the sample (HISTORY.md, "Recorded data"). */
void recorder_put(struct recorder *recorder, int tag, const struct history_point *sample, struct recorder_rows *kept);
/* Sets *out to a tag's newest sample. Returns false if the tag has none yet. */
bool recorder_newest(const struct recorder *recorder, int tag, struct history_point *out);
/* Returns the quality that the tag's recording has from now on: that of the sample with the latest time;
   Bad_WaitingForInitialData if there is none yet. */
uint32_t recorder_quality(const struct recorder *recorder, int tag);
/* Sets the time and quality for recorder_quality(), even if a sample with a later time exists, because the clock was set back. */
void recorder_set_quality(struct recorder *recorder, int tag, int64_t t_us, uint32_t quality);
/* Appends the held rows: the newest sample of each tag that had samples since the last call. It may not be recorded yet. */
void recorder_held(struct recorder *recorder, struct recorder_rows *held);
/* Makes the next recorder_held() append the newest samples of all tags. Call it if the rows of an earlier recorder_held() could not be
   written. */
void recorder_hold_again(struct recorder *recorder);
/* Records a tag's newest sample if the filter has not recorded it yet, as if the override period (longest time between two
   recorded points) were over. */
void recorder_end_tag(struct recorder *recorder, int tag, struct recorder_rows *kept);
/* ends the recording of all tags; calls recorder_end_tag() for each */
void recorder_end(struct recorder *recorder, struct recorder_rows *kept);

#endif
