/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rules of a wall that the page follows too, tested with the same cases (protocol/vectors/wall): how large letters are, how bright a
   display is, and which alarm takes the place of a view. Pure. */
#ifndef WALL_RULES_H
#define WALL_RULES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RULES_TURN_NS 10000000000LL /* at the least between two changes of the picture for alarms */

/* Returns how many pixels of a display a pixel of a desk's page takes, so that it can be read from where people sit: a display of
   so many pixels and inches, read from so far, with a window of that size. */
double rules_unit(double inches, double metres, double display_width_px, double display_height_px, double width_px, double height_px);
/* Returns how large a pixel is. */
double rules_millimetres(double inches, double width_px, double height_px);
/* Returns how bright a display is at a minute of the day, up to 1; as the hours of the wall say, or 1 while an alarm calls. */
double rules_brightness(double from_min, double to_min, double percent, double minute, bool calls);

struct rules_alarm {
    int id; /* of tag and kind */
    int priority;
    bool gone, waiting, has_place;
    int64_t raised_us;
};
struct rules_call { /* zero, but for shown = -1: nothing is shown yet */
    int shown;      /* id; -1: the view */
    bool changed;
    int64_t changed_ns;
};
/* Returns whether there are so many alarms at once that jumping from place to place would show nothing. */
bool rules_is_flood(const struct rules_alarm *alarms, size_t count, int64_t now_us);
/* Returns the index of the alarm to show now, or -1: the gravest that waits, then the oldest, each for its turn. now_ns never goes back. */
int rules_next(struct rules_call *call, const struct rules_alarm *alarms, size_t count, int64_t now_ns, int64_t now_us);

#endif
