/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Determines what tags measure. */
#include "preprocess/match/quantities.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "plant/parse/number.h"
#include "plant/tags/units.h"
#include "preprocess/match/isa.h"
#include "preprocess/match/quantity_words.h"

enum { NAME_BYTES = 48 };

static bool has_any(const char *text, const char *const *words, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!strcasecmp(text, words[i]))
            return true;
    return false;
}

/* Returns whether the values of tags of this data type can be interpolated between sensors and shown as colours: false for
   booleans, texts and times. */
static bool is_number(const char *type)
{
    static const char *const others[] = { "Boolean",  "Bool", "Bit",      "String",  "Text", "Char",
                                          "DateTime", "Date", "Discrete", "Digital", "DI",   "DO" };
    return !has_any(type, others, sizeof(others) / sizeof(*others));
}

/* For each kind of unit, the quantities measured in such units; the first is the default. An empty list: units of this kind do
 * not identify a quantity. */
static const struct {
    const char *kind;
    bool alone; /* true: a unit of this kind alone determines the quantity, without the tag's description or ISA-5.1 letters */
    const char *quantities;
} kinds[] = {
    { "temperature", true, "|Temperature|" },
    /* units of pressure, whether gauge, absolute or relative to another reference */
    { "pressure", true, "|Pressure|Differential pressure|" },
    { "flow", true, "|Flow|" },
    { "density", true, "|Density|" },
    { "conductivity", true, "|Conductivity|" },
    { "power", true, "|Power|" },
    { "energy", true, "|Energy|" },
    { "force", true, "|Force|Weight|" },
    { "speed of rotation", true, "|Speed|" },
    { "voltage", true, "|Voltage|" },
    { "current", true, "|Current|" },
    { "velocity", false, "|Velocity|Vibration|Speed|Flow|" },
    { "acceleration", false, "|Vibration|Acceleration|" },
    { "frequency", false, "|Frequency|Speed|Vibration|" },
    { "length", false, "|Level|Position|Vibration|Length|" },
    { "mass", false, "|Weight|Quantity|Level|" },
    { "volume", false, "|Level|Quantity|Volume|" },
    { "angle", false, "|Position|Angle|" },
    { "resistance", false, "|Resistance|Conductivity|Temperature|" },
};

/* Returns the table index of the unit's kind; -1: unknown unit. */
static int kind_of(const char *unit)
{
    const char *kind = *unit ? unit_kind(unit) : NULL;
    int found = -1;
    for (size_t i = 0; i < sizeof(kinds) / sizeof(*kinds) && kind && found < 0; i++)
        if (!strncmp(kind, kinds[i].kind, strlen(kinds[i].kind)) || (i < 3 && strstr(kind, kinds[i].kind)))
            found = (int)i;
    return found;
}

static bool is_possible(int kind, const char *quantity)
{
    char *wanted = mem_printf("|%s|", quantity);
    bool possible = kind < 0 || strstr(kinds[kind].quantities, wanted) != NULL;
    mem_free(wanted);
    return possible;
}

/* Returns whether the tag is a tuning parameter of a controller. TI is one (integral time) if its unit is seconds; with another
   unit, or a description that names a temperature, it is a temperature indicator. */
static bool is_tuning(const struct export_tag *tag, const struct isa_name *isa, int kind, const char *described)
{
    if (strcmp(isa->attribute, "TI") != 0)
        return isa->role != ISA_MEASURED;
    const char *unit = *tag->fields[EXPORT_UNIT] ? unit_kind(tag->fields[EXPORT_UNIT]) : NULL;
    return (unit && !strcmp(unit, "time")) || (kind < 0 && !described);
}

/* Writes the name of the quantity that a tag measures, such as "Temperature", to `name`. Looks for a quantity in the tag's
   description, then in the last part of its name, then in its ISA-5.1 letters (T in TI-101), and takes the first that can be
   measured in the tag's unit. If there is none, uses the default quantity of the unit, the kind of unit, or the unit itself.
   "": the tag is a state or setting, not a number, or has neither such words nor a unit. */
static void name_of(const struct export_tag *tag, char name[NAME_BYTES])
{
    struct isa_name isa;
    isa_read(&isa, tag->fields[EXPORT_NAME]);
    const char *unit = tag->fields[EXPORT_UNIT], *full = tag->fields[EXPORT_NAME], *slash = strrchr(full, '/');
    int kind = kind_of(unit);
    const char *described = quantity_words_find(tag->fields[EXPORT_DESCRIPTION]);
    const char *const said[] = { described, quantity_words_find(slash ? slash + 1 : full),
                                 isa.variable ? isa_quantity(isa.variable) : NULL };
    const char *found = NULL, *spoken = *unit ? unit_kind(unit) : NULL;
    name[0] = 0;
    if (is_tuning(tag, &isa, kind, described) || !is_number(tag->fields[EXPORT_TYPE]))
        return;
    for (size_t i = 0; i < sizeof(said) / sizeof(*said) && !found; i++)
        if (said[i] && is_possible(kind, said[i]))
            found = said[i];
    if (found)
        snprintf(name, NAME_BYTES, "%s", found);
    else if (kind >= 0 && kinds[kind].alone)
        snprintf(name, NAME_BYTES, "%.*s", (int)strcspn(kinds[kind].quantities + 1, "|"), kinds[kind].quantities + 1);
    else
        snprintf(name, NAME_BYTES, "%s", spoken ? spoken : unit);
    name[0] = (char)toupper((unsigned char)name[0]);
}

