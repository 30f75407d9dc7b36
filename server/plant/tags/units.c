/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of engineering units, and the comparison of unit names in the spellings that people use. */
#include "plant/tags/units.h"

#include <stddef.h>
#include <string.h>
#include <strings.h>

#include "plant/parse/suggest.h"

enum { NAME_BYTES = 48 };

enum quantity_kind {
    UNKNOWN, TEMPERATURE, TEMPERATURE_DIFFERENCE, PRESSURE, PRESSURE_ABSOLUTE, PRESSURE_GAUGE, VOLUME_FLOW, FLOW_AT_0_C, FLOW_AT_15_C,
    FLOW_AT_60_F, MASS_FLOW, LENGTH, VELOCITY, VELOCITY_RMS, VELOCITY_PEAK, ACCELERATION, POWER, APPARENT_POWER, REACTIVE_POWER, RATIO,
    PARTS, VOLUME, MASS, DENSITY, TIME, FREQUENCY, SPEED_OF_ROTATION, CURRENT, VOLTAGE, RESISTANCE, ENERGY, CONDUCTIVITY, FORCE, ANGLE
};

static const char *const kind_names[] = {
    [TEMPERATURE] = "temperature",
    [TEMPERATURE_DIFFERENCE] = "difference of temperatures",
    [PRESSURE] = "pressure (absolute or gauge not stated)",
    [PRESSURE_ABSOLUTE] = "absolute pressure",
    [PRESSURE_GAUGE] = "gauge pressure",
    [VOLUME_FLOW] = "volume flow",
    [FLOW_AT_0_C] = "volume flow at 0 °C and 1.01325 bar",
    [FLOW_AT_15_C] = "volume flow at 15 °C and 1.01325 bar",
    [FLOW_AT_60_F] = "volume flow at 60 °F and 14.696 psi",
    [MASS_FLOW] = "mass flow",
    [LENGTH] = "length",
    [VELOCITY] = "velocity",
    [VELOCITY_RMS] = "velocity, root mean square",
    [VELOCITY_PEAK] = "velocity, peak",
    [ACCELERATION] = "acceleration",
    [POWER] = "power",
    [APPARENT_POWER] = "apparent power",
    [REACTIVE_POWER] = "reactive power",
    [RATIO] = "ratio",
    [PARTS] = "number of parts",
    [VOLUME] = "volume",
    [MASS] = "mass",
    [DENSITY] = "density",
    [TIME] = "time",
    [FREQUENCY] = "frequency",
    [SPEED_OF_ROTATION] = "speed of rotation",
    [CURRENT] = "current",
    [VOLTAGE] = "voltage",
    [RESISTANCE] = "resistance",
    [ENERGY] = "energy",
    [CONDUCTIVITY] = "conductivity",
    [FORCE] = "force",
    [ANGLE] = "angle",
};

#define INCH 0.0254
#define FOOT 0.3048
#define POUND 0.45359237
#define GALLON 3.785411784e-3 /* US */
#define BARREL 0.158987294928 /* of oil */
#define CUBIC_FOOT (FOOT * FOOT * FOOT)
#define PSI 6894.757293168361        /* value of 1 psi in Pa: POUND * 9.80665 / INCH^2 */
#define MM_HG 133.322387415          /* conventional millimetre of mercury */
#define HORSEPOWER 745.6998715822702 /* 550 ft lbf/s */
#define BTU 1055.05585262            /* international table BTU */
#define CALORIE 4.1868               /* international table calorie */
#define MINUTE 60.0
#define HOUR 3600.0
#define DAY 86400.0

struct unit_entry {
    const char *names; /* names of the unit, normalised and separated by |; messages use the first one */
    enum quantity_kind kind;
    double factor, offset; /* conversion: SI value = value * factor + offset */
};

