/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of a pane that shows the place of a tag: looks for a side from which nothing stands before it, by asking the server what is at a pixel
   (`pick`). Under the player's lock. */
#ifndef WALL_VIEW_SIGHT_H
#define WALL_VIEW_SIGHT_H
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "approach.h"

struct view_pane;
struct model;
struct view_sight {
    bool looks;
    int tag;
    struct camera first;     /* what is shown meanwhile */
    int side, around;        /* what was asked; around -1: the place itself */
    int covered;             /* of the places around it, so far */
    int best, least_covered; /* the best side so far; -1: none */
    bool behind;             /* from some side other equipment stood before it */
    uint32_t seq;            /* of the newest question */
    int tries;
    int64_t begun_ns, asked_ns;
};

/* Begins to look. first: a camera that was asked for. */
void view_sight_begin(struct view_pane *pane, const struct model *model, int tag, const struct camera *first);
/* Takes an answer in; asks on, or has the pane show the best side. */
void view_sight_hear(struct view_pane *pane, const struct model *model, const json_t *picked);
/* Asks again where no answer came. To be called as time goes by. */
void view_sight_tick(struct view_pane *pane, const struct model *model, int64_t now_ns);

#endif
