/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes the rows of matches.csv, one decision about a tag per row. */
#include "preprocess/match/decisions.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>
#include <xxhash.h>

#include "base/math/search.h"
#include "base/mem.h"
#include "base/text/charset.h"
#include "preprocess/match/table.h"

enum { TAG, STATUS, ASSET, PLACE, CONFIDENCE, REASON, MAY_BE, CHECK, COLUMNS };
static const char *const names[COLUMNS] = { "Tag", "Status", "Asset", "Place", "Confidence", "Reason", "Candidates", "Check" };
static const size_t max_bytes = (size_t)256 << 20;
static const char special[] = "\",;\t\r\n";
static const char by_hand_reason[] = "by hand";

static void add_cell(struct text *out, const char *cell)
{
    if (strpbrk(cell, special) || *cell == ' ')
        text_add_quoted(out, cell);
    else
        text_add(out, "%s", cell);
}

/* Computes the check cell of a row of matches.csv, from which a later run detects edits: the first letter of the status
 * written, then a hash of tag, status and asset. */
static void find_check(const char *tag, const char *status, const char *asset, char check[16])
{
    char *all = mem_printf("%s\n%s\n%s", tag, status, asset);
    snprintf(check, 16, "%c%06x", status[0], (unsigned)(XXH3_64bits(all, strlen(all)) & 0xffffff));
    mem_free(all);
}

void decisions_add_header(struct text *out)
{
    for (int i = 0; i < COLUMNS; i++)
        text_add(out, "%s%s", i > 0 ? "," : "", names[i]);
    text_add(out, "\n");
}

void decisions_add_row(struct text *out, const struct plant *plant, const char *tag, const struct match *match, const char *asset,
                       const char *place, bool by_hand)
{
    struct text may_be = { 0 };
    char confidence[16] = "", check[16];
    const char *status = match_status_names[match->status];
    if (!by_hand && match->status != MATCH_NONE)
        snprintf(confidence, sizeof(confidence), "%.2f", match->confidence);
    find_check(tag, status, asset, check);
    for (int i = 0; i < match->candidate_count && !by_hand; i++)
        text_add(&may_be, "%s%s", i > 0 ? "|" : "", plant->assets[match->candidates[i]].id);
    const char *const cells[COLUMNS] = {
        tag, status, asset, place, confidence, by_hand ? by_hand_reason : match->reason, may_be.at ? may_be.at : "", check
    };
    for (int i = 0; i < COLUMNS; i++) {
        text_add(out, "%s", i > 0 ? "," : "");
        add_cell(out, cells[i]);
    }
    text_add(out, "\n");
    text_finish(&may_be);
}

static char *row_text(const struct table_row *row, const int columns[COLUMNS])
{
    struct text out = { 0 };
    for (int i = 0; i < COLUMNS; i++) {
        text_add(&out, "%s", i > 0 ? "," : "");
        add_cell(&out, columns[i] < 0 ? "" : table_cell(row, columns[i]));
    }
    text_add(&out, "\n");
    return out.at;
}

static bool find_columns(const struct table_row *header, int columns[COLUMNS], char why[MATCH_WHY_BYTES])
{
    for (int i = 0; i < COLUMNS; i++) {
        columns[i] = -1;
        for (size_t c = 0; c < header->count; c++)
            if (!strcasecmp(header->cells[c], names[i]))
                columns[i] = (int)c;
    }
    for (int i = TAG; i <= ASSET; i++)
        if (columns[i] < 0) {
            snprintf(why, MATCH_WHY_BYTES, "line %d: the header of this file of decisions has no column '%s'", header->line, names[i]);
            return false;
        }
    return true;
}

/* Reads a row of matches.csv and compares it with its check cell. If they do not match, a person edited the row. If the status
 * still begins with the check's first letter, only the asset was edited, and the status follows from the new asset. */
static bool read_row(struct decision *out, const struct table_row *row, const int columns[COLUMNS], char why[MATCH_WHY_BYTES])
{
    const char *status = table_cell(row, columns[STATUS]), *asset = table_cell(row, columns[ASSET]),
               *written = table_cell(row, columns[CHECK]);
    char check[16];
    int found = -1;
    for (int i = 0; i < 3; i++)
        if (!strcasecmp(status, match_status_names[i]))
            found = i;
    if (found < 0 && *status) {
        snprintf(why, MATCH_WHY_BYTES, "line %d: column Status: expected sure, likely or none, found '%.40s'", row->line, status);
        return false;
    }
    *out = (struct decision){ .tag = mem_strdup(table_cell(row, columns[TAG])), .asset = mem_strdup(asset), .row = row_text(row, columns) };
    find_check(out->tag, found < 0 ? "" : match_status_names[found], asset, check);
    bool changed = strcmp(check, written) != 0, same_status = found >= 0 && written[0] == match_status_names[found][0];
    out->edited = changed;
    out->by_hand = changed || !strcmp(table_cell(row, columns[REASON]), by_hand_reason);
    out->status = found < 0 || (changed && same_status) ? (*asset ? MATCH_SURE : MATCH_NONE) : (enum match_status)found;
    return true;
}

