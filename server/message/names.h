/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables that map names in messages (PROTOCOL.md) to enum values and back. Pure. */
#ifndef MESSAGE_NAMES_H
#define MESSAGE_NAMES_H
#include "protocol/wire.h"

struct name {
    const char *text;
    int value;
};

enum projection { PROJECTION_AS_IT_IS = -1, PROJECTION_PERSPECTIVE, PROJECTION_ORTHOGRAPHIC };

extern const struct name names_arrows[], names_backdrop[], names_strip[], names_language[], names_interpolation[], names_distance[],
    names_fill[], names_show[], names_scale[], names_look[], names_codec[], names_projection[], names_side[], names_pick[],
    names_signed[]; /* one table for each enum; each is terminated by an entry whose text is NULL */

/* Returns the enum value of a name; -1: the name is not in the table. */
int name_find(const struct name *names, const char *text);
/* Returns the name of a value (static text). The table must contain the value. */
const char *name_of(const struct name *names, int value);

#endif
