/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensors that people place: for each who does it a set of moves, which become a trial (field/trials.h) at once with straight distances,
   and again when those along the surface are there. Thread: the loop, but for what workers call by themselves. */
#ifndef PLACING_PLACING_H
#define PLACING_PLACING_H
#include "base/log.h"
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
/* Never NULL. All but folder must outlive it. */
struct placing *placing_create(const struct placing_params *params);
/* Every set is gone by then. Waits for what is under way. &NULL is fine; leaves NULL. */
void placing_destroy(struct placing **placing);
struct trials *placing_trials(struct placing *placing); /* where views of its trials find them */

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
struct placed {
    struct place_move move;
    double surface_m[3];        /* on the asset, plant frame */
    double distance_m, limit_m; /* from there to the position; more than the limit is worth a word */
    enum placed_state state;
};

struct place_set;
struct place_set *place_set_create(struct placing *placing);
void place_set_destroy(struct place_set **set); /* &NULL is fine; leaves NULL; what waits for it is cancelled */
/* In place of all that was in the set; what is as it was keeps its distances. At most PLACING_MOVES, each tag once. False: nothing has
   changed, and why says which tag cannot be there (it has no group, or the place is farther from the asset than that is large). */
bool place_set_moves(struct place_set *set, const struct place_move *moves, size_t count, char why[160]);
uint32_t place_set_trial(const struct place_set *set);                        /* 0: no moves */
size_t place_set_get(const struct place_set *set, const struct placed **out); /* valid until it changes */
/* Distances came in since it was asked last: another trial stands for the set. */
bool place_set_changed(struct place_set *set);

/* Gaps of a group on all its assets, by a worker. client, seq: whose answer it is. */
struct sensor_coverage_answer {
    uint64_t client;
    uint32_t seq;
    int group;
    double reach_m;
    size_t count;
    struct {
        int asset;
        struct sensor_coverage gaps;
    } * assets; /* those with sensors of the group */
    struct sensor_coverage_answer *next;
};
/* set: whose moves count; NULL: nobody's. far_m: as in sensor_coverage_query. */
void placing_request_coverage(struct placing *placing, const struct place_set *set, int group, double far_m,
                              const struct snapshot *snapshot, uint64_t client, uint32_t seq);
/* What came in: sets take their distances; gaps go to the caller (sensor_coverage_answer_free), oldest first. */
struct sensor_coverage_answer *placing_collect(struct placing *placing);
void sensor_coverage_answer_free(struct sensor_coverage_answer *answer);

#endif
