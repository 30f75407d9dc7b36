/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which format a file has, and which column is what. */
#include "preprocess/match/tag_export.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "base/text.h"
#include "plant/number.h"
#include "preprocess/match/table.h"

static const size_t max_bytes = (size_t)256 << 20;
enum { HEADER_ROWS = 40, KEY_BYTES = 64 };

/* What exports call their columns, without blanks and signs, in lower case; of two in one file the one further up counts. */
static const struct column_word {
    const char *word;
    enum export_field field;
} column_words[] = {
    { "tagname", EXPORT_NAME },
    { "pointname", EXPORT_NAME },
    { "pntname", EXPORT_NAME },
    { "pointid", EXPORT_NAME },
    { "tag", EXPORT_NAME },
    { "tagno", EXPORT_NAME },
    { "tagnumber", EXPORT_NAME },
    { "tagid", EXPORT_NAME },
    { "instrumenttag", EXPORT_NAME },
    { "태그명", EXPORT_NAME },
    { "태그이름", EXPORT_NAME },
    { "태그", EXPORT_NAME },
    { "module", EXPORT_NAME },
    { "modulename", EXPORT_NAME },
    { "point", EXPORT_NAME },
    { "objectname", EXPORT_NAME },
    { "name", EXPORT_NAME },
    { "itemname", EXPORT_NAME },
    { "address", EXPORT_ADDRESS },
    { "opcitempath", EXPORT_ADDRESS },
    { "pvsourceaddress", EXPORT_ADDRESS },
    { "sourceaddress", EXPORT_ADDRESS },
    { "pvinputinputsource", EXPORT_ADDRESS },
    { "ioaddress", EXPORT_ADDRESS },
    { "plcaddress", EXPORT_ADDRESS },
    { "modbusaddress", EXPORT_ADDRESS },
    { "register", EXPORT_ADDRESS },
    { "ioin", EXPORT_ADDRESS },
    { "주소", EXPORT_ADDRESS },
    { "datatype", EXPORT_TYPE },
    { "pointtype", EXPORT_TYPE },
    { "type", EXPORT_TYPE },
    { "scanrate", EXPORT_SCAN },
    { "scaling", EXPORT_SCALING },
    { "scalemode", EXPORT_SCALING },
    { "conversion", EXPORT_SCALING },
    { "rawlow", EXPORT_RAW_LOW },
    { "minraw", EXPORT_RAW_LOW },
    { "rawmin", EXPORT_RAW_LOW },
    { "rawhigh", EXPORT_RAW_HIGH },
    { "maxraw", EXPORT_RAW_HIGH },
    { "rawmax", EXPORT_RAW_HIGH },
    { "scaledlow", EXPORT_SCALED_LOW },
    { "mineu", EXPORT_SCALED_LOW },
    { "pveulo", EXPORT_SCALED_LOW },
    { "englow", EXPORT_SCALED_LOW },
    { "pvengunitsmin", EXPORT_SCALED_LOW },
    { "0rangevalue", EXPORT_SCALED_LOW },
    { "eu0", EXPORT_SCALED_LOW },
    { "rangelow", EXPORT_SCALED_LOW },
    { "rangemin", EXPORT_SCALED_LOW },
    { "lowrange", EXPORT_SCALED_LOW },
    { "lrv", EXPORT_SCALED_LOW },
    { "lowerrange", EXPORT_SCALED_LOW },
    { "lowscale", EXPORT_SCALED_LOW },
    { "최소", EXPORT_SCALED_LOW },
    { "minimum", EXPORT_SCALED_LOW },
    { "min", EXPORT_SCALED_LOW },
    { "scaledhigh", EXPORT_SCALED_HIGH },
    { "maxeu", EXPORT_SCALED_HIGH },
    { "pveuhi", EXPORT_SCALED_HIGH },
    { "enghigh", EXPORT_SCALED_HIGH },
    { "pvengunitsmax", EXPORT_SCALED_HIGH },
    { "100rangevalue", EXPORT_SCALED_HIGH },
    { "eu100", EXPORT_SCALED_HIGH },
    { "rangehigh", EXPORT_SCALED_HIGH },
    { "rangemax", EXPORT_SCALED_HIGH },
    { "highrange", EXPORT_SCALED_HIGH },
    { "urv", EXPORT_SCALED_HIGH },
    { "upperrange", EXPORT_SCALED_HIGH },
    { "highscale", EXPORT_SCALED_HIGH },
    { "최대", EXPORT_SCALED_HIGH },
    { "maximum", EXPORT_SCALED_HIGH },
    { "max", EXPORT_SCALED_HIGH },
    { "engunits", EXPORT_UNIT },
    { "engunit", EXPORT_UNIT },
    { "engineeringunits", EXPORT_UNIT },
    { "engineeringunit", EXPORT_UNIT },
    { "pvengunits", EXPORT_UNIT },
    { "eudesc", EXPORT_UNIT },
    { "eunits", EXPORT_UNIT },
    { "eu", EXPORT_UNIT },
    { "uom", EXPORT_UNIT },
    { "단위", EXPORT_UNIT },
    { "units", EXPORT_UNIT },
    { "unit", EXPORT_UNIT },
    { "description", EXPORT_DESCRIPTION },
    { "tagdescription", EXPORT_DESCRIPTION },
    { "ptdesc", EXPORT_DESCRIPTION },
    { "desc", EXPORT_DESCRIPTION },
    { "shortdesc", EXPORT_DESCRIPTION },
    { "comment", EXPORT_DESCRIPTION },
    { "documentation", EXPORT_DESCRIPTION },
    { "tooltip", EXPORT_DESCRIPTION },
    { "service", EXPORT_DESCRIPTION },
    { "descriptor", EXPORT_DESCRIPTION },
    { "설명", EXPORT_DESCRIPTION },
    { "path", EXPORT_AREA },
    { "area", EXPORT_AREA },
    { "plantarea", EXPORT_AREA },
    { "asset", EXPORT_AREA },
    { "folder", EXPORT_AREA },
    { "alarmgroup", EXPORT_AREA },
    { "group", EXPORT_AREA },
    { "구역", EXPORT_AREA },
    { "accessname", EXPORT_DEVICE },
    { "device", EXPORT_DEVICE },
    { "devicename", EXPORT_DEVICE },
    { "opcserver", EXPORT_DEVICE },
    { "controller", EXPORT_DEVICE },
    { "source", EXPORT_DEVICE },
    { "ll", EXPORT_LL },
    { "lolo", EXPORT_LL },
    { "loloalarmvalue", EXPORT_LL },
    { "lololimit", EXPORT_LL },
    { "lololim", EXPORT_LL },
    { "pvlltp", EXPORT_LL },
    { "l", EXPORT_L },
    { "lo", EXPORT_L },
    { "loalarmvalue", EXPORT_L },
    { "lolimit", EXPORT_L },
    { "lolim", EXPORT_L },
    { "pvlotp", EXPORT_L },
    { "h", EXPORT_H },
    { "hi", EXPORT_H },
    { "hialarmvalue", EXPORT_H },
    { "hilimit", EXPORT_H },
    { "hilim", EXPORT_H },
    { "pvhitp", EXPORT_H },
    { "hh", EXPORT_HH },
    { "hihi", EXPORT_HH },
    { "hihialarmvalue", EXPORT_HH },
    { "hihilimit", EXPORT_HH },
    { "hihilim", EXPORT_HH },
    { "pvhhtp", EXPORT_HH },
};
enum { COLUMN_WORDS = sizeof(column_words) / sizeof(*column_words) };

