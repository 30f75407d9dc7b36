/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tells without blocking whether rows that another thread writes are on disk yet. The owner of the rows keeps the counts under
   its own lock. */
#ifndef BASE_SETTLING_H
#define BASE_SETTLING_H
#include <errno.h>
#include <stdint.h>

#include "base/clock.h"

struct settling {
    uint64_t queued, done; /* number of rows queued for the disk since the start; number of these written or dropped since the start */
    uint64_t lost;         /* sequence number of the newest row that was dropped instead of written; 0: none was dropped */
    uint64_t failures;     /* number of failed write attempts */
    /* -errno of the newest failed attempt to write rows. A later success does not clear it, because tickets (settling_ticket)
       from before the success need it */
    int error;
};

/* The rows queued for the disk between settling_begin() and settling_end(). All zero: no rows. */
struct settling_ticket {
    uint64_t first, last, failures;
    int64_t until_ns; /* monotonic time after which a row that is not on disk counts as not saved */
};

static inline struct settling_ticket settling_begin(const struct settling *settling)
{
    return (struct settling_ticket){ .first = settling->queued, .failures = settling->failures };
}

static inline void settling_end(const struct settling *settling, struct settling_ticket *ticket, int64_t now_ns)
{
    ticket->last = settling->queued;
    ticket->until_ns = now_ns + NS_PER_S;
}

/* Counts a row that is dropped instead of written, because the queue for the disk is full. */
static inline void settling_drop(struct settling *settling)
{
    settling->lost = ++settling->queued;
    settling->done++;
}

/* Counts an attempt to write queued rows, which put `rows` more rows on disk. error: 0, or -errno if the attempt failed. */
static inline void settling_wrote(struct settling *settling, uint64_t rows, int error)
{
    settling->done += rows;
    settling->failures += error != 0;
    settling->error = error ? error : settling->error;
}

/* Returns 0 if all rows of the ticket are on disk, -EINPROGRESS while that is undecided, and another -errno if they count as not saved. */
static inline int settling_state(const struct settling *settling, const struct settling_ticket *ticket, int64_t now_ns)
{
    if (ticket->last > ticket->first && settling->lost > ticket->first)
        return -ENOSPC;
    if (ticket->last == ticket->first || settling->done >= ticket->last)
        return 0;
    if (settling->failures != ticket->failures)
        return settling->error;
    return now_ns >= ticket->until_ns ? -ETIMEDOUT : -EINPROGRESS;
}

#endif
