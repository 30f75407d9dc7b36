/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stores rows and cells of a table, and reads CSV. */
#include "preprocess/match/table.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"

enum { SAMPLE_LINES = 50 };

void table_add_cell(struct cell_table *table, struct table_row *row, const char *text, size_t length)
{
    char *cell = mem_array(length + 1, 1);
    size_t from = 0, to = length;
    for (size_t i = 0; i < length; i++) {
        unsigned char c = (unsigned char)text[i];
        bool control = c < 32 || c == 127;
        cell[i] = control ? ' ' : text[i];
        table->control += control && c != '\n' && c != '\r' && c != '\t';
    }
    while (from < to && cell[from] == ' ')
        from++;
    while (to > from && cell[to - 1] == ' ')
        to--;
    memmove(cell, cell + from, to - from);
    cell[to - from] = 0;
    mem_grow(&row->cells, &row->capacity, row->count + 1, sizeof(*row->cells));
    row->cells[row->count++] = cell;
}

void table_row_finish(struct table_row *row)
{
    for (size_t i = 0; i < row->count; i++)
        mem_free(row->cells[i]);
    mem_free(row->cells);
    *row = (struct table_row){ 0 };
}

void table_add_row(struct cell_table *table, struct table_row *row)
{
    bool blank = true;
    for (size_t i = 0; i < row->count; i++)
        blank &= row->cells[i][0] == 0;
    if (blank) {
        table_row_finish(row);
        return;
    }
    mem_grow(&table->rows, &table->capacity, table->count + 1, sizeof(*table->rows));
    table->rows[table->count++] = *row;
    *row = (struct table_row){ 0 };
}

const char *table_cell(const struct table_row *row, int column)
{
    return column >= 0 && (size_t)column < row->count ? row->cells[column] : "";
}

void table_finish(struct cell_table *table)
{
    for (size_t i = 0; i < table->count; i++)
        table_row_finish(&table->rows[i]);
    mem_free(table->rows);
    *table = (struct cell_table){ 0 };
}

/* Rates how likely a character is the separator of a CSV text: by the number of lines in which it occurs equally often, outside
 * quotes and at least once. Returns this number times 1000, plus its count per line as a tie-breaker. */
static size_t rate(const char *text, char separator)
{
    size_t counts[SAMPLE_LINES] = { 0 }, lines = 0, best = 0;
    bool quoted = false, any = false;
    for (; *text && lines < SAMPLE_LINES; text++) {
        if (!any && !quoted && (*text == ';' || *text == '#')) { /* skip a comment line, which may contain any character */
            text += strcspn(text, "\n");
            counts[lines] = 0;
            if (!*text)
                break;
            continue;
        }
        quoted ^= *text == '"';
        any |= *text != '\n' && *text != '\r';
        counts[lines] += *text == separator && !quoted;
        if (*text == '\n' && !quoted) {
            lines += any;
            any = false;
        }
    }
    lines += any && lines < SAMPLE_LINES;
    for (size_t i = 0; i < lines; i++) {
        size_t same = 0;
        for (size_t k = 0; k < lines; k++)
            same += counts[k] == counts[i];
        if (counts[i] > 0 && same * 1000 + counts[i] > best)
            best = same * 1000 + (counts[i] < 999 ? counts[i] : 999);
    }
    return best;
}

char table_separator(const char *text)
{
    static const char all[] = { ',', ';', '\t', '|' };
    char best = ',';
    size_t highest = 0;
    for (size_t i = 0; i < sizeof(all); i++) {
        size_t rated = rate(text, all[i]);
        if (rated > highest) {
            highest = rated;
            best = all[i];
        }
    }
    return best;
}

/* Reads the CSV cell that begins at `at` and appends it to the row. Returns the cell's end, or NULL if its quote is not terminated. */
static const char *read_cell(struct cell_table *table, struct table_row *row, const char *at, char separator, int *line)
{
    struct text cell = { 0 };
    while (*at == ' ' || (*at == '\t' && separator != '\t'))
        at++;
    text_add_bytes(&cell, "", 0);
    if (*at == '"') {
        for (at++; *at && !(*at == '"' && at[1] != '"'); at++) {
            *line += *at == '\n';
            text_add_bytes(&cell, at, 1);
            at += *at == '"';
        }
        if (!*at) {
            text_finish(&cell);
            return NULL;
        }
        at++;
    }
    const char *rest = at;
    while (*at && *at != separator && *at != '\n' && *at != '\r')
        at++;
    text_add_bytes(&cell, rest, (size_t)(at - rest));
    table_add_cell(table, row, cell.at, cell.length);
    text_finish(&cell);
    return at;
}

bool table_read_csv(struct cell_table *table, const char *text, char separator, char *why, size_t why_bytes)
{
    struct table_row row = { 0 };
    int line = 1;
    for (const char *at = text; *at;) {
        int begin = line;
        row.line = begin;
        while (true) {
            at = read_cell(table, &row, at, separator, &line);
            if (!at || row.count > TABLE_MAX_CELLS || table->count >= TABLE_MAX_ROWS) {
                if (!at)
                    snprintf(why, why_bytes, "line %d of the table: a quote is never closed", begin);
                else
                    snprintf(why, why_bytes, "line %d of the table: more than %d cells in a row, or more than %d rows", begin,
                             TABLE_MAX_CELLS, TABLE_MAX_ROWS);
                table_row_finish(&row);
                return false;
            }
            if (*at != separator)
                break;
            at++;
        }
        at += *at == '\r';
        if (*at == '\n' || (at > text && at[-1] == '\r'))
            line++;
        at += *at == '\n';
        table_add_row(table, &row);
    }
    return true;
}
