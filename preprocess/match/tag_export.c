/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Detects the format of an exported tag list and maps its columns to fields of tags. */
#include "preprocess/match/tag_export.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "preprocess/match/table.h"
#include "preprocess/match/tag_header.h"

static const size_t max_bytes = (size_t)256 << 20;
enum { HEADER_ROWS = 40 };

static const char *format_of(const struct table_row *row)
{
    if (tag_header_has(row, "respectdatatype") || tag_header_has(row, "clientaccess"))
        return "Kepware";
    if (tag_header_has(row, "specifier") && tag_header_has(row, "scope"))
        return "Studio 5000";
    if (tag_header_has(row, "instrumenttag") && tag_header_has(row, "pointsource"))
        return "PI";
    if (tag_header_has(row, "logicaladdress") || tag_header_has(row, "logischeadresse"))
        return "TIA Portal";
    if (tag_header_has(row, "opcitempath"))
        return "Ignition (CSV)";
    if (tag_header_has(row, "pveuhi") || tag_header_has(row, "pntname") || tag_header_has(row, "pvsourceaddress") ||
        tag_header_has(row, "100rangevalue"))
        return "Honeywell";
    if (tag_header_has(row, "module") || tag_header_has(row, "modulename"))
        return "Emerson";
    return "a list with a header";
}

/* --- rows ------------------------------------------------------------------------------------------------------------------- */

/* Removes the limits that the control system has switched off. InTouch exports a switched-off limit as a number, usually 0. */
static void drop_limits(struct export_tag *tag, const struct tag_header *header, const struct table_row *row)
{
    for (int i = 0; i < 4; i++)
        if (!strcasecmp(table_cell(row, header->limit_states[i]), "Off")) {
            mem_free(tag->fields[EXPORT_LL + i]);
            tag->fields[EXPORT_LL + i] = NULL;
        }
}

static void replace_field(struct export_tag *tag, enum export_field field, const char *text)
{
    mem_free(tag->fields[field]);
    tag->fields[field] = mem_strdup(text);
}

/* Sets the address and data type of an InTouch tag whose item is a Modbus register: the register's number, and a suffix of AVEVA's
 * Modbus driver for the type. InTouch's own type does not tell how many registers the value has. If the suffix is unknown, the
 * whole item becomes the data type, so that the tag is left out and named. */
static void read_register_item(struct export_tag *tag)
{
    static const struct {
        const char *suffix, *type;
    } suffixes[] = { { "", "Word" }, { "S", "Short" }, { "I", "Long" }, { "L", "Long" }, { "U", "DWord" }, { "F", "Float" } };
    const char *item = tag->fields[EXPORT_ADDRESS] ? tag->fields[EXPORT_ADDRESS] : "";
    size_t digits = strspn(item, "0123456789");
    const char *suffix = item + digits + strspn(item + digits, " "), *type = item;
    if ((*item != '3' && *item != '4') || digits < 5 || digits > 6 || strspn(suffix, ".#:") > 0)
        return;
    for (size_t i = 0; i < sizeof(suffixes) / sizeof(*suffixes); i++)
        if (!strcasecmp(suffix, suffixes[i].suffix))
            type = suffixes[i].type;
    char *address = mem_printf("%.*s", (int)digits, item);
    replace_field(tag, EXPORT_TYPE, type);
    replace_field(tag, EXPORT_ADDRESS, address);
    mem_free(address);
}

static void read_row(struct tag_export *list, const struct tag_header *header, const struct table_row *row)
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
    for (int f = 0; f < EXPORT_FIELDS; f++)
        export_tag_set(tag, (enum export_field)f, table_cell(row, header->columns[f]));
    drop_limits(tag, header, row);
    if (header->data_type)
        export_tag_set(tag, EXPORT_TYPE, header->data_type);
    if (header->data_type && strcmp(header->data_type, "Boolean") != 0 && strcmp(header->data_type, "String") != 0)
        read_register_item(tag);
}

/* --- Studio 5000 exports, which have several kinds of rows: tags, aliases, comments --- */

/* Returns a description with the escapes $N (new line), $Q and $' (quotes) and $$ (dollar) decoded. */
static char *without_escapes(const char *text)
{
    static const char signs[] = "NnLlRrTtPp'Qq$", meant[] = "          '\"\"$";
    char *out = mem_strdup(text), *to = out;
    for (; *text; text++) {
        const char *found = *text == '$' && text[1] ? strchr(signs, text[1]) : NULL;
        char c = found ? meant[found - signs] : *text;
        text += found != NULL;
        if (c != ' ' || (to > out && to[-1] != ' '))
            *to++ = c;
    }
    while (to > out && to[-1] == ' ')
        to--;
    *to = 0;
    return out;
}

static bool is_of_kind(const struct table_row *row, const struct tag_header *header, const char *kind)
{
    return !strcasecmp(table_cell(row, header->kind), kind);
}

/* Applies a comment row about an element of a tag: the comment becomes the description of all tags that refer to this element, such as
 * aliases. */
