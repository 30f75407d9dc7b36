/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plant made in a test, without files. It is freed automatically after the test (tests/support/owned.h). */
#ifndef TESTS_PLANT_BY_HAND_H
#define TESTS_PLANT_BY_HAND_H
#include "plant/plant.h"

/* Returns a plant without tags and sources, with memory for max_tags tags and 16 sources. */
struct plant *plant_by_hand_create(size_t max_tags);
/* Adds a Modbus source at 127.0.0.1:port, unit 1, polled every 100 ms, timeout 2 s. */
struct plant_source *plant_by_hand_source(struct plant *plant, const char *id, int port);
/* Adds a tag to the newest source: unscaled, without a unit, stale after 5 s, byte order ABCD if it takes more than one
   register. A unit set by a test must come from mem_strdup(); it is freed together with the plant. */
struct plant_tag *plant_by_hand_tag(struct plant *plant, const char *name, enum register_table table, int register_index,
                                    enum data_type type);

#endif
