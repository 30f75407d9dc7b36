/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A view as the query of /snapshot.png that asks for it: the reverse of view_query.h. Pure. */
#ifndef MESSAGE_VIEW_QUERY_WRITE_H
#define MESSAGE_VIEW_QUERY_WRITE_H
#include "message/view_address.h"
#include "message/view_query.h"

/* Writes all that the view shows, but its instant and its tier, which no query has. In any case view_address_finish is to be called.
   Returns false with *error if a query cannot say it: sensors that are tried out, a baseline without a name, a name with a comma; the
   query is parsed again, and has to be that view. */
bool view_query_write(const struct params_context *context, const struct view *view, struct view_address *out, struct message_error *error);

#endif
