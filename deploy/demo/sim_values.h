/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The current value of every tag: forced through the control port, replayed from a series, or from the simulated process. Call from
   one thread only. */
#ifndef DEMO_SIM_VALUES_H
#define DEMO_SIM_VALUES_H
#include "base/text/diag.h"
#include "plant/plant.h"
#include "sim_map.h"

struct sim_values;

/* Reads the columns `Sim Value` (operating value) and `Sim Loop` of the tag list, and the series of the map. Returns NULL after
   errors, which are in diag. `plant` must outlive the result; `map` may be freed after the call. */
struct sim_values *sim_values_create(const struct plant *plant, const struct sim_map *map, bool loop, struct diag *diag);
void sim_values_destroy(struct sim_values **values); /* frees the values and sets *values to NULL; *values may be NULL */
void sim_values_step(struct sim_values *values, double dt_s);
double sim_values_at(const struct sim_values *values, size_t tag);
void sim_values_force(struct sim_values *values, size_t tag, double value);
void sim_values_release(struct sim_values *values, size_t tag);
/* Returns progress and name of the current upset, like process_upset(). */
double sim_values_upset(const struct sim_values *values, const char **name);

#endif
