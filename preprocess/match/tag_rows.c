/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edits rows of tags.csv. */
#include "preprocess/match/tag_rows.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/math/search.h"
#include "base/mem.h"
#include "base/text/charset.h"
#include "plant/parse/number.h"
#include "plant/sources/address.h"
#include "plant/tags/units.h"
#include "preprocess/match/fold.h"
#include "preprocess/match/table.h"

enum column {
    NAME,
    ADDRESS,
    TYPE,
    SCALING,
    RAW_LOW,
    RAW_HIGH,
    SCALED_LOW,
    SCALED_HIGH,
    NEGATE,
    UNITS,
    DESCRIPTION,
    SOURCE,
    GROUP,
    ASSET,
    PLACE,
    NODE,
    X,
    Y,
    Z,
    LL,
    L,
    H,
    HH,
    COLUMNS
};
static const char *const names[COLUMNS] = {
    "Tag Name",  "Address",     "Data Type", "Scaling", "Raw Low", "Raw High", "Scaled Low", "Scaled High", "Negate Value",
    "Eng Units", "Description", "Source",    "Group",   "Asset",   "Place",    "Node",       "X",           "Y",
    "Z",         "LL",          "L",         "H",       "HH"
};
static const size_t max_bytes = (size_t)64 << 20;

/* --- reading ---------------------------------------------------------------------------------------------------------------- */

static struct table_row *add_row(struct tag_rows *rows)
{
    mem_grow(&rows->at, &rows->capacity, rows->count + 1, sizeof(*rows->at));
    return &rows->at[rows->count++];
}

static void set_cell(struct table_row *row, int column, const char *text)
{
    while ((int)row->count <= column) {
        mem_grow(&row->cells, &row->capacity, row->count + 1, sizeof(*row->cells));
        row->cells[row->count++] = mem_strdup("");
    }
    mem_free(row->cells[column]);
    row->cells[column] = mem_strdup(text);
}

static int find_column(const struct tag_rows *rows, enum column column)
{
    static const char *const others[] = { "Eng. Units", "Engineering Units" };
    for (size_t c = 0; c < rows->at[0].count; c++) {
        const char *cell = rows->at[0].cells[c];
        if (!strcasecmp(cell, names[column]) || (column == UNITS && (!strcasecmp(cell, others[0]) || !strcasecmp(cell, others[1]))))
            return (int)c;
    }
    return -1;
}

static int by_name(const void *pa, const void *pb, void *rows_ptr)
{
    const struct tag_rows *rows = rows_ptr;
    int column = find_column(rows, NAME);
    return strcmp(table_cell(&rows->at[*(const int *)pa], column), table_cell(&rows->at[*(const int *)pb], column));
}

static void add_header(struct tag_rows *rows)
{
    struct table_row *header = add_row(rows);
    for (int i = 0; i < COLUMNS; i++)
        set_cell(header, i, names[i]);
}

static bool read_file(struct tag_rows *rows, const char *path, char why[MATCH_WHY_BYTES])
{
    struct charset_text text;
    struct cell_table table = { 0 };
    size_t count;
    char *bytes = text_read_file(path, max_bytes, &count);
    if (!bytes) {
        snprintf(why, MATCH_WHY_BYTES, "%s", strerror(errno));
        return errno == ENOENT;
    }
    charset_decode(bytes, count, NULL, &text);
    rows->separator = table_separator(text.utf8);
    bool good = table_read_csv(&table, text.utf8, rows->separator, why, MATCH_WHY_BYTES);
    /* keep the file's rows unless it has only a header: the new list then gets the default header */
    if (good && table.count > 1) {
        rows->at = table.rows;
        rows->count = table.count;
        rows->capacity = table.capacity;
        table.rows = NULL;
        table.count = 0;
    }
    table_finish(&table);
    mem_free(text.utf8);
    mem_free(bytes);
    return good;
}

bool tag_rows_read(struct tag_rows *rows, const char *path, char why[MATCH_WHY_BYTES])
{
    *rows = (struct tag_rows){ .separator = ',' };
    if (!read_file(rows, path, why))
        return false;
    if (rows->count == 0) {
        rows->separator = ',';
        add_header(rows);
    }
    rows->known = rows->count;
    if (find_column(rows, NAME) < 0) {
        snprintf(why, MATCH_WHY_BYTES, "the header of the tag list has no column 'Tag Name'");
        return false;
    }
    rows->by_name = mem_array(rows->known, sizeof(*rows->by_name));
    for (size_t i = 1; i < rows->known; i++)
        rows->by_name[i - 1] = (int)i;
    qsort_r(rows->by_name, rows->known - 1, sizeof(*rows->by_name), by_name, rows);
    return true;
}

