/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints progress and estimated remaining time while a plant is prepared. On a terminal, rewrites one line; otherwise prints a
 * new line from time to time. The caller passes the current time. Call from one thread at a time. */
#ifndef PREPROCESS_PIPELINE_PROGRESS_H
#define PREPROCESS_PIPELINE_PROGRESS_H
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#define PROGRESS_TERMINAL_NS 200000000LL
#define PROGRESS_LINE_NS 5000000000LL

struct progress { /* zero-initialise; out NULL: prints nothing */
    FILE *out;
    bool terminal;
    int64_t began_ns, said_ns;
    /* numbers of assets. total: all; there: need no work; done: needed work and are finished */
    size_t total, there, done;
    size_t known; /* number of assets that need a known amount of work */
    double work_known, work_done;
};

/* Starts counting finished assets. total: number of assets; there: number of assets that need no work. out NULL: prints nothing. */
void progress_begin(struct progress *progress, FILE *out, size_t total, size_t there, int64_t now_ns);
/* Adds an asset's amount of work, in any unit. Call it before the asset is finished. */
void progress_expect(struct progress *progress, double work);
/* Counts an asset with this amount of work as finished. Prints a line if one is due. */
void progress_step(struct progress *progress, double work, int64_t now_ns);
/* Clears the progress line on a terminal. */
void progress_end(struct progress *progress);

/* Returns the estimated remaining seconds at the average rate so far, or a negative number if nothing is finished yet. */
double progress_left_s(const struct progress *progress, int64_t now_ns);

#endif
