/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses a query of /snapshot.png or /api/v1/pick into a view. The arguments are named after the members of the messages
   `camera` and `params`; lists are comma separated. Pure. */
#ifndef MESSAGE_VIEW_QUERY_H
#define MESSAGE_VIEW_QUERY_H
#include "message/role.h"

/* Builds *view from `args`, decoded texts NAME=VALUE. Refuses arguments that the role may not use. An instant (`at`) is stored
   in view->at_us, but its readings are not loaded yet. place: receives the required arguments `x` and `y`, the pixel of a pick;
   NULL: these arguments are refused. Returns false with *error saying what is wrong. */
bool view_query_parse(const struct params_context *context, enum role role, const char *const *args, size_t count, struct view *view,
                      double place[2], struct message_error *error);

#endif
