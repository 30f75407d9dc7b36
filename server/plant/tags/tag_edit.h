/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edits the text of a tag list to move sensors, or to confirm an assumed place. Everything else stays the same to the byte:
   order, unknown columns, blank rows, quotes, number format, line ends. Pure. Call from any thread. */
#ifndef PLANT_TAGS_TAG_EDIT_H
#define PLANT_TAGS_TAG_EDIT_H
#include <stdbool.h>
#include <stddef.h>

#include "base/refusal.h"

struct tag_edit {
    const char *tag;
    const char *asset, *group; /* new ids; NULL: unchanged */
    const char *node, *place;  /* new texts; NULL: cleared */
    /* new position in the coordinate frame that the asset's settings name, written to the millimetre; NaN: the cells are emptied */
    double position_m[3];
    bool place_only;           /* true: only empties the cell `Place`, which marks the place as assumed */
};

struct tag_line {         /* line that differs between two versions of the tag list */
    int line;             /* line number, from 1, in the new text; if the line was removed, in the old text */
    char *before, *after; /* text of the line in both versions, without its line end; NULL: that version lacks the line */
};
struct tag_lines { /* zero-initialise */
    struct tag_line *at;
    size_t count, capacity, more; /* more: number of differing lines that `lines` leaves out, because it has TAG_LINES already */
};
enum { TAG_LINES = 200 };

/* Returns the text of the tag list with the edits applied; free with mem_free(). Returns NULL if a tag is missing or the list is invalid,
   with the reason in *why (mem_free()). */
char *tag_edit(const char *text, const struct tag_edit *edits, size_t count, struct refusal *why);
/* Appends the lines in which two texts differ to *out, at most TAG_LINES lines. Texts with the same number of lines are
   compared line by line. Otherwise all lines between the first and the last difference are listed, even equal ones: removed
   lines first, then added lines. Free with tag_lines_finish(). */
void tag_lines(const char *before, const char *after, struct tag_lines *out);
void tag_lines_finish(struct tag_lines *lines);

#endif