static void describe(struct tag_export *list, const char *element, const char *text)
{
    for (size_t i = 0; i < list->count; i++) {
        struct export_tag *tag = &list->tags[i];
        const char *address = tag->fields[EXPORT_ADDRESS];
        if (!strcasecmp(tag->fields[EXPORT_NAME], element) || (address && !strcasecmp(address, element)))
            export_tag_set(tag, EXPORT_DESCRIPTION, text);
    }
}

static void read_studio(struct tag_export *list, const struct cell_table *table, size_t first, const struct tag_header *header)
{
    size_t comments = 0;
    for (size_t i = first; i < table->count; i++) {
        const struct table_row *row = &table->rows[i];
        bool alias = is_of_kind(row, header, "ALIAS");
        if (!alias && !is_of_kind(row, header, "TAG"))
            continue;
        read_row(list, header, row);
        if (alias && list->count > 0)
            export_tag_set(&list->tags[list->count - 1], EXPORT_ADDRESS, table_cell(row, header->specifier));
    }
    for (size_t i = first; i < table->count; i++)
        if (is_of_kind(&table->rows[i], header, "COMMENT")) {
            describe(list, table_cell(&table->rows[i], header->specifier),
                     table_cell(&table->rows[i], header->columns[EXPORT_DESCRIPTION]));
            comments++;
        }
    for (size_t i = 0; i < list->count; i++) {
        char **text = &list->tags[i].fields[EXPORT_DESCRIPTION], *with = *text;
        *text = with ? without_escapes(with) : NULL;
        mem_free(with);
    }
    if (comments > 0)
        text_add(&list->remarks, "%zu comments are skipped, because they describe only elements of tags, such as single bits\n", comments);
}

/* --- lists with a row of column names among the first lines ------------------------------------------------------------------------ */

/* Finds the header of a tag list: the row with the most recognised column names. Returns the number of these names, or 0 if no
 * row has a column of tag names. */
static int find_header(const struct cell_table *table, struct tag_header *header, size_t *row)
{
    bool one_column = table->count > 0;
    int most = 0;
    for (size_t i = 0; i < table->count; i++)
        one_column &= table->rows[i].count == 1;
    for (size_t i = 0; i < table->count && i < HEADER_ROWS; i++) {
        struct tag_header found;
        int known = tag_header_read(&table->rows[i], &found);
        if (known >= (one_column ? 1 : 2) && known > most && found.columns[EXPORT_NAME] >= 0) {
            most = known;
            *header = found;
            *row = i;
        }
    }
    return most;
}

/* Reads a second header row, in which the two columns of a range are named "from" and "to". Returns whether there is one. */
static bool read_second(const struct table_row *row, struct tag_header *header)
{
    struct tag_header second;
    bool any = false;
    if (*table_cell(row, header->columns[EXPORT_NAME]) || tag_header_read(row, &second) == 0)
        return false;
    for (int f = EXPORT_ADDRESS; f < EXPORT_FIELDS; f++)
        if (header->columns[f] < 0 && second.columns[f] >= 0) {
            header->columns[f] = second.columns[f];
            any = true;
        }
    return any;
}

static bool read_rows(struct tag_export *list, const struct cell_table *table, char *why, size_t why_bytes)
{
    struct tag_header header = { 0 };
    size_t first = 0;
    bool one_column = table->count > 0;
    for (size_t i = 0; i < table->count; i++)
        one_column &= table->rows[i].count == 1;
    if (find_header(table, &header, &first) > 0) {
        list->format = format_of(&table->rows[first]);
        first++;
        if (first < table->count && read_second(&table->rows[first], &header))
            first++;
    } else if (one_column) {
        tag_header_read(&table->rows[0], &header);
        header.columns[EXPORT_NAME] = 0;
        list->format = "one name a line";
        first = 0;
    } else {
        snprintf(why, why_bytes, "no header with a column of tag names in the first %d rows: expected Tag Name, Point ID, Name, ...",
                 HEADER_ROWS);
        return false;
    }
    if (header.kind >= 0 && header.specifier >= 0) {
        read_studio(list, table, first, &header);
        return true;
    }
    for (size_t i = first; i < table->count; i++)
        if (table->rows[i].cells[0][0] != ';' || (table->rows[i].count > 1 && list->separator == ';'))
            read_row(list, &header, &table->rows[i]);
    return true;
}

/* --- AVEVA dumps: sections whose headers begin with a colon ------------------------------------------------------------------- */

static bool is_dump(const struct cell_table *table)
{
    for (size_t i = 0; i < table->count && i < HEADER_ROWS; i++) {
        const char *cell = table->rows[i].cells[0];
        if (!strncasecmp(cell, ":mode", 5) || !strncasecmp(cell, ":TEMPLATE", 9) || !strncasecmp(cell, ":IO", 3) ||
            !strncasecmp(cell, ":Memory", 7))
            return true;
    }
    return false;
}

/* Reads the header of a section of an AVEVA dump. Returns whether the section's rows are tags; false for access names, alarm
 * groups and trends. */
