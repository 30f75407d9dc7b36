/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Manages sensors moved on trial by users, the relocation objects (which compute geodesic distances on an asset), and results
   of worker threads. */
#include "placing/placing.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

#include "base/mem.h"
#include "placing/mover.h"
#include "plant/influence.h"
#include "plant/models/transform.h"
#include "scene/far_sensors.h"
#include "surface/relocation.h"
#include "value/quality.h"

enum { MOVERS = 4 }; /* maximum number of relocation objects in memory; beyond it, objects of assets without moved sensors are freed */

struct distance_ask { /* pending request for the geodesic distances of one moved sensor */
    struct placing *placing;
    uint64_t number;
    float *along_m; /* by vertex: geodesic distance from the sensor in metres; NULL: the distances could not be computed */
    struct distance_ask *next;
};

struct placing_entry { /* data of a moved sensor that only this file uses; set->placed has the data that callers see */
    uint64_t asked;    /* sequence number of the sensor's pending distance request; 0: none is pending */
    uint64_t ticket;
    struct trial_sensor sensor;
};

struct place_set {
    struct placing *placing;
    uint32_t trial;
    bool changed;
    size_t count;
    struct placing_entry entries[PLACING_MOVES];
    struct placed placed[PLACING_MOVES];
    struct place_set *next;
};

struct warm {
    struct relocation *relocation; /* data for computing distances of moved sensors on the asset; NULL: not in memory */
    uint64_t used;
};

struct placing {
    struct placing_params params;
    char *folder;
    struct trials *trials;
    struct warm *warm; /* by asset: the asset's relocation object (computes distances of moved sensors), if in memory */
    struct place_set *sets;
    uint64_t uses, asked;
    pthread_mutex_t lock;
    pthread_cond_t idle;
    /* --- below: under lock */
    struct distance_ask *done;
    struct sensor_coverage_answer *answers, **answers_last;
    /* number of requests for the sensor coverage of an asset (how well sensors cover its surface) that workers are still
       computing */
    int jobs;
};

/* --- creating and destroying ------------------------------------------------------------------------------------------------ */

struct placing *placing_create(const struct placing_params *params)
{
    struct placing *placing = mem_new(sizeof(*placing));
    placing->params = *params;
    placing->folder = mem_strdup(params->folder);
    placing->trials = trials_create();
    placing->warm = mem_array(params->scene->asset_count, sizeof(*placing->warm));
    placing->answers_last = &placing->answers;
    pthread_mutex_init(&placing->lock, NULL);
    pthread_cond_init(&placing->idle, NULL);
    return placing;
}

struct trials *placing_trials(struct placing *placing)
{
    return placing->trials;
}

static void forget_done(struct distance_ask *done)
{
    for (struct distance_ask *next; done; done = next) {
        next = done->next;
        mem_free(done->along_m);
        mem_free(done);
    }
}

void sensor_coverage_answer_free(struct sensor_coverage_answer *answer)
{
    mem_free(answer->assets);
    mem_free(answer);
}

void placing_destroy(struct placing **pointer)
{
    struct placing *placing = *pointer;
    if (!placing)
        return;
    pthread_mutex_lock(&placing->lock);
    while (placing->jobs > 0)
        pthread_cond_wait(&placing->idle, &placing->lock);
    pthread_mutex_unlock(&placing->lock);
    for (size_t i = 0; i < placing->params.scene->asset_count; i++)
        relocation_destroy(&placing->warm[i].relocation);
    forget_done(placing->done);
    for (struct sensor_coverage_answer *answer = placing->answers, *next; answer; answer = next) {
        next = answer->next;
        sensor_coverage_answer_free(answer);
    }
    trials_destroy(&placing->trials);
    pthread_mutex_destroy(&placing->lock);
    pthread_cond_destroy(&placing->idle);
    mem_free(placing->warm);
    mem_free(placing->folder);
    mem_free(placing);
    *pointer = NULL;
}

/* --- movers ------------------------------------------------------------------------------------------------------------------ */