static void finish_names(struct tag_rows *rows)
{
    struct tag_names *const lists[] = { &rows->types, &rows->scalings, &rows->ranges, &rows->limits, &rows->differing };
    for (size_t i = 0; i < sizeof(lists) / sizeof(*lists); i++)
        tag_names_finish(lists[i]);
}

static void finish_rows(struct tag_rows *rows)
{
    for (size_t i = 0; i < rows->count; i++)
        table_row_finish(&rows->at[i]);
    mem_free(rows->at);
    mem_free(rows->by_name);
    finish_names(rows);
}

void tag_rows_finish(struct tag_rows *rows)
{
    if (rows->fresh)
        finish_rows(rows->fresh);
    mem_free(rows->fresh);
    finish_rows(rows);
    *rows = (struct tag_rows){ 0 };
}

/* --- one tag ---------------------------------------------------------------------------------------------------------------- */

static int find_row(const struct tag_rows *rows, const char *name)
{
    int column = find_column(rows, NAME);
    size_t at, count = rows->known - 1;
    search_sorted(at, count, strcmp(table_cell(&rows->at[rows->by_name[at]], column), name) < 0);
    return at < count && !strcmp(table_cell(&rows->at[rows->by_name[at]], column), name) ? rows->by_name[at] : -1;
}

static void put(struct tag_rows *rows, struct table_row *row, enum column column, const char *text)
{
    int at = find_column(rows, column);
    if (at < 0 && !*text)
        return;
    if (at < 0) {
        at = (int)rows->at[0].count;
        set_cell(&rows->at[0], at, names[column]);
    }
    set_cell(row, at, text);
}

/* Returns Kepware's name for a data type, converting names used by Ignition, IEC 61131-3, PI and WinCC: "" if the export states
 * no type, "String" for all kinds of text, NULL if the name is unknown. */
static const char *type_of(const char *type)
{
    static const struct {
        const char *name, *words; /* words: other names of the type after fold_key(), each with a blank before and after */
    } types[] = {
        { "", " default " },
        { "String", " text char wchar wstring datetime texttag8bitcharacterset texttag16bitcharacterset " },
        { "Boolean", " bool bit discrete digital ebool di do binarytag binarevariable " },
        { "Short", " int int1 int2 int16 i16 signed16bitvalue vorzeichenbehafteter16bitwert " },
        { "Word", " uint ushort u16 unsigned16bitvalue vorzeichenloser16bitwert " },
        { "Long", " dint integer int4 int32 i32 signed32bitvalue vorzeichenbehafteter32bitwert " },
        { "DWord", " udint u32 unsigned32bitvalue vorzeichenloser32bitwert " },
        { "LLong", " lint int8 i64 " },
        { "QWord", " ulint lword u64 " },
        { "Float", " real single float32 float4 real4 real32 f32 32bitfloat floatingpointnumber32bitieee754 gleitkommazahl32bitieee754 " },
        { "Double", " lreal float64 float8 real8 real64 f64 64bitfloat floatingpointnumber64bitieee754 gleitkommazahl64bitieee754 " },
    };
    enum data_type parsed;
    const char *found = NULL;
    char *key = fold_key(type), *word = mem_printf(" %s ", key);
    for (size_t i = 0; i < sizeof(types) / sizeof(*types) && !found; i++)
        if (strstr(types[i].words, word))
            found = types[i].name;
    if (!found && !strncmp(key, "string", 6)) /* STRING[80], StringArray */
        found = "String";
    if (!found && (!*type || data_type_parse(type, &parsed)))
        found = type;
    mem_free(word);
    mem_free(key);
    return found;
}

/* Returns whether an exported tag is omitted from the tag list. Adds the tag to `types` if its data type is the reason. type: result of
 * type_of() for the tag's data type. */