struct header {
    int columns[EXPORT_FIELDS]; /* -1: none */
    int tag_type;               /* Ignition's, which tells folders */
    const char *data_type;      /* of all rows below, or NULL */
};

struct export_tag *tag_export_add(struct tag_export *list, int line)
{
    mem_grow(&list->tags, &list->capacity, list->count + 1, sizeof(*list->tags));
    struct export_tag *tag = &list->tags[list->count++];
    *tag = (struct export_tag){ .line = line };
    return tag;
}

void export_tag_set(struct export_tag *tag, enum export_field field, const char *text)
{
    if (*text && !tag->fields[field])
        tag->fields[field] = mem_strdup(text);
}

/* --- the header ------------------------------------------------------------------------------------------------------------- */

static void find_key(const char *cell, char key[KEY_BYTES])
{
    size_t length = 0;
    for (; *cell && length < KEY_BYTES - 1; cell++)
        if (isalnum((unsigned char)*cell) || (unsigned char)*cell >= 0x80)
            key[length++] = (char)tolower((unsigned char)*cell);
    key[length] = 0;
}

/* Returns the number of columns that are known. */
static int read_header(const struct table_row *row, struct header *header)
{
    int ranks[EXPORT_FIELDS], known = 0;
    for (int f = 0; f < EXPORT_FIELDS; f++) {
        header->columns[f] = -1;
        ranks[f] = COLUMN_WORDS;
    }
    header->tag_type = -1;
    for (size_t c = 0; c < row->count; c++) {
        char key[KEY_BYTES];
        find_key(row->cells[c], key);
        if (!strcmp(key, "tagtype"))
            header->tag_type = (int)c;
        for (int w = 0; w < COLUMN_WORDS; w++)
            if (!strcmp(column_words[w].word, key) && w < ranks[column_words[w].field]) {
                known += header->columns[column_words[w].field] < 0;
                header->columns[column_words[w].field] = (int)c;
                ranks[column_words[w].field] = w;
            }
    }
    return known;
}

