/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints how far preparing has come and how long it will still take: one line that is rewritten on a terminal, else a line now and then.
   Time is passed in. Thread: one at a time. */
#ifndef PREPROCESS_PIPELINE_PROGRESS_H
#define PREPROCESS_PIPELINE_PROGRESS_H
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#define PROGRESS_TERMINAL_NS 200000000LL
#define PROGRESS_LINE_NS 5000000000LL

struct progress { /* zero-initialise; out NULL: silent */
    FILE *out;
    bool terminal;
    int64_t began_ns, said_ns;
    size_t total, there, done; /* assets: all; those that need no work; those of the rest that are finished */
    size_t known;              /* of the rest: those whose work is known */
    double work_known, work_done;
};

/* Starts counting: `total` assets, of which `there` need no work. out NULL: prints nothing. */
void progress_begin(struct progress *progress, FILE *out, size_t total, size_t there, int64_t now_ns);
/* Adds an asset's amount of work, in any unit, as soon as it is known and before it is done. */
void progress_expect(struct progress *progress, double work);
/* Counts an asset of this amount of work as finished, and prints if it is time to. */
void progress_step(struct progress *progress, double work, int64_t now_ns);
/* Clears the terminal's line. */
void progress_end(struct progress *progress);

/* Returns the estimated seconds for the rest at the rate so far; negative if nothing is done yet. */
double progress_left_s(const struct progress *progress, int64_t now_ns);

#endif
