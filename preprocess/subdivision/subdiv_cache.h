/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache of the errors measured at edges and triangles: KEY.splitting in the folder of prepared files. Where few of many sensors have
   changed since, these findings still hold everywhere except near those sensors, and only there is measured again.

   A sensor that has at most the fraction x of a value changes an edge's error by about x times that error, and so does one that is
   removed. Such fractions add up from run to run (doubt) until the edge is measured again; together they stay far below the tenth of a
   colour step that subdivision keeps in reserve (SUBDIV_AIM). With larger doubt a finding still holds if its error is far from any limit.
   This is so for Shepard interpolation with one strength for all sensors of a group. Under Algorithm 1 every sensor counts everywhere, and
   a reach bends the weights where it ends: an asset with such a group is not cached.

   Coarser levels that were given up are not tried again before as many sensors have changed as findings may outlive at once. Safe to
   delete; a damaged file counts as absent. Thread: one, except where a function says otherwise. */
#ifndef PREPROCESS_SUBDIVISION_SUBDIV_CACHE_H
#define PREPROCESS_SUBDIVISION_SUBDIV_CACHE_H
#include "base/files/cache_file.h"
#include "base/text/text.h"
#include "preprocess/subdivision/linear_error.h"

struct subdiv_cache {
    bool applies; /* else nothing is kept */
    struct cache_file file;
    const uint64_t *keys; /* of the findings of the last time, in the file */
    const float *errors, *rest;
    const unsigned char *kinds;
    uint32_t *rest_at; /* of each finding */
    uint32_t *slots;   /* findings by key, one more than their number; 0: none. NULL: none of use */
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

/* Opens the findings of the last run under this key and works out which sensors have changed since. Never fails: without a usable file the
   cache is empty. linear must outlive it. */
void subdiv_cache_open(struct subdiv_cache *cache, const char *folder, uint64_t key, const struct linear_error *linear);
/* Unmaps and frees the cache. A zeroed one is fine. */
void subdiv_cache_close(struct subdiv_cache *cache);
/* Writes this run's findings, after subdivision. Errors are ignored: then nothing is cached. */
void subdiv_cache_write(const struct subdiv_cache *cache, const char *folder, uint64_t key);

#endif