static bool is_left_out(struct tag_names *types, const struct tag_row_input *input, const char *type)
{
    const struct export_tag *tag = input->tag;
    const struct tag_source *source = input->source;
    struct modbus_address address;
    char why[200];
    const char *text = tag->fields[EXPORT_ADDRESS], *stated = tag->fields[EXPORT_TYPE];
    if (type && !strcmp(type, "String"))
        return true;
    if (!source->modbus)
        return false;
    if (!address_parse(text, source->address_base, &address, why))
        return true;
    bool whole = address.table != TABLE_COIL && address.table != TABLE_DISCRETE && address.bit < 0,
         bit = type && !strcasecmp(type, "Boolean");
    if (!whole || (type && !bit)) /* a single bit is Boolean, whatever its type in the export */
        return false;
    if (type)
        tag_names_add(types, tag->fields[EXPORT_NAME], "%.40s at %.40s, not at a bit such as %.40s.0", stated, text, text);
    else
        tag_names_add(types, tag->fields[EXPORT_NAME], "%.60s", stated);
    return true;
}

static void put_address(struct tag_rows *rows, struct table_row *row, const struct tag_row_input *input, const char *type)
{
    struct modbus_address address;
    char why[200];
    const char *text = input->tag->fields[EXPORT_ADDRESS];
    if (!input->source->id)
        return;
    bool one_bit = input->source->modbus && address_parse(text, input->source->address_base, &address, why) &&
                   (address.table == TABLE_COIL || address.table == TABLE_DISCRETE || address.bit >= 0);
    put(rows, row, ADDRESS, text);
    put(rows, row, TYPE, type && (!one_bit || !strcasecmp(type, "Boolean")) ? type : "");
    put(rows, row, SOURCE, input->source->id);
}

struct tag_end {
    double value;
    char text[64];
};

/* The range of an exported tag's raw or scaled values. */
struct tag_range {
    bool stated;
    struct tag_end ends[2]; /* low, high */
};

static void read_ends(const struct export_tag *tag, enum export_field field, struct tag_range *range)
{
    *range = (struct tag_range){ .stated = true };
    for (int i = 0; i < 2; i++) {
        const char *cell = tag->fields[(int)field + i];
        snprintf(range->ends[i].text, sizeof(range->ends[i].text), "%s", cell);
        range->stated &= number_parse(cell, &range->ends[i].value) == NUMBER_GOOD;
    }
}

static void swap_ends(struct tag_range *range)
{
    const struct tag_end low = range->ends[0];
    range->ends[0] = range->ends[1];
    range->ends[1] = low;
}

static void negate_ends(struct tag_range *range)
{
    for (int i = 0; i < 2; i++) {
        struct tag_end *end = &range->ends[i];
        const struct tag_end before = *end;
        const char *digits = before.text + (*before.text == '-' || *before.text == '+');
        end->value = before.value == 0 ? 0 : -before.value;
        snprintf(end->text, sizeof(end->text), "%s%s", end->value < 0 ? "-" : "", digits);
    }
}

/* Makes the ends of both ranges rise, without changing the values of a tag. A scale that falls becomes one that rises to the
 * negative values, and *negate changes. Returns NULL, or why this is impossible. */
static const char *straighten(bool linear, struct tag_range *raw, struct tag_range *scaled, bool *negate)
{
    if (raw->ends[0].value == raw->ends[1].value)
        return "Raw Low equals Raw High";
    if (scaled->ends[0].value == scaled->ends[1].value)
        return "Scaled Low equals Scaled High";
    if (raw->ends[0].value > raw->ends[1].value) {
        if (!linear)
            return "Raw Low is above Raw High";
        swap_ends(raw);
        swap_ends(scaled);
    }
    if (scaled->ends[0].value > scaled->ends[1].value) {
        negate_ends(scaled);
        *negate = !*negate;
    }
    return NULL;
}

/* Returns the row's cell Scaling: "Linear", "Square Root" or "". *why receives the reason if the export's scaling cannot be used,
 * else "". */
