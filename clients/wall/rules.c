/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clients/web/core/wall.js and alarm_call.js say the same. */
#include "rules.h"

#include <math.h>

/* ISO 9241-303: no capital letter is smaller than 16 minutes of arc. */
static const double MINUTES = 16, CAPITAL = 0.72,
                    SMALLEST_PX = 12.5;                    /* capital: of a letter's size; smallest: what is written on a desk's page */
static const double LEAST_WIDTH = 560, LEAST_HEIGHT = 315; /* units that a display has at the least */
static const int FLOOD = 10;                               /* more alarms than that, in ten minutes */
static const int64_t FLOOD_US = 600000000;

double rules_millimetres(double inches, double width_px, double height_px)
{
    return inches * 25.4 / hypot(width_px, height_px);
}

double rules_unit(double inches, double metres, double display_width_px, double display_height_px, double width_px, double height_px)
{
    double needed_mm = metres * 1000 * tan(MINUTES / 60 * M_PI / 180);
    double needed = fmax(1, needed_mm / (CAPITAL * SMALLEST_PX * rules_millimetres(inches, display_width_px, display_height_px)));
    return fmax(0.5, fmin(needed, fmin(width_px / LEAST_WIDTH, height_px / LEAST_HEIGHT)));
}

double rules_brightness(double from_min, double to_min, double percent, double minute, bool calls)
{
    bool within = from_min <= to_min ? minute >= from_min && minute < to_min : minute >= from_min || minute < to_min;
    return within && !calls ? percent / 100 : 1;
}

bool rules_is_flood(const struct rules_alarm *alarms, size_t count, int64_t now_us)
{
    int recent = 0;
    for (size_t i = 0; i < count; i++)
        recent += !alarms[i].gone && now_us - alarms[i].raised_us <= FLOOD_US;
    return recent > FLOOD;
}

static bool calls(const struct rules_alarm *alarm)
{
    return alarm->waiting && alarm->has_place;
}

/* Of two that call, in the order of a list where they are equal. */
static bool is_before(const struct rules_alarm *alarms, size_t a, size_t b)
{
    const struct rules_alarm *i = &alarms[a], *k = &alarms[b];
    if (i->gone != k->gone)
        return k->gone;
    if (i->priority != k->priority)
        return i->priority < k->priority;
    return i->raised_us != k->raised_us ? i->raised_us < k->raised_us : a < b;
}

/* The first one after `after` (-1: of all); -1: none. */
static int find_after(const struct rules_alarm *alarms, size_t count, int after)
{
    int found = -1;
    for (size_t i = 0; i < count; i++)
        if (calls(&alarms[i]) && (int)i != after && (after < 0 || is_before(alarms, (size_t)after, i)) &&
            (found < 0 || is_before(alarms, i, (size_t)found)))
            found = (int)i;
    return found;
}

static int find_shown(const struct rules_call *call, const struct rules_alarm *alarms, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (calls(&alarms[i]) && alarms[i].id == call->shown)
            return (int)i;
    return -1;
}

int rules_next(struct rules_call *call, const struct rules_alarm *alarms, size_t count, int64_t now_ns, int64_t now_us)
{
    if (rules_is_flood(alarms, count, now_us))
        count = 0;
    if (!call->changed || now_ns - call->changed_ns >= RULES_TURN_NS) {
        int next = find_after(alarms, count, find_shown(call, alarms, count));
        if (next < 0)
            next = find_after(alarms, count, -1);
        int id = next >= 0 ? alarms[next].id : -1;
        if (id >= 0 || call->shown >= 0) {
            call->changed = true;
            call->changed_ns = now_ns;
        }
        call->shown = id;
    }
    return find_shown(call, alarms, count);
}
