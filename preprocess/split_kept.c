/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Findings by the places of the corners that they are about, and whether they still hold. */
#include "preprocess/split_kept.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "base/atomic_file.h"
#include "base/mem.h"
#include "preprocess/folder.h"
#include "preprocess/split_impl.h"

#define MAGIC "PLCSPLIT"
#define MOST_CHANGES 16 /* sensors */
#define FEW 16          /* changes must be fewer than one in so many sensors */
#define MOST_DOUBT 0.05f /* then, of edges that err by about a step, one in a thousand errs by a tenth of a step more or less: measured */
#define MOST_SETTLED 0.5f /* doubt, where the error is so far from what matters that it cannot have come there */
#define LITTLE 0.4f       /* of the error that matters: what errs by less at its middle was not looked at elsewhere */

struct split_kept_finding {
    uint64_t key;
    float error, share, barred, doubt, off;
    uint32_t jumps;
};

struct sensor { /* all that its shares depend on */
    float place_m[3], strength, power;
    uint32_t group;
};

struct head {
    uint64_t sensors, findings;      /* how many follow */
    uint64_t given_up, changes_since; /* split_kept.h */
};

/* --- sensors ---------------------------------------------------------------------------------------------------------------------- */

static bool is_local(const struct straight_group *group)
{
    for (size_t i = 0; i < group->count; i++)
        if (!(group->of.strength[i] > 0) || group->of.strength[i] != group->of.strength[0])
            return false;
    return !group->papers && !(group->of.reach_m < INFINITY);
}

static int compare_sensors(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct sensor));
}

static void list_sensors(const struct straight *straight, struct text *list)
{
    for (uint32_t g = 0; g < straight->group_count; g++) {
        const struct straight_group *group = &straight->groups[g];
        for (size_t i = 0; i < group->count; i++) {
            struct sensor sensor = { .strength = group->of.strength[i], .power = group->of.power, .group = g };
            for (int axis = 0; axis < 3; axis++)
                sensor.place_m[axis] = straight->axes_m[axis][group->columns[i]];
            text_add_bytes(list, &sensor, sizeof(sensor));
        }
    }
    qsort(list->at, list->length / sizeof(struct sensor), sizeof(struct sensor), compare_sensors);
}

static uint32_t column_of(const struct straight *straight, const struct sensor *sensor)
{
    const struct straight_group *group = &straight->groups[sensor->group];
    for (size_t i = 0; i < group->count; i++) {
        const float place_m[3] = { straight->axes_m[0][group->columns[i]], straight->axes_m[1][group->columns[i]],
                                   straight->axes_m[2][group->columns[i]] };
        if (memcmp(place_m, sensor->place_m, sizeof(place_m)) == 0)
            return group->columns[i];
    }
    return UINT32_MAX;
}

/* Those that only one of two sorted lists has. False: too many, or of a group that is no more. */
static bool find_changes(struct split_kept *kept, const struct straight *straight, const struct sensor *old, size_t old_count)
{
    const struct sensor *now = (const struct sensor *)(const void *)kept->sensors.at;
    size_t count = kept->sensors.length / sizeof(*now), i = 0, j = 0;
    kept->changes = mem_array(MOST_CHANGES, sizeof(*kept->changes));
    while (i < old_count || j < count) {
        int order = i == old_count ? 1 : j == count ? -1 : compare_sensors(&old[i], &now[j]);
        const struct sensor *changed = order < 0 ? &old[i] : &now[j];
        i += order <= 0;
        j += order >= 0;
        if (order == 0)
            continue;
        if (kept->change_count == MOST_CHANGES || FEW * kept->change_count >= count || changed->group >= straight->group_count)
            return false;
        struct split_change *change = &kept->changes[kept->change_count++];
        *change = (struct split_change){ .power = changed->power, .group = changed->group, .column = UINT32_MAX };
        memcpy(change->place_m, changed->place_m, sizeof(change->place_m));
        if (order > 0)
            change->column = column_of(straight, changed);
    }
    return true;
}

/* --- the file --------------------------------------------------------------------------------------------------------------------- */

static void index_findings(struct split_kept *kept, size_t count)
{
    kept->finding_count = count;
    kept->mask = 15;
    while (kept->mask < 2 * count)
        kept->mask = kept->mask * 2 + 1;
    kept->slots = mem_array(kept->mask + 1, sizeof(*kept->slots));
    for (uint32_t i = 0; i < count; i++) {
        size_t slot = kept->findings[i].key & kept->mask;
        while (kept->slots[slot])
            slot = (slot + 1) & kept->mask;
        kept->slots[slot] = i + 1;
    }
}

