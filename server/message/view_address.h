/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the address of the page has after `#`: its fields, and these as arguments of view_query_parse. Pure. */
#ifndef MESSAGE_VIEW_ADDRESS_H
#define MESSAGE_VIEW_ADDRESS_H
#include <stdbool.h>
#include <stddef.h>

#include "message/message_error.h"

/* Takes a field: decoded, "" where there is no value. Returns false to stop. */
typedef bool view_address_field(void *arg, const char *name, char *value);
/* Hands over the fields of an address, one after the other. Returns false where `take` did. */
bool view_address_each(const char *address, view_address_field *take, void *arg);

enum { VIEW_ADDRESS_ARGS = 40 };

struct view_address {
    char *args[VIEW_ADDRESS_ARGS]; /* NAME=VALUE, decoded */
    size_t count;
};

/* Reads an address. Returns false with *error saying what a picture cannot show. The selected tag, and how the camera is tilted, are left
   out. In any case view_address_finish is to be called. */
bool view_address_read(struct view_address *out, const char *address, struct message_error *error);
/* Adds an argument. Returns false where there is no room. */
bool view_address_add(struct view_address *address, const char *name, const char *value);
void view_address_finish(struct view_address *address);

#endif
