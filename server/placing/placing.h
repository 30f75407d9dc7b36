/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensors that users move on the model, before the new places are saved. Each user has a set of moved sensors. The set becomes
   a trial (a changed sensor layout, field/trials.h) with straight-line distances, and later a second trial with geodesic
   distances. Call only in the event loop, except functions that workers call. */
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
    const char *folder;        /* folder of the prepared files; read only by placing_create() */
    void (*notify)(void *arg); /* called, on any thread, when newly computed distances or coverage answers wait for placing_collect() */
    void *notify_arg;
};
struct placing;
/* Creates the service for moved sensors. Everything that `params` points to, except `folder`, must outlive the service. Never
   returns NULL. The caller destroys it. */
struct placing *placing_create(const struct placing_params *params);
/* Waits for pending work and frees everything. All sets of moved sensors must have been destroyed. Accepts a pointer to NULL;
   sets *placing to NULL. */
void placing_destroy(struct placing **placing);
/* Returns the registry in which views find trials (sets of moved sensors). Owned by `placing`. */
struct trials *placing_trials(struct placing *placing);

enum { PLACING_MOVES = TRIAL_SENSORS };
struct place_move {
    int tag, asset;       /* tag: index of the tag whose sensor moves; asset: index of the asset on which it is placed */
    double position_m[3]; /* requested position of the sensor in metres, in plant coordinates */
};
enum placed_state {
    PLACED_WAITING, /* geodesic distances are still being computed; straight-line distances are used meanwhile */
    PLACED_READY,
    PLACED_STRAIGHT /* geodesic distances cannot be computed (the reason is logged); straight-line distances are used */
};
/* A moved sensor, with its place on the surface and the state of its distances. */
struct placed {
    struct place_move move;
    double surface_m[3]; /* nearest point on the asset's surface, in plant coordinates */
    /* metres from surface_m to the requested position; the page warns the user if distance_m is above limit_m */
    double distance_m, limit_m;
    enum placed_state state;
};

struct place_set; /* set of the sensors that one user moves to try out other positions, with these positions; nothing is saved */
/* Creates a set without moved sensors. The caller destroys it. */
struct place_set *place_set_create(struct placing *placing);
/* Cancels the pending requests of the set and frees it. Accepts a pointer to NULL; sets *set to NULL. */
void place_set_destroy(struct place_set **set);
/* Replaces the moved sensors of the set: at most PLACING_MOVES, each tag once. Sensors that did not move keep their distances.
   Returns false, changing nothing, if a tag cannot be placed: it has no group, or the position is farther from the asset than
   the asset's size. `why` names the tag. */
bool place_set_moves(struct place_set *set, const struct place_move *moves, size_t count, struct refusal *why);
/* Returns the id of the set's trial (field/trials.h), or 0 if the set has no moved sensors. Views with this id show the field
   of the moved sensors. Each change of the set gives it another id. */
uint32_t place_set_trial(const struct place_set *set);
/* *out receives the moved sensors of the set with their results, valid until the set changes. Returns their number. */
size_t place_set_get(const struct place_set *set, const struct placed **out);
/* Returns true if geodesic distances of the set's sensors arrived since the last call. The set's trial (field/trials.h) then
   has a new id, so views show the field computed with these distances. */
bool place_set_changed(struct place_set *set);

/* The answer to placing_request_coverage(). client and seq are those of the request. */
struct sensor_coverage_answer {
    uint64_t client;
    uint32_t seq;
    int group;
    double reach_m;
    size_t count;
    struct {
        int asset;
        struct sensor_coverage coverage;
    } * assets; /* coverage of each asset that has sensors of the requested group */
    struct sensor_coverage_answer *next;
};
/* Computes on a worker thread how well the sensors of a group cover the surfaces of its assets, with the moved sensors of `set`
   (NULL: none). far_m: distance in metres from which a point counts as far from its sensors; 0: chosen for each asset.
   placing_collect() returns the answer. */
void placing_request_coverage(struct placing *placing, const struct place_set *set, int group, double far_m,
                              const struct snapshot *snapshot, uint64_t client, uint32_t seq);
/* Passes newly computed geodesic distances to the sets of moved sensors that requested them. Returns a linked list of finished
   coverage answers, oldest first; the caller frees each with sensor_coverage_answer_free(). */
struct sensor_coverage_answer *placing_collect(struct placing *placing);
/* Frees one coverage answer. */
void sensor_coverage_answer_free(struct sensor_coverage_answer *answer);

#endif