static void read_file(struct split_kept *kept, const struct straight *straight)
{
    struct head head = { 0 };
    if (kept->file.count < sizeof(head))
        return;
    memcpy(&head, kept->file.bytes, sizeof(head));
    size_t left = kept->file.count - sizeof(head);
    if (head.sensors > left / sizeof(struct sensor) || head.findings > UINT32_MAX / 2 ||
        left != head.sensors * sizeof(struct sensor) + head.findings * sizeof(struct split_kept_finding))
        return;
    const char *sensors = kept->file.bytes + sizeof(head), *findings = sensors + head.sensors * sizeof(struct sensor);
    if (!find_changes(kept, straight, (const struct sensor *)(const void *)sensors, head.sensors))
        return;
    kept->findings = (const struct split_kept_finding *)(const void *)findings;
    index_findings(kept, head.findings);
    if (FEW * (head.changes_since + kept->change_count) < kept->sensors.length / sizeof(struct sensor)) {
        kept->hopeless = head.given_up;
        kept->changes_since = head.changes_since + kept->change_count;
    }
}

void split_kept_open(struct split_kept *kept, const char *folder, uint64_t key, const struct straight *straight)
{
    char *path = folder_path(folder, key, FOLDER_SPLITTING);
    *kept = (struct split_kept){ .applies = true };
    for (size_t g = 0; g < straight->group_count; g++)
        kept->applies &= is_local(&straight->groups[g]);
    if (kept->applies)
        list_sensors(straight, &kept->sensors);
    if (kept->applies && kept_open(&kept->file, path, MAGIC, key))
        read_file(kept, straight);
    mem_free(path);
}

void split_kept_close(struct split_kept *kept)
{
    kept_close(&kept->file);
    mem_free(kept->slots);
    mem_free(kept->changes);
    text_finish(&kept->sensors);
    text_finish(&kept->found);
    *kept = (struct split_kept){ 0 };
}

void split_kept_write(const struct split_kept *kept, const char *folder, uint64_t key)
{
    const struct head head = { kept->sensors.length / sizeof(struct sensor), kept->found.length / sizeof(struct split_kept_finding),
                               kept->given_up, kept->changes_since };
    const struct atomic_file_part parts[] = { { &head, sizeof(head) },
                                       { kept->sensors.at, kept->sensors.length },
                                       { kept->found.at, kept->found.length } };
    if (!kept->applies)
        return;
    char *path = folder_path(folder, key, FOLDER_SPLITTING);
    kept_write_parts(path, MAGIC, key, parts, sizeof(parts) / sizeof(*parts));
    mem_free(path);
}

/* --- findings --------------------------------------------------------------------------------------------------------------------- */

/* The same for every order of the corners. */
static uint64_t key_of(const struct split *split, const uint32_t *corners, size_t count)
{
    float places_m[3][3];
    for (size_t c = 0; c < count; c++) {
        const float *place_m = split_position(split, corners[c]);
        size_t at = c;
        for (; at > 0 && memcmp(places_m[at - 1], place_m, sizeof(*places_m)) > 0; at--)
            memcpy(places_m[at], places_m[at - 1], sizeof(*places_m));
        memcpy(places_m[at], place_m, sizeof(*places_m));
    }
    return XXH3_64bits_withSeed(places_m, count * sizeof(*places_m), split->level);
}

/* How far from straight the share of a new sensor is between these corners, at most: since it bends, and since its distance along the
   surface may have a kink there, where two ways round are equally long; on an edge, where it does not grow as fast as it can. */
static float bend_of(const struct split *split, const struct split_change *change, const uint32_t *corners, size_t count, double wide_m,
                     double near_m, double far_m, double share)
{
    const double p = (double)change->power, near = wide_m / fmax(near_m, 1e-9), far = wide_m / far_m;
    double low_m = INFINITY, high_m = 0;
    for (size_t c = 0; c < count; c++) {
        double m = (double)split->geodesic_m[split->mesh.places.of_vertex[corners[c]] * split->sensors + change->column];
        low_m = fmin(low_m, m);
        high_m = fmax(high_m, m);
    }
    double kink_m = high_m < INFINITY ? wide_m - (count == 2 ? (high_m - low_m) / 2 : 0) : 0, round_m = fmax(low_m - wide_m, far_m);
    double kink = pow(fmin(1, (near_m + wide_m) / round_m), p) * p * fmax(kink_m, 0) / round_m;
    return (float)(share * (p * (p - 1) / 2 * near * near + p * p * near * far + p * (p + 1) / 2 * far * far) + kink);
}

