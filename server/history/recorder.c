/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The recorder: selects the samples to record, with one swinging-door filter per tag. */
#include "history/recorder.h"

#include "base/mem.h"
#include "history/swinging_door.h"
#include "history/history.h"
#include "history/month.h"
#include "value/quality.h"

struct recorder_lane {
    struct swinging_door door;
    struct swinging_door_params params;
    int64_t sampling_us; /* interval in microseconds at which the tag's source checks for changes */
    /* If no sample arrives for more than this many microseconds, the recorded line keeps the last value until sampling_us
       before the next sample. INT64_MAX: samples are imported, and nothing is recorded for a time without samples. */
    int64_t silence_us;
    /* time and quality of the sample with the latest time, which need not be the last to arrive: a source may send an old time */
    int64_t latest_us;
    uint32_t quality;
    bool touched; /* true: the tag is in recorder->touched, because it has had samples since the last recorder_held() */
};

struct recorder {
    struct history_tag *tags;
    struct recorder_lane *lanes;
    size_t count, touched_count;
    int *touched;
};

/* Returns the width of a tag's range of values: its instrument's measuring range if known, otherwise its group's colour range;
   0: unknown. */
static double span_of(const struct plant *plant, const struct plant_tag *tag)
{
    if (tag->scale.has_range)
        return unit_change_span(&tag->scale.change, fabs(tag->scale.scaled_high - tag->scale.scaled_low));
    return tag->group >= 0 ? plant->groups[tag->group].max - plant->groups[tag->group].min : 0;
}

/* Returns the longest time between two samples of a tag that the recorded line may bridge with a slope. After a longer time,
   the line is level until shortly before the next sample. The tag's `Stale s` may allow a far longer silence, during which live
   pictures show the last value. */
static int64_t silence_of(const struct plant *plant, const struct plant_tag *tag)
{
    if (tag->validity.stale_s >= PLANT_NEVER_STALE_S || plant_tag_sends_changes(plant, tag))
        return 2 * (int64_t)plant_tag_scan_ms(plant, tag) * 1000;
    return (int64_t)(plant_tag_default_stale_s(plant, tag) * US_PER_S);
}

struct history_tag *history_tags(const struct plant *plant)
{
    struct history_tag *tags = mem_array(plant->tag_count ? plant->tag_count : 1, sizeof(*tags));
    for (size_t i = 0; i < plant->tag_count; i++) {
        const struct plant_tag *tag = &plant->tags[i];
        tags[i] = (struct history_tag){
            .name = tag->name,
            .unit = plant_tag_unit(plant, (int)i),
            .step = tag->signal.type == DATA_BIT,
            .within = isnan(tag->deadband) ? plant->history.deadband_percent / 100 * span_of(plant, tag) : tag->deadband,
            .stale_us = tag->validity.stale_s < PLANT_NEVER_STALE_S ? (int64_t)(tag->validity.stale_s * US_PER_S) : INT64_MAX,
        };
    }
    return tags;
}

struct recorder *recorder_create(const struct plant *plant, int64_t begin_us)
{
    struct recorder *recorder = mem_new(sizeof(*recorder));
    recorder->count = plant->tag_count;
    recorder->tags = history_tags(plant);
    recorder->lanes = mem_array(recorder->count ? recorder->count : 1, sizeof(*recorder->lanes));
    recorder->touched = mem_array(recorder->count ? recorder->count : 1, sizeof(*recorder->touched));
    for (size_t i = 0; i < recorder->count; i++) {
        const struct history_tag *tag = &recorder->tags[i];
        recorder->lanes[i].quality = QUALITY_BAD_WAITING;
        recorder->lanes[i].latest_us = begin_us;
        recorder->lanes[i].sampling_us = (int64_t)plant_tag_scan_ms(plant, &plant->tags[i]) * 1000;
        recorder->lanes[i].silence_us = begin_us == INT64_MIN ? INT64_MAX : silence_of(plant, &plant->tags[i]);
        recorder->lanes[i].params = (struct swinging_door_params){
            /* The recorded line (straight between recorded points) may differ from the samples by at most `within`.
               swinging_door.h guarantees at most 2 * deadband + deviation, which is 2 * within/4 + within/2 = within here. */
            .deadband = tag->step ? 0 : tag->within / 4,
            .deviation = tag->step ? 0 : tag->within / 2,
            .override_us = (int64_t)(plant->history.override_s * US_PER_S),
            .step = tag->step,
        };
    }
    return recorder;
}

