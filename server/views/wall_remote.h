/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Remote control of the panes of video walls from desks. A user sends a view to a pane, holds a pane, or points at a position
 * in it. Also records which displays are connected. Orders are stored in walls.json in the history's folder, if any, until the
 * pane is released. Call only in the event loop. */
#ifndef VIEWS_WALL_REMOTE_H
#define VIEWS_WALL_REMOTE_H
#include <jansson.h>

#include "base/files/file_writer.h"
#include "base/refusal.h"
#include "plant/plant.h"
#include "plant/walls/wall.h"

enum { WALL_DESK_BYTES = 121, WALL_AREA_BYTES = 61, WALL_POINTERS = 8 };
#define WALL_REMOTE_FILE "walls.json"

struct wall_place {
    /* wall: id of the wall; area: name of the area of the wall's display that the pane covers; "": the whole display */
    char wall[NAMED_VIEW_ID_BYTES], area[WALL_AREA_BYTES];
    int display; /* number of the display on the wall, from 1; 0: no display */
};

struct wall_order {
    struct wall_place place;
    /* address (fields of the page's URL) and title of the view that the pane must show; view "": the pane shows the views that
       the plant file gives it */
    const char *view, *title;
    /* true: the pane (area of a display) stays at its present view, even if it otherwise shows several views in turn. An order
       with neither `view` nor `held` releases the pane */
    bool held;
    const char *desk;
};

struct wall_remote;
/* Reads the orders. folder: the history's folder; NULL: orders are lost when the daemon ends. An unreadable file counts as empty
   (logged) and is not overwritten. Never returns NULL. `plant` and `folder` must outlive the result. */
struct wall_remote *wall_remote_open(struct log *log, const struct plant *plant, const char *folder, struct file_writer *writer);
void wall_remote_close(struct wall_remote **remote); /* Frees the orders and sets *remote to NULL. *remote may be NULL. */
/* Returns the name of the file (static) if it could not be read; otherwise NULL. */
const char *wall_remote_unread_file(const struct wall_remote *remote);
/* Returns why a pane cannot be controlled (static text): it is missing in the plant file, or has no views. NULL: it can be controlled. */
const char *wall_place_wrong(const struct plant *plant, const struct wall_place *place);
/* Carries out an order and queues the file (kept_list_put()). The pane must exist in the plant file. Returns REFUSAL_NONE, or why it
   failed. */
enum refusal_code wall_remote_order(struct wall_remote *remote, const struct wall_order *order, const char *who, int64_t now_us);
/* Shows in a pane the position to which a user points. position_m NULL: removes the pointer from the pane. */
void wall_remote_point(struct wall_remote *remote, const struct wall_place *place, const double *position_m, const char *who,
                       const char *desk);
/* Replaces all pointers with those of another daemon. pointed: the result of wall_remote_pointers_text() there. Returns false
 * if it is invalid. */
bool wall_remote_mirror_pointers(struct wall_remote *remote, const json_t *pointed);
/* Records whether a wall display is connected now. */
void wall_remote_see(struct wall_remote *remote, const char *wall, int display, bool there);
/* Return counters that increase with each change of the messages `walls` and `pointed`. */
uint64_t wall_remote_number(const struct wall_remote *remote);
uint64_t wall_remote_pointer_number(const struct wall_remote *remote);
/* Return the message `walls`, and the message `pointed` with those changes whose counter is above `after`. The caller frees the text
 * (mem_free()). */
char *wall_remote_text(const struct wall_remote *remote);
char *wall_remote_pointers_text(const struct wall_remote *remote, uint64_t after);
/* For the connection between a core and its renderers. wall_remote_list() returns the list of orders, owned by `remote`.
   wall_remote_mirror() replaces the list with that of the other daemon; it returns false, with nothing changed, if that list is
   invalid. */
json_t *wall_remote_list(const struct wall_remote *remote);
bool wall_remote_mirror(struct wall_remote *remote, json_t *list);

#endif
