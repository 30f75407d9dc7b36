/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A pane that is a tile of one picture over many displays: pictures are kept until the server says when all tiles show them. Under the
   player's lock. */
#ifndef WALL_VIEW_TILE_H
#define WALL_VIEW_TILE_H
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "protocol/wire.h"

enum { TILE_KEPT = 4, TILE_ORDERS = 4 };
struct tile_picture {
    struct wire_frame frame;
    uint8_t *pixels; /* 4 bytes each, rows without gaps */
};

struct tile_order { /* to show the picture `seq` at that time of the server */
    uint32_t seq;
    int64_t at_us;
};

struct view_tile {
    int display, columns, rows; /* from 1, row by row; display 0: it is no tile */
    double part[4];             /* of the whole picture: left, top, width, height, as shares of it; 0: not told yet */
    const char *wall;           /* the player's */
    bool leads;                 /* what it asks for is what all show */
    int64_t late_us;            /* since when it is left out; 0: it is not */
    char missing[100];          /* displays that are not there; "": all are */
    /* Not done yet, oldest first. Where there are more, those between the oldest and the newest are left out, so that also who looks
       rarely finds one whose time has come. */
    struct tile_order orders[TILE_ORDERS];
    int order_count;
    struct tile_picture kept[TILE_KEPT]; /* decoded and not shown yet, likewise */
    int kept_count;
};

/* Takes in `tiles` and `present`. */
void view_tile_hear(struct view_tile *tile, const char *type, const json_t *message);
/* Keeps a copy of a picture; a newer one has all that an older one changed. */
void view_tile_keep(struct view_tile *tile, const struct wire_frame *frame, const uint8_t *pixels);
/* Returns the picture to show now, which the caller frees (pixels, mem_free), once. Returns false if it is not time. */
bool view_tile_take(struct view_tile *tile, int64_t now_us, struct tile_picture *out);
/* Forgets what a connection brought that is gone. */
void view_tile_clear(struct view_tile *tile);

#endif
