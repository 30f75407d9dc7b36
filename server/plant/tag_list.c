/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tag list: columns by name, rows into tags, and what must hold in each row. PLANT.md describes the form. */
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "plant/address.h"
#include "plant/csv.h"
#include "plant/number.h"
#include "plant/plant_parts.h"
#include "plant/suggest.h"

enum column {
    COL_NAME, COL_ADDRESS, COL_DATA_TYPE, COL_SCAN_RATE, COL_SCALING, COL_RAW_LOW, COL_RAW_HIGH, COL_SCALED_LOW, COL_SCALED_HIGH, COL_ENG_UNITS, COL_NEGATE, COL_DESCRIPTION,
    COL_CLAMP_LOW, COL_CLAMP_HIGH, COL_RESPECT_DATA_TYPE, COL_CLIENT_ACCESS, COL_SCALED_DATA_TYPE,
    COL_SOURCE, COL_GROUP, COL_ASSET, COL_NODE, COL_X, COL_Y, COL_Z, COL_STRENGTH, COL_DECAY, COL_BYTE_ORDER, COL_STALE, COL_LL, COL_L, COL_H, COL_HH,
    COL_FLATLINE, COL_QUALITY_TAG, COL_DEADBAND, COL_ALARM_DEADBAND, COL_ON_DELAY, COL_OFF_DELAY, COL_PRIORITY,
    COL_COUNT
};

struct column_name { /* begins with a name, for suggest_nearest */
    const char *name;
    enum column column;
};
static const struct column_name column_names[] = { /* the first name of a column is the one for messages */
    { "Tag Name", COL_NAME }, { "Address", COL_ADDRESS }, { "Data Type", COL_DATA_TYPE }, { "Scan Rate", COL_SCAN_RATE }, { "Scaling", COL_SCALING },
    { "Raw Low", COL_RAW_LOW }, { "Raw High", COL_RAW_HIGH }, { "Scaled Low", COL_SCALED_LOW }, { "Scaled High", COL_SCALED_HIGH },
    { "Eng Units", COL_ENG_UNITS }, { "Eng. Units", COL_ENG_UNITS }, { "Engineering Units", COL_ENG_UNITS }, { "Negate Value", COL_NEGATE },
    { "Description", COL_DESCRIPTION }, { "Clamp Low", COL_CLAMP_LOW }, { "Clamp High", COL_CLAMP_HIGH },
    { "Respect Data Type", COL_RESPECT_DATA_TYPE }, { "Client Access", COL_CLIENT_ACCESS }, { "Scaled Data Type", COL_SCALED_DATA_TYPE },
    { "Source", COL_SOURCE }, { "Group", COL_GROUP }, { "Asset", COL_ASSET }, { "Node", COL_NODE }, { "X", COL_X }, { "Y", COL_Y }, { "Z", COL_Z },
    { "Strength", COL_STRENGTH }, { "Decay", COL_DECAY }, { "Byte Order", COL_BYTE_ORDER }, { "Stale s", COL_STALE },
    { "LL", COL_LL }, { "L", COL_L }, { "H", COL_H }, { "HH", COL_HH },
    { "Flatline s", COL_FLATLINE }, { "Quality Tag", COL_QUALITY_TAG }, { "Deadband", COL_DEADBAND }, { "Alarm Deadband", COL_ALARM_DEADBAND },
    { "On Delay s", COL_ON_DELAY }, { "Off Delay s", COL_OFF_DELAY }, { "Priority", COL_PRIORITY },
};
enum { NAME_COUNT = sizeof(column_names) / sizeof(*column_names) };

struct tag_reader {
    struct plant *plant;
    struct csv csv;
    int at[COL_COUNT]; /* column of the file, or -1 */
    struct plant_tag *tag; /* of the current row */
    size_t capacity;
};

static const char *name_of(enum column column)
{
    size_t i = 0;
    while (column_names[i].column != column)
        i++;
    return column_names[i].name;
}

static const char *text_of(const struct tag_reader *reader, enum column column)
{
    return csv_text(&reader->csv, reader->at[column]);
}