static bool begin_section(struct tag_export *list, const struct table_row *row, struct tag_header *header)
{
    static const struct {
        const char *section, *type;
    } kinds[] = { { ":IODisc", "Boolean" }, { ":MemoryDisc", "Boolean" }, { ":IndirectDisc", "Boolean" }, { ":IOInt", "Long" },
                  { ":MemoryInt", "Long" }, { ":IOReal", "Float" },       { ":MemoryReal", "Float" },     { ":IndirectAnalog", "Float" },
                  { ":IOMsg", "String" },   { ":MemoryMsg", "String" },   { ":IndirectMsg", "String" } };
    const char *cell = row->cells[0];
    tag_header_read(row, header);
    header->data_type = NULL;
    if (!strcasecmp(cell, ":Tagname")) {
        header->columns[EXPORT_NAME] = 0;
        list->format = "AVEVA Galaxy dump";
        return true;
    }
    for (size_t i = 0; i < sizeof(kinds) / sizeof(*kinds); i++)
        if (!strcasecmp(cell, kinds[i].section)) {
            header->data_type = kinds[i].type;
            /* in a section of tags, the first column is the tag's name, and the column ItemName its address */
            header->columns[EXPORT_NAME] = 0;
            for (size_t c = 0; c < row->count; c++)
                if (!strcasecmp(row->cells[c], "ItemName"))
                    header->columns[EXPORT_ADDRESS] = (int)c;
            list->format = "AVEVA InTouch DBDump";
            return true;
        }
    return false;
}

static void read_dump(struct tag_export *list, const struct cell_table *table)
{
    struct tag_header header = { 0 };
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
    struct cell_table table = { 0 };
    charset_decode(bytes, count, encoding, &text);
    list->encoding = text.encoding;
    list->damaged = text.damaged;
    bool good, json = *first_sign(text.utf8) == '{' || *first_sign(text.utf8) == '[';
    if (*first_sign(text.utf8) == '<') {
        snprintf(why, why_bytes, "XML is not supported: export the tags as JSON, CSV or .xlsx");
        good = false;
    } else if (json) {
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

struct workbook {
    /* the sheet whose header has the most recognised column names; if several have, the one with the most rows */
    struct cell_table best;
    struct text others;     /* names of the other sheets with a header, for a remark */
    char *name;
    int known;
    size_t sheets;
};

static bool is_better(const struct workbook *book, int known, const struct cell_table *sheet)
{
    return known > book->known || (known == book->known && sheet->count > book->best.count);
}

static void take_sheet(void *data, struct cell_table *sheet, const char *name)
{
    struct workbook *book = data;
    struct tag_header header;
    size_t row;
    int known = find_header(sheet, &header, &row);
    bool better = is_better(book, known, sheet);
    const char *other = better ? book->name : name;
    if ((better ? book->known : known) > 0)
        text_add(&book->others, "%s'%.60s'", book->others.length > 0 ? ", " : "", other);
    book->sheets++;
    if (better) {
        struct cell_table before = book->best;
        book->best = *sheet;
        *sheet = before;
        mem_free(book->name);
        book->name = mem_strdup(name);
        book->known = known;
    }
    table_finish(sheet);
}

/* Reads the sheet of a spreadsheet that contains the tag list; cover sheets, notes and hidden sheets may precede it. */
static bool read_workbook(struct tag_export *list, const char *path, char *why, size_t why_bytes)
{
    struct workbook book = { .known = -1 };
    bool good = table_read_xlsx(path, take_sheet, &book, why, why_bytes) && read_rows(list, &book.best, why, why_bytes);
    list->control = book.best.control;
    if (good && book.sheets > 1)
        text_add(&list->remarks, "the tag list is sheet '%.60s' of %zu sheets\n", book.name, book.sheets);
    if (good && book.others.length > 0)
        text_add(&list->remarks, "other sheets with a header are not read: %s\n", book.others.at);
    table_finish(&book.best);
    text_finish(&book.others);
    mem_free(book.name);
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
        good = read_workbook(list, path, why, why_bytes);
    } else if (count >= 4 && !memcmp(bytes, "\xd0\xcf\x11\xe0", 4)) {
        snprintf(why, why_bytes, "spreadsheets of Excel 97 to 2003 (.xls) are not supported: save the sheet as .xlsx or CSV");
    } else {
        good = read_text(list, bytes, count, encoding, why, why_bytes);
    }
    mem_free(bytes);
    if (good && list->count == 0) {
        /* adds the first remark about the exported file to the error message, because it often says why the file has no tags */
        size_t length = strcspn(list->remarks.at ? list->remarks.at : "", "\n");
        snprintf(why, why_bytes, "the file contains no tags%s%.*s", length > 0 ? ": " : "", (int)length,
                 length > 0 ? list->remarks.at : "");
        good = false;
    }
    if (good) {
        tag_export_read_numbers(list);
        tag_export_join(list);
    } else {
        tag_export_finish(list);
    }
    return good;
}

void tag_export_finish(struct tag_export *list)
{
    for (size_t i = 0; i < list->count; i++)
        for (int f = 0; f < EXPORT_FIELDS; f++)
            mem_free(list->tags[i].fields[f]);
    mem_free(list->tags);
    tag_names_finish(&list->differing);
    text_finish(&list->remarks);
    *list = (struct tag_export){ 0 };
}
