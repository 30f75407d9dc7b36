/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The field of one asset: a scalar and its flags per vertex, in the memory layout that the renderer uploads. */
#ifndef FIELD_SCALARS_H
#define FIELD_SCALARS_H
#include <stddef.h>
#include <stdint.h>

struct scalar {
    /* value of the field in engineering units, possibly outside MIN..MAX. Finite even where there is no data, so that it can be
       interpolated */
    float value;
    /* distance beyond the border between data and no data, encoded by weights_lacking_at(). Above 127: no data. A distance
       rather than a flag makes the border exact when interpolated between vertices */
    uint8_t lacking;
    /* uncertainty of the value: proportional to the share of Uncertain sensors in the sum of its weights. Above 127: these
       sensors have at least half of the weights, or the value was filled in from neighbours; the value is a number rather than
       a flag, so that a border interpolated between vertices is exact. 255 also marks triangles whose interpolation deviates
       from the field (struct scalars: drawn_error) */
    uint8_t uncertain;
    /* 255: only in the operator's view: the nearest sensor is good but its tag has no alarm limits, so there is data but no
       position between limits */
    uint8_t no_limits;
    /* 255: no data, because no good sensor reaches the vertex or the nearest configured one is Bad; 0: data. Derived from
       `lacking` */
    uint8_t no_data;
};

struct scalars {
    int asset;
    /* version of these scalars, counted over all assets of the field; grows with every real change, so equal versions mean
       equal contents */
    uint64_t version;
    uint64_t flags_version; /* version in which a flag of any vertex (such as no data or uncertain) last changed */
    /* sum of the largest value changes of all versions so far: a copy of the scalars made when `travel` was t is wrong by at
       most travel - t */
    double travel;
    size_t count;   /* number of elements of `at`: one per vertex of the asset file */
    size_t ready;   /* number of vertices, from the first on, that are up to date: as many as the requested levels of detail need */
    /* number of times that `ready` (the number of up-to-date vertices) has grown; a change tells callers to copy the added
       vertices */
    uint64_t grown;
    const struct scalar *at;
    /* bound on the error of interpolation within triangles, in the unit of values, if it exceeds 1/255 of the range on a large
       part of the surface; else 0. Vertices with such errors are marked uncertain in either case */
    double drawn_error;
    int64_t oldest_age_ns; /* age of the oldest reading that contributes to a value; INT64_MAX: none contributes */
};

#endif
