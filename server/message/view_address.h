/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Address of a view: the part of the page's URL after `#`. Splits it into fields, and translates these into arguments for
   view_query_parse(). Pure. */
#ifndef MESSAGE_VIEW_ADDRESS_H
#define MESSAGE_VIEW_ADDRESS_H
#include <stdbool.h>
#include <stddef.h>

#include "message/message_error.h"

enum { VIEW_ADDRESS_ARGS = 40 };

struct view_address {
    char *args[VIEW_ADDRESS_ARGS]; /* arguments NAME=VALUE that were found in the address, decoded */
    size_t count;
};

/* Translates a view's address into arguments of an HTTP query for a picture. Drops the selected tag and the camera's tilt,
   because pictures do not show them. Returns false with *error if no picture can show the view at this address. Call
   view_address_finish() in any case. */
bool view_address_read(struct view_address *out, const char *address, struct message_error *error);
/* Adds the argument NAME=VALUE. Returns false if there is no room for more. */
bool view_address_add(struct view_address *address, const char *name, const char *value);
/* Returns true if an argument NAME=VALUE has this name. */
bool view_address_is_named(const char *arg, const char *name);
/* Returns true if a query's argument `given` replaces a saved view's argument `name`: it is the same argument, or it makes the
   other meaningless, as `fit` does with `camera`. Either text may be followed by `=` and a value. */
bool view_address_replaces(const char *given, const char *name);
/* Adds an argument NAME=VALUE, and removes those that it replaces (view_address_replaces()). Returns false if there is no room
   for more. */
bool view_address_set(struct view_address *address, const char *arg);
void view_address_finish(struct view_address *address);

#endif
