/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables in PostgreSQL (HISTORY.md): made, checked, written. Functions return false on failure; postgres_link_why() says what it was.
   Thread: one. */
#ifndef HISTORY_POSTGRES_POSTGRES_TABLES_H
#define HISTORY_POSTGRES_POSTGRES_TABLES_H
#include "history/month_outbox.h"
#include "history/postgres/postgres_link.h"

enum { POSTGRES_VERSION = 1 };

struct postgres_tables { /* of one connection; zero-initialise, free with postgres_tables_finish() */
    struct postgres_link *link;
    int plant; /* its id there */
    int month; /* whose tags are known */
    struct postgres_tag {
        int32_t id; /* there; 0: not known */
        char *unit;
    } *tags;        /* by their id in the month's file */
    size_t tag_capacity;
};

/* Makes the tables where there are none, checks that they are of this version, and, with `alone`, makes sure that nobody else writes for
   this plant. Says in why what is wrong, if the server does not. */
bool postgres_tables_open(struct postgres_tables *tables, struct postgres_link *link, const struct plant *plant, bool alone,
                          char why[POSTGRES_WHY_BYTES]);
void postgres_tables_finish(struct postgres_tables *tables);
/* Writes a batch in one transaction: points that are there already are replaced. newest: the newest samples and the events as well. */
bool postgres_tables_write(struct postgres_tables *tables, int month, const struct month_outbox_batch *batch, bool newest);

#endif
