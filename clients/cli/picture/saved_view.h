/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Named views, of the plant file or saved on the page, as parameters of a picture. */
#ifndef CLI_PICTURE_SAVED_VIEW_H
#define CLI_PICTURE_SAVED_VIEW_H
#include <jansson.h>

#include "plant/plant.h"
#include "snapshot.h"

/* Returns a text member of a view or tour in a daemon's JSON, "" if the member is missing; owned by the JSON. */
const char *saved_view_text(const json_t *view, const char *name);
/* Adds the parameters of an address (part of the page's URL after `#`) to options->args, except those that the command line gave, and the
   instant. All of options->args must come from the command line. id: name of the view in messages. Returns false with the reason
   printed. */
bool saved_view_add_address(struct snapshot_options *options, const char *id, const char *address);
/* Adds the parameters of the view options->view, from the list of the daemon options->from, to options->args. Returns false with the
   reason printed. */
bool saved_view_add_from_daemon(struct snapshot_options *options);
/* Like saved_view_add_from_daemon(), with the views of the plant file and those in the history folder. */
bool saved_view_add_from_plant(struct snapshot_options *options, struct log *log, const struct plant *plant);

#endif