static bool is_moved_on(const struct placing *placing, int asset)
{
    for (const struct place_set *set = placing->sets; set; set = set->next)
        for (size_t i = 0; i < set->count; i++)
            if (set->placed[i].move.asset == asset)
                return true;
    return false;
}

/* Frees the least recently used relocation object of an asset without moved sensors, if more than MOVERS are in memory. Objects
   whose surface is still being built are kept, because freeing one would block. keep: index of an asset whose object is kept. */
static void cool(struct placing *placing, int keep)
{
    int count = 0, oldest = -1;
    for (int i = 0; i < (int)placing->params.scene->asset_count; i++) {
        const struct warm *warm = &placing->warm[i];
        count += warm->relocation != NULL;
        if (warm->relocation && i != keep && relocation_state(warm->relocation) != RELOCATION_WARMING && !is_moved_on(placing, i) &&
            (oldest < 0 || warm->used < placing->warm[oldest].used))
            oldest = i;
    }
    if (count > MOVERS && oldest >= 0)
        relocation_destroy(&placing->warm[oldest].relocation);
}

static struct relocation *relocation_of(struct placing *placing, int asset)
{
    struct warm *warm = &placing->warm[asset];
    if (!warm->relocation) {
        warm->relocation = mover_create(placing->params.log, placing->params.workers, placing->params.scene, placing->folder, asset);
        cool(placing, asset);
    }
    warm->used = ++placing->uses;
    return warm->relocation;
}

/* --- one move ---------------------------------------------------------------------------------------------------------------- */

static void on_distances(void *arg, struct relocation_result *result)
{
    struct distance_ask *ask = arg;
    struct placing *placing = ask->placing;
    if (result->status == RELOCATION_CANCELLED) {
        mem_free(result->geodesic_m);
        mem_free(ask);
        return;
    }
    ask->along_m = result->geodesic_m;
    pthread_mutex_lock(&placing->lock);
    ask->next = placing->done;
    placing->done = ask;
    pthread_mutex_unlock(&placing->lock);
    placing->params.notify(placing->params.notify_arg);
}

static void to_file(const struct scene_asset *asset, const double plant_m[3], double out[3])
{
    double file_from_plant[16];
    /* transform_invert() cannot fail here: plant_load() refuses assets whose placement has no inverse */
    if (!transform_invert(asset->placement, file_from_plant))
        memcpy(file_from_plant, transform_identity, sizeof(file_from_plant));
    transform_point(file_from_plant, plant_m, out);
}

/* Finds the point of the asset's surface that is nearest to a moved sensor. Returns false if the sensor is too far from the asset. */
static bool find_place(struct placing *placing, const struct place_move *move, struct placing_entry *entry, struct placed *placed)
{
    const struct scene_asset *asset = &placing->params.scene->assets[move->asset];
    struct relocation_place place;
    double at_m[3];
    to_file(asset, move->position_m, at_m);
    if (!relocation_place(relocation_of(placing, move->asset), at_m, &place, NULL))
        return false;
    *placed = (struct placed){ .move = *move, .distance_m = place.distance_m, .limit_m = far_limit_m(asset) };
    transform_point(asset->placement, place.surface_m, placed->surface_m);
    *entry = (struct placing_entry){ .sensor = { .tag = move->tag, .asset = move->asset, .vertex = place.vertex } };
    memcpy(entry->sensor.place_m, placed->surface_m, sizeof(placed->surface_m));
    for (int c = 0; c < 3; c++)
        entry->sensor.surface_m[c] = (float)place.surface_m[c];
    return true;
}

static void ask_distances(struct placing *placing, struct placing_entry *entry, struct placed *placed)
{
    struct distance_ask *ask = mem_new(sizeof(*ask));
    double at_m[3];
    to_file(&placing->params.scene->assets[placed->move.asset], placed->move.position_m, at_m);
    *ask = (struct distance_ask){ .placing = placing, .number = ++placing->asked };
    entry->asked = ask->number;
    entry->ticket = relocation_request(relocation_of(placing, placed->move.asset), at_m, on_distances, ask);
    if (entry->ticket == 0) {
        entry->asked = 0;
        placed->state = PLACED_STRAIGHT;
        mem_free(ask);
    }
}

