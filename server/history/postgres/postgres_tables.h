/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables in PostgreSQL (HISTORY.md): creates, checks and fills them. Functions return false on failure; postgres_link_why()
   has the reason. Call from one thread only. */
#ifndef HISTORY_POSTGRES_POSTGRES_TABLES_H
#define HISTORY_POSTGRES_POSTGRES_TABLES_H
#include "history/month_outbox.h"
#include "history/postgres/postgres_link.h"

enum { POSTGRES_VERSION = 1 };

struct postgres_tables { /* state of one connection; zero-initialise, free with postgres_tables_finish() */
    struct postgres_link *link;
    int plant; /* id of the plant in the PostgreSQL database */
    int month; /* month (months since January 1970) to whose file `tags` belongs */
    struct postgres_tag {
        int32_t id; /* id of the tag in the PostgreSQL database; 0: not known */
        char *unit;
    } * tags; /* array of that month's tags, indexed by their ids in the month's file */
    size_t tag_capacity;
};

/* Creates missing tables, checks their version and, if `alone` is true, takes a lock that keeps other daemons from writing for
   this plant. On failure `why` has the reason; it is empty if postgres_link_why() has it. */
bool postgres_tables_open(struct postgres_tables *tables, struct postgres_link *link, const struct plant *plant, bool alone,
                          char why[POSTGRES_WHY_BYTES]);
void postgres_tables_finish(struct postgres_tables *tables);
/* Writes a batch of points in one transaction; existing points are replaced. newest true: also writes the newest samples, which
   are not recorded yet, and the events. */
bool postgres_tables_write(struct postgres_tables *tables, int month, const struct month_outbox_batch *batch, bool newest);

#endif