static const struct unit_entry units[] = {
    { "K|kelvin", TEMPERATURE, 1, 0 },
    { "degC|C|Cel|celsius", TEMPERATURE, 1, 273.15 },
    { "degF|F|fahrenheit", TEMPERATURE, 5 / 9.0, 459.67 * 5 / 9 },
    { "degR|rankine", TEMPERATURE, 5 / 9.0, 0 },

    { "Pa", PRESSURE, 1, 0 },
    { "mPa", PRESSURE, 1e-3, 0 },
    { "hPa", PRESSURE, 1e2, 0 },
    { "kPa", PRESSURE, 1e3, 0 },
    { "MPa", PRESSURE, 1e6, 0 },
    { "bar", PRESSURE, 1e5, 0 },
    { "mbar", PRESSURE, 1e2, 0 },
    { "psi", PRESSURE, PSI, 0 },
    { "ksi", PRESSURE, 1000 * PSI, 0 },
    { "atm", PRESSURE, 101325, 0 },
    { "at|kgf/cm2|kg/cm2|kp/cm2", PRESSURE, 98066.5, 0 },
    { "Torr", PRESSURE, 101325 / 760.0, 0 },
    { "mmHg", PRESSURE, MM_HG, 0 },
    { "inHg|iniHg", PRESSURE, 25.4 * MM_HG, 0 },
    { "mmH2O|mmWC|mmWS", PRESSURE, 9.80665, 0 },
    { "mH2O|mWC|mWS", PRESSURE, 9806.65, 0 },
    { "inH2O|iniH2O|inWC", PRESSURE, 25.4 * 9.80665, 0 },
    { "ftH2O|ftWC", PRESSURE, 304.8 * 9.80665, 0 },

    { "m3/s", VOLUME_FLOW, 1, 0 },
    { "m3/min", VOLUME_FLOW, 1 / MINUTE, 0 },
    { "m3/h|m3/hr|cbm/h", VOLUME_FLOW, 1 / HOUR, 0 },
    { "m3/d|m3/day", VOLUME_FLOW, 1 / DAY, 0 },
    { "l/s", VOLUME_FLOW, 1e-3, 0 },
    { "l/min|lpm", VOLUME_FLOW, 1e-3 / MINUTE, 0 },
    { "l/h|l/hr", VOLUME_FLOW, 1e-3 / HOUR, 0 },
    { "ml/min|mL/min", VOLUME_FLOW, 1e-6 / MINUTE, 0 },
    { "Ml/min|ML/min", VOLUME_FLOW, 1e3 / MINUTE, 0 },
    { "l/d|l/day", VOLUME_FLOW, 1e-3 / DAY, 0 },
    { "Ml/d|ML/d|Ml/day|ML/day|MLD", VOLUME_FLOW, 1e3 / DAY, 0 },
    { "ft3/s|cfti/s|cfs", VOLUME_FLOW, CUBIC_FOOT, 0 },
    { "ft3/min|cfti/min|cfm|acfm", VOLUME_FLOW, CUBIC_FOOT / MINUTE, 0 },
    { "ft3/h|ft3/hr|cfti/h|cfh|acfh", VOLUME_FLOW, CUBIC_FOOT / HOUR, 0 },
    { "gal/min|galus/min|gpm|usgpm", VOLUME_FLOW, GALLON / MINUTE, 0 },
    { "gal/h|gal/hr|galus/h|gph", VOLUME_FLOW, GALLON / HOUR, 0 },
    { "gal/d|gal/day|galus/d|gpd", VOLUME_FLOW, GALLON / DAY, 0 },
    { "bbl/h|bbl/hr|bblus/h", VOLUME_FLOW, BARREL / HOUR, 0 },
    { "bbl/d|bbl/day|bblus/d|bpd", VOLUME_FLOW, BARREL / DAY, 0 },

    { "Nm3/s", FLOW_AT_0_C, 1, 0 },
    { "Nm3/min", FLOW_AT_0_C, 1 / MINUTE, 0 },
    { "Nm3/h|Nm3/hr", FLOW_AT_0_C, 1 / HOUR, 0 },
    { "Nl/min", FLOW_AT_0_C, 1e-3 / MINUTE, 0 },
    { "Nl/h", FLOW_AT_0_C, 1e-3 / HOUR, 0 },
    { "Sm3/s", FLOW_AT_15_C, 1, 0 },
    { "Sm3/h|Sm3/hr", FLOW_AT_15_C, 1 / HOUR, 0 },
    { "Sm3/d|Sm3/day", FLOW_AT_15_C, 1 / DAY, 0 },
    { "scfm", FLOW_AT_60_F, CUBIC_FOOT / MINUTE, 0 },
    { "scfh", FLOW_AT_60_F, CUBIC_FOOT / HOUR, 0 },
    { "MMscfd", FLOW_AT_60_F, 1e6 * CUBIC_FOOT / DAY, 0 },

    { "kg/s", MASS_FLOW, 1, 0 },
    { "kg/min", MASS_FLOW, 1 / MINUTE, 0 },
    { "kg/h|kg/hr", MASS_FLOW, 1 / HOUR, 0 },
    { "kg/d|kg/day", MASS_FLOW, 1 / DAY, 0 },
    { "g/s", MASS_FLOW, 1e-3, 0 },
    { "g/min", MASS_FLOW, 1e-3 / MINUTE, 0 },
    { "g/h", MASS_FLOW, 1e-3 / HOUR, 0 },
    { "t/h|t/hr|tph", MASS_FLOW, 1e3 / HOUR, 0 },
    { "t/d|t/day|tpd", MASS_FLOW, 1e3 / DAY, 0 },
    { "lb/s|lbav/s", MASS_FLOW, POUND, 0 },
    { "lb/min|lbav/min", MASS_FLOW, POUND / MINUTE, 0 },
    { "lb/h|lb/hr|lbm/h|lbm/hr|lbav/h|pph", MASS_FLOW, POUND / HOUR, 0 },

    { "m", LENGTH, 1, 0 },
    { "km", LENGTH, 1e3, 0 },
    { "cm", LENGTH, 1e-2, 0 },
    { "mm", LENGTH, 1e-3, 0 },
    { "um|micron", LENGTH, 1e-6, 0 },
    { "nm", LENGTH, 1e-9, 0 },
    { "in|ini|inch|\"", LENGTH, INCH, 0 },
    { "ft|fti|foot|feet", LENGTH, FOOT, 0 },
    { "mil|mili|thou", LENGTH, INCH / 1000, 0 },

    { "m/s", VELOCITY, 1, 0 },
    { "mm/s", VELOCITY, 1e-3, 0 },
    { "cm/s", VELOCITY, 1e-2, 0 },
    { "um/s", VELOCITY, 1e-6, 0 },
    { "m/min", VELOCITY, 1 / MINUTE, 0 },
    { "km/h|kph", VELOCITY, 1e3 / HOUR, 0 },
    { "in/s|ini/s|ips", VELOCITY, INCH, 0 },
    { "ft/s|fti/s|fps", VELOCITY, FOOT, 0 },
    { "ft/min|fti/min|fpm", VELOCITY, FOOT / MINUTE, 0 },
    { "mi/h|mii/h|mph", VELOCITY, 1609.344 / HOUR, 0 },
    { "kn|kni|knot|knots", VELOCITY, 1852 / HOUR, 0 },
    { "mm/srms", VELOCITY_RMS, 1e-3, 0 },
    { "in/srms|ipsrms", VELOCITY_RMS, INCH, 0 },
    { "mm/spk|mm/speak|mm/s0-p", VELOCITY_PEAK, 1e-3, 0 },
    { "in/spk|in/speak|in/s0-p|ipspk", VELOCITY_PEAK, INCH, 0 },
    { "m/s2", ACCELERATION, 1, 0 },
    { "mm/s2", ACCELERATION, 1e-3, 0 },
    { "ft/s2", ACCELERATION, FOOT, 0 },

    { "W", POWER, 1, 0 },
    { "mW", POWER, 1e-3, 0 },
    { "kW", POWER, 1e3, 0 },
    { "MW", POWER, 1e6, 0 },
    { "GW", POWER, 1e9, 0 },
    { "hp", POWER, HORSEPOWER, 0 },
    { "PS", POWER, 735.49875, 0 },
    { "BTU/h|BTU/hr|BtuIT/h", POWER, BTU / HOUR, 0 },
    { "kcal/h", POWER, 1000 * CALORIE / HOUR, 0 },
    { "VA", APPARENT_POWER, 1, 0 },
    { "kVA", APPARENT_POWER, 1e3, 0 },
    { "MVA", APPARENT_POWER, 1e6, 0 },
    { "var", REACTIVE_POWER, 1, 0 },
    { "kvar", REACTIVE_POWER, 1e3, 0 },
    { "Mvar", REACTIVE_POWER, 1e6, 0 },

    { "%|percent", RATIO, 1e-2, 0 },
    { "permille", RATIO, 1e-3, 0 },
    { "1|fraction", RATIO, 1, 0 },
    { "ppm", PARTS, 1, 0 },
    { "ppb", PARTS, 1e-3, 0 },

    { "m3", VOLUME, 1, 0 },
    { "l", VOLUME, 1e-3, 0 },
    { "hl", VOLUME, 0.1, 0 },
    { "ml|mL", VOLUME, 1e-6, 0 },
    { "Ml|ML", VOLUME, 1e3, 0 },
    { "ft3|cfti", VOLUME, CUBIC_FOOT, 0 },
    { "gal|galus", VOLUME, GALLON, 0 },
    { "bbl|bblus", VOLUME, BARREL, 0 },
    { "kg", MASS, 1, 0 },
    { "mg", MASS, 1e-6, 0 },
    { "Mg", MASS, 1e3, 0 },
    { "t|tonne", MASS, 1e3, 0 },
    { "lb|lbm|lbav", MASS, POUND, 0 },
    { "kg/m3|g/l", DENSITY, 1, 0 },
    { "kg/l|g/cm3|g/ml", DENSITY, 1e3, 0 },
    { "lb/ft3", DENSITY, POUND / CUBIC_FOOT, 0 },
    { "s|sec", TIME, 1, 0 },
    { "ms", TIME, 1e-3, 0 },
    { "min", TIME, MINUTE, 0 },
    { "h|hr", TIME, HOUR, 0 },
    { "d|day", TIME, DAY, 0 },
    { "Hz", FREQUENCY, 1, 0 },
    { "mHz", FREQUENCY, 1e-3, 0 },
    { "kHz", FREQUENCY, 1e3, 0 },
    { "MHz", FREQUENCY, 1e6, 0 },
    { "rpm|1/min|min-1|r/min|rev/min", SPEED_OF_ROTATION, 1 / MINUTE, 0 },
    { "r/s|rev/s|rps", SPEED_OF_ROTATION, 1, 0 },
    { "A", CURRENT, 1, 0 },
    { "uA", CURRENT, 1e-6, 0 },
    { "mA", CURRENT, 1e-3, 0 },
    { "kA", CURRENT, 1e3, 0 },
    { "V", VOLTAGE, 1, 0 },
    { "uV", VOLTAGE, 1e-6, 0 },
    { "mV", VOLTAGE, 1e-3, 0 },
    { "MV", VOLTAGE, 1e6, 0 },
    { "kV", VOLTAGE, 1e3, 0 },
    { "ohm", RESISTANCE, 1, 0 },
    { "kohm", RESISTANCE, 1e3, 0 },
    { "Mohm", RESISTANCE, 1e6, 0 },
    { "mohm", RESISTANCE, 1e-3, 0 },
    { "J", ENERGY, 1, 0 },
    { "mJ", ENERGY, 1e-3, 0 },
    { "kJ", ENERGY, 1e3, 0 },
    { "MJ", ENERGY, 1e6, 0 },
    { "GJ", ENERGY, 1e9, 0 },
    { "Wh", ENERGY, HOUR, 0 },
    { "kWh", ENERGY, 1e3 * HOUR, 0 },
    { "mWh", ENERGY, 1e-3 * HOUR, 0 },
    { "MWh", ENERGY, 1e6 * HOUR, 0 },
    { "BTU|BtuIT", ENERGY, BTU, 0 },
    { "kcal", ENERGY, 1000 * CALORIE, 0 },
    { "S/m", CONDUCTIVITY, 1, 0 },
    { "mS/cm", CONDUCTIVITY, 0.1, 0 },
    { "MS/cm", CONDUCTIVITY, 1e8, 0 },
    { "uS/cm", CONDUCTIVITY, 1e-4, 0 },
    { "N", FORCE, 1, 0 },
    { "mN", FORCE, 1e-3, 0 },
    { "kN", FORCE, 1e3, 0 },
    { "MN", FORCE, 1e6, 0 },
    { "lbf", FORCE, POUND * 9.80665, 0 },
    { "deg", ANGLE, 3.14159265358979323846 / 180, 0 },
    { "rad", ANGLE, 1, 0 },
};
enum { UNIT_COUNT = sizeof(units) / sizeof(*units) };

