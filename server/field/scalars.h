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
    /* proportional to the fraction of the weight on Uncertain sensors, so that its border, at 127, is exact after
       interpolation, too. Above 127: they have at least half of the weight, or the value was filled in from neighbours. 255
       also marks triangles whose interpolation deviates from the field (struct scalars: drawn_error) */
    uint8_t uncertain;
    /* 255: in the operator's view, the nearest sensor is good but its tag has no limits, so there is data but no value */
    uint8_t no_limits;
    uint8_t no_data; /* 255: no good sensor reaches the vertex, or the nearest configured one is Bad; else 0. Derived from `lacking` */
};

struct scalars {
    int asset;
    /* version of the content, counted over all assets of the field; grows with every real change, so equal versions mean equal contents */
    uint64_t version;
    uint64_t flags_version; /* version in which a flag of any vertex (such as no data or uncertain) last changed */
    /* sum of the largest value changes of all versions so far: a copy of the scalars made when `travel` was t is wrong by at
       most travel - t */
    double travel;
    size_t count;   /* number of elements of `at`: one per vertex of the asset file */
    size_t ready;   /* the first `ready` vertices are up to date: as many as the requested levels of detail need */
    uint64_t grown; /* number of times that `ready` has grown, so that callers notice new vertices */
    const struct scalar *at;
    /* bound on the error of interpolation within triangles, in the unit of values, if it exceeds 1/255 of the range on a large
       part of the surface; else 0. Vertices with such errors are marked uncertain in either case */
    double drawn_error;
    int64_t oldest_age_ns; /* age of the oldest contributing reading; INT64_MAX: none contributes */
};

#endif
