/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plant made in memory, for tests of everything after preprocessing: assets made from shapes, with real asset files. */
#ifndef TESTS_SUPPORT_TOY_H
#define TESTS_SUPPORT_TOY_H
#include "scene/scene.h"
#include "tests/support/shape.h"
#include "value/snapshot.h"

enum toy_material { TOY_STEEL, TOY_BLUE, TOY_CONCRETE, TOY_MATERIALS };

struct toy {
    struct plant plant;
    struct scene scene;
};

/* Returns a plant with one group: "temperature", 0..100 degC, Shepard interpolation, distances along surfaces. */
struct toy *toy_create(void);
void toy_destroy(struct toy **toy);
/* Adds an asset; takes the shape's content and leaves it empty. at_m: position of its origin. Sensors: positions in the shape's own
   frame. Tags are named ASSET-1, ASSET-2, ... Distances are straight lines from the nearest vertex. Returns the asset's index. */
int toy_add(struct toy *toy, const char *id, struct test_shape *shape, const double at_m[3], const double (*sensors)[3],
            size_t sensor_count);
/* Adds another instance of asset `of`, with its own tags at the same places; plant_from_shape: column-major, without shear. Returns its
   index. */
int toy_add_again(struct toy *toy, const char *id, int of, const double plant_from_shape[16]);
/* Call it after adding the last asset. Returns readings for every tag, all Bad_WaitingForInitialData. */
struct snapshot *toy_snapshot(const struct toy *toy);
void toy_set(struct snapshot *snapshot, int tag, double value, uint32_t quality);

/* Sets the eight tags of toy_unit(): one value is beyond the range, one is uncertain and one is bad; `more` is added to all. */
void toy_fill(struct snapshot *snapshot, double more);

/* Returns a plant with a heat exchanger with 5 sensors, on saddles; a tank with 3 sensors; and pipes and a pump without sensors. */
struct toy *toy_unit(void);

#endif