/* --- names ------------------------------------------------------------------------------------------------------------------ */

/* Converts a unit's name to the form used in the table: drops blanks, brackets and dots, and replaces signs by letters. */
static void normalise(const char *name, char out[NAME_BYTES])
{
    static const struct {
        const char *written, *means;
    } signs[] = {
        { "\xC2\xB0", "deg" }, { "\xC2\xBA", "deg" },     { "\xE2\x84\x83", "degC" }, { "\xE2\x84\x89", "degF" },
        { "\xC2\xB2", "2" },   { "\xC2\xB3", "3" },       { "\xE2\x82\x82", "2" },    { "\xC2\xB5", "u" },
        { "\xCE\xBC", "u" },   { "\xCE\x94", "delta" },   { "\xE2\x88\x86", "delta" }, { "\xE2\x80\xB0", "permille" },
        { "\xCE\xA9", "ohm" }, { "\xE2\x84\xA6", "ohm" }, { "\xC2\xB7", "" },         { "\xC2\xA0", "" },
        { "\xE2\x8B\x85", "" }, { " ", "" },              { "(", "" },                { ")", "" },
        { "[", "" },           { "]", "" },               { "^", "" },                { "_", "" },
        { ".", "" },           { "*", "" },               { "'", "" },
    };
    size_t length = 0;
    while (*name && length < NAME_BYTES - 10) {
        size_t i = 0, count = sizeof(signs) / sizeof(*signs);
        while (i < count && strncmp(name, signs[i].written, strlen(signs[i].written)) != 0)
            i++;
        if (i == count) {
            out[length++] = *name++;
            continue;
        }
        memcpy(out + length, signs[i].means, strlen(signs[i].means));
        length += strlen(signs[i].means);
        name += strlen(signs[i].written);
    }
    out[length] = 0;
}

