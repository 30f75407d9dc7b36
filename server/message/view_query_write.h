/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes a view as the query of /snapshot.png that reproduces it: the reverse of view_query.h. Pure. */
#ifndef MESSAGE_VIEW_QUERY_WRITE_H
#define MESSAGE_VIEW_QUERY_WRITE_H
#include "message/view_address.h"
#include "message/view_query.h"

/* Writes everything that the view shows, except the past instant and the quality (preview or refined), which queries cannot
   express. Returns false with *error if a query cannot express the view, because it has sensors moved on trial, a baseline
   without a name, or a name with a comma. As a check, the written query is parsed and must give an equal view. Call
   view_address_finish() in any case. */
bool view_query_write(const struct params_context *context, const struct view *view, struct view_address *out, struct message_error *error);

#endif
