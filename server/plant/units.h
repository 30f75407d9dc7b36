/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Engineering units: which are of one kind, and how a value in one becomes a value in another. Pure. Thread: any.
   Names are UCUM's codes (https://ucum.org/ucum, 2.1) and those in use beside them; factors are those of NIST SP 811 (2008), appendix B. */
#ifndef PLANT_UNITS_H
#define PLANT_UNITS_H
#include <stdbool.h>

/* to = from * factor + offset. All zero: the two are the same. */
struct unit_change {
    bool converts;
    double factor, offset;
};

enum unit_match {
    UNITS_SAME,       /* also where neither is known and both are written alike */
    UNITS_CONVERT,
    UNITS_OTHER_KIND, /* two known units that measure different things, also absolute and gauge pressure */
    UNITS_UNKNOWN     /* one of them, or both */
};

/* Blanks, brackets, dots, raised digits and the ways to write a degree sign do not matter; upper and lower case only where they tell
   units apart (mW, MW). *change is set in every case: to nothing where values cannot be converted. */
enum unit_match units_compare(const char *from, const char *to, struct unit_change *change);
const char *unit_kind(const char *name);    /* "volume flow", "gauge pressure", ...; NULL: the unit is not known */
enum { UNIT_NAME_BYTES = 16 };
bool unit_suggest(const char *name, char near[UNIT_NAME_BYTES]); /* a known one that is written nearly so */

static inline double unit_change_value(const struct unit_change *change, double from)
{
    return change->converts ? from * change->factor + change->offset : from;
}
static inline double unit_change_back(const struct unit_change *change, double to)
{
    return change->converts ? (to - change->offset) / change->factor : to;
}
/* Of a difference of two values: a deadband, a span. */
static inline double unit_change_span(const struct unit_change *change, double from)
{
    return change->converts ? from * change->factor : from;
}

#endif
