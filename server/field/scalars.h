/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The field of one asset: one scalar and its flags per vertex, as the renderer uploads it. */
#ifndef FIELD_SCALARS_H
#define FIELD_SCALARS_H
#include <stddef.h>
#include <stdint.h>

struct scalar {
    float value;       /* engineering units; may pass MIN and MAX. Finite even where there is no data, so that it can be interpolated */
    uint8_t lacking;   /* beyond the rim of the data, by distance: above 127 there is none; so the rim runs true between vertices */
    uint8_t uncertain; /* above 127: at least half of the weight is on Uncertain sensors (or filled by neighbours); by how much of it, as
                          its rim too shall run true between vertices. 255 also where triangles err (struct scalars' drawn_error) */
    uint8_t no_limits; /* 255: for operators; the nearest sensor is good, but its tag has no limits. Then there is data, but no value */
    uint8_t no_data;   /* 255: no good sensor reaches, or the nearest configured one is Bad; else 0. What `lacking` says */
};

struct scalars {
    int asset;
    uint64_t version;       /* grows with every real change; one count for the whole field, so that equal versions are equal contents */
    uint64_t flags_version; /* version of the last change of a flag */
    double travel;          /* grows by the largest change of a value at each version: what was uploaded at t errs by at most travel - t */
    size_t count;           /* = vertex_count of the asset file */
    size_t ready;           /* so many of the first vertices are up to date: what the levels asked for need */
    uint64_t grown;         /* counts how often more became ready than was before */
    const struct scalar *at;
    double drawn_error;    /* bound on how far triangles may show another value than the field has, in the unit of values, where a
                              large part of the surface errs by more than 1/255 of the range; else 0. Vertices that err are
                              marked uncertain in either case */
    int64_t oldest_age_ns; /* of the readings that take part; INT64_MAX: none does */
};

#endif
