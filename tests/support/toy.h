/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A small plant made in memory from simple shapes, with valid asset files, for tests of the code that uses prepared plants. */
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

/* Returns a plant without assets and with one group: id "temperature", range 0..100 degC, Shepard interpolation, distances
   along surfaces. */
struct toy *toy_create(void);
void toy_destroy(struct toy **toy);
/* Adds an asset made of `shape`, which is empty afterwards. at_m: position of its origin in the plant. sensors: positions in
   the shape's frame; their tags are named ASSET-1, ASSET-2 and so on. A vertex's stored distance to a sensor is the
   straight-line distance to the vertex nearest to the sensor. Returns the asset's index. */
int toy_add(struct toy *toy, const char *id, struct test_shape *shape, const double at_m[3], const double (*sensors)[3],
            size_t sensor_count);
/* Adds a second instance of asset number `of`, with tags of its own at the same places of the shape. plant_from_shape:
   column-major transform without shear. Returns the new asset's index. */
int toy_add_again(struct toy *toy, const char *id, int of, const double plant_from_shape[16]);
/* Returns a snapshot with a reading for every tag, all with quality Bad_WaitingForInitialData. Call it after the last asset was
   added. */
struct snapshot *toy_snapshot(const struct toy *toy);
void toy_set(struct snapshot *snapshot, int tag, double value, uint32_t quality);

/* Sets the readings of the eight tags of toy_unit(): one lies beyond the range, one is Uncertain and one is Bad. `more` is
   added to each value. */
void toy_fill(struct snapshot *snapshot, double more);

/* Returns a plant with four kinds of assets: a heat exchanger on saddles with 5 sensors, a tank with 3 sensors, and pipes and a
   pump without sensors. */
struct toy *toy_unit(void);

#endif