/* Returns the name after `at` in a list "a|b|c"; NULL: `at` is the last one. */
static const char *next_name(const char *at)
{
    const char *bar = strchr(at, '|');
    return bar ? bar + 1 : NULL;
}

/* Returns whether a unit has this name, comparing exactly or ignoring case. */
static bool has_name(const struct unit_entry *unit, const char *name, bool exact)
{
    size_t bytes = strlen(name);
    for (const char *at = unit->names; at; at = next_name(at))
        if (strcspn(at, "|") == bytes && (exact ? !strncmp(at, name, bytes) : !strncasecmp(at, name, bytes)))
            return true;
    return false;
}

/* Returns whether a name differs from a unit's name in the case of its first letter, and this letter is the prefix milli or mega:
 * MA is a megaampere, not the milliampere of the table. */
static bool has_other_prefix(const struct unit_entry *unit, const char *name)
{
    size_t bytes = strlen(name);
    for (const char *at = unit->names; at; at = next_name(at)) {
        if (strcspn(at, "|") != bytes || *at == *name || !strchr("mM", *at) || strncmp(at + 1, name + 1, bytes - 1) != 0)
            continue;
        for (size_t i = 0; i < UNIT_COUNT; i++)
            if (units[i].kind == unit->kind && has_name(&units[i], name + 1, false))
                return true;
    }
    return false;
}

