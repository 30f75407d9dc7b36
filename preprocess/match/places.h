/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Proposes where on its equipment a tag is: at the node of its name; at a nozzle or an end that its description names; else spread over the
 * equipment. All but the first are assumed until somebody confirms them. Thread: one. */
#ifndef PREPROCESS_MATCH_PLACES_H
#define PREPROCESS_MATCH_PLACES_H
#include "preprocess/match/matcher.h"
#include "preprocess/match/quantities.h"

enum place_kind { PLACE_NONE, PLACE_OWN_NODE, PLACE_AT_NODE, PLACE_SPREAD };

struct place_proposal {
    enum place_kind kind;
    int node; /* of the asset's model, or -1 */
    bool has_position;
    double position_m[3]; /* in the frame that the asset's sensor_frame says */
};

/* Proposes a place for each tag that is matched and in a group. Returns one for each tag; the caller frees them (mem_free). */
struct place_proposal *places_find(const struct model_index *site, const struct tag_export *list, const struct match *matches,
                                   const struct quantities *quantities);

#endif
