/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What desks do to the panes of walls: a view sent there, a pane held, a place pointed at; and which displays are there. What was sent is
   in walls.json in the folder of the history, where there is one, until the pane is given back. Thread: the loop. */
#ifndef VIEWS_WALL_REMOTE_H
#define VIEWS_WALL_REMOTE_H
#include <jansson.h>

#include "base/log/log.h"
#include "base/refusal.h"
#include "plant/plant.h"
#include "plant/walls/wall.h"

enum { WALL_DESK_BYTES = 121, WALL_AREA_BYTES = 61, WALL_POINTERS = 8 };
#define WALL_REMOTE_FILE "walls.json"

struct wall_place {
    char wall[NAMED_VIEW_ID_BYTES], area[WALL_AREA_BYTES]; /* area "": the whole display */
    int display;                                           /* from 1; 0: none */
};

struct wall_order {
    struct wall_place place;
    const char *view, *title; /* as of a view with a name; view "": the pane's own */
    bool held;                /* what is shown stays. Neither view nor held: the pane is given back */
    const char *desk;
};

struct wall_remote;
/* Reads what was sent. folder: of the history; NULL: it is forgotten with the daemon. A file that cannot be read counts as empty (logged)
   and is not written over. Never returns NULL. plant and folder must outlive it. */
struct wall_remote *wall_remote_open(struct log *log, const struct plant *plant, const char *folder);
void wall_remote_close(struct wall_remote **remote); /* &NULL is fine; leaves NULL */
/* Returns what of a place is not in the plant file (static), or NULL. */
const char *wall_place_wrong(const struct plant *plant, const struct wall_place *place);
/* Does it, and writes the file. The place must be in the plant file. Returns NULL, or why it could not (static). */
enum refusal_code wall_remote_order(struct wall_remote *remote, const struct wall_order *order, const char *who, int64_t now_us);
/* Has a pane show where somebody points. position_m: NULL: nowhere any more. */
void wall_remote_point(struct wall_remote *remote, const struct wall_place *place, const double *position_m, const char *who,
                       const char *desk);
/* Takes `pointed` as wall_remote_pointers_text() of another daemon says it. Returns false if it is none. */
bool wall_remote_mirror_pointers(struct wall_remote *remote, const json_t *pointed);
/* Notes whether a display is connected. */
void wall_remote_see(struct wall_remote *remote, const char *wall, int display, bool there);
/* Return numbers that increase with each change of what the next two say. */
uint64_t wall_remote_number(const struct wall_remote *remote);
uint64_t wall_remote_pointer_number(const struct wall_remote *remote);
/* Return the message `walls`; and `pointed` with what changed after that number. Free with mem_free. */
char *wall_remote_text(const struct wall_remote *remote);
char *wall_remote_pointers_text(const struct wall_remote *remote, uint64_t after);
/* For a core and its renderers: return the list of what was sent to panes, which belongs to them; and take it from the other one (false: it
   is none, and nothing changed). */
json_t *wall_remote_list(const struct wall_remote *remote);
bool wall_remote_mirror(struct wall_remote *remote, json_t *list);

#endif
