/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache of the errors measured at edges and triangles ("findings"): KEY.splitting in the folder of prepared files. If few of
 * many sensors have changed since the last run, its findings still hold except near those sensors, and errors are measured
 * again only there. A new or removed sensor with at most the weight x at an edge changes the edge's error by about x times the
 * error. Such changes add up from run to run ("doubt") until the edge is measured again. A finding holds as long as its doubt
 * is far below the tenth of a colour step that subdivision keeps in reserve (SUBDIV_AIM). With larger doubt, it holds only if
 * its error is much smaller or larger than the error from which on an edge is split. This is valid for Shepard interpolation
 * if all sensors of a group have the same strength. Assets with a group that uses Algorithm 1 or a reach are not cached: under
 * Algorithm 1 every sensor matters everywhere, and a reach bends the weights at its end. Coarser levels that were dropped are
 * tried again once so many sensors have changed that findings would no longer be used. The file can be deleted at any time; a
 * damaged file counts as absent. Call from one thread only, unless a function says otherwise. */
#ifndef PREPROCESS_SUBDIVISION_SUBDIV_CACHE_H
#define PREPROCESS_SUBDIVISION_SUBDIV_CACHE_H
#include "base/files/cache_file.h"
#include "base/text/text.h"
#include "preprocess/subdivision/linear_error.h"

struct subdiv_cache {
    bool applies; /* true: the cache is usable for this asset; false: nothing is read or written */
    struct cache_file file;
    const uint64_t *keys; /* cache keys of the last run's findings (measured errors), in the opened file */
    const float *errors;
    const uint16_t *rest; /* optional numbers of findings */
    const unsigned char *kinds;
    uint32_t *rest_at; /* by finding (measured error): index in `rest` of its optional numbers */
    /* hash table by key: index of the finding (measured error) + 1; 0: empty slot. NULL: the cache has no usable findings */
    uint32_t *slots;
    size_t mask, finding_count;
    struct subdiv_sensor_change { /* a sensor that was added or removed */
        float place_m[3], power;
        uint32_t group;  /* the sensor's group, as an index in struct linear_error */
        uint32_t column; /* index of the added sensor on the asset; UINT32_MAX: the sensor was removed */
    } * changes;
    size_t change_count;
    /* bit masks of levels of detail. hopeless: skipped in this run because an earlier run dropped them; given_up: dropped in this run */
    uint64_t hopeless, given_up;
    uint64_t changes_since;     /* number of sensors added or removed since the dropped levels were last tried */
    struct text sensors, found; /* this run's sensors and findings (measured errors) in the file's binary format */
    size_t measured_count, kept_count;
};

/* Opens the last run's findings (measured errors) under this key, and determines which sensors have changed since. Never fails:
 * without a usable file, the cache is empty. linear must outlive the cache. */
void subdiv_cache_open(struct subdiv_cache *cache, struct log *log, const char *folder, uint64_t key, const struct linear_error *linear);
/* Closes the cache file and frees the arrays. A zeroed cache is allowed. */
void subdiv_cache_close(struct subdiv_cache *cache);
/* Writes this run's findings (measured errors) to the file after subdivision. Ignores write errors: the next run then measures
 * everything again. */
void subdiv_cache_write(const struct subdiv_cache *cache, const char *folder, uint64_t key);

#endif