/* The most that the sensors that are new or gone have, together, of a value between these corners. A distance along the surface is no
   shorter than the straight one. */
static float share_of_changes(const struct split *split, const uint32_t *corners, size_t count, float *off)
{
    const struct split_kept *kept = split->in->kept;
    float middle[3] = { 0 }, share = 0;
    double wide_m = 0;
    *off = 0;
    for (size_t c = 0; c < count; c++)
        for (int axis = 0; axis < 3; axis++)
            middle[axis] += split_position(split, corners[c])[axis] / (float)count;
    for (size_t c = 0; c < count; c++)
        wide_m = fmax(wide_m, split_length(middle, split_position(split, corners[c])));
    for (size_t i = 0; i < kept->change_count; i++) {
        const struct split_change *change = &kept->changes[i];
        double near_m = 0, far_m = fmax(1e-9, split_length(middle, change->place_m) - wide_m - split->on_surface_m);
        for (size_t c = 0; c < count; c++) {
            uint32_t place = split->mesh.places.of_vertex[corners[c]];
            near_m = fmax(near_m, (double)split->norms[place * split->norm_count + change->group].near_m);
        }
        double ratio = (near_m + wide_m) / far_m;
        float own = ratio < 1 ? powf((float)ratio, change->power) : 1;
        share += own;
        if (change->column != UINT32_MAX && own < MOST_SETTLED)
            *off += bend_of(split, change, corners, count, wide_m, near_m, far_m, (double)own);
    }
    return share;
}

/* So far from the error that matters that it is sure to stay on its side. */
static bool is_settled(const struct split_kept_finding *old, float doubt, float off)
{
    const float matters = (float)SPLIT_AIM, error = fmaxf(old->error, old->barred);
    float most = error / (1 - doubt) + off, least = error * (1 - 2 * doubt) - off;
    return doubt <= MOST_SETTLED && (most <= LITTLE * matters || (error > LITTLE * matters && most <= matters) || least > matters);
}

/* Most come in the order that they had the last time. */
static const struct split_kept_finding *find(const struct split_kept *kept, uint64_t key, uint32_t *next)
{
    if (*next >= kept->finding_count || kept->findings[*next].key != key) {
        size_t slot = key & kept->mask;
        while (kept->slots[slot] && kept->findings[kept->slots[slot] - 1].key != key)
            slot = (slot + 1) & kept->mask;
        if (!kept->slots[slot])
            return NULL;
        *next = kept->slots[slot] - 1;
    }
    return &kept->findings[(*next)++];
}

bool split_recall(const struct split *split, const uint32_t *corners, size_t count, uint32_t *next, struct split_finding *finding)
{
    const struct split_kept *kept = split->in->kept;
    const struct split_kept_finding *old = kept && kept->findings ? find(kept, key_of(split, corners, count), next) : NULL;
    if (!old)
        return false;
    float off, doubt = old->doubt + share_of_changes(split, corners, count, &off);
    off += old->off;
    if (!(doubt <= MOST_DOUBT) && !is_settled(old, doubt, off))
        return false;
    *finding = (struct split_finding){ .number = finding->number,
                                       .error = old->error,
                                       .share = old->share,
                                       .barred = old->barred,
                                       .jumps = old->jumps != 0,
                                       .kept = true,
                                       .doubt = doubt,
                                       .off = off };
    return true;
}

void split_remember(struct split *split, const uint32_t *corners, size_t count, const struct split_finding *finding)
{
    struct split_kept *kept = split->in->kept;
    if (!kept)
        return;
    kept->measured_count += !finding->kept;
    kept->kept_count += finding->kept;
    if (!kept->applies)
        return;
    const struct split_kept_finding found = { .key = key_of(split, corners, count),
                                              .error = finding->error,
                                              .share = finding->share,
                                              .barred = finding->barred,
                                              .doubt = finding->doubt,
                                              .off = finding->off,
                                              .jumps = finding->jumps };
    text_add_bytes(&kept->found, &found, sizeof(found));
}
