/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A synthetic plant of point clouds with sensors, as plain structs, for tests and benchmarks of the field. */
#ifndef TESTS_SYNTHETIC_H
#define TESTS_SYNTHETIC_H
#include "scene/scene.h"
#include "value/snapshot.h"

struct synthetic_params {
    size_t vertices, sensors; /* number of vertices and of sensors on each asset; sensor i sits exactly at vertex i */
    size_t assets;            /* number of assets, all instances of one asset file; 0: one */
    size_t island;            /* number of vertices, the last ones, that no path along the surface joins with a sensor */
    double min, max;          /* range of values of the only group; both 0: 0 to 100 */
    uint64_t seed;
};

struct synthetic {
    struct plant plant;
    struct plant_group group;
    struct scene scene;
    struct asset file;
    struct snapshot *snapshot; /* all readings are Good and spread over the range */
    void *bytes;
};

/* Creates the plant. Vertices are random points in a box of 10 x 6 x 4 m. As distance along the surface it uses the sum of the
   distances along the three axes. Sensor s of asset a has the tag number a * sensors + s. Never returns NULL. */
struct synthetic *synthetic_create(const struct synthetic_params *params);
#define synthetic_create(...) synthetic_create(&(struct synthetic_params){ __VA_ARGS__ })
void synthetic_destroy(struct synthetic **synthetic);

/* Returns a random number; the same seed gives the same numbers on every machine. */
uint64_t synthetic_random(uint64_t *state);
double synthetic_random_unit(uint64_t *state); /* returns a number in [0, 1) */

/* Sets a distance along the surface in the file, rounded as in stored files. */
void synthetic_set_distance(struct synthetic *synthetic, size_t sensor, size_t vertex, float distance_m);

#endif