static bool unit_fits(const char *unit, const char *of_group)
{
    struct unit_change change;
    enum unit_match match = *unit ? units_compare(unit, of_group, &change) : UNITS_SAME;
    return match == UNITS_SAME || match == UNITS_CONVERT;
}

static void make_id(const struct quantities *quantities, const char *name, char id[NAME_BYTES + 8])
{
    size_t length = 0;
    for (const char *c = name; *c && length < NAME_BYTES; c++)
        if (isalnum((unsigned char)*c) || (unsigned char)*c >= 0x80)
            id[length++] = (char)tolower((unsigned char)*c);
        else if (length > 0 && id[length - 1] != '-')
            id[length++] = '-';
    while (length > 0 && id[length - 1] == '-')
        length--;
    id[length] = 0;
    for (int number = 2;; number++) {
        bool taken = false;
        for (size_t i = 0; i < quantities->count; i++)
            taken |= !strcmp(quantities->at[i].id, id);
        if (!taken)
            return;
        snprintf(id + length, 8, "-%d", number % 100000);
    }
}

static struct quantity *add_quantity(struct quantities *quantities, const char *id, const char *name, const char *unit, bool is_new)
{
    mem_grow(&quantities->at, &quantities->capacity, quantities->count + 1, sizeof(*quantities->at));
    struct quantity *quantity = &quantities->at[quantities->count++];
    *quantity = (struct quantity){
        .id = mem_strdup(id), .name = mem_strdup(name), .unit = mem_strdup(unit), .is_new = is_new, .low = INFINITY, .high = -INFINITY
    };
    return quantity;
}

/* Returns the index of the group for a quantity and unit; -1: none. An existing group fits by its unit alone if no other group
 * has that unit. */
static int find(const struct quantities *quantities, const char *name, const char *unit)
{
    int by_unit = -1, fitting = 0;
    for (size_t i = 0; i < quantities->count; i++) {
        const struct quantity *of = &quantities->at[i];
        if (!unit_fits(unit, of->unit))
            continue;
        if (!strcasecmp(of->name, name) || !strcasecmp(of->id, name))
            return (int)i;
        if (!of->is_new && *unit) {
            by_unit = (int)i;
            fitting++;
        }
    }
    return fitting == 1 ? by_unit : -1;
}

static void take_range(struct quantity *quantity, const struct export_tag *tag)
{
    const char *unit = tag->fields[EXPORT_UNIT];
    struct unit_change change = { 0 };
    double low, high;
    if (*unit)
        units_compare(unit, quantity->unit, &change);
    if (number_parse(tag->fields[EXPORT_SCALED_LOW], &low) != NUMBER_GOOD ||
        number_parse(tag->fields[EXPORT_SCALED_HIGH], &high) != NUMBER_GOOD || low == high)
        return;
    if (!strcmp(tag->fields[EXPORT_NEGATE], "1")) {
        low = -low;
        high = -high;
    }
    quantity->low = fmin(quantity->low, unit_change_value(&change, fmin(low, high)));
    quantity->high = fmax(quantity->high, unit_change_value(&change, fmax(low, high)));
}

/* Returns a unit as spelt in a colour scale's legend, such as "°C" for "degC". */
static const char *written(const char *unit)
{
    static const char *const usual[] = { "°C", "°F" };
    struct unit_change change;
    for (size_t i = 0; i < sizeof(usual) / sizeof(*usual); i++)
        if (*unit && units_compare(unit, usual[i], &change) == UNITS_SAME)
            return usual[i];
    return unit;
}

static void take(struct quantities *quantities, const struct tag_export *list, size_t i)
{
    const struct export_tag *tag = &list->tags[i];
    const char *unit = tag->fields[EXPORT_UNIT];
    char name[NAME_BYTES], id[NAME_BYTES + 8];
    name_of(tag, name);
    if (!*name)
        return;
    int at = find(quantities, name, unit);
    if (at < 0) {
        make_id(quantities, name, id);
        add_quantity(quantities, id, name, written(unit), true);
        at = (int)quantities->count - 1;
    }
    quantities->of_tag[i] = at;
    quantities->at[at].tags++;
    quantities->at[at].blank += !*unit;
    take_range(&quantities->at[at], tag);
}

void quantities_find(struct quantities *quantities, const struct plant *plant, const char *unused, const struct tag_export *list,
                     const struct match *matches)
{
    quantities->of_tag = mem_array(list->count, sizeof(*quantities->of_tag));
    for (size_t g = 0; g < plant->group_count; g++)
        if (!unused || strcmp(unused, plant->groups[g].id) != 0)
            add_quantity(quantities, plant->groups[g].id, plant->groups[g].quantity, plant->groups[g].unit, false);
    /* The second round assigns the tags without a unit, which join groups created by other tags in the first round. */
    for (int blank = 0; blank < 2; blank++)
        for (size_t i = 0; i < list->count; i++) {
            if (blank == 0)
                quantities->of_tag[i] = -1;
            if (matches[i].status == MATCH_SURE && blank == !*list->tags[i].fields[EXPORT_UNIT])
                take(quantities, list, i);
        }
}

void quantities_finish(struct quantities *quantities)
{
    for (size_t i = 0; i < quantities->count; i++) {
        mem_free(quantities->at[i].id);
        mem_free(quantities->at[i].name);
        mem_free(quantities->at[i].unit);
    }
    mem_free(quantities->at);
    mem_free(quantities->of_tag);
    *quantities = (struct quantities){ 0 };
}
