/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the columns of the tag list by their names, and reads cells of its rows. */
#include "plant/tags/tag_columns.h"

#include <string.h>
#include <strings.h>

#include "plant/parse/number.h"
#include "plant/parse/suggest.h"

struct column_name { /* `text` is the first member, because suggest_nearest() expects a name at the beginning of each record */
    const char *name;
    enum tag_column column;
};

static const struct column_name column_names[] = {
    /* accepted names of the tag list's columns; the first name of each column is used in messages */
    { "Tag Name", COL_NAME },
    { "Address", COL_ADDRESS },
    { "Data Type", COL_DATA_TYPE },
    { "Scan Rate", COL_SCAN_RATE },
    { "Scaling", COL_SCALING },
    { "Raw Low", COL_RAW_LOW },
    { "Raw High", COL_RAW_HIGH },
    { "Scaled Low", COL_SCALED_LOW },
    { "Scaled High", COL_SCALED_HIGH },
    { "Eng Units", COL_ENG_UNITS },
    { "Eng. Units", COL_ENG_UNITS },
    { "Engineering Units", COL_ENG_UNITS },
    { "Negate Value", COL_NEGATE },
    { "Description", COL_DESCRIPTION },
    { "Clamp Low", COL_CLAMP_LOW },
    { "Clamp High", COL_CLAMP_HIGH },
    { "Respect Data Type", COL_RESPECT_DATA_TYPE },
    { "Client Access", COL_CLIENT_ACCESS },
    { "Scaled Data Type", COL_SCALED_DATA_TYPE },
    { "Source", COL_SOURCE },
    { "Group", COL_GROUP },
    { "Asset", COL_ASSET },
    { "Node", COL_NODE },
    { "X", COL_X },
    { "Y", COL_Y },
    { "Z", COL_Z },
    { "Strength", COL_STRENGTH },
    { "Decay", COL_DECAY },
    { "Byte Order", COL_BYTE_ORDER },
    { "Stale s", COL_STALE },
    { "LL", COL_LL },
    { "L", COL_L },
    { "H", COL_H },
    { "HH", COL_HH },
    { "Flatline s", COL_FLATLINE },
    { "Deadband", COL_DEADBAND },
    { "Alarm Deadband", COL_ALARM_DEADBAND },
    { "On Delay s", COL_ON_DELAY },
    { "Off Delay s", COL_OFF_DELAY },
    { "Priority", COL_PRIORITY },
    { "Quality Tag", COL_QUALITY_TAG },
    { "NE 43", COL_NE43 },
    { "Open Circuit", COL_OPEN_CIRCUIT },
    { "Latch", COL_LATCH },
    { "Suppressed By", COL_SUPPRESSED_BY },
    { "Mirrors", COL_MIRRORS },
    { "Place", COL_PLACE },
    { "Direction", COL_DIRECTION },
    { "OPC Deadband", COL_OPC_DEADBAND },
};
enum { NAME_COUNT = sizeof(column_names) / sizeof(*column_names) };

const char *tag_column_name(enum tag_column column)
{
    size_t i = 0;
    while (column_names[i].column != column)
        i++;
    return column_names[i].name;
}

/* --- the header ------------------------------------------------------------------------------------------------------------- */

#define header_error(columns, cell, ...) diag_error((columns)->csv.diag, (columns)->csv.path, (cell)->line, (cell)->column, __VA_ARGS__)
#define header_warning(columns, cell, ...) diag_warning((columns)->csv.diag, (columns)->csv.path, (cell)->line, (cell)->column, __VA_ARGS__)

static void report_unknown(struct tag_columns *columns, const struct csv_cell *cell)
{
    const char *near = suggest_nearest(cell->text, column_names, NAME_COUNT, sizeof(*column_names));
    if (near)
        header_warning(columns, cell, "unknown column '%.60s' is ignored; did you mean '%s'?", cell->text, near);
    else if (*cell->text)
        header_warning(columns, cell, "unknown column '%.60s' is ignored", cell->text);
    else
        header_warning(columns, cell, "a column without a name is ignored: write a name into the header, or delete the column");
}

