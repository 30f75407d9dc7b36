/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads spreadsheets: a ZIP archive (minizip) of XML (expat), ISO/IEC 29500-1, 18.3 and 18.4. Reads texts and numbers as
 * stored, without applying number formats. */
#include "preprocess/match/table.h"

#include <expat.h>
#include <minizip/unzip.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"

enum {
    MAX_SHEETS = 1024,
    /* maximum total bytes of a spreadsheet's shared strings and cells; a shared string counts for each cell that uses it */
    MAX_BYTES = 1 << 28,
    MAX_CELL_BYTES = 1 << 20, /* maximum bytes of one cell or shared string; programs that write spreadsheets allow 32,767 characters */
    MAX_TAG_BYTES = 1 << 20,  /* maximum bytes of one XML tag; limited because expat parses an unfinished tag again with each block */
    MAX_DEPTH = 64,           /* maximum depth of nested XML elements; a sheet has 8 */
    STRING_BYTES = 40         /* bytes of memory that a shared string takes in addition to its text */
};
static const size_t max_part_bytes = (size_t)512 << 20;

struct xlsx_sheet {
    struct cell_table *table;
    char **strings; /* shared strings of the workbook */
    size_t string_count, string_room;
    struct table_row row;
    struct text text; /* text of the cell or shared string being parsed */
    int column, last_row;
    /* type of the cell being parsed: 's' index of a shared string, 'i' text in the cell itself, 0 value in the cell */
    char type;
    size_t bytes; /* total bytes of all shared strings and cells so far */
    int depth;    /* number of open nested XML elements */
    bool in_value, in_phonetic, too_large;
    XML_Parser parser;
};

/* Returns an XML element's name without its namespace prefix, which only some programs write. */
static const char *local(const char *name)
{
    const char *colon = strchr(name, ':');
    return colon ? colon + 1 : name;
}

static const char *attribute(const char **attributes, const char *name)
{
    for (; *attributes; attributes += 2)
        if (!strcmp(attributes[0], name))
            return attributes[1];
    return "";
}

static void refuse_large(struct xlsx_sheet *sheet)
{
    sheet->too_large = true;
    XML_StopParser(sheet->parser, XML_FALSE);
}

/* Counts the nesting depth of a beginning XML element, and refuses deeply nested elements. Returns the element's name without prefix. */
static const char *enter(struct xlsx_sheet *sheet, const char *name)
{
    if (++sheet->depth > MAX_DEPTH)
        refuse_large(sheet);
    return local(name);
}

static void on_text(void *data, const char *text, int length)
{
    struct xlsx_sheet *sheet = data;
    if (!sheet->in_value || sheet->in_phonetic)
        return;
    if (sheet->text.length + (size_t)length > MAX_CELL_BYTES)
        refuse_large(sheet);
    else
        text_add_bytes(&sheet->text, text, (size_t)length);
}

/* --- shared strings --------------------------------------------------------------------------------------------------------- */

static void string_begins(void *data, const char *name, const char **attributes)
{
    struct xlsx_sheet *sheet = data;
    name = enter(sheet, name);
    (void)attributes;
    if (!strcmp(name, "si"))
        sheet->text.length = 0;
    sheet->in_value |= !strcmp(name, "t");
    sheet->in_phonetic |= !strcmp(name, "rPh");
}

static void string_ends(void *data, const char *name)
{
    struct xlsx_sheet *sheet = data;
    sheet->depth--;
    name = local(name);
    if (!strcmp(name, "t"))
        sheet->in_value = false;
    else if (!strcmp(name, "rPh"))
        sheet->in_phonetic = false;
    else if (!strcmp(name, "si")) {
        text_add_bytes(&sheet->text, "", 0);
        sheet->bytes += sheet->text.length + STRING_BYTES;
        if (sheet->bytes > MAX_BYTES)
            refuse_large(sheet);
        mem_grow(&sheet->strings, &sheet->string_room, sheet->string_count + 1, sizeof(*sheet->strings));
        sheet->strings[sheet->string_count++] = mem_strdup(sheet->text.at);
    }
}

/* --- cells ------------------------------------------------------------------------------------------------------------------ */

static int column_of(const char *reference)
{
    int column = 0;
    for (; *reference >= 'A' && *reference <= 'Z' && column < 20000; reference++)
        column = column * 26 + (*reference - 'A' + 1);
    return column - 1;
}

