/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Notes of the crew, as pins over a picture. Under the player's lock. */
#ifndef WALL_NOTES_H
#define WALL_NOTES_H
#include "model.h"
#include "view_pane.h"

/* Writes what makes another drawing of them: those that are in force now. */
void notes_say(const struct model *model, struct text *said);
/* Draws those that are in force, over the picture of a pane with the upper left corner there. A view that is split has them in its left
   half. */
void notes_draw(const struct view_pane *pane, const struct model *model, cairo_t *cairo, double x, double y);
/* Draws where a desk points, and who, likewise. */
void notes_draw_pointer(const struct view_pane *pane, cairo_t *cairo, double x, double y, const double place_m[3], const char *by);

#endif