/* Finds a unit by name: first exactly, then ignoring case. The second search must find exactly one unit: MPA could be MPa or mPa. */
static const struct unit_entry *look_up(const char *name)
{
    const struct unit_entry *found = NULL;
    for (size_t i = 0; i < UNIT_COUNT; i++)
        if (has_name(&units[i], name, true))
            return &units[i];
    for (size_t i = 0; i < UNIT_COUNT; i++) {
        if (!has_name(&units[i], name, false))
            continue;
        if (found || has_other_prefix(&units[i], name))
            return NULL;
        found = &units[i];
    }
    return found;
}

static bool take_end(char *name, const char *end)
{
    size_t bytes = strlen(name), end_bytes = strlen(end);
    if (bytes <= end_bytes || strcasecmp(name + bytes - end_bytes, end) != 0)
        return false;
    name[bytes - end_bytes] = 0;
    return true;
}

/* Finds a pressure unit with a suffix for absolute or gauge: psia, bar(g), kPa abs. Returns false if the name is not such a unit. */
static bool find_pressure(const char *name, struct unit_entry *out)
{
    static const char *const absolute[] = { "absolute", "abs", "a" }, *const gauge[] = { "gauge", "gage", "g" };
    for (int kind = PRESSURE_ABSOLUTE; kind <= PRESSURE_GAUGE; kind++)
        for (size_t i = 0; i < 3; i++) {
            char base[NAME_BYTES];
            strcpy(base, name);
            if (!take_end(base, (kind == PRESSURE_GAUGE ? gauge : absolute)[i]))
                continue;
            const struct unit_entry *unit = look_up(base);
            if (!unit || unit->kind != PRESSURE)
                continue;
            *out = *unit;
            out->kind = (enum quantity_kind)kind;
            return true;
        }
    return false;
}

