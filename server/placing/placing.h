/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensors that users place on the model: a set of moves per user, which becomes a trial (field/trials.h): at once with straight-line
 * distances, and a new trial when geodesic distances have been computed. Thread: the loop, except functions called by workers. */
#ifndef PLACING_PLACING_H
#define PLACING_PLACING_H
#include "base/log/log.h"
#include "base/refusal.h"
#include "base/workers.h"
#include "field/trials.h"
#include "placing/sensor_coverage.h"
#include "value/snapshot.h"

struct placing_params {
    struct log *log;
    struct workers *workers;
    const struct scene *scene;
    const char *folder;        /* folder of prepared files; only read during placing_create() */
    void (*notify)(void *arg); /* callback, on any thread: placing_collect() has new results */
    void *notify_arg;
};
struct placing;
/* Everything in params but `folder` must outlive the result. Never NULL. The caller destroys it. */
struct placing *placing_create(const struct placing_params *params);
/* Waits for pending work and frees everything. Destroy all sets before. &NULL is fine; sets it to NULL. */
void placing_destroy(struct placing **placing);
/* Returns the registry in which views look up trials. Owned by `placing`. */
struct trials *placing_trials(struct placing *placing);

enum { PLACING_MOVES = TRIAL_SENSORS };
struct place_move {
    int tag, asset;       /* indices in the plant */
    double position_m[3]; /* in the plant frame */
};
enum placed_state {
    PLACED_WAITING, /* geodesic distances are being computed; straight-line ones are used meanwhile */
    PLACED_READY,
    PLACED_STRAIGHT /* geodesic distances are unavailable; the reason is logged */
};
/* A move and its result. */
struct placed {
    struct place_move move;
    double surface_m[3];        /* point on the asset, in the plant frame */
    double distance_m, limit_m; /* distance from surface_m to the requested position; a distance above limit_m deserves a warning */
    enum placed_state state;
};

struct place_set;
/* Creates an empty set of moves. The caller destroys it. */
struct place_set *place_set_create(struct placing *placing);
/* Cancels the set's pending requests and frees it. &NULL is fine; sets it to NULL. */
void place_set_destroy(struct place_set **set);
/* Replaces the set's moves: at most PLACING_MOVES, each tag once; unchanged ones keep their distances. Returns false with nothing changed;
   `why` names the tag that cannot be placed (it has no group, or the point is farther from the asset than the asset's size). */
bool place_set_moves(struct place_set *set, const struct place_move *moves, size_t count, struct refusal *why);
/* Returns the id of the set's trial (field/trials.h); 0: the set has no moves. */
uint32_t place_set_trial(const struct place_set *set);
/* Writes the set's moves to *out, valid until the set changes. Returns their number. */
size_t place_set_get(const struct place_set *set, const struct placed **out);
/* Returns whether geodesic distances arrived since the last call; the set then has a new trial id. */
bool place_set_changed(struct place_set *set);

/* The answer to a coverage request; client and seq identify the request. */
struct sensor_coverage_answer {
    uint64_t client;
    uint32_t seq;
    int group;
    double reach_m;
    size_t count;
    struct {
        int asset;
        struct sensor_coverage coverage;
    } * assets; /* coverage of each asset that has sensors of the group */
    struct sensor_coverage_answer *next;
};
/* Computes on a worker the sensor coverage of a group on all its assets, with the moves of `set` (NULL: none). far_m: as in
   sensor_coverage_query. placing_collect() returns the answer. */
void placing_request_coverage(struct placing *placing, const struct place_set *set, int group, double far_m,
                              const struct snapshot *snapshot, uint64_t client, uint32_t seq);
/* Delivers newly computed distances to their sets. Returns a linked list of the coverage answers that are ready, oldest first. The caller
 * frees each answer with sensor_coverage_answer_free(). */
struct sensor_coverage_answer *placing_collect(struct placing *placing);
/* Frees one answer. */
void sensor_coverage_answer_free(struct sensor_coverage_answer *answer);

#endif