static void let_go(struct placing *placing, struct placing_entry *entry, const struct placed *placed)
{
    if (entry->asked)
        relocation_cancel(placing->warm[placed->move.asset].relocation, entry->ticket);
    entry->asked = 0;
    trial_reach_unref(&entry->sensor.reach);
}

/* --- sets of moves --------------------------------------------------------------------------------------------------------- */

struct place_set *place_set_create(struct placing *placing)
{
    struct place_set *set = mem_new(sizeof(*set));
    *set = (struct place_set){ .placing = placing, .next = placing->sets };
    placing->sets = set;
    return set;
}

static void put_trial(struct place_set *set)
{
    struct trial_sensor sensors[PLACING_MOVES];
    trials_drop(set->placing->trials, set->trial);
    for (size_t i = 0; i < set->count; i++)
        sensors[i] = set->entries[i].sensor;
    set->trial = set->count ? trials_put(set->placing->trials, sensors, set->count) : 0;
}

void place_set_destroy(struct place_set **pointer)
{
    struct place_set *set = *pointer;
    if (!set)
        return;
    struct place_set **at = &set->placing->sets;
    while (*at != set)
        at = &(*at)->next;
    *at = set->next;
    for (size_t i = 0; i < set->count; i++)
        let_go(set->placing, &set->entries[i], &set->placed[i]);
    trials_drop(set->placing->trials, set->trial);
    mem_free(set);
    *pointer = NULL;
}

/* Returns the index of the moved sensor in the set that has the same tag and position as `move`; -1: none. */
static int find_same(const struct place_set *set, const struct place_move *move)
{
    for (size_t i = 0; i < set->count; i++) {
        const struct place_move *other = &set->placed[i].move;
        if (other->tag == move->tag && other->asset == move->asset &&
            memcmp(other->position_m, move->position_m, sizeof(move->position_m)) == 0)
            return (int)i;
    }
    return -1;
}

static bool check(const struct placing *placing, const struct place_move *moves, size_t i, struct refusal *why)
{
    const struct plant *plant = placing->params.scene->plant;
    const struct plant_tag *tag = &plant->tags[moves[i].tag];
    why->code = REFUSAL_NONE;
    if (tag->group < 0)
        refusal_set(why, REFUSAL_GROUPLESS, "tag=%s", tag->name);
    for (size_t j = 0; j < i; j++)
        if (moves[j].tag == moves[i].tag)
            refusal_set(why, REFUSAL_TWICE, "tag=%s", tag->name);
    return why->code == REFUSAL_NONE;
}

bool place_set_moves(struct place_set *set, const struct place_move *moves, size_t count, struct refusal *why)
{
    struct placing *placing = set->placing;
    struct placing_entry entries[PLACING_MOVES] = { 0 };
    struct placed placed[PLACING_MOVES] = { 0 };
    int same[PLACING_MOVES];
    bool kept[PLACING_MOVES] = { 0 };
    for (size_t i = 0; i < count; i++) {
        same[i] = find_same(set, &moves[i]);
        if (!check(placing, moves, i, why))
            return false;
        if (same[i] < 0 && !find_place(placing, &moves[i], &entries[i], &placed[i])) {
            refusal_set(why, REFUSAL_FAR, "tag=%s\nasset=%s", placing->params.scene->plant->tags[moves[i].tag].name,
                        placing->params.scene->assets[moves[i].asset].plant->id);
            return false;
        }
    }
    for (size_t i = 0; i < count; i++)
        if (same[i] >= 0) {
            kept[same[i]] = true;
            entries[i] = set->entries[same[i]];
            placed[i] = set->placed[same[i]];
        } else {
            ask_distances(placing, &entries[i], &placed[i]);
        }
    for (size_t i = 0; i < set->count; i++)
        if (!kept[i])
            let_go(placing, &set->entries[i], &set->placed[i]);
    memcpy(set->entries, entries, sizeof(entries));
    memcpy(set->placed, placed, sizeof(placed));
    set->count = count;
    put_trial(set);
    return true;
}

uint32_t place_set_trial(const struct place_set *set)
{
    return set->trial;
}

