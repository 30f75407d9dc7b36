/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Selects the source of each tag's value. */
#include "sim_values.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "plant/parse/csv.h"
#include "sim_process.h"
#include "value/series.h"

struct tag_value {
    bool forced;
    double forced_to;
    const struct series *series; /* recorded series that the tag's value comes from; NULL: it comes from the simulated process */
    double scale, offset;
    struct unit_change change; /* unit conversion from the series to the device's value */
};

struct sim_values {
    const struct plant *plant;
    struct tag_value *tags;
    struct series *series;
    size_t series_count;
    struct process *process;
    double now_s;
    bool loop;
};

/* --- the process ------------------------------------------------------------------------------------------------------------ */

static bool mentions(const char *text, const char *const *words)
{
    for (; text && *words; words++)
        if (strcasestr(text, *words))
            return true;
    return false;
}

static enum process_kind kind_of(const struct plant *plant, const struct plant_tag *tag)
{
    static const char *const temperature[] = { "temp", NULL }, *const pressure[] = { "press", NULL }, *const vibration[] = { "vibr", NULL };
    static const char *const degrees[] = { "°", "degc", "degf", "deg c", "deg f", NULL };
    static const char *const bars[] = { "bar", "pa", "psi", NULL }, *const speeds[] = { "mm/s", "in/s", NULL };
    const char *quantity = tag->group >= 0 ? plant->groups[tag->group].quantity : "";
    const char *unit = tag->unit ? tag->unit : "";
    if (mentions(quantity, temperature) || mentions(unit, degrees))
        return PROCESS_TEMPERATURE;
    if (mentions(quantity, pressure) || mentions(unit, bars))
        return PROCESS_PRESSURE;
    return mentions(quantity, vibration) || mentions(unit, speeds) ? PROCESS_VIBRATION : PROCESS_OTHER;
}

/* Chooses a tag's range in the device's own unit. The operating value is 40 % of the range, unless the tag list has a `Sim Value`. */
static void choose_range(const struct plant *plant, const struct plant_tag *tag, struct process_tag *out)
{
    double low = 0, high = 100;
    if (tag->group >= 0) {
        low = unit_change_back(&tag->scale.change, plant->groups[tag->group].min);
        high = unit_change_back(&tag->scale.change, plant->groups[tag->group].max);
    } else if (tag->scale.kind != SCALING_NONE) {
        low = tag->scale.scaled_low;
        high = tag->scale.scaled_high;
    } else if (tag->signal.type == DATA_BIT || tag->signal.bit >= 0) {
        high = 0;
    }
    out->normal = low + 0.4 * (high - low);
    out->span = high - low;
}

static struct process *make_process(const struct plant *plant, struct diag *diag)
{
    struct csv csv;
    if (!csv_open(&csv, plant->files.tags_path, diag))
        return NULL;
    struct process_tag *tags = mem_array(plant->tag_count, sizeof(*tags));
    int value_column = csv_find(&csv, "Sim Value"), loop_column = csv_find(&csv, "Sim Loop");
    for (size_t i = 0; i < plant->tag_count && csv_next(&csv); i++) {
        const char *normal = csv_text(&csv, value_column);
        char *end = NULL;
        tags[i] = (struct process_tag){ .kind = kind_of(plant, &plant->tags[i]),
                                        .name = plant->tags[i].name,
                                        .loop = csv_text(&csv, loop_column) };
        choose_range(plant, &plant->tags[i], &tags[i]);
        if (!*normal)
            continue;
        tags[i].normal = strtod(normal, &end);
        if (*end || !isfinite(tags[i].normal))
            csv_error(&csv, value_column, "column Sim Value: expected a number, found %s", normal);
    }
    struct process *process = diag->errors ? NULL : process_create(tags, plant->tag_count, 1);
    mem_free(tags);
    csv_close(&csv);
    return process;
}

/* --- recorded series -------------------------------------------------------------------------------------------------------- */

