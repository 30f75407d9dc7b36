/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Named views, in an order that all clients share: first the views of the plant file, which users cannot change, then those
 * that users saved. The latter are stored with earlier versions in views.json in the history's folder. Call only in the event
 * loop. */
#ifndef VIEWS_NAMED_VIEWS_H
#define VIEWS_NAMED_VIEWS_H
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/files/file_writer.h"
#include "base/refusal.h"
#include "plant/plant.h"
#include "plant/walls/wall.h"

enum { NAMED_VIEW_VERSIONS = 10 /* number of earlier versions that are stored of each named view */ };
#define NAMED_VIEWS_FILE "views.json"

struct named_view_edit {
    char id[NAMED_VIEW_ID_BYTES], title[NAMED_VIEW_TITLE_BYTES], address[NAMED_VIEW_ADDRESS_BYTES];
    int at; /* new index of the view among the saved views; -1: the index stays unchanged, or a new view becomes the last one */
};

struct named_views;
/* Reads the views of a plant. folder: the history's folder, which need not exist; NULL: saving is refused. An unreadable file counts as
   empty (logged) and is not overwritten. Never returns NULL. `plant` and `folder` must outlive the views. */
struct named_views *named_views_open(struct log *log, const struct plant *plant, const char *folder, struct file_writer *writer);
void named_views_close(struct named_views **views); /* Frees the views and sets *views to NULL. *views may be NULL. */
/* Returns the name of the file (static) if it could not be read; otherwise NULL. */
const char *named_views_unread_file(const struct named_views *views);
/* Saves a new or changed view, and queues the file (kept_list_put()). who: the user; time_us: UTC. Returns REFUSAL_NONE, or why it
   failed. */
enum refusal_code named_views_save(struct named_views *views, const struct named_view_edit *edit, const char *who, int64_t time_us);
/* Removes a saved view and its earlier versions, and queues the file (kept_list_put()). Returns REFUSAL_NONE, or why it failed. */
enum refusal_code named_views_remove(struct named_views *views, const char *id);
/* Returns the address of a saved view, owned by `views` until the next change; NULL: no user saved a view with this id. */
const char *named_views_address(const struct named_views *views, const char *id);
/* Returns whether `address` belongs to a saved view, or to one of its earlier versions. */
bool named_views_have(const struct named_views *views, const char *address);
/* Returns a counter that increases with each change of the views; 0: there has been no view. */
uint64_t named_views_number(const struct named_views *views);
/* Returns the JSON message `views` with all views. Only the view `id` includes its earlier versions, as `before` (id NULL: no
 * view does). The caller releases it. */
json_t *named_views_message(const struct named_views *views, const char *id);
/* For the connection between a core and its renderers. named_views_list() returns the list of saved views, owned by `views`.
   named_views_mirror() replaces the list with that of the other daemon; it returns false, with nothing changed, if that list is
   invalid. */
json_t *named_views_list(const struct named_views *views);
bool named_views_mirror(struct named_views *views, json_t *list);

#endif
