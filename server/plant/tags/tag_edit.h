/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edits the text of a tag list to move sensors, or to take them off their equipment. Everything else stays the same to the byte: order,
   unknown columns, blank rows, quotes, the format of numbers, line ends. Pure. Thread: any. */
#ifndef PLANT_TAGS_TAG_EDIT_H
#define PLANT_TAGS_TAG_EDIT_H
#include <stdbool.h>
#include <stddef.h>

#include "base/refusal.h"

struct tag_edit {
    const char *tag;
    const char *asset, *group; /* ids; NULL: unchanged */
    const char *node, *place;  /* NULL: cleared */
    double position_m[3];      /* in the frame that the asset states; written to the millimetre. NaN: cleared */
    bool place_only;           /* `Place` is cleared, and nothing else is changed */
};

struct tag_line { /* one line that differs */
    int line;     /* from 1, in the text after; of a line that was removed, in the text before */
    char *before, *after; /* without the line end; NULL: none */
};
struct tag_lines { /* zero-initialise */
    struct tag_line *at;
    size_t count, capacity, more; /* more: how many beyond TAG_LINES */
};
enum { TAG_LINES = 200 };

/* Returns the new text; free with mem_free(). Returns NULL if a tag is missing or the list is invalid, with the reason in *why
   (mem_free()). */
char *tag_edit(const char *text, const struct tag_edit *edits, size_t count, struct refusal *why);
/* Appends the lines in which two texts differ to *out, at most TAG_LINES of them. With as many lines in both, it compares them one by one;
   otherwise it lists all lines between the first and the last difference, equal ones too: first those removed, then those added.
   Free with tag_lines_finish(). */
void tag_lines(const char *before, const char *after, struct tag_lines *out);
void tag_lines_finish(struct tag_lines *lines);

#endif
