/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensors that people place on the model: a set of moves per person, which becomes a trial (field/trials.h) at once with straight-line
   distances, and again when geodesic ones are there. Thread: the loop, except what workers call themselves. */
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
    const char *folder;        /* of prepared files; need only live for placing_create */
    void (*notify)(void *arg); /* something is there for placing_collect; any thread */
    void *notify_arg;
};
struct placing;
/* Creates it. Everything in params but folder must outlive it. Never NULL. The caller destroys it. */
struct placing *placing_create(const struct placing_params *params);
/* Waits for what is under way and frees everything. All sets must be destroyed before. &NULL is fine; leaves NULL. */
void placing_destroy(struct placing **placing);
/* Returns the registry in which views find the trials. */
struct trials *placing_trials(struct placing *placing);

enum { PLACING_MOVES = TRIAL_SENSORS };
struct place_move {
    int tag, asset;       /* in the plant */
    double position_m[3]; /* plant frame */
};
enum placed_state {
    PLACED_WAITING, /* for distances along the surface; straight ones stand in */
    PLACED_READY,
    PLACED_STRAIGHT /* there will be no others: the log says why */
};
/* A move and what came of it. */
struct placed {
    struct place_move move;
    double surface_m[3];        /* on the asset, plant frame */
    double distance_m, limit_m; /* from there to the position; more than the limit is worth a word */
    enum placed_state state;
};

struct place_set;
/* Creates an empty set of moves. The caller destroys it. */
struct place_set *place_set_create(struct placing *placing);
/* Cancels what the set waits for and frees it. &NULL is fine; leaves NULL. */
void place_set_destroy(struct place_set **set);
/* Replaces the set's moves: at most PLACING_MOVES, each tag once; unchanged ones keep their distances. Returns false with nothing changed,
   and why says which tag cannot be there (it has no group, or the point is farther from the asset than that is large). */
bool place_set_moves(struct place_set *set, const struct place_move *moves, size_t count, struct refusal *why);
/* Returns the number of the trial that stands for the set; 0: it has no moves. */
uint32_t place_set_trial(const struct place_set *set);
/* Writes the set's moves to *out, valid until the set changes. Returns their number. */
size_t place_set_get(const struct place_set *set, const struct placed **out);
/* Returns whether geodesic distances came in since the last call: another trial stands for the set now. */
bool place_set_changed(struct place_set *set);

/* The answer to a coverage request; client and seq say whose. */
struct sensor_coverage_answer {
    uint64_t client;
    uint32_t seq;
    int group;
    double reach_m;
    size_t count;
    struct {
        int asset;
        struct sensor_coverage coverage;
    } * assets; /* those with sensors of the group */
    struct sensor_coverage_answer *next;
};
/* Computes, on a worker, the sensor coverage of a group on all its assets, with the moves of `set` (NULL: none). far_m: as in
   sensor_coverage_query. The answer comes from placing_collect(). */
void placing_request_coverage(struct placing *placing, const struct place_set *set, int group, double far_m,
                              const struct snapshot *snapshot, uint64_t client, uint32_t seq);
/* Gives the sets the distances that came in, and returns the coverage answers that are ready, oldest first, as a list that the caller frees
   (sensor_coverage_answer_free() each). */
struct sensor_coverage_answer *placing_collect(struct placing *placing);
/* Frees one answer. */
void sensor_coverage_answer_free(struct sensor_coverage_answer *answer);

#endif
