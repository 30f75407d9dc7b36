/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Proposes the position of a tag on its equipment: that of the node with the tag's name, else of a nozzle or end named in the
 * tag's description, else one of several positions spread over the equipment. Positions of the second and third kind are marked
 * as assumed until a person confirms them. Call from one thread only. */
#ifndef PREPROCESS_MATCH_PLACES_H
#define PREPROCESS_MATCH_PLACES_H
#include "preprocess/match/matcher.h"
#include "preprocess/match/quantities.h"

enum place_kind { PLACE_NONE, PLACE_OWN_NODE, PLACE_AT_NODE, PLACE_SPREAD };

struct place_proposal {
    enum place_kind kind;
    int node; /* index of the node in the asset's model at which the sensor is proposed; -1: none */
    bool has_position;
    double position_m[3]; /* position, in the frame given by the asset's sensor_frame */
};

/* Proposes a position for each tag that has a match and a group. Returns an array by tag, which the caller frees (mem_free). */
struct place_proposal *places_find(const struct model_index *site, const struct tag_export *list, const struct match *matches,
                                   const struct quantities *quantities);

#endif
