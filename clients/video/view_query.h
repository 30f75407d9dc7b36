/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Turns the text that a view with a name is kept as, which is the fragment of the page's URL (clients/web/core/address.js), into a query of
   /snapshot.png. Pure. */
#ifndef VIDEO_VIEW_QUERY_H
#define VIDEO_VIEW_QUERY_H
#include <glib.h>

/* Appends "&NAME=VALUE" for all that a picture can show of the view: without its instant, what is selected, and how the field is computed,
   which is an engineer's. */
void view_query_add(GString *query, const char *view);

#endif
