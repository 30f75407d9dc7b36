/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files with users' entries (views, notes, short links, orders to walls, paired displays) that this daemon could not read. Event
   loop only. */
#ifndef NET_UNREAD_FILES_H
#define NET_UNREAD_FILES_H
#include "session/plant_services.h"

enum { UNREAD_FILES = 5 };

/* Writes the names (static) of these files to `names`, and returns their number. */
int unread_files(const struct plant_services *plant, const char *names[UNREAD_FILES]);

#endif
