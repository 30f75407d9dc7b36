/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The query of /snapshot.png to a view: the names of the camera and params messages, lists with commas. Pure. */
#ifndef NET_QUERY_H
#define NET_QUERY_H
#include "net/message.h"

/* args: `name=value`, decoded. False: *error says which is wrong. */
bool query_parse(const struct params_world *world, const char *const *args, size_t count, struct view *view, struct message_error *error);

#endif