void recorder_destroy(struct recorder **recorder)
{
    if (!*recorder)
        return;
    mem_free((*recorder)->tags);
    mem_free((*recorder)->lanes);
    mem_free((*recorder)->touched);
    mem_free(*recorder);
    *recorder = NULL;
}

static void add_points(struct recorder_rows *rows, int tag, const struct history_point *points, int count)
{
    mem_grow(&rows->at, &rows->capacity, rows->count + (size_t)count, sizeof(*rows->at));
    for (int i = 0; i < count; i++)
        rows->at[rows->count++] = (struct history_row){ tag, points[i] };
}

bool recorder_newest(const struct recorder *recorder, int tag, struct history_point *out)
{
    const struct swinging_door *door = &recorder->lanes[tag].door;
    if (!swinging_door_held(door, out))
        *out = door->anchor;
    return door->open;
}

static void put(struct recorder *recorder, int tag, const struct history_point *sample, struct recorder_rows *kept)
{
    struct recorder_lane *lane = &recorder->lanes[tag];
    struct history_point points[SWINGING_DOOR_MAX_POINTS];
    add_points(kept, tag, points, swinging_door_put(&lane->door, &lane->params, sample, points));
}

/* Call before a sample is recorded. If the previous sample is long ago, first records the old value at a time shortly before
   the new sample. Otherwise the recorded line would slope from the old value to the new one over the whole time without
   samples. */
static void put_silence(struct recorder *recorder, int tag, const struct history_point *sample, struct recorder_rows *kept)
{
    const struct recorder_lane *lane = &recorder->lanes[tag];
    const int64_t stale_us = recorder->tags[tag].stale_us;
    struct history_point newest;
    if (lane->silence_us == INT64_MAX || !recorder_newest(recorder, tag, &newest) || !history_point_usable(&newest))
        return;
    int64_t silent_us = sample->t_us - newest.t_us;
    if (silent_us > stale_us && sample->quality != QUALITY_BAD_COMMUNICATION_ERROR)
        newest = (struct history_point){ newest.t_us + stale_us, NAN, QUALITY_BAD_COMMUNICATION_ERROR };
    else if (silent_us > lane->silence_us && history_point_joined(&newest, sample, lane->params.step))
        newest.t_us = sample->t_us - lane->sampling_us;
    else
        return;
    put(recorder, tag, &newest, kept);
}

void recorder_put(struct recorder *recorder, int tag, const struct history_point *sample, struct recorder_rows *kept)
{
    struct recorder_lane *lane = &recorder->lanes[tag];
    put_silence(recorder, tag, sample, kept);
    put(recorder, tag, sample, kept);
    if (sample->t_us >= lane->latest_us)
        recorder_set_quality(recorder, tag, sample->t_us, sample->quality);
    if (!lane->touched)
        recorder->touched[recorder->touched_count++] = tag;
    lane->touched = true;
}

void recorder_set_quality(struct recorder *recorder, int tag, int64_t t_us, uint32_t quality)
{
    recorder->lanes[tag].latest_us = t_us;
    recorder->lanes[tag].quality = quality;
}

uint32_t recorder_quality(const struct recorder *recorder, int tag)
{
    return recorder->lanes[tag].quality;
}

void recorder_hold_again(struct recorder *recorder)
{
    recorder->touched_count = 0;
    for (size_t i = 0; i < recorder->count; i++) {
        recorder->lanes[i].touched = recorder->lanes[i].door.open;
        if (recorder->lanes[i].touched)
            recorder->touched[recorder->touched_count++] = (int)i;
    }
}

void recorder_held(struct recorder *recorder, struct recorder_rows *held)
{
    struct history_point point;
    for (size_t i = 0; i < recorder->touched_count; i++) {
        struct recorder_lane *lane = &recorder->lanes[recorder->touched[i]];
        lane->touched = false;
        /* The held row is the tag's newest sample, which marks the end of the tag's recorded line after a crash. It is written
           even if that sample was recorded as a point already. */
        recorder_newest(recorder, recorder->touched[i], &point);
        add_points(held, recorder->touched[i], &point, 1);
    }
    recorder->touched_count = 0;
}

void recorder_end_tag(struct recorder *recorder, int tag, struct recorder_rows *kept)
{
    struct history_point points[SWINGING_DOOR_MAX_POINTS];
    add_points(kept, tag, points, swinging_door_end(&recorder->lanes[tag].door, &recorder->lanes[tag].params, points));
}

void recorder_end(struct recorder *recorder, struct recorder_rows *kept)
{
    for (size_t i = 0; i < recorder->count; i++)
        recorder_end_tag(recorder, (int)i, kept);
}