static int by_tag(const void *pa, const void *pb, void *rows_ptr)
{
    const struct decision *rows = rows_ptr;
    int a = *(const int *)pa, b = *(const int *)pb, order = strcasecmp(rows[a].tag, rows[b].tag);
    return order ? order : a - b;
}

static void sort(struct decisions *decisions)
{
    int *all = mem_array(decisions->count + 1, sizeof(*all));
    for (size_t i = 0; i < decisions->count; i++)
        all[i] = (int)i;
    qsort_r(all, decisions->count, sizeof(*all), by_tag, decisions->at);
    decisions->tags = 0;
    for (size_t i = 0; i < decisions->count; i++)
        if (i == 0 || strcasecmp(decisions->at[all[i]].tag, decisions->at[all[decisions->tags - 1]].tag) != 0)
            all[decisions->tags++] = all[i];
    mem_free(decisions->by_tag);
    decisions->by_tag = all;
}

bool decisions_read(struct decisions *decisions, const char *path, char why[MATCH_WHY_BYTES])
{
    struct charset_text text;
    struct cell_table table = { 0 };
    size_t count;
    int columns[COLUMNS];
    if (access(path, F_OK) != 0 && errno == ENOENT)
        return true;
    char *bytes = text_read_file(path, max_bytes, &count);
    if (!bytes) {
        snprintf(why, MATCH_WHY_BYTES, "%s", strerror(errno));
        return false;
    }
    charset_decode(bytes, count, NULL, &text);
    bool good = table_read_csv(&table, text.utf8, table_separator(text.utf8), why, MATCH_WHY_BYTES) &&
                (table.count == 0 || find_columns(&table.rows[0], columns, why));
    for (size_t i = 1; i < table.count && good; i++) {
        mem_grow(&decisions->at, &decisions->capacity, decisions->count + 1, sizeof(*decisions->at));
        good = read_row(&decisions->at[decisions->count], &table.rows[i], columns, why);
        decisions->count += good;
    }
    sort(decisions);
    table_finish(&table);
    mem_free(text.utf8);
    mem_free(bytes);
    return good;
}

const struct decision *decisions_of(const struct decisions *decisions, const char *tag)
{
    size_t at;
    search_sorted(at, decisions->tags, strcasecmp(decisions->at[decisions->by_tag[at]].tag, tag) < 0);
    const struct decision *found = at < decisions->tags ? &decisions->at[decisions->by_tag[at]] : NULL;
    return found && !strcasecmp(found->tag, tag) ? found : NULL;
}

static bool is_one_of(const char *tag, const char *const *tags, size_t count)
{
    bool found = false;
    for (size_t i = 0; i < count && !found; i++)
        found = !strcmp(tag, tags[i]);
    return found;
}

static const char *line_at(const char *at, int from, int line)
{
    for (; from < line && *at; from++) {
        at += strcspn(at, "\n");
        at += *at == '\n';
    }
    return at;
}

char *decisions_without(const char *text, const char *const *tags, size_t count)
{
    struct cell_table table = { 0 };
    struct text out = { 0 };
    char why[MATCH_WHY_BYTES];
    int columns[COLUMNS], line = 1;
    const char *at = text;
    bool good = table_read_csv(&table, text, table_separator(text), why, sizeof(why)) && table.count > 0 &&
                find_columns(&table.rows[0], columns, why);
    for (size_t i = 1; i < table.count && good; i++) {
        if (!is_one_of(table_cell(&table.rows[i], columns[TAG]), tags, count))
            continue;
        const char *begin = line_at(at, line, table.rows[i].line);
        int next = i + 1 < table.count ? table.rows[i + 1].line : table.rows[i].line + 1;
        text_add_bytes(&out, at, (size_t)(begin - at));
        at = line_at(begin, table.rows[i].line, next);
        line = next;
    }
    text_add(&out, "%s", at);
    table_finish(&table);
    if (!good)
        text_finish(&out);
    return out.at;
}

void decisions_finish(struct decisions *decisions)
{
    for (size_t i = 0; i < decisions->count; i++) {
        mem_free(decisions->at[i].tag);
        mem_free(decisions->at[i].asset);
        mem_free(decisions->at[i].row);
    }
    mem_free(decisions->at);
    mem_free(decisions->by_tag);
    *decisions = (struct decisions){ 0 };
}