static const char *find_scaling(const struct export_tag *tag, const char *type, struct tag_range *raw, struct tag_range *scaled,
                                bool *negate, char why[120])
{
    const char *text = tag->fields[EXPORT_SCALING], *bent;
    char *key = fold_key(text);
    bool linear = !strcmp(key, "linear"), root = !strcmp(key, "squareroot") || !strcmp(key, "sqrt"),
         inverts = !strcmp(key, "bitinversion") && type && !strcasecmp(type, "Boolean"),
         none = !*key || !strcmp(key, "none") || !strcmp(key, "off") || !strcmp(key, "no");
    mem_free(key);
    *why = 0;
    *negate = !strcmp(tag->fields[EXPORT_NEGATE], "1") != inverts;
    read_ends(tag, EXPORT_RAW_LOW, raw);
    read_ends(tag, EXPORT_SCALED_LOW, scaled);
    if (!linear && !root) {
        bool another =
            raw->stated && scaled->stated && (raw->ends[0].value != scaled->ends[0].value || raw->ends[1].value != scaled->ends[1].value);
        if (!none && !inverts)
            snprintf(why, 120, "Scaling '%.60s'", text);
        else if (!*text && another)
            snprintf(why, 120, "the export has a raw range, but does not state Scaling");
        return "";
    }
    for (int i = 0; i < 4 && !*why; i++)
        if (!*tag->fields[EXPORT_RAW_LOW + i])
            snprintf(why, 120, "no %s", names[RAW_LOW + i]);
    if (!*why && (bent = straighten(linear, raw, scaled, negate)))
        snprintf(why, 120, "%s", bent);
    return *why ? "" : linear ? "Linear" : "Square Root";
}

static void put_scaling(struct tag_rows *rows, struct table_row *row, const struct export_tag *tag, const char *type)
{
    struct tag_range raw, scaled;
    bool negate;
    char why[120];
    const char *scaling = find_scaling(tag, type, &raw, &scaled, &negate, why);
    if (*why)
        tag_names_add(&rows->scalings, tag->fields[EXPORT_NAME], "%s", why);
    else if (!*scaling && (*tag->fields[EXPORT_SCALED_LOW] == 0) != (*tag->fields[EXPORT_SCALED_HIGH] == 0))
        tag_names_add(&rows->ranges, tag->fields[EXPORT_NAME], "no %s", names[*tag->fields[EXPORT_SCALED_LOW] ? SCALED_HIGH : SCALED_LOW]);
    if (!*scaling && scaled.stated && scaled.ends[0].value > scaled.ends[1].value)
        swap_ends(&scaled);
    put(rows, row, SCALING, scaling);
    for (int i = 0; i < 2; i++) {
        if (*scaling)
            put(rows, row, RAW_LOW + i, raw.ends[i].text);
        if (scaled.stated && scaled.ends[0].value < scaled.ends[1].value)
            put(rows, row, SCALED_LOW + i, scaled.ends[i].text);
    }
    put(rows, row, NEGATE, negate ? "1" : "");
}

/* Writes a tag's alarm limits to its row. Writes no limit if they are not in ascending order, because each one may be wrong. */
static void put_limits(struct tag_rows *rows, struct table_row *row, const struct export_tag *tag)
{
    int before = -1;
    for (int i = 0; i < 4; i++) {
        const char *cell = tag->fields[EXPORT_LL + i];
        double limit, last;
        if (number_parse(cell, &limit) != NUMBER_GOOD)
            continue;
        if (before >= 0 && number_parse(tag->fields[EXPORT_LL + before], &last) == NUMBER_GOOD && last >= limit) {
            tag_names_add(&rows->limits, tag->fields[EXPORT_NAME], "%s %s, %s %s", names[LL + before], tag->fields[EXPORT_LL + before],
                          names[LL + i], cell);
            return;
        }
        before = i;
    }
    for (int i = 0; i < 4; i++)
        put(rows, row, LL + i, tag->fields[EXPORT_LL + i]);
}

static void put_equipment(struct tag_rows *rows, struct table_row *row, const struct tag_row_input *input)
{
    const struct place_proposal *place = input->place;
    bool matched = input->match->status == MATCH_SURE, grouped = matched && *input->group;
    char node[24] = "", number[40];
    const char *node_text = node;
    put(rows, row, GROUP, grouped ? input->group : "");
    put(rows, row, ASSET, matched ? input->site->plant->assets[input->match->asset].id : "");
    if (grouped && place->kind == PLACE_OWN_NODE) {
        const struct model_tree *tree = &input->site->models[input->site->assets[input->match->asset].model];
        const char *name = tree->nodes[place->node].name;
        size_t alike = 0;
        for (size_t i = 0; i < tree->count; i++)
            alike += !strcmp(tree->nodes[i].name, name);
        snprintf(node, sizeof(node), "#%u", tree->nodes[place->node].number);
        node_text = alike == 1 && !strpbrk(name, "*?[#!") ? name : node;
    }
    put(rows, row, PLACE, grouped && place->kind != PLACE_OWN_NODE ? "equipment" : "");
    put(rows, row, NODE, grouped ? node_text : "");
    for (int axis = 0; axis < 3; axis++) {
        snprintf(number, sizeof(number), "%.3f", place->position_m[axis]);
        put(rows, row, X + axis, grouped && place->has_position ? number : "");
    }
}