/* Finds the unit of a temperature difference, such as deltaK. Its conversion has no offset, because the zero point of the scale
   does not matter for a difference. Returns false if the name is not such a unit. */
static bool find_difference(const char *name, struct unit_entry *out)
{
    const struct unit_entry *unit = strncasecmp(name, "delta", 5) == 0 ? look_up(name + 5) : NULL;
    if (!unit || unit->kind != TEMPERATURE)
        return false;
    *out = *unit;
    out->kind = TEMPERATURE_DIFFERENCE;
    out->offset = 0;
    return true;
}

static bool find(const char *name, struct unit_entry *out)
{
    const struct unit_entry *unit = look_up(name);
    if (unit)
        *out = *unit;
    return unit || find_pressure(name, out) || find_difference(name, out);
}

/* --- interface -------------------------------------------------------------------------------------------------------------- */

/* Returns whether the names of two unknown units are equal. Ignores case except for the first letter, since prefixes such as M
   and m, P and p differ. */
static bool written_alike(const char *a, const char *b)
{
    return *a == *b && !strcasecmp(a, b);
}

enum unit_match units_compare(const char *from, const char *to, struct unit_change *change)
{
    char from_name[NAME_BYTES], to_name[NAME_BYTES];
    struct unit_entry a, b;
    normalise(from, from_name);
    normalise(to, to_name);
    *change = (struct unit_change){ 0 };
    if (!strcmp(from_name, to_name))
        return UNITS_SAME;
    bool know_from = find(from_name, &a), know_to = find(to_name, &b);
    if (!know_from || !know_to)
        return !know_from && !know_to && written_alike(from_name, to_name) ? UNITS_SAME : UNITS_UNKNOWN;
    if (a.kind != b.kind)
        return UNITS_OTHER_KIND;
    if (a.factor == b.factor && a.offset == b.offset)
        return UNITS_SAME;
    *change = (struct unit_change){ true, a.factor / b.factor, (a.offset - b.offset) / b.factor };
    return UNITS_CONVERT;
}

const char *unit_kind(const char *name)
{
    char normal[NAME_BYTES];
    struct unit_entry unit;
    normalise(name, normal);
    return find(normal, &unit) ? kind_names[unit.kind] : NULL;
}

bool unit_suggest(const char *name, char near[UNIT_NAME_BYTES])
{
    char normal[NAME_BYTES], firsts[UNIT_COUNT][UNIT_NAME_BYTES];
    const char *names[UNIT_COUNT];
    normalise(name, normal);
    for (size_t i = 0; i < UNIT_COUNT; i++) {
        size_t bytes = strcspn(units[i].names, "|");
        memcpy(firsts[i], units[i].names, bytes);
        firsts[i][bytes] = 0;
        names[i] = firsts[i];
    }
    const char *found = suggest_nearest(normal, names, UNIT_COUNT, sizeof(*names));
    strcpy(near, found ? found : "");
    return found != NULL;
}
