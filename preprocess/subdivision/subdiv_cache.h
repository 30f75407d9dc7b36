/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What splitting found out about edges and triangles, for the next time: KEY.splitting beside the asset files. Where few of many sensors
   have changed, it still holds everywhere but near these, and only there is measured anew.

   A sensor that has at most the share x of a value changes what the field errs along an edge by about x times as much as it errs, and so
   does one that is gone. Such shares add up from one time to the next (doubt) until an edge is measured again; what they may be together
   is far below the tenth of a step of colour by which the splitting keeps within SUBDIV_ERROR. Where doubts are larger, a finding still
   holds if it is so far from what matters that no such change brings it there. That is so for shepard with one strength for
   all sensors of a group. In paper every sensor has a share everywhere, and with a reach shares bend where it ends: nothing is kept for an
   asset with a group that is looked at in paper, or that has a reach.
   Coarser levels that were given up are not tried again before as many sensors have changed as findings may outlive at once.
   Safe to delete; one that is no good counts as none. */
#ifndef PREPROCESS_SUBDIVISION_SUBDIV_CACHE_H
#define PREPROCESS_SUBDIVISION_SUBDIV_CACHE_H
#include "base/cache_file.h"
#include "base/text.h"
#include "preprocess/subdivision/linear_error.h"

struct subdiv_cache {
    bool applies; /* else nothing is kept */
    struct cache_file file;
    const struct subdiv_cache_entry *findings; /* of the last time, in the file; NULL: none of use */
    uint32_t *slots;                           /* findings by key, one more than their number; 0: none */
    size_t mask, finding_count;
    struct subdiv_sensor_change { /* a sensor that is new or gone */
        float place_m[3], power;
        uint32_t group;  /* of straight's */
        uint32_t column; /* of a new one; UINT32_MAX: it is gone */
    } * changes;
    size_t change_count;
    uint64_t hopeless, given_up; /* levels by bits: those that need not be tried; those given up this time */
    uint64_t changes_since;      /* they were tried */
    struct text sensors, found;  /* of this time */
    size_t measured_count, kept_count;
};

/* Never fails. straight must outlive it. */
void subdiv_cache_open(struct subdiv_cache *cache, const char *folder, uint64_t key, const struct linear_error *linear);
void subdiv_cache_close(struct subdiv_cache *cache); /* a zeroed one is fine */
/* After splitting. What cannot be written is not kept. */
void subdiv_cache_write(const struct subdiv_cache *cache, const char *folder, uint64_t key);

#endif
