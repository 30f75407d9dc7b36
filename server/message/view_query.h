/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The query of /snapshot.png and /api/v1/pick to a view: the names of the camera and params messages, lists with commas. Pure. */
#ifndef MESSAGE_VIEW_QUERY_H
#define MESSAGE_VIEW_QUERY_H
#include "message/role.h"

/* args: `name=value`, decoded. place: NULL, or the `x` and `y` of a pick, which must be there then. `at` is an
   instant: view->at_us, whose readings are yet to be found. False: *error says which is wrong. */
bool view_query_parse(const struct params_context *world, enum role role, const char *const *args, size_t count, struct view *view,
                      double place[2], struct message_error *error);

#endif
