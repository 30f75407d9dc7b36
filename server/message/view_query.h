/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The query of /snapshot.png and /api/v1/pick, as a view. Its arguments are named like the members of `camera` and `params`; lists have
   commas. Pure. */
#ifndef MESSAGE_VIEW_QUERY_H
#define MESSAGE_VIEW_QUERY_H
#include <jansson.h>

#include "message/role.h"

/* Reads the value of one argument, as in `camera` and `params` of the protocol. The caller owns it. NULL: it has another form, or no
   argument has that name. */
json_t *view_query_value(const char *name, const char *text);

/* Builds *view from `args`, decoded `name=value` texts, as far as the role may ask for it. An instant (`at`) goes to view->at_us; its
   readings are yet to be found. place: where the required `x` and `y` of a pick are written; NULL: these are not arguments. Returns false
   with *error saying what is wrong. */
bool view_query_parse(const struct params_context *context, enum role role, const char *const *args, size_t count, struct view *view,
                      double place[2], struct message_error *error);

#endif
