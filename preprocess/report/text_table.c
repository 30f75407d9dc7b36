/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Formats text tables for a terminal. */
#include "preprocess/report/text_table.h"

#include <stdarg.h>
#include <string.h>

#include "base/mem.h"

void text_table_add(struct text_table *table, const char *fmt, ...)
{
    struct text cell = { 0 };
    va_list ap;
    va_start(ap, fmt);
    text_add_v(&cell, fmt, ap);
    va_end(ap);
    mem_grow(&table->cells, &table->capacity, table->cell_count + 1, sizeof(*table->cells));
    table->cells[table->cell_count++] = cell.at ? cell.at : mem_strdup("");
}

/* Returns the width of a cell's text in characters, not bytes: names may be in any language. */
static size_t width_of(const char *text)
{
    size_t width = 0;
    for (; *text; text++)
        width += ((unsigned char)*text & 0xc0) != 0x80;
    return width;
}

/* Returns the width of a column in characters, or 0 if it has no content. */
static size_t column_width(const struct text_table *table, size_t column, size_t rows)
{
    size_t width = 0;
    for (size_t row = 0; row < rows; row++) {
        size_t own = width_of(table->cells[row * table->column_count + column]);
        width = own > width ? own : width;
    }
    size_t title = width_of(table->columns[column].title);
    return width && title > width ? title : width;
}

static void pad(struct text *line, size_t count)
{
    while (count--)
        text_add_bytes(line, " ", 1);
}

static void add_cell(struct text *line, const char *cell, size_t width, bool right)
{
    size_t missing = width - width_of(cell);
    if (line->length)
        pad(line, 2);
    pad(line, right ? missing : 0);
    text_add_bytes(line, cell, strlen(cell));
    pad(line, right ? 0 : missing);
}

static void print_line(struct text *line, FILE *out)
{
    while (line->length && line->at[line->length - 1] == ' ')
        line->at[--line->length] = 0;
    fprintf(out, "%s\n", line->at ? line->at : "");
    line->length = 0;
}

void text_table_print(const struct text_table *table, size_t rows, FILE *out)
{
    size_t all = table->cell_count / table->column_count, shown = all < rows ? all : rows;
    size_t *widths = mem_array(table->column_count, sizeof(*widths));
    struct text line = { 0 };
    for (size_t c = 0; c < table->column_count; c++) {
        widths[c] = column_width(table, c, shown);
        if (widths[c])
            add_cell(&line, table->columns[c].title, widths[c], table->columns[c].right);
    }
    print_line(&line, out);
    for (size_t row = 0; row < shown; row++) {
        for (size_t c = 0; c < table->column_count; c++)
            if (widths[c])
                add_cell(&line, table->cells[row * table->column_count + c], widths[c], table->columns[c].right);
        print_line(&line, out);
    }
    if (shown < all)
        fprintf(out, "... and %zu more rows: --report text lists all rows\n", all - shown);
    text_finish(&line);
    mem_free(widths);
}

void text_table_finish(struct text_table *table)
{
    for (size_t i = 0; i < table->cell_count; i++)
        mem_free(table->cells[i]);
    mem_free(table->cells);
    table->cells = NULL;
    table->cell_count = table->capacity = 0;
}

struct text_table_number text_table_number(unsigned long long number)
{
    struct text_table_number out;
    char digits[32];
    int length = snprintf(digits, sizeof(digits), "%llu", number), to = 0;
    for (int i = 0; i < length; i++) {
        if (i && (length - i) % 3 == 0)
            out.text[to++] = ',';
        out.text[to++] = digits[i];
    }
    out.text[to] = 0;
    return out;
}
