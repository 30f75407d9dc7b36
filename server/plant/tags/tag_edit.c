/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replaces cells in the text of a tag list without changing anything else. */
#include "plant/tags/tag_edit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "plant/parse/csv.h"

enum edited { EDIT_NAME, EDIT_ASSET, EDIT_GROUP, EDIT_NODE, EDIT_PLACE, EDIT_X, EDIT_Y, EDIT_Z, EDIT_COLUMNS };
static const char *const names[EDIT_COLUMNS] = { "Tag Name", "Asset", "Group", "Node", "Place", "X", "Y", "Z" };

struct cell_span { /* part of the tag list's text that is one cell, including quotes and blanks */
    const char *begin, *end;
};

struct tag_row {
    struct cell_span *cells;
    size_t count, capacity;
    const char *end; /* end of the text of the tag list's current row, before the line end */
};

struct tag_text {
    char separator;
    const char *at;
    struct tag_row row;
    int column[EDIT_COLUMNS]; /* index of each edited column in the file; -1: the file's header lacks the column */
    size_t width;             /* number of columns in the header of the tag list */
};

/* --- reading cell positions --------------------------------------------------------------------------------------------------------- */

static bool ends(char c)
{
    return c == 0 || c == '\n' || c == '\r';
}

static bool blank(char c)
{
    return c == ' ' || c == '\t';
}

static const char *cell_end(const char *at, char separator)
{
    while (blank(*at) && *at != separator)
        at++;
    if (*at == '"')
        for (at++; *at && !(*at == '"' && at[1] != '"'); at++)
            at += *at == '"';
    while (!ends(*at) && *at != separator)
        at++;
    return at;
}

/* Splits the next row of the tag list's text into cells. Returns false at the end of the list. */
static bool next_row(struct tag_text *list)
{
    struct tag_row *row = &list->row;
    row->count = 0;
    if (!*list->at)
        return false;
    for (const char *at = list->at;;) {
        const char *end = cell_end(at, list->separator);
        mem_grow(&row->cells, &row->capacity, row->count + 1, sizeof(*row->cells));
        row->cells[row->count++] = (struct cell_span){ at, end };
        if (ends(*end)) {
            row->end = end;
            list->at = end + (*end == '\r' && end[1] == '\n') + (*end != 0);
            return true;
        }
        at = end + 1;
    }
}

/* Copies the unquoted text of a cell into a buffer. */
static void read_cell(struct cell_span span, char *out, size_t size)
{
    size_t n = 0;
    while (span.begin < span.end && blank(*span.begin))
        span.begin++;
    bool quoted = span.begin < span.end && *span.begin == '"';
    for (const char *at = span.begin + quoted; at < span.end; at++) {
        if (quoted && *at == '"' && *++at != '"')
            break;
        if (n + 1 < size)
            out[n++] = *at;
    }
    while (!quoted && n > 0 && blank(out[n - 1]))
        n--;
    out[n] = 0;
}

static bool row_is_blank(const struct tag_row *row)
{
    char text[8];
    for (size_t i = 0; i < row->count; i++) {
        read_cell(row->cells[i], text, sizeof(text));
        if (text[0])
            return false;
    }
    return true;
}

static bool read_header(struct tag_text *list)
{
    char text[64];
    for (int i = 0; i < EDIT_COLUMNS; i++)
        list->column[i] = -1;
    while (next_row(list)) {
        if (row_is_blank(&list->row))
            continue;
        list->width = list->row.count;
        for (size_t c = 0; c < list->row.count; c++) {
            read_cell(list->row.cells[c], text, sizeof(text));
            for (int i = 0; i < EDIT_COLUMNS; i++)
                if (!strcasecmp(text, names[i]))
                    list->column[i] = (int)c;
        }
        return list->column[EDIT_NAME] >= 0;
    }
    return false;
}

/* --- writing ------------------------------------------------------------------------------------------------------------------ */

static void add_cell(struct text *out, const char *text, char separator)
{
    if (!text[strcspn(text, "\"\r\n")] && !strchr(text, separator) && text[0] != ' ') {
        text_add(out, "%s", text);
        return;
    }
    text_add_quoted(out, text);
}