static bool has_column(const struct table_row *row, const char *word)
{
    char key[KEY_BYTES];
    for (size_t c = 0; c < row->count; c++) {
        find_key(row->cells[c], key);
        if (!strcmp(key, word))
            return true;
    }
    return false;
}

static const char *format_of(const struct table_row *row)
{
    if (has_column(row, "respectdatatype") || has_column(row, "clientaccess"))
        return "Kepware";
    if (has_column(row, "opcitempath"))
        return "Ignition (CSV)";
    if (has_column(row, "pveuhi") || has_column(row, "pntname") || has_column(row, "pvsourceaddress") || has_column(row, "100rangevalue"))
        return "Honeywell";
    if (has_column(row, "module") || has_column(row, "modulename"))
        return "Emerson";
    return "a list with a header";
}

/* --- rows ------------------------------------------------------------------------------------------------------------------- */

static bool is_number_field(enum export_field field)
{
    return (field >= EXPORT_RAW_LOW && field <= EXPORT_SCALED_HIGH) || field >= EXPORT_LL;
}

/* "1.234,5" and "12,5" are numbers too. What is none is left out. */
static void set_number(struct export_tag *tag, enum export_field field, const char *text)
{
    char copy[64];
    double number;
    size_t length = 0;
    const char *comma = strrchr(text, ','), *dot = strrchr(text, '.');
    bool decimal_comma = comma && (!dot || dot < comma) && strchr(text, ',') == comma;
    for (; *text && length < sizeof(copy) - 1; text++)
        if (*text == ',' && decimal_comma)
            copy[length++] = '.';
        else if (*text != ',' && *text != ' ' && !(*text == '.' && decimal_comma))
            copy[length++] = *text;
    copy[length] = 0;
    if (number_parse(copy, &number) == NUMBER_GOOD)
        export_tag_set(tag, field, copy);
}

static void read_row(struct tag_export *list, const struct header *header, const struct table_row *row)
{
    const char *name = table_cell(row, header->columns[EXPORT_NAME]), *type = table_cell(row, header->tag_type);
    if (!strcasecmp(type, "Folder") || !strcasecmp(type, "UDT_INST") || !strcasecmp(type, "UDT_DEF"))
        return;
    list->rows++;
    if (!*name) {
        list->nameless++;
        return;
    }
    struct export_tag *tag = tag_export_add(list, row->line);
    for (int f = 0; f < EXPORT_FIELDS; f++) {
        const char *text = table_cell(row, header->columns[f]);
        if (is_number_field((enum export_field)f))
            set_number(tag, (enum export_field)f, text);
        else
            export_tag_set(tag, (enum export_field)f, text);
    }
    if (header->data_type)
        export_tag_set(tag, EXPORT_TYPE, header->data_type);
}

static bool read_rows(struct tag_export *list, const struct table *table, char *why, size_t why_bytes)
{
    struct header header = { 0 };
    size_t first = 0;
    bool one_column = table->count > 0;
    for (size_t i = 0; i < table->count; i++)
        one_column &= table->rows[i].count == 1;
    while (first < table->count && first < HEADER_ROWS &&
           !(read_header(&table->rows[first], &header) >= (one_column ? 1 : 2) && header.columns[EXPORT_NAME] >= 0))
        first++;
    if (first < table->count && first < HEADER_ROWS) {
        list->format = format_of(&table->rows[first]);
        first++;
    } else if (one_column) {
        read_header(&table->rows[0], &header);
        header.columns[EXPORT_NAME] = 0;
        list->format = "one name a line";
        first = 0;
    } else {
        snprintf(why, why_bytes, "no header with a column of tag names in the first %d rows; expected Tag Name, Point ID, Name, ...",
                 HEADER_ROWS);
        return false;
    }
    for (size_t i = first; i < table->count; i++)
        if (table->rows[i].cells[0][0] != ';' || table->rows[i].count > 1)
            read_row(list, &header, &table->rows[i]);
    return true;
}

/* --- AVEVA's dumps: each section has a header that begins with a colon ------------------------------------------------------- */

static bool is_dump(const struct table *table)
{
    for (size_t i = 0; i < table->count && i < HEADER_ROWS; i++) {
        const char *cell = table->rows[i].cells[0];
        if (!strncasecmp(cell, ":mode", 5) || !strncasecmp(cell, ":TEMPLATE", 9) || !strncasecmp(cell, ":IO", 3) ||
            !strncasecmp(cell, ":Memory", 7))
            return true;
    }
    return false;
}

