/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads tag values with their quality from a CSV file. */
#include "values.h"

#include <math.h>
#include <stdlib.h>
#include <strings.h>

#include "plant/parse/csv.h"
#include "value/quality.h"

struct columns {
    int tag, value, quality, unit;
};

/* Finds the columns by the header row. Without a header, the columns have their default order and the first row is data. */
static bool find_columns(const struct csv *csv, struct columns *columns)
{
    columns->tag = csv_find(csv, "tag");
    columns->value = csv_find(csv, "value");
    columns->quality = csv_find(csv, "quality");
    columns->unit = csv_find(csv, "unit");
    if (columns->tag < 0)
        columns->tag = csv_find(csv, "tag name");
    if (columns->tag >= 0 && columns->value >= 0)
        return true;
    *columns = (struct columns){ .tag = 0, .value = 1, .quality = 2, .unit = -1 };
    return false;
}

static bool quality_parse(const char *text, uint32_t *quality)
{
    static const struct {
        const char *name;
        uint32_t quality;
    } known[] = { { "", QUALITY_GOOD },
                  { "good", QUALITY_GOOD },
                  { "uncertain", QUALITY_UNCERTAIN_LAST_USABLE },
                  { "bad", QUALITY_BAD_SENSOR_FAILURE } };
    for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++)
        if (!strcasecmp(text, known[i].name)) {
            *quality = known[i].quality;
            return true;
        }
    return false;
}

static const char *cell(const struct csv_row *row, int column)
{
    return column >= 0 && (size_t)column < row->count ? row->cells[column].text : "";
}

/* Converts a value to the tag's display unit, from the unit in its CSV row or, if the row has none, from the tag's own unit. */
static bool take_unit(const struct csv *csv, const struct csv_row *row, const struct columns *columns, const struct plant_tag *tag,
                      double *value)
{
    const char *unit = cell(row, columns->unit);
    struct unit_change change = tag->scale.change;
    if (*unit && units_compare(unit, tag->unit, &change) > UNITS_CONVERT) {
        diag_error(csv->diag, csv->path, row->cells[columns->unit].line, row->cells[columns->unit].column,
                   "unit '%s' cannot be converted to '%s', the unit in which tag %s is displayed", unit, tag->unit, tag->name);
        return false;
    }
    *value = unit_change_value(&change, *value);
    return true;
}

static void row_read(const struct plant *plant, const struct csv *csv, const struct csv_row *row, const struct columns *columns,
                     struct snapshot *snapshot)
{
    const char *name = cell(row, columns->tag), *value = cell(row, columns->value), *quality = cell(row, columns->quality);
    int tag = plant_find_tag(plant, name), line = row->cells[0].line;
    struct reading reading = { .received_utc_ns = snapshot->taken_utc_ns };
    char *end;
    if (tag < 0)
        diag_error(csv->diag, csv->path, line, row->cells[0].column, "tag '%s' is not in the tag list %s", name, plant->files.tags_path);
    if (!quality_parse(quality, &reading.quality))
        diag_error(csv->diag, csv->path, line, row->cells[columns->quality].column, "quality: expected good, uncertain or bad, found '%s'",
                   quality);
    reading.value = strtod(value, &end);
    if (*end != 0)
        diag_error(csv->diag, csv->path, line, row->cells[columns->value].column, "value: expected a number, found '%s'", value);
    if (*value == 0 || !isfinite(reading.value))
        reading = (struct reading){ .quality = QUALITY_BAD_SENSOR_FAILURE, .received_utc_ns = snapshot->taken_utc_ns };
    if (tag < 0)
        return;
    if (!take_unit(csv, row, columns, &plant->tags[tag], &reading.value))
        return;
    reading.changes = snapshot->readings[tag].changes + 1;
    snapshot->readings[tag] = reading;
}

bool values_read(const struct plant *plant, const char *path, struct snapshot *snapshot, struct diag *diag)
{
    struct csv csv;
    struct columns columns;
    int errors = diag->errors;
    if (!csv_open(&csv, path, diag))
        return false;
    if (!find_columns(&csv, &columns))
        row_read(plant, &csv, &csv.header, &columns, snapshot);
    while (csv_next(&csv))
        row_read(plant, &csv, &csv.row, &columns, snapshot);
    csv_close(&csv);
    return diag->errors == errors;
}
