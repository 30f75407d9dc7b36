/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of other plants for panes of walls: their own servers are asked, by a viewer's token, as long as some display shows them. What
   comes is checked, and is handed on until it is too old or its server says something else. One thread of its own, by libcurl; nobody waits
   for it. Thread: any, for the functions below. */
#ifndef VIEWS_OTHER_PLANTS_H
#define VIEWS_OTHER_PLANTS_H
#include "base/log/log.h"
#include "plant/plant.h"
#include "plant/walls/wall.h"

struct other_plants;
/* plant: with `other_plants`; it must outlive them. Returns NULL if it cannot be started (logged). */
struct other_plants *other_plants_start(struct log *log, const struct plant *plant);
void other_plants_stop(struct other_plants **others); /* cuts off what is under way; &NULL is fine; leaves NULL */
/* Says what is known of these plants, by index, and has them asked for the next half a minute: /api/v1/other_plants in PROTOCOL.md. now_ns:
   monotonic. Returns JSON; mem_free. */
char *other_plants_text(struct other_plants *others, const int *which, size_t count, int64_t now_ns);
/* Returns the picture with that number (mem_free), or NULL: it is not shown any more. */
char *other_plants_picture(struct other_plants *others, int which, int64_t number, int64_t now_ns, size_t *bytes);

#endif
