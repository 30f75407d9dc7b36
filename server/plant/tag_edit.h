/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The text of a tag list with some sensors in other places. All that is not changed stays to the byte: order, unknown columns, blank rows,
   quotes, how numbers are written, ends of lines. Pure. Thread: any. */
#ifndef PLANT_TAG_EDIT_H
#define PLANT_TAG_EDIT_H
#include <stdbool.h>
#include <stddef.h>

struct tag_edit {
    const char *tag;
    const char *asset, *group; /* ids; NULL: as it is */
    double position_m[3];      /* in the frame that the asset states; written to the millimetre. A Node is taken out */
};

struct tag_line { /* what differs, line by line */
    int line;     /* from 1, in what there is after it; of what is only in the text before: there */
    char *before, *after; /* without its end; NULL: there is none */
};
struct tag_lines { /* zero-initialise */
    struct tag_line *at;
    size_t count, capacity, more; /* more: beyond TAG_LINES */
};
enum { TAG_LINES = 200 };

/* The new text (mem_free), 0 at its end. NULL: *why (mem_free) says which tag is not there, or what is wrong with the list. */
char *tag_edit(const char *text, const struct tag_edit *edits, size_t count, char **why);
/* Lines that two texts do not share. */
void tag_lines(const char *before, const char *after, struct tag_lines *out);
void tag_lines_finish(struct tag_lines *lines);

#endif