static void cell_begins(void *data, const char *name, const char **attributes)
{
    struct xlsx_sheet *sheet = data;
    name = enter(sheet, name);
    if (!strcmp(name, "row")) {
        int row = atoi(attribute(attributes, "r"));
        sheet->last_row = row > 0 ? row : sheet->last_row + 1;
        sheet->row.line = sheet->last_row;
    } else if (!strcmp(name, "c")) {
        const char *reference = attribute(attributes, "r"), *type = attribute(attributes, "t");
        sheet->column = *reference ? column_of(reference) : (int)sheet->row.count;
        sheet->type = !strcmp(type, "s") ? 's' : !strcmp(type, "inlineStr") ? 'i' : 0;
        sheet->text.length = 0;
    }
    sheet->in_value |= !strcmp(name, sheet->type == 'i' ? "t" : "v");
    sheet->in_phonetic |= !strcmp(name, "rPh");
}

static void finish_cell(struct xlsx_sheet *sheet)
{
    text_add_bytes(&sheet->text, "", 0);
    const char *value = sheet->text.at;
    size_t index = sheet->type == 's' ? strtoul(value, NULL, 10) : 0;
    if (sheet->type == 's')
        value = index < sheet->string_count ? sheet->strings[index] : "";
    size_t bytes = strlen(value);
    sheet->bytes += bytes + 1;
    if (sheet->column < 0 || sheet->column > TABLE_MAX_CELLS || sheet->row.count > TABLE_MAX_CELLS || sheet->bytes > MAX_BYTES ||
        sheet->table->count >= TABLE_MAX_ROWS) {
        refuse_large(sheet);
        return;
    }
    while ((int)sheet->row.count < sheet->column)
        table_add_cell(sheet->table, &sheet->row, "", 0);
    table_add_cell(sheet->table, &sheet->row, value, bytes);
}

static void cell_ends(void *data, const char *name)
{
    struct xlsx_sheet *sheet = data;
    sheet->depth--;
    name = local(name);
    if (!strcmp(name, "v") || !strcmp(name, "t"))
        sheet->in_value = false;
    else if (!strcmp(name, "rPh"))
        sheet->in_phonetic = false;
    else if (!strcmp(name, "c"))
        finish_cell(sheet);
    else if (!strcmp(name, "row"))
        table_add_row(sheet->table, &sheet->row);
}

/* --- the archive's parts, which are XML files -------------------------------------------------------------------------------- */

static void refuse_entity(void *data, const char *name, int parameter, const char *value, int length, const char *base,
                          const char *system_id, const char *public_id, const char *notation)
{
    struct xlsx_sheet *sheet = data;
    (void)name, (void)parameter, (void)value, (void)length, (void)base, (void)system_id, (void)public_id, (void)notation;
    XML_StopParser(sheet->parser, XML_FALSE);
}

static unsigned long current_line(XML_Parser parser)
{
#if XML_MAJOR_VERSION > 2 || XML_MINOR_VERSION >= 9 /* newer versions deprecate XML_GetCurrentLineNumber */
    return (unsigned long)XML_GetCurrentLineNumber64(parser);
#else
    return (unsigned long)XML_GetCurrentLineNumber(parser);
#endif
}

/* Parses a part (XML file) of the archive. Returns 1 if it was read, 0 if it is missing, -1 if it is malformed, with the reason in why. */
static int read_part(struct xlsx_sheet *sheet, unzFile zip, const char *part, XML_StartElementHandler begins, XML_EndElementHandler ends,
                     char *why, size_t why_bytes)
{
    char buffer[65536];
    size_t total = 0;
    int count = 0, good = 1;
    if (unzLocateFile(zip, part, 2) != UNZ_OK)
        return 0;
    if (unzOpenCurrentFile(zip) != UNZ_OK) {
        snprintf(why, why_bytes, "part %s of the .xlsx file cannot be unpacked: the file is damaged", part);
        return -1;
    }
    XML_Parser parser = sheet->parser = XML_ParserCreate(NULL);
    sheet->depth = 0;
    XML_SetUserData(parser, sheet);
    XML_SetElementHandler(parser, begins, ends);
    XML_SetCharacterDataHandler(parser, on_text);
    XML_SetEntityDeclHandler(parser, refuse_entity);
    do {
        count = unzReadCurrentFile(zip, buffer, sizeof(buffer));
        total += count > 0 ? (size_t)count : 0;
        if (count < 0 || total > max_part_bytes || XML_Parse(parser, buffer, count, count == 0) != XML_STATUS_OK)
            good = -1;
        else if (count > 0 && (XML_Index)total - XML_GetCurrentByteIndex(parser) > MAX_TAG_BYTES) {
            sheet->too_large = true;
            good = -1;
        }
    } while (good == 1 && count > 0);
    if (good < 0 && (total > max_part_bytes || sheet->too_large))
        snprintf(why, why_bytes, "part %s of the .xlsx file is too large: save the sheet with the tags as CSV", part);
    else if (good < 0)
        snprintf(why, why_bytes, "%s, line %lu: %s", part, current_line(parser),
                 count < 0 ? "cannot be unpacked" : XML_ErrorString(XML_GetErrorCode(parser)));
    XML_ParserFree(parser);
    if (unzCloseCurrentFile(zip) == UNZ_CRCERROR && good == 1) {
        snprintf(why, why_bytes, "%s is damaged: its checksum is wrong", part);
        good = -1;
    }
    return good;
}