static bool given(const struct tag_reader *reader, enum column column)
{
    return text_of(reader, column)[0];
}

#define row_error(reader, column, ...) csv_error(&(reader)->csv, (reader)->at[column], __VA_ARGS__)
#define row_warning(reader, column, ...) csv_warning(&(reader)->csv, (reader)->at[column], __VA_ARGS__)

/* --- the header ------------------------------------------------------------------------------------------------------------- */

static void find_columns(struct tag_reader *reader)
{
    const struct csv_row *header = &reader->csv.header;
    for (size_t c = 0; c < COL_COUNT; c++)
        reader->at[c] = -1;
    for (size_t i = 0; i < header->count; i++) {
        const struct csv_cell *cell = &header->cells[i];
        size_t n = 0;
        while (n < NAME_COUNT && strcasecmp(column_names[n].name, cell->text) != 0)
            n++;
        if (n < NAME_COUNT) {
            int *at = &reader->at[column_names[n].column];
            if (*at >= 0 && strcasecmp(header->cells[*at].text, cell->text) != 0)
                diag_error(reader->csv.diag, reader->csv.path, cell->line, cell->column, "column '%s' means the same as '%s' at column %d", cell->text,
                           header->cells[*at].text, header->cells[*at].column);
            *at = (int)i;
        } else if (strncasecmp(cell->text, "Sim ", 4) != 0) {
            const char *near = suggest_nearest(cell->text, column_names, NAME_COUNT, sizeof(*column_names));
            diag_warning(reader->csv.diag, reader->csv.path, cell->line, cell->column, "unknown column '%.60s' is ignored%s%s%s", cell->text,
                         near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
        }
    }
}

static void need_column(struct tag_reader *reader, enum column column)
{
    const struct csv_cell *first = &reader->csv.header.cells[0];
    if (reader->at[column] < 0)
        diag_error(reader->csv.diag, reader->csv.path, first->line, first->column, "the header has no column '%s'", name_of(column));
}

/* --- cells ------------------------------------------------------------------------------------------------------------------ */

/* Reads a number in [low, high] (both 0: any that is finite). False, and *out as it was: blank, or wrong (reported). */
static bool read_number(struct tag_reader *reader, enum column column, double low, double high, double *out)
{
    double value = 0;
    if (!given(reader, column))
        return false;
    switch (number_parse(text_of(reader, column), &value)) {
    case NUMBER_NOT_A_NUMBER:
        row_error(reader, column, "%s: expected a number%s, found '%.60s'", name_of(column),
                  strchr(text_of(reader, column), ',') ? " with a decimal point" : "", text_of(reader, column));
        return false;
    case NUMBER_NOT_FINITE:
        row_error(reader, column, "%s: expected a finite number, found '%.60s'", name_of(column), text_of(reader, column));
        return false;
    case NUMBER_GOOD:
        break;
    }
    if (!(low == 0 && high == 0) && !(value >= low && value <= high)) {
        row_error(reader, column, "%s: expected a number from %.9g to %.9g, found '%.60s'", name_of(column), low, high, text_of(reader, column));
        return false;
    }
    *out = value;
    return true;
}

static bool read_flag(struct tag_reader *reader, enum column column)
{
    static const char *const yes[] = { "1", "true", "yes" }, *const no[] = { "", "0", "false", "no" };
    const char *text = text_of(reader, column);
    for (size_t i = 0; i < 3; i++)
        if (!strcasecmp(text, yes[i]))
            return true;
    for (size_t i = 0; i < 4; i++)
        if (!strcasecmp(text, no[i]))
            return false;
    row_error(reader, column, "%s: expected 0 or 1, found '%.60s'", name_of(column), text);
    return false;
}

/* Index of the thing (its struct begins with its id) that the cell names; -1: blank, or unknown (reported). */
static int read_reference(struct tag_reader *reader, enum column column, const char *what, const void *things, size_t count, size_t stride)
{
    const char *text = text_of(reader, column), *id;
    if (!*text || (count == 0 && column != COL_SOURCE)) /* without groups or assets the plant file is wrong already */
        return -1;
    for (size_t i = 0; i < count; i++) {
        memcpy(&id, (const char *)things + i * stride, sizeof(id));
        if (id && !strcmp(id, text))
            return (int)i;
    }
    const char *near = suggest_nearest(text, things, count, stride);
    row_error(reader, column, "%s: unknown %s '%.60s'%s%s%s", name_of(column), what, text, near ? "; did you mean '" : "", near ? near : "",
              near ? "'?" : "");
    return -1;
}

/* --- rows ------------------------------------------------------------------------------------------------------------------- */

static void read_references(struct tag_reader *reader)
{
    const struct plant *plant = reader->plant;
    struct plant_tag *tag = reader->tag;
    tag->group = read_reference(reader, COL_GROUP, "group", plant->groups, plant->group_count, sizeof(*plant->groups));
    tag->asset = read_reference(reader, COL_ASSET, "asset", plant->assets, plant->asset_count, sizeof(*plant->assets));
    tag->source = read_reference(reader, COL_SOURCE, "source", plant->sources, plant->source_count, sizeof(*plant->sources));
    if (given(reader, COL_SOURCE))
        return;
    if (plant->source_count == 1)
        tag->source = 0;
    else if (plant->source_count > 1)
        row_error(reader, COL_SOURCE, "Source: expected the id of one of the %zu sources", plant->source_count);
}

/* In which order the bytes of this tag come: by the address' suffix or the column, else by the source. */
static void read_byte_order(struct tag_reader *reader, const struct modbus_address *address)
{
    struct plant_tag *tag = reader->tag;
    enum byte_order stated = BYTE_ORDER_NONE;
    if (given(reader, COL_BYTE_ORDER) && !byte_order_parse(text_of(reader, COL_BYTE_ORDER), &stated)) {
        row_error(reader, COL_BYTE_ORDER, "Byte Order: expected ABCD, CDAB, BADC or DCBA, found '%.60s'", text_of(reader, COL_BYTE_ORDER));
        return;
    }
    if (stated && address->byte_order && stated != address->byte_order) {
        row_error(reader, COL_BYTE_ORDER, "Byte Order: '%s' contradicts the address '%.60s'", text_of(reader, COL_BYTE_ORDER), tag->address);
        return;
    }
    tag->byte_order = stated ? stated : address->byte_order;
    if (tag->type == DATA_BIT)
        tag->byte_order = BYTE_ORDER_NONE;
    if (tag->byte_order || data_type_registers(tag->type) == 1)
        return;
    if (tag->source >= 0)
        tag->byte_order = reader->plant->sources[tag->source].byte_order;
    if (!tag->byte_order)
        row_error(reader, reader->at[COL_BYTE_ORDER] >= 0 ? COL_BYTE_ORDER : COL_DATA_TYPE,
                  "%s has %d bits, so it needs a byte order: ABCD, CDAB, BADC or DCBA in the column Byte Order, or byte_order of its source",
                  data_type_name(tag->type), data_type_registers(tag->type) * 16);
}

/* False: reported. Kepware's "Default" is Word, and Boolean where the address is one bit. */
static bool read_type(struct tag_reader *reader, const struct modbus_address *address)
{
    struct plant_tag *tag = reader->tag;
    const char *text = text_of(reader, COL_DATA_TYPE);
    bool one_bit = address->table == TABLE_COIL || address->table == TABLE_DISCRETE || address->bit >= 0;
    tag->type = one_bit ? DATA_BIT : DATA_UINT16;
    if (!*text || !strcasecmp(text, "Default"))
        return true;
    if (!data_type_parse(text, &tag->type)) {
        const char *near = data_type_suggest(text);
        row_error(reader, COL_DATA_TYPE, "Data Type: unknown type '%.60s'%s%s%s", text, near ? "; did you mean '" : "; expected bool, int16, uint16, "
                  "int32, uint32, float32, int64, uint64, float64, bcd, lbcd or Kepware's names for them", near ? near : "", near ? "'?" : "");
        return false;
    }
    if (one_bit != (tag->type == DATA_BIT)) {
        if (one_bit)
            row_error(reader, COL_DATA_TYPE, "Data Type: expected Boolean, since '%.60s' is one bit, found '%s'", tag->address, text);
        else
            row_error(reader, COL_ADDRESS, "Address: expected a bit such as %.60s.0, since the type is %s", tag->address, text);
        return false;
    }
    return true;
}

static void read_address(struct tag_reader *reader)
{
    struct plant_tag *tag = reader->tag;
    struct modbus_address address;
    char why[200];
    tag->address = mem_strdup(text_of(reader, COL_ADDRESS));
    if (!given(reader, COL_ADDRESS)) {
        if (tag->source >= 0)
            row_error(reader, COL_ADDRESS, "Address: expected the address of a register, such as 400001 or hr:0");
        return;
    }
    int base = tag->source >= 0 ? reader->plant->sources[tag->source].address_base : 1;
    if (!address_parse(tag->address, base, &address, why)) {
        row_error(reader, COL_ADDRESS, "Address: '%.60s' %s", tag->address, why);
        return;
    }
    tag->modbus_unit = address.unit;
    tag->table = address.table;
    tag->register_index = address.index;
    tag->bit = address.bit;
    if (!read_type(reader, &address))
        return;
    read_byte_order(reader, &address);
    if (tag->register_index + data_type_registers(tag->type) > 65536)
        row_error(reader, COL_ADDRESS, "Address: '%.60s' is the last register, but %s takes %d", tag->address, data_type_name(tag->type),
                  data_type_registers(tag->type));
}

static void read_range(struct tag_reader *reader, enum column low, enum column high, double *out_low, double *out_high)
{
    int errors = reader->csv.diag->errors;
    bool has_low = read_number(reader, low, 0, 0, out_low), has_high = read_number(reader, high, 0, 0, out_high);
    if (errors != reader->csv.diag->errors)
        return;
    if (!has_low || !has_high)
        row_error(reader, has_low ? high : low, "%s: expected a number, since Scaling is %s", name_of(has_low ? high : low), text_of(reader, COL_SCALING));
    else if (*out_low >= *out_high)
        row_error(reader, low, "%s: expected less than %s, which is %.9g, found %.9g", name_of(low), name_of(high), *out_high, *out_low);
}

static void read_scaling(struct tag_reader *reader)
{
    struct plant_tag *tag = reader->tag;
    const char *text = text_of(reader, COL_SCALING);
    if (!strcasecmp(text, "Linear"))
        tag->scaling = SCALING_LINEAR;
    else if (!strcasecmp(text, "Square Root"))
        tag->scaling = SCALING_SQUARE_ROOT;
    else if (*text && strcasecmp(text, "None") != 0)
        row_error(reader, COL_SCALING, "Scaling: expected None, Linear or Square Root, found '%.60s'", text);
    if (tag->scaling != SCALING_NONE) {
        read_range(reader, COL_RAW_LOW, COL_RAW_HIGH, &tag->raw_low, &tag->raw_high);
        read_range(reader, COL_SCALED_LOW, COL_SCALED_HIGH, &tag->scaled_low, &tag->scaled_high);
    } else if (!*text && given(reader, COL_RAW_LOW) && given(reader, COL_SCALED_LOW)) {
        row_warning(reader, COL_SCALING, "Scaling is blank, so the raw and scaled ranges have no effect; write Linear or None");
    }
    tag->negate = read_flag(reader, COL_NEGATE);
    for (enum column clamp = COL_CLAMP_LOW; clamp <= COL_CLAMP_HIGH; clamp++)
        if (read_flag(reader, clamp))
            row_warning(reader, clamp, "%s has no effect: what is beyond the range is shown as such", name_of(clamp));
}

static void read_place(struct tag_reader *reader)
{
    struct plant_tag *tag = reader->tag;
    static const enum column axes[3] = { COL_X, COL_Y, COL_Z };
    int have = 0, good = 0, missing = 0;
    for (int i = 0; i < 3; i++) {
        have += given(reader, axes[i]);
        good += read_number(reader, axes[i], -PLANT_MAX_M, PLANT_MAX_M, &tag->position_m[i]);
        if (!given(reader, axes[i]))
            missing = i;
    }
    tag->has_position = good == 3;
    if (given(reader, COL_NODE))
        tag->node = mem_strdup(text_of(reader, COL_NODE));
    if (have == 1 || have == 2)
        row_error(reader, axes[missing], "%s is missing: a position needs X, Y and Z", name_of(axes[missing]));
    if (have == 3 && tag->node)
        row_warning(reader, COL_NODE, "both Node and X, Y, Z are given; the position is used");
    if (have == 0 && !tag->node && given(reader, COL_GROUP) && given(reader, COL_ASSET))
        row_error(reader, reader->at[COL_NODE] >= 0 ? COL_NODE : COL_NAME, "'%.60s' has a group and an asset but no place: expected Node or X, Y, Z", tag->name);
    if (given(reader, COL_GROUP) && !given(reader, COL_ASSET))
        row_warning(reader, reader->at[COL_ASSET] >= 0 ? COL_ASSET : COL_NAME, "'%.60s' has a group but no asset, so it is in no field", tag->name);
}

static void read_limits(struct tag_reader *reader)
{
    static const enum column columns[LIMIT_COUNT] = { [LIMIT_LL] = COL_LL, [LIMIT_L] = COL_L, [LIMIT_H] = COL_H, [LIMIT_HH] = COL_HH };
    struct plant_tag *tag = reader->tag;
    const struct plant_group *group = tag->group >= 0 ? &reader->plant->groups[tag->group] : NULL;
    bool own = false;
    int lower, upper;
    for (int i = 0; i < LIMIT_COUNT; i++) {
        tag->limits[i] = group ? group->limits[i] : NAN;
        own |= read_number(reader, columns[i], -PLANT_MAX_VALUE, PLANT_MAX_VALUE, &tag->limits[i]);
    }
    if (!own || !plant_limits_wrong(tag->limits, &lower, &upper))
        return;
    row_error(reader, given(reader, columns[upper]) ? columns[upper] : columns[lower], "%s is %.9g, but %s is %.9g%s; expected LL < L < H < HH",
              plant_limit_names[lower], tag->limits[lower], plant_limit_names[upper], tag->limits[upper],
              given(reader, columns[upper]) && given(reader, columns[lower]) ? "" : " (one of them the group's)");
}

/* "degC", "°C" and "C" are the same. */
static bool same_unit(const char *a, const char *b)
{
    static const char *const skipped[] = { "\xC2\xB0", "deg", " " };
    const char **both[2] = { &a, &b };
    for (;;) {
        for (int i = 0; i < 2; i++)
            for (size_t k = 0; k < 3; k++)
                if (!strncasecmp(*both[i], skipped[k], strlen(skipped[k])))
                    *both[i] += strlen(skipped[k]);
        if (tolower((unsigned char)*a) != tolower((unsigned char)*b))
            return false;
        if (!*a)
            return true;
        a++;
        b++;
    }
}

static void read_unit(struct tag_reader *reader)
{
    struct plant_tag *tag = reader->tag;
    const char *of_group = tag->group >= 0 ? reader->plant->groups[tag->group].unit : NULL;
    tag->unit = mem_strdup(given(reader, COL_ENG_UNITS) ? text_of(reader, COL_ENG_UNITS) : of_group ? of_group : "");
    if (of_group && !same_unit(tag->unit, of_group))
        row_warning(reader, COL_ENG_UNITS, "Eng Units: '%.60s' is not the unit of its group, '%s'", tag->unit, of_group);
}

static void read_timing(struct tag_reader *reader)
{
    struct plant_tag *tag = reader->tag;
    double scan_ms = 0;
    if (given(reader, COL_SCAN_RATE) && strcmp(text_of(reader, COL_SCAN_RATE), "0") != 0)
        read_number(reader, COL_SCAN_RATE, 10, 86400000, &scan_ms);
    tag->scan_ms = (int)ceil(scan_ms);
    int poll_ms = tag->scan_ms ? tag->scan_ms : tag->source >= 0 ? reader->plant->sources[tag->source].poll_ms : 1000;
    tag->stale_s = fmax(5, 3 * poll_ms / 1000.0);
    read_number(reader, COL_STALE, 1e-3, 1e6, &tag->stale_s);
}

static void read_weights(struct tag_reader *reader)
{
    struct plant_tag *tag = reader->tag;
    const struct plant_group *group = tag->group >= 0 ? &reader->plant->groups[tag->group] : NULL;
    tag->strength = group ? group->strength : 1;
    tag->decay = group ? group->decay : 1;
    read_number(reader, COL_STRENGTH, 0, 100, &tag->strength);
    read_number(reader, COL_DECAY, 0, 100, &tag->decay);
}

/* Columns that are read by what comes later; here their numbers are checked. */
static void check_others(struct tag_reader *reader)
{
    static const enum column columns[] = { COL_FLATLINE, COL_DEADBAND, COL_ALARM_DEADBAND, COL_ON_DELAY, COL_OFF_DELAY, COL_PRIORITY };
    double ignored;
    for (size_t i = 0; i < sizeof(columns) / sizeof(*columns); i++)
        read_number(reader, columns[i], 0, PLANT_MAX_VALUE, &ignored);
}

static void read_row(struct tag_reader *reader)
{
    struct plant *plant = reader->plant;
    mem_grow(&plant->tags, &reader->capacity, plant->tag_count + 1, sizeof(*plant->tags));
    struct plant_tag *tag = reader->tag = &plant->tags[plant->tag_count++];
    *tag = (struct plant_tag){ .line = csv_cell_line(&reader->csv, reader->at[COL_NAME]), .column = csv_cell_column(&reader->csv, reader->at[COL_NAME]), .modbus_unit = -1, .bit = -1 };
    tag->name = mem_strdup(text_of(reader, COL_NAME));
    tag->description = mem_strdup(text_of(reader, COL_DESCRIPTION));
    if (!*tag->name && reader->at[COL_NAME] >= 0)
        row_error(reader, COL_NAME, "Tag Name: expected a name, found none");
    read_references(reader);
    read_address(reader);
    read_scaling(reader);
    read_place(reader);
    read_limits(reader);
    read_unit(reader);
    read_timing(reader);
    read_weights(reader);
    check_others(reader);
}

/* --- the list as a whole ---------------------------------------------------------------------------------------------------- */

static int by_name(const void *pa, const void *pb, void *tags_ptr)
{
    const struct plant_tag *tags = tags_ptr;
    int a = *(const int *)pa, b = *(const int *)pb;
    int order = strcmp(tags[a].name, tags[b].name);
    return order ? order : (a > b) - (a < b);
}

static void check_duplicates(struct tag_reader *reader)
{
    struct plant *plant = reader->plant;
    plant->tags_by_name = mem_array(plant->tag_count, sizeof(*plant->tags_by_name));
    for (size_t i = 0; i < plant->tag_count; i++)
        plant->tags_by_name[i] = (int)i;
    qsort_r(plant->tags_by_name, plant->tag_count, sizeof(*plant->tags_by_name), by_name, plant->tags);
    for (size_t i = 1, first = 0; i < plant->tag_count; i++) {
        const struct plant_tag *one = &plant->tags[plant->tags_by_name[first]], *two = &plant->tags[plant->tags_by_name[i]];
        if (strcmp(one->name, two->name) != 0)
            first = i;
        else if (*two->name)
            diag_error(reader->csv.diag, reader->csv.path, two->line, two->column, "Tag Name: '%.60s' is there twice (first at line %d)", two->name,
                       one->line);
    }
}

void tag_list_read(struct plant *plant, struct diag *diag)
{
    struct tag_reader reader = { .plant = plant };
    if (!csv_open(&reader.csv, plant->tags_path, diag))
        return;
    find_columns(&reader);
    need_column(&reader, COL_NAME);
    if (plant->source_count > 0)
        need_column(&reader, COL_ADDRESS);
    while (csv_next(&reader.csv))
        read_row(&reader);
    check_duplicates(&reader);
    csv_close(&reader.csv);
}
