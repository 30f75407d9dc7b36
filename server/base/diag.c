/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Findings with their places, printed in the order of the text. */
#include "base/diag.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/text.h"

void diag_add(struct diag *diag, enum diag_severity severity, const char *file, int line, int column, const char *fmt, ...)
{
    struct text text = { 0 };
    va_list ap;
    va_start(ap, fmt);
    text_add_v(&text, fmt, ap);
    va_end(ap);
    mem_grow(&diag->items, &diag->capacity, diag->count + 1, sizeof(*diag->items));
    diag->items[diag->count++] = (struct diag_item){ severity, mem_strdup(file), line, column, text.at };
    if (severity == DIAG_ERROR)
        diag->errors++;
    else
        diag->warnings++;
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
        order = (a > b) - (a < b); /* as found */
    return order;
}

void diag_print(const struct diag *diag, FILE *out)
{
    const struct diag_item **sorted = mem_array(diag->count, sizeof(struct diag_item *));
    for (size_t i = 0; i < diag->count; i++)
        sorted[i] = &diag->items[i];
    qsort(sorted, diag->count, sizeof(*sorted), by_place);
    for (size_t i = 0; i < diag->count; i++) {
        const struct diag_item *item = sorted[i];
        fputs(item->file, out);
        if (item->line)
            fprintf(out, ":%d", item->line);
        if (item->column)
            fprintf(out, ":%d", item->column);
        fprintf(out, ": %s: %s\n", item->severity == DIAG_ERROR ? "error" : "warning", item->text);
    }
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
