/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Named views, from the plant file or saved on the page, as picture parameters. */
#ifndef CLI_PICTURE_SAVED_VIEW_H
#define CLI_PICTURE_SAVED_VIEW_H
#include <jansson.h>

#include "plant/plant.h"
#include "snapshot.h"

/* Returns a text member of a view or tour in a daemon's JSON, "" if it is missing; owned by the JSON. */
const char *saved_view_text(const json_t *view, const char *name);
/* Adds the parameters of an address (the part of the page's URL after `#`) to options->args, except the instant and those that
   the command line gave. On entry, options->args may contain only command-line arguments. id: name of the view in error
   messages. Returns false with the reason printed. */
bool saved_view_add_address(struct snapshot_options *options, const char *id, const char *address);
/* Finds the view options->view in the list of the daemon options->from, and adds its id to options->args. present true: if the
   view shows a past instant, also adds an argument that requests the present. Returns false with the reason printed. */
bool saved_view_add_from_daemon(struct snapshot_options *options, bool present);
/* Finds the view options->view in the plant file or the history folder, and adds its parameters to options->args, as
   saved_view_add_address() does. Returns false with the reason printed. */
bool saved_view_add_from_plant(struct snapshot_options *options, struct log *log, const struct plant *plant);

#endif
