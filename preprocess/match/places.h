/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Proposes the place of a tag on its equipment: the node that has the tag's name, else a nozzle or end named in its description, else one
 * of several positions spread over the equipment. The latter two kinds are marked as assumed until a person confirms them. Thread: one. */
#ifndef PREPROCESS_MATCH_PLACES_H
#define PREPROCESS_MATCH_PLACES_H
#include "preprocess/match/matcher.h"
#include "preprocess/match/quantities.h"

enum place_kind { PLACE_NONE, PLACE_OWN_NODE, PLACE_AT_NODE, PLACE_SPREAD };

struct place_proposal {
    enum place_kind kind;
    int node; /* node of the asset's model; -1: none */
    bool has_position;
    double position_m[3]; /* position in the frame that the asset's sensor_frame states */
};

/* Proposes a place for each tag that is matched and in a group. Returns an array with one element per tag, which the caller frees
 * (mem_free). */
struct place_proposal *places_find(const struct model_index *site, const struct tag_export *list, const struct match *matches,
                                   const struct quantities *quantities);

#endif
