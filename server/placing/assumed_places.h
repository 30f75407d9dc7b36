/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses, among the sensors whose place is assumed (PLANT.md, "Assumed places"), those that an engineer accepts at once.
   Thread: the loop. */
#ifndef PLACING_ASSUMED_PLACES_H
#define PLACING_ASSUMED_PLACES_H
#include <stddef.h>
#include <stdint.h>

#include "base/refusal.h"
#include "scene/scene.h"

struct assumed_filter {
    int asset, group;   /* in the plant; -1: any */
    char pattern[101];  /* glob of the tag's name, or without * and ? a part of its name or description; case is ignored; "": any */
    double within_m;    /* most distance from the surface of the asset; negative: any */
    double confidence;  /* least confidence of the match, 0..1, by matches.csv beside the tag list; negative: any */
};

enum assumed_outcome {
    ASSUMED_NOT_MEANT, /* its place is not assumed, or asset, group or pattern are other ones */
    ASSUMED_ACCEPTED,
    ASSUMED_NOWHERE,   /* its row names neither a node nor X, Y, Z */
    ASSUMED_MISSING,   /* its asset has no model */
    ASSUMED_FAR,       /* from the surface */
    ASSUMED_UNSURE,    /* confidence is less, or not known */
    ASSUMED_OUTCOMES
};

/* Writes an enum assumed_outcome for each tag of the plant. Returns the number of accepted ones. */
size_t assumed_places_choose(const struct scene *scene, const struct assumed_filter *filter, uint8_t *outcome);
/* Returns the tag list with `Place` cleared in the rows of the accepted tags and nothing else changed; NULL with the reason in *why. The
   caller frees either (mem_free). */
char *assumed_places_accept(const struct plant *plant, const char *list, const uint8_t *outcome, struct refusal *why);
/* Writes the filter in words, for the audit trail. */
void assumed_filter_text(const struct plant *plant, const struct assumed_filter *filter, char *out, size_t size);

#endif
