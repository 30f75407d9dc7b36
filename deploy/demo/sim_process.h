/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A process that behaves: each tag follows its loop with a dead time and a lag, drifts slowly, has a little noise, and every few
   minutes something goes wrong slowly and is put right again. No I/O, no clock; the same seed gives the same run. Thread: one. */
#ifndef DEMO_SIM_PROCESS_H
#define DEMO_SIM_PROCESS_H
#include <stddef.h>
#include <stdint.h>

enum process_kind { PROCESS_TEMPERATURE, PROCESS_PRESSURE, PROCESS_VIBRATION, PROCESS_OTHER };

struct process_tag {
    enum process_kind kind;
    double normal;     /* operating value */
    double span;       /* of its range: what drifts and upsets are shares of */
    const char *name;  /* only lives for the call; so below */
    const char *loop;  /* where it belongs: any word. Upsets know the words of --help; others drift by a phase made from it */
};

struct process;

struct process *process_create(const struct process_tag *tags, size_t count, uint64_t seed);
void process_destroy(struct process **process); /* &NULL is fine; leaves NULL */
void process_step(struct process *process, double dt_s);
double process_value(const struct process *process, size_t tag);
/* How far the running upset has come, 0..1, and its name; 0 and "" between upsets. */
double process_upset(const struct process *process, const char **name);
/* One line each, for --help. */
const char *process_upset_help(void);

#endif
