/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Databases that cannot be read any more. Thread: any. */
#ifndef BASE_DAMAGED_H
#define BASE_DAMAGED_H
#include <stdbool.h>

#include "base/log.h"

/* Renames NAME.sqlite, which nobody has open, with what SQLite keeps beside it, to NAME.damaged-INSTANT.sqlite: out of the way, for
   whoever wants to look into it. Logged either way. */
bool damaged_set_aside(struct log *log, const char *path);

#endif