/* Writes metres with millimetre precision, without trailing zeros. */
static void print_metres(double metres, char out[32])
{
    snprintf(out, 32, "%.3f", metres);
    size_t n = strlen(out);
    while (out[n - 1] == '0')
        n--;
    out[n - (out[n - 1] == '.')] = 0;
    if (!strcmp(out, "-0"))
        strcpy(out, "0");
}

/* Returns whether an edit changes the row's cell in this column; if so, *out receives the cell's new text. */
static bool wanted(const struct tag_text *list, const struct tag_edit *edit, size_t column, char number[32], const char **out)
{
    if (edit->place_only) {
        *out = "";
        return list->column[EDIT_PLACE] == (int)column;
    }
    for (int axis = 0; axis < 3; axis++)
        if (list->column[EDIT_X + axis] == (int)column) {
            number[0] = 0;
            if (!isnan(edit->position_m[axis]))
                print_metres(edit->position_m[axis], number);
            *out = number;
            return true;
        }
    *out = list->column[EDIT_NODE] == (int)column    ? (edit->node ? edit->node : "")
           : list->column[EDIT_PLACE] == (int)column ? (edit->place ? edit->place : "")
           : list->column[EDIT_ASSET] == (int)column ? edit->asset
           : list->column[EDIT_GROUP] == (int)column ? edit->group
                                                     : NULL;
    return *out != NULL;
}

static void write_row(const struct tag_text *list, const struct tag_edit *edit, struct text *out)
{
    const struct tag_row *row = &list->row;
    size_t count = row->count > list->width ? row->count : list->width, last = 0;
    char number[32], old[128];
    const char *text;
    for (size_t c = 0; c < count; c++)
        if (c < row->count || (wanted(list, edit, c, number, &text) && text[0]))
            last = c;
    for (size_t c = 0; c <= last; c++) {
        struct cell_span span = c < row->count ? row->cells[c] : (struct cell_span){ "", "" };
        if (c > 0)
            text_add_bytes(out, &list->separator, 1);
        old[0] = 0;
        if (c < row->count)
            read_cell(span, old, sizeof(old));
        if (wanted(list, edit, c, number, &text) && strcmp(old, text) != 0)
            add_cell(out, text, list->separator);
        else
            text_add_bytes(out, span.begin, (size_t)(span.end - span.begin));
    }
}

static const struct tag_edit *edit_of(const struct tag_text *list, const struct tag_edit *edits, size_t count, bool *done)
{
    char name[256];
    size_t column = (size_t)list->column[EDIT_NAME];
    if (column >= list->row.count)
        return NULL;
    read_cell(list->row.cells[column], name, sizeof(name));
    for (size_t i = 0; i < count; i++)
        if (!strcmp(edits[i].tag, name)) {
            done[i] = true;
            return &edits[i];
        }
    return NULL;
}

/* Appends to the header line those columns that the edits need and the tag list lacks. */
static void widen(struct tag_text *list, const struct tag_edit *edits, size_t count, struct text *out)
{
    bool needed[EDIT_COLUMNS] = { 0 };
    for (size_t i = 0; i < count; i++) {
        needed[EDIT_ASSET] |= edits[i].asset != NULL;
        needed[EDIT_GROUP] |= edits[i].group != NULL;
        needed[EDIT_NODE] |= edits[i].node != NULL;
        needed[EDIT_PLACE] |= edits[i].place != NULL;
        for (int axis = 0; axis < 3; axis++)
            needed[EDIT_X + axis] |= !edits[i].place_only && !isnan(edits[i].position_m[axis]);
    }
    for (int i = EDIT_ASSET; i < EDIT_COLUMNS; i++) {
        if (!needed[i] || list->column[i] >= 0)
            continue;
        text_add(out, "%c%s", list->separator, names[i]);
        list->column[i] = (int)list->width++;
    }
}

