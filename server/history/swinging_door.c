/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Swinging-door filter: selects the samples to record. Skips samples within the deadband around the last sample that left it;
   the swinging door (a range of slopes) decides on the others. */
#include "history/swinging_door.h"

static void begin(struct swinging_door *door, const struct history_point *at)
{
    *door = (struct swinging_door){ .open = true, .anchor = *at, .slope_low = -INFINITY, .slope_high = INFINITY };
}

static int keep(struct swinging_door *door, const struct history_point *point, struct history_point *kept, int count)
{
    kept[count] = *point;
    begin(door, point);
    return count + 1;
}

static double slope_to(const struct swinging_door *door, const struct history_point *point, double offset)
{
    return (point->value + offset - door->anchor.value) / (double)(point->t_us - door->anchor.t_us);
}

static bool passes(const struct swinging_door *door, const struct history_point *sample)
{
    double slope = slope_to(door, sample, 0);
    return slope >= door->slope_low && slope <= door->slope_high;
}

/* Passes a sample that left the deadband to the swinging door. The sample must have the anchor's quality and be newer than the
   held point. Appends points to be recorded to `kept`, which already has `count` points. Returns the new count. */
static int swing(struct swinging_door *door, const struct swinging_door_params *params, const struct history_point *sample,
                 struct history_point *kept, int count)
{
    if (door->has_held && !passes(door, sample)) {
        struct history_point held = door->held;
        count = keep(door, &held, kept, count);
    }
    door->slope_low = fmax(door->slope_low, slope_to(door, sample, -params->deviation));
    door->slope_high = fmin(door->slope_high, slope_to(door, sample, params->deviation));
    door->held = *sample;
    door->has_held = true;
    door->has_skipped = false;
    return count;
}

/* Returns the newest sample that the filter has seen, whether or not it was recorded. */
static const struct history_point *last(const struct swinging_door *door)
{
    return door->has_skipped ? &door->skipped : door->has_held ? &door->held : &door->anchor;
}

static int keep_last(struct swinging_door *door, const struct swinging_door_params *params, struct history_point *kept, int count)
{
    struct history_point point;
    if (!swinging_door_held(door, &point))
        return count;
    if (door->has_skipped && door->has_held)
        count = swing(door, params, &point, kept, count);
    return keep(door, &point, kept, count);
}

static bool same_quality(const struct history_point *a, const struct history_point *b)
{
    return a->quality == b->quality && history_point_usable(a) == history_point_usable(b);
}

int swinging_door_put(struct swinging_door *door, const struct swinging_door_params *params, const struct history_point *sample,
                      struct history_point kept[SWINGING_DOOR_MAX_POINTS])
{
    int count = 0;
    if (!door->open)
        return keep(door, sample, kept, 0);
    if (sample->t_us <= last(door)->t_us || !same_quality(last(door), sample)) {
        count = keep_last(door, params, kept, count);
        return keep(door, sample, kept, count);
    }
    bool usable = history_point_usable(sample), due = sample->t_us - door->anchor.t_us >= params->override_us;
    const struct history_point *passed = door->has_held ? &door->held : &door->anchor;
    if (!usable || fabs(sample->value - passed->value) <= params->deadband) {
        /* The sample is within the deadband but outside the door: records the held point (the newest sample that left the
           deadband). Otherwise the line drawn from the recorded points to the present would show a ramp where the value made a
           step. */
        if (usable && door->has_held && !passes(door, sample)) {
            struct history_point held = door->held;
            count = keep(door, &held, kept, count);
        }
        door->skipped = *sample;
        door->has_skipped = true;
        return due ? keep_last(door, params, kept, count) : count;
    }
    /* First passes the skipped sample (the last one within the deadband) to the door. Otherwise the line through the recorded
       points would begin to rise before the values did. */
    if (door->has_skipped) {
        struct history_point skipped = door->skipped;
        count = params->step ? 0 : swing(door, params, &skipped, kept, count);
    }
    if (params->step)
        return keep(door, sample, kept, count);
    count = swing(door, params, sample, kept, count);
    return due ? keep_last(door, params, kept, count) : count;
}

int swinging_door_end(struct swinging_door *door, const struct swinging_door_params *params,
                      struct history_point kept[SWINGING_DOOR_MAX_POINTS])
{
    return keep_last(door, params, kept, 0);
}

bool swinging_door_held(const struct swinging_door *door, struct history_point *out)
{
    if (!door->open || (!door->has_held && !door->has_skipped))
        return false;
    *out = *last(door);
    return true;
}
