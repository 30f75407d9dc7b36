/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Views with names, in an order that all share: those of the plant file, which only that file changes, then those that people saved, in
   views.json in the folder of the history, with earlier versions of each. Thread: the loop. */
#ifndef VIEWS_NAMED_VIEWS_H
#define VIEWS_NAMED_VIEWS_H
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/log/log.h"
#include "base/refusal.h"
#include "plant/plant.h"
#include "plant/walls/wall.h"

enum { NAMED_VIEW_VERSIONS = 10 /* earlier ones kept */ };
#define NAMED_VIEWS_FILE "views.json"

struct named_view_edit {
    char id[NAMED_VIEW_ID_BYTES], title[NAMED_VIEW_TITLE_BYTES], address[NAMED_VIEW_ADDRESS_BYTES];
    int at; /* its place among those that people saved, from 0; -1: where it is, a new one last */
};

struct named_views;
/* Reads the views of a plant. folder: of the history, which need not exist; NULL: none can be saved. A file that cannot be read counts as
   empty (logged) and is not written over. Never returns NULL. plant and folder must outlive them. */
struct named_views *named_views_open(struct log *log, const struct plant *plant, const char *folder);
void named_views_close(struct named_views **views); /* &NULL is fine; leaves NULL */
/* Saves a view, new or changed, and writes the file. who: the person; time_us: UTC. Returns NULL, or why it could not (static). */
enum refusal_code named_views_save(struct named_views *views, const struct named_view_edit *edit, const char *who, int64_t time_us);
/* Removes a saved view, with its earlier versions, and writes the file. Returns NULL, or why it could not (static). */
enum refusal_code named_views_remove(struct named_views *views, const char *id);
/* Returns a number that increases with each change; 0: there has been no view. */
uint64_t named_views_number(const struct named_views *views);
/* Returns the message `views` with all of them, without earlier versions, or with those of the view `id` as `before` (NULL: of none),
   which belongs to the caller. */
json_t *named_views_message(const struct named_views *views, const char *id);
/* For a core and its renderers: return the list of views that people saved, which belongs to them; and take it from the other one (false:
   it is none, and nothing changed). */
json_t *named_views_list(const struct named_views *views);
bool named_views_mirror(struct named_views *views, json_t *list);

#endif
