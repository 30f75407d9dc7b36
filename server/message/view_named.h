/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Views with names, by their addresses: what they show, and what of it this plant does not have. Pure. */
#ifndef MESSAGE_VIEW_NAMED_H
#define MESSAGE_VIEW_NAMED_H
#include "message/message.h"
#include "plant/walls/wall.h"

/* Builds *view from an address as its author wrote it, who may say all that there is to say. Returns false with *error saying what is
   wrong with the address. */
bool view_named_read(const struct params_context *context, const char *address, int width_px, int height_px, struct view *view,
                     struct message_error *error);
/* Checks that the plant has all that an address names. A difference from a baseline is not checked: baselines come and go. Returns false
   with *error saying what is wrong. */
bool view_named_check(const struct scene *scene, const char *address, struct message_error *error);
/* Calls `say` for each view of the plant file with what is wrong with it. */
typedef void view_named_say(void *arg, const struct named_view *view, const char *wrong);
void view_named_check_all(const struct scene *scene, view_named_say *say, void *arg);

#endif
