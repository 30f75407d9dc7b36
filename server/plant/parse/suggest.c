/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the nearest name by edit distance: insert, delete, replace, and swap of two neighbours. */
#include "plant/parse/suggest.h"

#include <ctype.h>
#include <string.h>

enum { NAME_MAX_BYTES = 64, NAMES_MAX = 4096 };

static int least(int a, int b, int c)
{
    int ab = a < b ? a : b;
    return ab < c ? ab : c;
}

static int lower(char c)
{
    return tolower((unsigned char)c);
}

/* Returns how many letters must be inserted, deleted, replaced or swapped with a neighbour to turn one text into the other (optimal string
   alignment). Texts have at most NAME_MAX_BYTES; case is ignored. */
static int edit_distance(const char *a, size_t a_bytes, const char *b, size_t b_bytes)
{
    int rows[3][NAME_MAX_BYTES + 1];
    int *before = rows[0], *last = rows[1], *now = rows[2];
    for (size_t j = 0; j <= b_bytes; j++)
        last[j] = (int)j;
    for (size_t i = 1; i <= a_bytes; i++) {
        now[0] = (int)i;
        for (size_t j = 1; j <= b_bytes; j++) {
            now[j] = least(last[j] + 1, now[j - 1] + 1, last[j - 1] + (lower(a[i - 1]) != lower(b[j - 1])));
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]) && before[j - 2] + 1 < now[j])
                now[j] = before[j - 2] + 1;
        }
        int *spare = before;
        before = last;
        last = now;
        now = spare;
    }
    return last[b_bytes];
}

const char *suggest_nearest(const char *wrong, const void *names, size_t count, size_t stride)
{
    size_t wrong_bytes = strlen(wrong);
    if (wrong_bytes == 0 || wrong_bytes > NAME_MAX_BYTES)
        return NULL;
    int limit = wrong_bytes < 3 ? 1 : wrong_bytes < 6 ? 2 : (int)wrong_bytes / 3;
    const char *best = NULL;
    for (size_t i = 0; i < count && i < NAMES_MAX; i++) {
        const char *name;
        memcpy(&name, (const char *)names + i * stride, sizeof(name));
        size_t bytes = name ? strlen(name) : 0;
        if (bytes == 0 || bytes > NAME_MAX_BYTES || bytes > wrong_bytes + (size_t)limit || wrong_bytes > bytes + (size_t)limit)
            continue;
        int distance = edit_distance(wrong, wrong_bytes, name, bytes);
        if (distance <= limit && distance < (int)bytes) {
            limit = distance - 1;
            best = name;
        }
        if (limit < 0)
            break;
    }
    return best;
}
