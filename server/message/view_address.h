/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fragment of the page's URL after `#`: splits it into fields, and translates them into arguments of view_query_parse(). Pure. */
#ifndef MESSAGE_VIEW_ADDRESS_H
#define MESSAGE_VIEW_ADDRESS_H
#include <stdbool.h>
#include <stddef.h>

#include "message/message_error.h"

/* Callback for one field, decoded; value "" if the field has none. Returns false to stop. */
typedef bool view_address_field(void *arg, const char *name, char *value);
/* Calls `take` for each field of an address. Returns false if a call of `take` returned false. */
bool view_address_each(const char *address, view_address_field *take, void *arg);

enum { VIEW_ADDRESS_ARGS = 40 };

struct view_address {
    char *args[VIEW_ADDRESS_ARGS]; /* decoded texts NAME=VALUE */
    size_t count;
};

/* Reads an address. Returns false with *error if a picture cannot show it. The selected tag and the tilt of the camera are dropped. Call
   view_address_finish() in any case. */
bool view_address_read(struct view_address *out, const char *address, struct message_error *error);
/* Adds an argument. Returns false if the array is full. */
bool view_address_add(struct view_address *address, const char *name, const char *value);
void view_address_finish(struct view_address *address);

#endif