/* Returns whether tags stand below: not in sections of access names, alarm groups or trends. */
static bool begin_section(struct tag_export *list, const struct table_row *row, struct header *header)
{
    static const struct {
        const char *section, *type;
    } kinds[] = { { ":IODisc", "Boolean" }, { ":MemoryDisc", "Boolean" }, { ":IndirectDisc", "Boolean" }, { ":IOInt", "Long" },
                  { ":MemoryInt", "Long" }, { ":IOReal", "Float" },       { ":MemoryReal", "Float" },     { ":IndirectAnalog", "Float" },
                  { ":IOMsg", "String" },   { ":MemoryMsg", "String" },   { ":IndirectMsg", "String" } };
    const char *cell = row->cells[0];
    read_header(row, header);
    header->data_type = NULL;
    if (!strcasecmp(cell, ":Tagname")) {
        header->columns[EXPORT_NAME] = 0;
        list->format = "AVEVA Galaxy dump";
        return true;
    }
    for (size_t i = 0; i < sizeof(kinds) / sizeof(*kinds); i++)
        if (!strcasecmp(cell, kinds[i].section)) {
            header->data_type = kinds[i].type;
            header->columns[EXPORT_NAME] = 0; /* ItemName is the address here */
            for (size_t c = 0; c < row->count; c++)
                if (!strcasecmp(row->cells[c], "ItemName"))
                    header->columns[EXPORT_ADDRESS] = (int)c;
            list->format = "AVEVA InTouch DBDump";
            return true;
        }
    return false;
}

static void read_dump(struct tag_export *list, const struct table *table)
{
    struct header header = { 0 };
    bool within = false;
    list->format = "AVEVA dump";
    for (size_t i = 0; i < table->count; i++) {
        const struct table_row *row = &table->rows[i];
        if (row->cells[0][0] == ':')
            within = begin_section(list, row, &header);
        else if (within && row->cells[0][0] != ';')
            read_row(list, &header, row);
    }
}

/* --- the file --------------------------------------------------------------------------------------------------------------- */

static const char *first_sign(const char *text)
{
    return text + strspn(text, " \t\r\n");
}

static bool read_text(struct tag_export *list, const char *bytes, size_t count, const char *encoding, char *why, size_t why_bytes)
{
    struct charset_text text;
    struct table table = { 0 };
    charset_decode(bytes, count, encoding, &text);
    list->encoding = text.encoding;
    list->damaged = text.damaged;
    bool good, json = *first_sign(text.utf8) == '{' || *first_sign(text.utf8) == '[';
    if (json) {
        good = tag_export_read_json(list, text.utf8, text.length, why, why_bytes);
    } else {
        list->separator = table_separator(text.utf8);
        good = table_read_csv(&table, text.utf8, list->separator, why, why_bytes);
        list->control = table.control;
        if (good && is_dump(&table))
            read_dump(list, &table);
        else if (good)
            good = read_rows(list, &table, why, why_bytes);
    }
    table_finish(&table);
    mem_free(text.utf8);
    return good;
}

bool tag_export_read(struct tag_export *list, const char *path, const char *encoding, char *why, size_t why_bytes)
{
    size_t count;
    char *bytes = text_read_file(path, max_bytes, &count);
    bool good = false;
    if (!bytes) {
        snprintf(why, why_bytes, "%s", strerror(errno));
    } else if (count >= 4 && !memcmp(bytes, "PK\3\4", 4)) {
        struct table table = { 0 };
        good = table_read_xlsx(&table, path, why, why_bytes) && read_rows(list, &table, why, why_bytes);
        list->control = table.control;
        table_finish(&table);
    } else if (count >= 4 && !memcmp(bytes, "\xd0\xcf\x11\xe0", 4)) {
        snprintf(why, why_bytes, "a spreadsheet of Excel 97 to 2003 (.xls); save it as .xlsx or CSV");
    } else {
        good = read_text(list, bytes, count, encoding, why, why_bytes);
    }
    mem_free(bytes);
    if (good && list->count == 0) {
        snprintf(why, why_bytes, "no tags in it");
        good = false;
    }
    if (good)
        tag_export_join(list);
    else
        tag_export_finish(list);
    return good;
}

void tag_export_finish(struct tag_export *list)
{
    for (size_t i = 0; i < list->count; i++)
        for (int f = 0; f < EXPORT_FIELDS; f++)
            mem_free(list->tags[i].fields[f]);
    mem_free(list->tags);
    mem_free(list->differing_lines);
    text_finish(&list->remarks);
    *list = (struct tag_export){ 0 };
}