/* --- the workbook ----------------------------------------------------------------------------------------------------------- */

struct book_sheet {
    char name[200], id[64], part[300];
};

struct book {
    /* must be the first member, because the XML handlers cast a pointer to it to a pointer to this struct */
    struct xlsx_sheet sheet;
    struct book_sheet sheets[MAX_SHEETS];
    int count;
    bool too_many;
};

static void sheet_begins(void *data, const char *name, const char **attributes)
{
    struct book *book = data;
    if (strcmp(enter(&book->sheet, name), "sheet") != 0)
        return;
    if (book->count == MAX_SHEETS) {
        book->too_many = true;
        return;
    }
    struct book_sheet *at = &book->sheets[book->count++];
    snprintf(at->name, sizeof(at->name), "%s", attribute(attributes, "name"));
    for (; *attributes; attributes += 2)
        if (strchr(attributes[0], ':') && !strcmp(local(attributes[0]), "id"))
            snprintf(at->id, sizeof(at->id), "%s", attributes[1]);
}

static void relation_begins(void *data, const char *name, const char **attributes)
{
    struct book *book = data;
    const char *target = attribute(attributes, "Target");
    bool relation = !strcmp(enter(&book->sheet, name), "Relationship");
    for (int i = 0; i < book->count && relation; i++)
        if (!strcmp(book->sheets[i].id, attribute(attributes, "Id")))
            snprintf(book->sheets[i].part, sizeof(book->sheets[i].part), "%s%s", *target == '/' ? "" : "xl/", target + (*target == '/'));
}

static void nothing_ends(void *data, const char *name)
{
    ((struct book *)data)->sheet.depth--;
    (void)name;
}

/* Finds the sheets of a spreadsheet in the archive's list of sheets, or by their usual file names if there is no list. Returns
 * false with the reason in why. */
static bool find_sheets(struct book *book, unzFile zip, char *why, size_t why_bytes)
{
    if (read_part(&book->sheet, zip, "xl/workbook.xml", sheet_begins, nothing_ends, why, why_bytes) < 0 ||
        read_part(&book->sheet, zip, "xl/_rels/workbook.xml.rels", relation_begins, nothing_ends, why, why_bytes) < 0)
        return false;
    if (book->too_many) {
        snprintf(why, why_bytes, "more than %d sheets: save the sheet with the tags as a separate file", MAX_SHEETS);
        return false;
    }
    for (int i = 0; i < MAX_SHEETS && book->count == i; i++) {
        char part[64];
        snprintf(part, sizeof(part), "xl/worksheets/sheet%d.xml", i + 1);
        if (unzLocateFile(zip, part, 2) == UNZ_OK)
            snprintf(book->sheets[book->count++].part, sizeof(part), "%s", part);
    }
    return true;
}

bool table_read_xlsx(const char *path, table_take_sheet *take, void *data, char *why, size_t why_bytes)
{
    unzFile zip = unzOpen(path);
    if (!zip) {
        snprintf(why, why_bytes, "not a spreadsheet: the ZIP archive cannot be opened");
        return false;
    }
    struct book *book = mem_new(sizeof(*book));
    struct xlsx_sheet *sheet = &book->sheet;
    int good = find_sheets(book, zip, why, why_bytes) ? 1 : -1, sheets = 0;
    if (good > 0)
        good = read_part(sheet, zip, "xl/sharedStrings.xml", string_begins, string_ends, why, why_bytes);
    for (int i = 0; good >= 0 && i < book->count; i++) {
        struct cell_table table = { 0 };
        sheet->table = &table;
        sheet->in_value = sheet->in_phonetic = false;
        sheet->last_row = 0;
        good = read_part(sheet, zip, book->sheets[i].part, cell_begins, cell_ends, why, why_bytes);
        sheets += good > 0;
        if (good > 0 && table.count > 0)
            take(data, &table, book->sheets[i].name);
        table_finish(&table);
        table_row_finish(&sheet->row);
    }
    if (good >= 0 && sheets == 0) {
        snprintf(why, why_bytes, "not a spreadsheet: the file has no sheet");
        good = -1;
    }
    unzClose(zip);
    for (size_t i = 0; i < sheet->string_count; i++)
        mem_free(sheet->strings[i]);
    mem_free(sheet->strings);
    text_finish(&sheet->text);
    mem_free(book);
    return good >= 0;
}
