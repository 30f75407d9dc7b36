/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Selects the sensors whose assumed places (proposed by `plantcast match`) an engineer accepts in one operation. TAGS.md,
   "Assumed places", describes assumed places. Call only in the event loop. */
#ifndef PLACING_ASSUMED_PLACES_H
#define PLACING_ASSUMED_PLACES_H
#include <stddef.h>
#include <stdint.h>

#include "base/refusal.h"
#include "scene/scene.h"

struct assumed_filter {
    /* Indices in the plant of an asset and of a group of sensors: only their sensors are selected. -1: sensors of any asset, or
       of any group. */
    int asset, group;
    /* glob for the tag's name; a text without * or ? is searched for in the tag's name and description; case-insensitive; empty: any tag */
    char pattern[101];
    double within_m; /* largest distance in metres of the assumed place from the asset's surface; negative: any distance */
    /* smallest confidence (0..1) of the match between tag and asset, from matches.csv next to the tag list; negative: any */
    double confidence;
};

enum assumed_outcome {
    /* not selected by the filter: the tag's place is not an assumed one, or its asset, group or name does not match */
    ASSUMED_NOT_MEANT,
    ASSUMED_ACCEPTED,
    ASSUMED_NOWHERE, /* not accepted: the tag's row in the tag list has neither a node nor X, Y, Z */
    ASSUMED_MISSING, /* not accepted: the tag's asset has no prepared model */
    ASSUMED_FAR,     /* not accepted: the place is too far from the asset's surface */
    ASSUMED_UNSURE,  /* not accepted: the confidence of the match is too low or unknown */
    ASSUMED_OUTCOMES
};

/* Writes for each tag whether its assumed place is accepted (enum assumed_outcome). Returns the number of accepted tags. */
size_t assumed_places_choose(const struct scene *scene, const struct assumed_filter *filter, uint8_t *outcome);
/* Returns the text of the tag list with the column `Place` cleared in the rows of the accepted tags, and nothing else changed
   (mem_free). `list`: the present text. Returns NULL on failure, with the reason in *why. */
char *assumed_places_accept(const struct plant *plant, const char *list, const uint8_t *outcome, struct refusal *why);
/* Describes the filter (which sensors' assumed places are accepted) as text, for the audit trail. */
void assumed_filter_text(const struct plant *plant, const struct assumed_filter *filter, char *out, size_t size);

#endif
