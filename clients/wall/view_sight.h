/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of a pane that shows the place of a tag: looks for a side from which nothing stands before it, by asking the server what is at a pixel
   (`pick`). Where something does from all sides, that becomes a ghost, for as long as the place is shown. Under the player's lock. */
#ifndef WALL_VIEW_SIGHT_H
#define WALL_VIEW_SIGHT_H
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "approach.h"
#include "link.h"

enum { SIGHT_GHOSTS = 8, SIGHT_ID_BYTES = 260 };
struct view_sight {
    char tag[SIGHT_ID_BYTES], asset[SIGHT_ID_BYTES]; /* its name; the id of the equipment that it stands on */
    double place_m[3];
    double x_px, y_px; /* where the place is in the picture, whichever the side */
    int width_px, height_px;
    struct camera first; /* what is shown meanwhile */
    json_t *ghosts;       /* ids of those that the view has anyway, an array: owned */
    uint32_t *params_seq; /* of the pane: its last number of parameters */
    /* --- below: of view_sight.c */
    bool looks;
    int side, around;        /* what was asked; around -1: the place itself */
    int covered;             /* of the places around it, so far */
    int best, least_covered; /* the best side so far; -1: none */
    int behind[APPROACH_SIDES], behind_count; /* sides from which other equipment stands before it */
    int through;                              /* which of them is being looked from, through ghosts; -1: none yet */
    char made[SIGHT_GHOSTS][SIGHT_ID_BYTES];  /* ids of ghosts that stand before it */
    int made_count;
    uint32_t seq; /* of the newest question */
    int tries;
    int64_t begun_ns, asked_ns;
};

/* Begins to look; what stands above in the struct is set. */
void view_sight_begin(struct view_sight *sight, struct link *link);
/* Stops looking; ghosts that were made stay until other parameters are asked for. */
void view_sight_end(struct view_sight *sight);
void view_sight_finish(struct view_sight *sight); /* leaves it empty */
/* Takes an answer in, and asks on. Returns true once if another camera than the first is to be shown. */
bool view_sight_hear(struct view_sight *sight, struct link *link, const json_t *picked, struct camera *out);
/* Asks again where no answer came. To be called as time goes by. Returns the same. */
bool view_sight_tick(struct view_sight *sight, struct link *link, int64_t now_ns, struct camera *out);

#endif
