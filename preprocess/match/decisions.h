/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes matches.csv: the equipment that each tag was matched to, and the reason. Rows edited by people are kept and
 * override the matcher. Call from one thread only. */
#ifndef PREPROCESS_MATCH_DECISIONS_H
#define PREPROCESS_MATCH_DECISIONS_H
#include "base/text/text.h"
#include "preprocess/match/matcher.h"

struct decision { /* one row of matches.csv */
    char *tag, *asset;
    enum match_status status; /* status in matches.csv; for an edited row, the status implied by the edit */
    bool by_hand, edited;     /* by_hand: a person made the decision; edited: a person changed the row after the last run */
    char *row;                /* the whole row of matches.csv with its line end */
};

struct decisions {       /* zero-initialise */
    struct decision *at; /* decisions in the order of the file */
    int *by_tag;         /* index of the first decision about each tag, sorted by tag (case-insensitive) */
    size_t count, capacity, tags;
};

/* Reads decisions about tags from a file written by decisions_add_row(), possibly edited since, or from a file with only the
 * columns Tag, Status and Asset. A missing file counts as empty. Decisions already in `decisions` take precedence over the
 * file's decisions about the same tags. Returns false with the reason in why. */
bool decisions_read(struct decisions *decisions, const char *path, char why[MATCH_WHY_BYTES]);
/* Returns the decision about a tag, or NULL if there is none. */
const struct decision *decisions_of(const struct decisions *decisions, const char *tag);
void decisions_finish(struct decisions *decisions);

/* Returns the text of matches.csv without the rows of these tags, so that the next run matches the tags again. The caller frees the text
 * (mem_free). Returns NULL if the text cannot be parsed. */
char *decisions_without(const char *text, const char *const *tags, size_t count);

/* Append the header line, or one row, to the text of matches.csv. If a tag may belong to several assets, their names are
 * separated by bars. The row's last cell is a check of the status and asset, from which a later run detects edits. */
void decisions_add_header(struct text *out);
void decisions_add_row(struct text *out, const struct plant *plant, const char *tag, const struct match *match, const char *asset,
                       const char *place, bool by_hand);

#endif
