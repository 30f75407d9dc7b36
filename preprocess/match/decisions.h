/* SPDX-License-Identifier: GPL-3.0-or-later */
/* matches.csv: what each tag was matched to, and why; what people change in it is kept and obeyed. Thread: one. */
#ifndef PREPROCESS_MATCH_DECISIONS_H
#define PREPROCESS_MATCH_DECISIONS_H
#include "base/text/text.h"
#include "preprocess/match/matcher.h"

struct decision { /* a row, as it was */
    char *tag, *asset;
    enum match_status status; /* of a row by hand what it means now */
    bool by_hand, edited;     /* edited: since it was written */
    char *row;                /* all of it, with its line end */
};

struct decisions {       /* zero-initialise */
    struct decision *at; /* in the order of the file */
    int *by_tag;         /* the first of each tag, sorted; upper and lower case taken as one */
    size_t count, capacity, tags;
};

/* Reads a file that decisions_add_row() wrote, perhaps changed since, or one that has Tag, Status and Asset alone. A file that is not there
 * has none. What was read before goes before what the file has of the same tag. Returns false with the reason. */
bool decisions_read(struct decisions *decisions, const char *path, char why[MATCH_WHY_BYTES]);
/* Returns the decision about a tag, or NULL. */
const struct decision *decisions_of(const struct decisions *decisions, const char *tag);
void decisions_finish(struct decisions *decisions);

/* Returns the file's text without the rows of these tags (mem_free), so that they are matched anew; NULL if it cannot be read. */
char *decisions_without(const char *text, const char *const *tags, size_t count);

/* Appends the header, and a row, with bars between the assets that a tag may be on. A row that people changed is told by its last cell,
 * which depends on what was written. */
void decisions_add_header(struct text *out);
void decisions_add_row(struct text *out, const struct plant *plant, const char *tag, const struct match *match, const char *asset,
                       const char *place, bool by_hand);

#endif
