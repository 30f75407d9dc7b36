/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Engineering units: knows which units measure the same quantity, and converts between them. Pure. Call from any thread. Names
   are UCUM codes (https://ucum.org/ucum, 2.1) and others in common use; factors are from NIST SP 811 (2008), appendix B. */
#ifndef PLANT_TAGS_UNITS_H
#define PLANT_TAGS_UNITS_H
#include <stdbool.h>

/* A conversion of units: converted value = value * factor + offset. All members zero: the units are equal or cannot be converted. */
struct unit_change {
    bool converts;
    double factor, offset;
};

enum unit_match {
    UNITS_SAME, /* equal units, or two unknown units with names that are spelled alike */
    UNITS_CONVERT,
    UNITS_OTHER_KIND, /* units of different quantities, including absolute and gauge pressure; both units are known */
    UNITS_UNKNOWN     /* not comparable, because at least one of the units is unknown */
};

/* Compares two units by name and sets *change to the conversion, all zero if there is none. Ignores blanks, brackets, dots,
   superscript digits and variants of the degree sign, and ignores case unless it distinguishes units (mW, MW). */
enum unit_match units_compare(const char *from, const char *to, struct unit_change *change);
/* Returns the quantity that a unit measures, such as "volume flow" (static); NULL if the unit is unknown. */
const char *unit_kind(const char *name);
enum { UNIT_NAME_BYTES = 16 };
/* Finds a known unit whose name is similar to a mistyped one. Returns false if no name is similar. */
bool unit_suggest(const char *name, char near[UNIT_NAME_BYTES]);

/* Converts a value from the first to the second unit of the units_compare() call. */
static inline double unit_change_value(const struct unit_change *change, double from)
{
    return change->converts ? from * change->factor + change->offset : from;
}
/* Converts a value back, from the second to the first unit of the units_compare() call. */
static inline double unit_change_back(const struct unit_change *change, double to)
{
    return change->converts ? (to - change->offset) / change->factor : to;
}
/* Converts the difference of two values, such as a deadband or a span. */
static inline double unit_change_span(const struct unit_change *change, double from)
{
    return change->converts ? from * change->factor : from;
}

#endif
