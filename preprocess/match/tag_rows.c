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
#include "plant/sources/address.h"
#include "base/text/charset.h"
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
static const char *const names[COLUMNS] = { "Tag Name",   "Address",     "Data Type", "Scaling",     "Raw Low", "Raw High",
                                            "Scaled Low", "Scaled High", "Eng Units", "Description", "Source",  "Group",
                                            "Asset",      "Place",       "Node",      "X",           "Y",       "Z",
                                            "LL",         "L",           "H",         "HH" };
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
        struct table_row *header = add_row(rows);
        for (int i = 0; i < COLUMNS; i++)
            set_cell(header, i, names[i]);
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

void tag_rows_finish(struct tag_rows *rows)
{
    for (size_t i = 0; i < rows->count; i++)
        table_row_finish(&rows->at[i]);
    mem_free(rows->at);
    mem_free(rows->by_name);
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

static bool is_text(const char *type)
{
    return !strcasecmp(type, "String") || !strcasecmp(type, "Text") || !strcasecmp(type, "Char") || !strcasecmp(type, "DateTime");
}

/* Returns whether an exported tag is omitted from the tag list: it is not numeric, or its address is invalid for its source. */
static bool is_left_out(const struct export_tag *tag, const struct tag_source *source)
{
    struct modbus_address address;
    char why[200];
    return is_text(tag->fields[EXPORT_TYPE]) ||
           (source->modbus && !address_parse(tag->fields[EXPORT_ADDRESS], source->address_base, &address, why));
}

/* Returns Kepware's name for a data type, converting names used by Ignition, IEC 61131-3 and PI. An unknown name gives "", so
 * that the type follows from the address. */
static const char *type_of(const char *type)
{
    static const char *const others[][2] = {
        { "Float4", "Float" },  { "Float8", "Double" },  { "Int1", "Short" },  { "Int2", "Short" },   { "Int4", "Long" },
        { "Int8", "LLong" },    { "Integer", "Long" },   { "Real", "Float" },  { "Bool", "Boolean" }, { "Discrete", "Boolean" },
        { "Int", "Short" },     { "DInt", "Long" },      { "UInt", "Word" },   { "UDInt", "DWord" },  { "LReal", "Double" },
        { "Float32", "Float" }, { "Float64", "Double" }, { "Int16", "Short" }, { "Int32", "Long" }
    };
    enum data_type parsed;
    for (size_t i = 0; i < sizeof(others) / sizeof(*others); i++)
        if (!strcasecmp(type, others[i][0]))
            return others[i][1];
    return data_type_parse(type, &parsed) ? type : "";
}

static void put_address(struct tag_rows *rows, struct table_row *row, const struct tag_row_input *input)
{
    struct modbus_address address;
    char why[200];
    const char *text = input->tag->fields[EXPORT_ADDRESS], *type = type_of(input->tag->fields[EXPORT_TYPE]);
    if (!input->source->id)
        return;
    bool one_bit = input->source->modbus && address_parse(text, input->source->address_base, &address, why) &&
                   (address.table == TABLE_COIL || address.table == TABLE_DISCRETE || address.bit >= 0);
    bool bit = !strcasecmp(type, "Boolean");
    put(rows, row, ADDRESS, text);
    put(rows, row, TYPE, one_bit == bit ? type : "");
    put(rows, row, SOURCE, input->source->id);
}

static void put_scaling(struct tag_rows *rows, struct table_row *row, const struct export_tag *tag)
{
    static const enum column columns[] = { RAW_LOW, RAW_HIGH, SCALED_LOW, SCALED_HIGH };
    const char *cells[4], *scaling = tag->fields[EXPORT_SCALING];
    bool pairs[2], linear = !strcasecmp(scaling, "Linear"),
                   root = !strcasecmp(scaling, "Square Root") || !strcasecmp(scaling, "SquareRoot");
    for (int i = 0; i < 4; i++)
        cells[i] = tag->fields[EXPORT_RAW_LOW + i];
    for (int i = 0; i < 2; i++)
        pairs[i] = *cells[2 * i] && *cells[2 * i + 1] && strtod(cells[2 * i], NULL) < strtod(cells[2 * i + 1], NULL);
    bool scales = (linear || root) && pairs[0] && pairs[1];
    put(rows, row, SCALING, scales ? (linear ? "Linear" : "Square Root") : "");
    for (int i = 0; i < 4; i++)
        if (i < 2 ? scales : pairs[1])
            put(rows, row, columns[i], cells[i]);
}

/* Writes a tag's alarm limits to its row. Omits limits that are not in ascending order: they cannot be alarm limits, and the
 * group's limits apply instead. */
static void put_limits(struct tag_rows *rows, struct table_row *row, const struct export_tag *tag)
{
    const char *before = NULL;
    for (int i = 0; i < 4; i++) {
        const char *cell = tag->fields[EXPORT_LL + i];
        if (*cell && before && strtod(before, NULL) >= strtod(cell, NULL))
            return;
        before = *cell ? cell : before;
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

const char *tag_rows_put(struct tag_rows *rows, const struct tag_row_input *input)
{
    const struct export_tag *tag = input->tag;
    int at = find_row(rows, tag->fields[EXPORT_NAME]);
    if (at < 0 && is_left_out(tag, input->source))
        return NULL;
    struct table_row *row = at < 0 ? add_row(rows) : &rows->at[at];
    if (at < 0) {
        put(rows, row, NAME, tag->fields[EXPORT_NAME]);
        put_address(rows, row, input);
        put_scaling(rows, row, tag);
        put(rows, row, UNITS, tag->fields[EXPORT_UNIT]);
        put(rows, row, DESCRIPTION, tag->fields[EXPORT_DESCRIPTION]);
        put_limits(rows, row, tag);
        put_equipment(rows, row, input);
    } else {
        if (!*table_cell(row, find_column(rows, ADDRESS)) && !is_left_out(tag, input->source))
            put_address(rows, row, input);
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
