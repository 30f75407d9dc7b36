/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was last said of tags, kept for the next who is to hear the same: many sessions hear of every change at one time. Pure. */
#ifndef NET_TAGS_SAID_H
#define NET_TAGS_SAID_H
#include "net/session/session.h"

struct tags_said { /* zero-initialise */
    uint32_t *before; /* what those knew who heard it; by tag */
    int64_t taken_ns; /* the snapshot that it is of */
    bool all;
    char *text; /* NULL: nothing was said yet */
};

/* As reply_tags_text; said NULL: nothing is kept. mem_free. */
char *tags_said_text(struct tags_said *said, const struct plant *plant, const struct snapshot *snapshot, uint32_t *sent, bool all);
void tags_said_finish(struct tags_said *said);

#endif
