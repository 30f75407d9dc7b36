/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints findings, sorted by position in the files. */
#include "base/text/diag.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"

void diag_add(struct diag *diag, enum diag_severity severity, const char *file, int line, int column, const char *fmt, ...)
{
    struct text text = { 0 };
    va_list ap;
    va_start(ap, fmt);
    text_add_v(&text, fmt, ap);
    va_end(ap);
    mem_grow(&diag->items, &diag->capacity, diag->count + 1, sizeof(*diag->items));
    diag->items[diag->count++] = (struct diag_item){ severity, mem_strdup(file), line, column, text.at, fmt };
    if (severity == DIAG_ERROR)
        diag->errors++;
    else
        diag->warnings++;
}

void diag_copy(struct diag *diag, const struct diag_item *item)
{
    diag_add(diag, item->severity, item->file, item->line, item->column, "%s", item->text);
    diag->items[diag->count - 1].form = item->form;
}

static int by_place(const void *pa, const void *pb)
{
    const struct diag_item *a = *(const struct diag_item *const *)pa, *b = *(const struct diag_item *const *)pb;
    int order = strcmp(a->file, b->file);
    if (order == 0)
        order = (a->line > b->line) - (a->line < b->line);
    if (order == 0)
        order = (a->column > b->column) - (a->column < b->column);
    if (order == 0)
        order = (a > b) - (a < b); /* findings at equal positions keep the order in which they were added */
    return order;
}

enum { PLACES_BYTES = 100 };
/* maximum number of similar findings that get a line each. Of more errors, only the first 20 are printed; more warnings are
   merged into one line that lists all positions */
static const size_t most_alike[] = { [DIAG_ERROR] = 20, [DIAG_WARNING] = 3 };

static bool is_alike(const struct diag_item *a, const struct diag_item *b)
{
    return a->severity == b->severity && a->form == b->form && !strcmp(a->file, b->file);
}

/* Prints the line numbers of the findings after `shown` that are similar to it, such as "4-66, 70". */
static void print_places(const struct diag_item *const *sorted, size_t shown, size_t count, FILE *out)
{
    size_t length = 0;
    int begin = 0, last = 0;
    fputs(" (line", out);
    for (size_t i = shown + 1; i <= count; i++) {
        bool alike = i < count && is_alike(sorted[shown], sorted[i]);
        if (alike && last && (sorted[i]->line == last || sorted[i]->line == last + 1)) {
            last = sorted[i]->line;
            continue;
        }
        if (!alike && i < count)
            continue;
        if (last && length < PLACES_BYTES)
            length += (size_t)(begin == last ? fprintf(out, " %d", begin) : fprintf(out, " %d-%d", begin, last));
        else if (last && length < 2 * PLACES_BYTES)
            length += (size_t)fprintf(out, " ...") + PLACES_BYTES;
        begin = last = i < count ? sorted[i]->line : 0;
    }
    fputc(')', out);
}

static void print_item(const struct diag_item *item, FILE *out)
{
    fputs(item->file, out);
    if (item->line)
        fprintf(out, ":%d", item->line);
    if (item->column)
        fprintf(out, ":%d", item->column);
    fprintf(out, ": %s: %s", item->severity == DIAG_ERROR ? "error" : "warning", item->text);
}

struct finding_group { /* similar findings (same format string) in one file, printed together */
    size_t first, count, shown;
};

static struct finding_group *find_group(struct finding_group *groups, size_t *group_count, const struct diag_item *const *sorted,
                                        size_t item)
{
    size_t g = 0;
    while (g < *group_count && !is_alike(sorted[groups[g].first], sorted[item]))
        g++;
    if (g == *group_count)
        groups[(*group_count)++] = (struct finding_group){ .first = item };
    return &groups[g];
}

void diag_print(const struct diag *diag, FILE *out)
{
    const struct diag_item **sorted = mem_array(diag->count, sizeof(struct diag_item *));
    struct finding_group *groups = mem_array(diag->count, sizeof(*groups));
    size_t group_count = 0;
    for (size_t i = 0; i < diag->count; i++)
        sorted[i] = &diag->items[i];
    qsort(sorted, diag->count, sizeof(*sorted), by_place);
    for (size_t i = 0; i < diag->count; i++)
        find_group(groups, &group_count, sorted, i)->count++;
    for (size_t i = 0; i < diag->count; i++) {
        struct finding_group *group = find_group(groups, &group_count, sorted, i);
        bool is_error = sorted[i]->severity == DIAG_ERROR, is_many = group->count > most_alike[sorted[i]->severity];
        size_t most = is_error ? most_alike[DIAG_ERROR] : 1;
        if (is_many && group->shown == most)
            continue;
        group->shown++;
        print_item(sorted[i], out);
        if (is_many && group->shown == most) {
            fprintf(out, "; %zu more like this", group->count - most);
            print_places(sorted, i, diag->count, out);
        }
        fputc('\n', out);
    }
    mem_free(groups);
    mem_free(sorted);
}

void diag_finish(struct diag *diag)
{
    for (size_t i = 0; i < diag->count; i++) {
        mem_free(diag->items[i].file);
        mem_free(diag->items[i].text);
    }
    mem_free(diag->items);
    *diag = (struct diag){ 0 };
}
