/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A simulated process: each tag follows its loop with a dead time and a lag, drifts slowly and has a little noise; every few
   minutes an upset develops slowly and is corrected. No I/O, no clock; the same seed gives the same run. Call from one thread
   only. */
#ifndef DEMO_SIM_PROCESS_H
#define DEMO_SIM_PROCESS_H
#include <stddef.h>
#include <stdint.h>

enum process_kind { PROCESS_TEMPERATURE, PROCESS_PRESSURE, PROCESS_VIBRATION, PROCESS_OTHER };

struct process_tag {
    enum process_kind kind;
    double normal;    /* operating value of the tag, around which it drifts */
    double span;      /* width of the tag's range; drifts and upsets are given as fractions of this width */
    const char *name; /* name of the tag; only process_create() reads name and loop, so the caller may free both afterwards */
    const char *loop; /* any word: upsets affect the loops listed by --help; other loops drift with a phase derived from the word */
};

struct process;

struct process *process_create(const struct process_tag *tags, size_t count, uint64_t seed);
void process_destroy(struct process **process); /* Frees the simulated process and sets *process to NULL. *process may be NULL. */
void process_step(struct process *process, double dt_s);
double process_value(const struct process *process, size_t tag);
/* Returns the progress of the current upset, 0 to 1, and its name; 0 and "" between upsets. */
double process_upset(const struct process *process, const char **name);
/* Returns one line for each upset, for --help (static). */
const char *process_upset_help(void);

#endif
