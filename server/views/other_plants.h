/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of other plants for wall panes: requests them from their servers with a viewer's token, while some display shows
 * them. Each picture is checked. It is passed on to displays until it is too old or the server sends another answer. Uses one
 * thread and libcurl; no other thread waits for it. Call from any thread, for the functions below. */
#ifndef VIEWS_OTHER_PLANTS_H
#define VIEWS_OTHER_PLANTS_H
#include "base/clock.h"
#include "base/log/log.h"
#include "plant/plant.h"
#include "plant/walls/wall.h"

struct other_plants;
/* Starts the thread. plant: has the section `other_plants`. Plant and clock must outlive the result. Returns NULL if the thread cannot be
 * started (logged). */
struct other_plants *other_plants_start(struct log *log, const struct plant *plant, const struct plant_clock *clock);
/* Ends the thread, aborts requests in progress and sets *others to NULL. *others may be NULL. */
void other_plants_stop(struct other_plants **others);
/* Returns the state of the plants whose indices `which` lists, as JSON (/api/v1/other_plants in HTTP.md), and keeps requesting their
 * pictures for the next half minute. now_ns: monotonic. The caller frees the text (mem_free()). */
char *other_plants_text(struct other_plants *others, const int *which, size_t count, int64_t now_ns);
/* Returns the picture with this id, or NULL if it is no longer the newest one. The caller frees it (mem_free()). */
char *other_plants_picture(struct other_plants *others, int which, int64_t number, int64_t now_ns, size_t *bytes);

#endif