static void put_values(struct tag_rows *rows, struct table_row *row, const struct tag_row_input *input, const char *type)
{
    put_address(rows, row, input, type);
    put_scaling(rows, row, input->tag, type);
    put(rows, row, UNITS, input->tag->fields[EXPORT_UNIT]);
    put_limits(rows, row, input->tag);
}

/* Returns whether the equipment in an existing row of the tag list may be overwritten: false if a person changed it after the last run. */
static bool may_put(const struct tag_row_input *input, const char *asset)
{
    const struct decision *before = input->before;
    if (!before)
        return !*asset && input->match->status == MATCH_SURE;
    if (before->edited)
        return true;
    const char *now = input->match->status == MATCH_SURE ? input->site->plant->assets[input->match->asset].id : "";
    return !strcmp(asset, before->status == MATCH_SURE ? before->asset : "") && strcmp(asset, now) != 0;
}

/* Returns whether two cells of a column mean the same. */
static bool same_cell(enum column column, const char *a, const char *b, const struct tag_source *source)
{
    struct unit_change change;
    struct modbus_address address[2];
    enum data_type types[2];
    double numbers[2];
    char why[200];
    if (column != ADDRESS && column != UNITS && !strcasecmp(a, b)) /* in units, capitals may matter: mW, MW */
        return true;
    if (column == UNITS)
        return units_compare(a, b, &change) == UNITS_SAME;
    if (column == TYPE)
        return data_type_parse(a, &types[0]) && data_type_parse(b, &types[1]) && types[0] == types[1];
    if (column == ADDRESS && source->modbus && address_parse(a, source->address_base, &address[0], why) &&
        address_parse(b, source->address_base, &address[1], why))
        return address[0].unit == address[1].unit && address[0].table == address[1].table && address[0].index == address[1].index &&
               address[0].bit == address[1].bit && address[0].byte_order == address[1].byte_order;
    if (column == ADDRESS)
        return !strcmp(a, b);
    return number_parse(a, &numbers[0]) == NUMBER_GOOD && number_parse(b, &numbers[1]) == NUMBER_GOOD && numbers[0] == numbers[1];
}

/* Returns whether the export states a value for the column: a text, or explicitly none. */
static bool is_stated(const struct tag_rows *fresh, enum column column, const struct export_tag *tag)
{
    if (*table_cell(&fresh->at[1], (int)column))
        return true;
    if (column == SCALING)
        return *tag->fields[EXPORT_SCALING] && fresh->scalings.count == 0;
    return column == NEGATE && *tag->fields[EXPORT_NEGATE];
}

static bool is_blank(const struct tag_rows *rows, const struct table_row *row, enum column first, enum column last)
{
    for (enum column column = first; column <= last; column++)
        if (*table_cell(row, find_column(rows, column)))
            return false;
    return true;
}

/* Returns a header with all columns, followed by the row that the tag would get if it were new. Kept in `rows` until the next call. */
static const struct tag_rows *put_fresh(struct tag_rows *rows, const struct tag_row_input *input, const char *type)
{
    if (!rows->fresh) {
        rows->fresh = mem_array(1, sizeof(*rows->fresh));
        add_header(rows->fresh);
        add_row(rows->fresh);
    }
    struct table_row *row = &rows->fresh->at[1];
    table_row_finish(row);
    finish_names(rows->fresh);
    put_values(rows->fresh, row, input, type);
    return rows->fresh;
}

/* Adds a tag to `differing` if its row would now be written with another address, type, scaling, unit or limit. The first such
 * column is named. Also lists scalings, ranges and limits of the export that Plantcast cannot use, if the row's own cells are blank.
 * unknown_type: the export's data type is unknown or does not fit the address. */
