/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A made-up plant of point clouds with sensors, as plain structs, for tests and benches of the field. */
#ifndef TESTS_SYNTHETIC_H
#define TESTS_SYNTHETIC_H
#include "scene/scene.h"
#include "value/snapshot.h"

struct synthetic_params {
    size_t vertices, sensors; /* on each asset; sensor i stands exactly at vertex i */
    size_t assets;            /* instances of one file; 0: one */
    size_t island;            /* so many of the last vertices cannot be reached on the surface from any sensor */
    double min, max;          /* of the only group; 0, 0: 0..100 */
    uint64_t seed;
};

struct synthetic {
    struct plant plant;
    struct plant_group group;
    struct scene scene;
    struct asset file;
    struct snapshot *snapshot; /* all Good, spread over the range */
    void *bytes;
};

/* Positions are random in a box of 10 x 6 x 4 m. The way along the surface is the sum of the ways along the three axes.
   Tag number: asset * sensors + sensor. Never NULL. */
struct synthetic *synthetic_create(const struct synthetic_params *params);
#define synthetic_create(...) synthetic_create(&(struct synthetic_params){ __VA_ARGS__ })
void synthetic_destroy(struct synthetic **synthetic);

/* The same numbers from the same seed everywhere. */
uint64_t synthetic_random(uint64_t *state);
double synthetic_random_unit(uint64_t *state); /* [0, 1) */

/* Sets a distance along the surface in the file, rounded as files have it. */
void synthetic_set_distance(struct synthetic *synthetic, size_t sensor, size_t vertex, float distance_m);

#endif
