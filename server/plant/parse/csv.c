/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads CSV and unquotes it in place: unquoting never lengthens a cell, so the text fits into the file's own buffer. */
#include "plant/parse/csv.h"

#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "plant/parse/input.h"

static bool at_line_end(const char *p)
{
    return *p == '\n' || *p == '\r';
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

static void step(struct csv *csv)
{
    char c = *csv->at++;
    if (c == '\n' || (c == '\r' && *csv->at != '\n')) {
        csv->line++;
        csv->column = 1;
    } else if (((unsigned char)c & 0xC0) != 0x80) {
        csv->column++;
    }
}

static void skip_blanks(struct csv *csv)
{
    while (is_blank(*csv->at) && *csv->at != csv->separator)
        step(csv);
}

/* Reads a quoted cell, starting at its opening quote. Leaves csv->at after the closing quote; *end receives the end of the cell's text. */
static void read_quoted(struct csv *csv, struct csv_cell *cell, char **end)
{
    char *out = csv->at;
    cell->text = out;
    step(csv);
    for (;;) {
        char c = *csv->at;
        if (!c) {
            diag_error(csv->diag, csv->path, cell->line, cell->column, "a quote that begins here is never closed");
            break;
        }
        step(csv);
        if (c == '"') {
            if (*csv->at != '"')
                break;
            step(csv);
        }
        *out++ = c;
    }
    *end = out;
}

static void skip_after_quote(struct csv *csv)
{
    skip_blanks(csv);
    if (*csv->at && !at_line_end(csv->at) && *csv->at != csv->separator)
        diag_error(csv->diag, csv->path, csv->line, csv->column, "text after the closing quote; write a quote inside a cell twice");
    while (*csv->at && !at_line_end(csv->at) && *csv->at != csv->separator)
        step(csv);
}

static void read_plain(struct csv *csv, struct csv_cell *cell, char **end)
{
    cell->text = *end = csv->at;
    while (*csv->at && !at_line_end(csv->at) && *csv->at != csv->separator) {
        char c = *csv->at;
        step(csv);
        if (!is_blank(c))
            *end = csv->at;
    }
}

/* Reads a cell. Returns true if another cell of the same row follows. */
static bool read_cell(struct csv *csv, struct csv_row *row)
{
    mem_grow(&row->cells, &row->capacity, row->count + 1, sizeof(*row->cells));
    struct csv_cell *cell = &row->cells[row->count++];
    char *end;
    skip_blanks(csv);
    cell->line = csv->line;
    cell->column = csv->column;
    if (*csv->at == '"') {
        read_quoted(csv, cell, &end);
        skip_after_quote(csv);
    } else {
        read_plain(csv, cell, &end);
    }
    bool more = *csv->at && *csv->at == csv->separator;
    if (more || *csv->at == '\n') {
        step(csv);
    } else if (*csv->at == '\r') {
        step(csv);
        if (*csv->at == '\n')
            step(csv);
    }
    *end = 0;
    return more;
}

static bool row_is_blank(const struct csv_row *row)
{
    for (size_t i = 0; i < row->count; i++)
        if (row->cells[i].text[0])
            return false;
    return true;
}

static bool read_row(struct csv *csv, struct csv_row *row)
{
    while (*csv->at) {
        row->count = 0;
        while (read_cell(csv, row))
            ;
        if (!row_is_blank(row))
            return true;
    }
    row->count = 0;
    return false;
}

char csv_separator(const char *p)
{
    static const char separators[] = ",;\t";
    size_t counts[3] = { 0 }, best = 0;
    bool quoted = false;
    p += strspn(p, " \t\r\n");
    for (; *p && (quoted || !at_line_end(p)); p++) {
        const char *found = strchr(separators, *p);
        quoted ^= *p == '"';
        if (found && !quoted)
            counts[found - separators]++;
    }
    for (size_t i = 1; i < 3; i++)
        if (counts[i] > counts[best])
            best = i;
    return separators[best];
}

static void check_header(struct csv *csv)
{
    struct csv_row *header = &csv->header;
    while (header->count > 1 && !header->cells[header->count - 1].text[0])
        header->count--;
    for (size_t i = 0; i < header->count; i++) {
        const struct csv_cell *cell = &header->cells[i];
        size_t first = 0;
        while (cell->text[0] && strcasecmp(header->cells[first].text, cell->text) != 0)
            first++;
        if (cell->text[0] && first < i)
            diag_error(csv->diag, csv->path, cell->line, cell->column, "column '%s' is listed twice (first at column %d)", cell->text,
                       header->cells[first].column);
    }
}

static const char WANTED[] = "a table (CSV)";

/* Begins to read CSV: takes ownership of `text`, the content of the file, and reads the header row. Returns false if that
   fails, or if text is NULL because the file could not be read. */
static bool begin(struct csv *csv, const char *path, char *text, struct diag *diag)
{
    if (!text)
        return false;
    *csv = (struct csv){ .path = mem_strdup(path), .diag = diag, .bytes = text, .at = text, .line = 1, .column = 1 };
    csv->separator = csv_separator(text);
    if (!read_row(csv, &csv->header)) {
        diag_error(diag, path, 1, 1, "the file has no header row with the names of its columns");
        csv_close(csv);
        return false;
    }
    check_header(csv);
    return true;
}

bool csv_open(struct csv *csv, const char *path, struct diag *diag)
{
    size_t bytes;
    return begin(csv, path, input_read(path, WANTED, diag, &bytes), diag);
}

bool csv_open_foreign(struct csv *csv, const char *path, const char *encoding, struct diag *diag, struct charset_choice *choice)
{
    size_t bytes;
    return begin(csv, path, input_read_foreign(path, WANTED, encoding, diag, &bytes, choice), diag);
}

void csv_close(struct csv *csv)
{
    mem_free(csv->path);
    mem_free(csv->bytes);
    mem_free(csv->header.cells);
    mem_free(csv->row.cells);
    *csv = (struct csv){ 0 };
}

bool csv_next(struct csv *csv)
{
    if (!read_row(csv, &csv->row))
        return false;
    for (size_t i = csv->header.count; i < csv->row.count; i++) {
        const struct csv_cell *cell = &csv->row.cells[i];
        if (!cell->text[0])
            continue;
        diag_error(csv->diag, csv->path, cell->line, cell->column, "the row has a cell %zu, but the header has only %zu columns", i + 1,
                   csv->header.count);
        break;
    }
    return true;
}

int csv_find(const struct csv *csv, const char *name)
{
    for (size_t i = 0; i < csv->header.count; i++)
        if (!strcasecmp(csv->header.cells[i].text, name))
            return (int)i;
    return -1;
}

static const struct csv_cell *find_cell(const struct csv *csv, int column)
{
    return column >= 0 && (size_t)column < csv->row.count ? &csv->row.cells[column] : NULL;
}

const char *csv_text(const struct csv *csv, int column)
{
    const struct csv_cell *cell = find_cell(csv, column);
    return cell ? cell->text : "";
}

int csv_cell_line(const struct csv *csv, int column)
{
    const struct csv_cell *cell = find_cell(csv, column);
    return cell ? cell->line : csv->row.cells[0].line;
}

int csv_cell_column(const struct csv *csv, int column)
{
    const struct csv_cell *cell = find_cell(csv, column);
    return cell ? cell->column : csv->row.cells[0].column;
}