static void compare(struct tag_rows *rows, const struct table_row *row, const struct tag_row_input *input, const char *type,
                    bool unknown_type)
{
    static const enum column compared[] = {
        ADDRESS, TYPE, SCALING, RAW_LOW, RAW_HIGH, SCALED_LOW, SCALED_HIGH, NEGATE, UNITS, LL, L, H, HH
    };
    const struct export_tag *tag = input->tag;
    const struct tag_rows *fresh = put_fresh(rows, input, type);
    bool named = false;
    for (size_t i = 0; i < sizeof(compared) / sizeof(*compared) && !named; i++) {
        enum column column = compared[i];
        const char *ours = table_cell(row, find_column(rows, column)), *theirs = table_cell(&fresh->at[1], (int)column);
        bool is_default =
            column == TYPE && !*ours && (!input->source->modbus || !strcasecmp(theirs, "Word") || !strcasecmp(theirs, "Boolean"));
        if (!is_stated(fresh, column, tag) || is_default || same_cell(column, ours, theirs, input->source) ||
            (column == SCALING && !*theirs && !strcasecmp(ours, "None")) || (column == NEGATE && !*theirs && !strcmp(ours, "0")))
            continue;
        if (!*theirs)
            theirs = column == SCALING ? tag->fields[EXPORT_SCALING] : "0";
        tag_names_add(&rows->differing, tag->fields[EXPORT_NAME], "%s %.60s, in the export %.60s", names[column], *ours ? ours : "blank",
                      theirs);
        named = true;
    }
    if (!named && unknown_type && is_blank(rows, row, TYPE, TYPE))
        tag_names_add(&rows->differing, tag->fields[EXPORT_NAME], "%s blank, in the export %.60s", names[TYPE], tag->fields[EXPORT_TYPE]);
    if (is_blank(rows, row, SCALING, SCALING))
        tag_names_join(&rows->scalings, &fresh->scalings);
    if (is_blank(rows, row, SCALED_LOW, SCALED_HIGH))
        tag_names_join(&rows->ranges, &fresh->ranges);
    if (is_blank(rows, row, LL, HH))
        tag_names_join(&rows->limits, &fresh->limits);
}

const char *tag_rows_put(struct tag_rows *rows, const struct tag_row_input *input)
{
    const struct export_tag *tag = input->tag;
    const char *type = type_of(tag->fields[EXPORT_TYPE]);
    int at = find_row(rows, tag->fields[EXPORT_NAME]);
    if (at < 0 && is_left_out(&rows->types, input, type))
        return NULL;
    struct table_row *row = at < 0 ? add_row(rows) : &rows->at[at];
    if (at < 0) {
        put(rows, row, NAME, tag->fields[EXPORT_NAME]);
        put_values(rows, row, input, type);
        put(rows, row, DESCRIPTION, tag->fields[EXPORT_DESCRIPTION]);
        put_equipment(rows, row, input);
    } else {
        struct tag_names types = { 0 };
        bool left_out = is_left_out(&types, input, type), unknown_type = types.count > 0;
        tag_names_finish(&types);
        if (!*table_cell(row, find_column(rows, ADDRESS)) && !left_out)
            put_address(rows, row, input, type);
        compare(rows, row, input, type, unknown_type);
        if (may_put(input, table_cell(row, find_column(rows, ASSET))))
            put_equipment(rows, row, input);
    }
    return table_cell(row, find_column(rows, ASSET));
}

/* --- writing ---------------------------------------------------------------------------------------------------------------- */

static void add_cell(const struct tag_rows *rows, struct text *out, const char *cell)
{
    if (strpbrk(cell, "\"\r\n") || strchr(cell, rows->separator) || *cell == ' ')
        text_add_quoted(out, cell);
    else
        text_add(out, "%s", cell);
}

void tag_rows_write(const struct tag_rows *rows, struct text *out)
{
    size_t width = rows->at[0].count;
    bool *used = mem_array(width + 1, sizeof(*used));
    for (size_t c = 0; c < width; c++) {
        used[c] = rows->known > 1; /* a column that the tag list already had is written even if blank */
        for (size_t i = 1; i < rows->count && !used[c]; i++)
            used[c] = *table_cell(&rows->at[i], (int)c);
    }
    for (enum column column = NAME; column <= Z; column++)
        if (find_column(rows, column) >= 0 && (column <= TYPE || column >= UNITS))
            used[find_column(rows, column)] = true;
    for (size_t i = 0; i < rows->count; i++) {
        bool first = true;
        for (size_t c = 0; c < width; c++) {
            if (!used[c])
                continue;
            if (!first)
                text_add_bytes(out, &rows->separator, 1);
            first = false;
            add_cell(rows, out, table_cell(&rows->at[i], (int)c));
        }
        text_add(out, "\n");
    }
    mem_free(used);
}