size_t place_set_get(const struct place_set *set, const struct placed **out)
{
    *out = set->placed;
    return set->count;
}

bool place_set_changed(struct place_set *set)
{
    bool changed = set->changed;
    set->changed = false;
    return changed;
}

/* --- results that workers have computed ---------------------------------------------------------------------------------------- */

static void take(struct placing *placing, struct distance_ask *ask)
{
    for (struct place_set *set = placing->sets; set; set = set->next)
        for (size_t i = 0; i < set->count; i++) {
            struct placing_entry *entry = &set->entries[i];
            if (entry->asked != ask->number)
                continue;
            entry->asked = 0;
            entry->sensor.reach = ask->along_m ? trial_reach_create(ask->along_m) : NULL;
            set->placed[i].state = ask->along_m ? PLACED_READY : PLACED_STRAIGHT;
            ask->along_m = NULL;
            set->changed = true;
            put_trial(set);
            return;
        }
}

struct sensor_coverage_answer *placing_collect(struct placing *placing)
{
    pthread_mutex_lock(&placing->lock);
    struct distance_ask *done = placing->done;
    struct sensor_coverage_answer *answers = placing->answers;
    placing->done = NULL;
    placing->answers = NULL;
    placing->answers_last = &placing->answers;
    pthread_mutex_unlock(&placing->lock);
    for (struct distance_ask *ask = done; ask; ask = ask->next)
        take(placing, ask);
    forget_done(done);
    return answers;
}

/* --- coverage ----------------------------------------------------------------------------------------------------------------- */

struct sensor_coverage_job {
    struct placing *placing;
    struct sensor_coverage_query order;
    uint8_t *good;
    struct sensor_coverage_answer *answer;
};

static void find_gaps(void *arg)
{
    struct sensor_coverage_job *job = arg;
    struct placing *placing = job->placing;
    struct sensor_coverage_answer *answer = job->answer;
    const struct scene *scene = placing->params.scene;
    answer->assets = mem_array(scene->asset_count, sizeof(*answer->assets));
    for (size_t a = 0; a < scene->asset_count; a++) {
        job->order.asset = answer->assets[answer->count].asset = (int)a;
        answer->count += sensor_coverage_find(&job->order, &answer->assets[answer->count].coverage);
    }
    trials_give(placing->trials, &job->order.trial);
    mem_free(job->good);
    mem_free(job);
    pthread_mutex_lock(&placing->lock);
    *placing->answers_last = answer;
    placing->answers_last = &answer->next;
    pthread_mutex_unlock(&placing->lock);
    placing->params.notify(placing->params.notify_arg);
    pthread_mutex_lock(&placing->lock);
    placing->jobs--;
    pthread_cond_broadcast(&placing->idle);
    pthread_mutex_unlock(&placing->lock);
}

void placing_request_coverage(struct placing *placing, const struct place_set *set, int group, double far_m,
                              const struct snapshot *snapshot, uint64_t client, uint32_t seq)
{
    const struct scene *scene = placing->params.scene;
    const struct plant_group *of = &scene->plant->groups[group];
    struct sensor_coverage_job *job = mem_new(sizeof(*job));
    *job = (struct sensor_coverage_job){ .placing = placing,
                                         .order = { .scene = scene,
                                                    .group = group,
                                                    .mode = interpolation_distance(of->interpolation, of->distance),
                                                    .reach_m = of->reach_m,
                                                    .far_m = far_m },
                                         .good = mem_array(scene->plant->tag_count, 1),
                                         .answer = mem_new(sizeof(*job->answer)) };
    for (size_t i = 0; i < scene->plant->tag_count; i++)
        job->good[i] = !quality_is_bad(snapshot->readings[i].quality);
    job->order.good = job->good;
    job->order.trial = set && set->trial ? trials_take(placing->trials, set->trial) : NULL;
    *job->answer = (struct sensor_coverage_answer){ .client = client, .seq = seq, .group = group, .reach_m = of->reach_m };
    pthread_mutex_lock(&placing->lock);
    placing->jobs++;
    pthread_mutex_unlock(&placing->lock);
    workers_submit(placing->params.workers, find_gaps, job);
}