/* Reports an error if the tag list has a column twice, under two of its accepted names. csv_open() reports columns with equal
   names. */
static void check_doubled(struct tag_columns *columns, const struct csv_cell *cell, int before)
{
    const struct csv_cell *first = before >= 0 ? &columns->csv.header.cells[before] : NULL;
    if (first && strcasecmp(first->text, cell->text) != 0)
        header_error(columns, cell, "column '%s' means the same as '%s' at column %d: delete one of the two columns", cell->text,
                     first->text, first->column);
}

static void find_columns(struct tag_columns *columns)
{
    for (size_t c = 0; c < COL_COUNT; c++)
        columns->at[c] = -1;
    for (size_t i = 0; i < columns->csv.header.count; i++) {
        const struct csv_cell *cell = &columns->csv.header.cells[i];
        size_t n = 0;
        while (n < NAME_COUNT && strcasecmp(column_names[n].name, cell->text) != 0)
            n++;
        if (n < NAME_COUNT) {
            int *at = &columns->at[column_names[n].column];
            check_doubled(columns, cell, *at);
            *at = (int)i;
        } else if (strncasecmp(cell->text, "Sim ", 4) != 0) { /* columns of plantcast-sim */
            report_unknown(columns, cell);
        }
    }
}

bool tag_columns_open(struct tag_columns *columns, const char *path, struct diag *diag)
{
    if (!csv_open(&columns->csv, path, diag))
        return false;
    find_columns(columns);
    return true;
}

void tag_columns_need(struct tag_columns *columns, enum tag_column column)
{
    const struct csv_cell *first = &columns->csv.header.cells[0];
    if (columns->at[column] < 0)
        header_error(columns, first, "the header of the tag list has no column '%s'", tag_column_name(column));
}

/* --- cells ------------------------------------------------------------------------------------------------------------------ */

const char *cell_text(const struct tag_columns *columns, enum tag_column column)
{
    return csv_text(&columns->csv, columns->at[column]);
}

bool cell_given(const struct tag_columns *columns, enum tag_column column)
{
    return cell_text(columns, column)[0];
}

bool cell_number(struct tag_columns *columns, enum tag_column column, double low, double high, double *out)
{
    const char *text = cell_text(columns, column), *name = tag_column_name(column);
    double value = 0;
    if (!*text)
        return false;
    enum number_result result = number_parse(text, &value);
    if (result == NUMBER_NOT_A_NUMBER) {
        cell_error(columns, column, "%s: expected a number%s, found '%.60s'", name, strchr(text, ',') ? " with a decimal point" : "", text);
        return false;
    }
    if (result == NUMBER_NOT_FINITE) {
        cell_error(columns, column, "%s: expected a finite number, found '%.60s'", name, text);
        return false;
    }
    if (!(low == 0 && high == 0) && !(value >= low && value <= high)) {
        cell_error(columns, column, "%s: expected a number from %.9g to %.9g, found '%.60s'", name, low, high, text);
        return false;
    }
    *out = value;
    return true;
}

bool cell_flag(struct tag_columns *columns, enum tag_column column)
{
    const char *text = cell_text(columns, column);
    bool flag = false;
    if (!*text || flag_parse(text, &flag))
        return flag;
    cell_error(columns, column, "%s: expected 0 or 1, found '%.60s'", tag_column_name(column), text);
    return false;
}

int cell_reference(struct tag_columns *columns, enum tag_column column, const char *what, const void *things, size_t count, size_t stride)
{
    const char *text = cell_text(columns, column), *id;
    if (!*text)
        return -1;
    for (size_t i = 0; i < count; i++) {
        memcpy(&id, (const char *)things + i * stride, sizeof(id));
        if (id && !strcmp(id, text))
            return (int)i;
    }
    const char *near = suggest_nearest(text, things, count, stride);
    if (near)
        cell_error(columns, column, "%s: unknown %s '%.60s'; did you mean '%s'?", tag_column_name(column), what, text, near);
    else
        cell_error(columns, column, "%s: unknown %s '%.60s'; the plant file has no such id", tag_column_name(column), what, text);
    return -1;
}