static char *all_rows(struct tag_text *list, const char *text, const struct tag_edit *edits, size_t count, bool *done)
{
    struct text out = { 0 };
    text_add_bytes(&out, text, (size_t)(list->row.end - text));
    widen(list, edits, count, &out);
    for (const char *copied = list->row.end; next_row(list);) {
        const char *begin = list->row.cells[0].begin;
        const struct tag_edit *edit = edit_of(list, edits, count, done);
        text_add_bytes(&out, copied, (size_t)(begin - copied));
        copied = begin;
        if (edit) {
            write_row(list, edit, &out);
            copied = list->row.end;
        }
        if (!*list->at)
            text_add_bytes(&out, copied, strlen(copied));
    }
    return out.at;
}

char *tag_edit(const char *text, const struct tag_edit *edits, size_t count, struct refusal *why)
{
    const char *begin = strncmp(text, "\xEF\xBB\xBF", 3) ? text : text + 3;
    struct tag_text list = { .separator = csv_separator(begin), .at = begin };
    bool *done = mem_array(count + 1, sizeof(*done));
    char *out = NULL;
    if (read_header(&list))
        out = all_rows(&list, text, edits, count, done);
    else
        *why = (struct refusal){ .code = REFUSAL_NO_TAG_COLUMN };
    for (size_t i = 0; out && i < count; i++)
        if (!done[i]) {
            refusal_set(why, REFUSAL_UNLISTED, "tag=%s", edits[i].tag);
            mem_free(out);
            out = NULL;
        }
    mem_free(list.row.cells);
    mem_free(done);
    return out;
}

/* --- differences -------------------------------------------------------------------------------------------------------------- */

struct text_lines {
    struct cell_span *at;
    size_t count, capacity;
};

static void split(const char *text, struct text_lines *out)
{
    while (*text) {
        const char *end = text + strcspn(text, "\r\n");
        mem_grow(&out->at, &out->capacity, out->count + 1, sizeof(*out->at));
        out->at[out->count++] = (struct cell_span){ text, end };
        text = end + (*end == '\r' && end[1] == '\n') + (*end != 0);
    }
}

static bool same(struct cell_span a, struct cell_span b)
{
    size_t n = (size_t)(a.end - a.begin);
    return n == (size_t)(b.end - b.begin) && memcmp(a.begin, b.begin, n) == 0;
}

static char *copy_of(struct cell_span span)
{
    return mem_printf("%.*s", (int)(span.end - span.begin), span.begin);
}

static void say(struct tag_lines *out, int line, const struct cell_span *before, const struct cell_span *after)
{
    if (out->count == TAG_LINES) {
        out->more++;
        return;
    }
    mem_grow(&out->at, &out->capacity, out->count + 1, sizeof(*out->at));
    out->at[out->count++] = (struct tag_line){ line, before ? copy_of(*before) : NULL, after ? copy_of(*after) : NULL };
}

/* Lists the lines of two texts between their first and their last difference. If both texts have the same number of lines,
   lists them pairwise; else removed lines first, then added ones. */
static void say_middle(const struct text_lines *a, const struct text_lines *b, size_t head, size_t tail, struct tag_lines *out)
{
    bool even = a->count == b->count;
    for (size_t i = head; i + tail < a->count; i++)
        if (!even)
            say(out, (int)i + 1, &a->at[i], NULL);
        else if (!same(a->at[i], b->at[i]))
            say(out, (int)i + 1, &a->at[i], &b->at[i]);
    for (size_t i = head; !even && i + tail < b->count; i++)
        say(out, (int)i + 1, NULL, &b->at[i]);
}

void tag_lines(const char *before, const char *after, struct tag_lines *out)
{
    struct text_lines a = { 0 }, b = { 0 };
    size_t head = 0, tail = 0;
    split(before, &a);
    split(after, &b);
    size_t least = a.count < b.count ? a.count : b.count;
    while (head < least && same(a.at[head], b.at[head]))
        head++;
    while (tail < least - head && same(a.at[a.count - 1 - tail], b.at[b.count - 1 - tail]))
        tail++;
    say_middle(&a, &b, head, tail, out);
    mem_free(a.at);
    mem_free(b.at);
}

void tag_lines_finish(struct tag_lines *lines)
{
    for (size_t i = 0; i < lines->count; i++) {
        mem_free(lines->at[i].before);
        mem_free(lines->at[i].after);
    }
    mem_free(lines->at);
    *lines = (struct tag_lines){ 0 };
}