static const struct series *find_series(struct sim_values *values, const struct sim_map *map, const struct sim_map_entry *entry,
                                            struct diag *diag)
{
    char why[200] = "no recorded series to replay: add --values FILE";
    bool found = false;
    for (size_t i = 0; i < values->series_count; i++)
        if (!strcmp(values->series[i].name, entry->series))
            return &values->series[i];
    for (size_t i = 0; i < map->file_count && !found; i++)
        if (!series_read(&values->series[values->series_count], map->files[i], entry->series, &found, why))
            break;
    if (!found)
        diag_error(diag, entry->file, entry->line, 0, "%s: %s", entry->tag, why);
    return found ? &values->series[values->series_count++] : NULL;
}

/* Sets the unit conversion of a tag with a series: from the unit in the series' file to the unit in the tag's row of the tag list. */
static void take_unit(struct sim_values *values, const struct sim_map_entry *entry, size_t tag, struct diag *diag)
{
    const char *unit = values->tags[tag].series ? values->tags[tag].series->unit : NULL, *own = values->plant->tags[tag].scale.own_unit;
    if (unit && *unit && units_compare(unit, own, &values->tags[tag].change) > UNITS_CONVERT)
        diag_error(diag, entry->file, entry->line, 0, "tag %s: series %s has the unit '%.60s', which cannot be converted to '%.60s'",
                   entry->tag, entry->series, unit, own);
}

static void apply_map(struct sim_values *values, const struct sim_map *map, struct diag *diag)
{
    values->series = mem_array(map->count, sizeof(*values->series));
    for (size_t i = 0; i < map->count; i++) {
        const struct sim_map_entry *entry = &map->entries[i];
        int tag = plant_find_tag(values->plant, entry->tag);
        if (tag < 0) {
            diag_error(diag, entry->file, entry->line, 0, "the plant has no tag %s", entry->tag);
            continue;
        }
        values->tags[tag].series = find_series(values, map, entry, diag);
        take_unit(values, entry, (size_t)tag, diag);
        values->tags[tag].scale = entry->scale;
        values->tags[tag].offset = entry->offset;
    }
}

/* ---------------------------------------------------------------------------------------------------------------------------- */

struct sim_values *sim_values_create(const struct plant *plant, const struct sim_map *map, bool loop, struct diag *diag)
{
    struct sim_values *values = mem_new(sizeof(*values));
    values->plant = plant;
    values->loop = loop;
    values->tags = mem_array(plant->tag_count, sizeof(*values->tags));
    values->process = make_process(plant, diag);
    apply_map(values, map, diag);
    if (!values->process || diag->errors)
        sim_values_destroy(&values);
    return values;
}

void sim_values_destroy(struct sim_values **values)
{
    if (!*values)
        return;
    for (size_t i = 0; i < (*values)->series_count; i++)
        series_finish(&(*values)->series[i]);
    mem_free((*values)->series);
    mem_free((*values)->tags);
    process_destroy(&(*values)->process);
    mem_free(*values);
    *values = NULL;
}

void sim_values_step(struct sim_values *values, double dt_s)
{
    values->now_s += dt_s;
    process_step(values->process, dt_s);
}

double sim_values_at(const struct sim_values *values, size_t tag)
{
    const struct tag_value *value = &values->tags[tag];
    if (value->forced)
        return value->forced_to;
    if (value->series)
        return unit_change_value(&value->change, series_at(value->series, values->now_s, values->loop)) * value->scale + value->offset;
    return process_value(values->process, tag);
}

void sim_values_force(struct sim_values *values, size_t tag, double value)
{
    values->tags[tag].forced = true;
    values->tags[tag].forced_to = value;
}

void sim_values_release(struct sim_values *values, size_t tag)
{
    values->tags[tag].forced = false;
}

double sim_values_upset(const struct sim_values *values, const char **name)
{
    return process_upset(values->process, name);
}
