/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts a named view's address to a struct view, and reports names in the address that the plant does not have. Pure. */
#ifndef MESSAGE_VIEW_NAMED_H
#define MESSAGE_VIEW_NAMED_H
#include "message/message.h"
#include "plant/walls/wall.h"

/* Builds *view from a view's address, with an engineer's rights, because only engineers can save parameters that are for
   engineers (role_may_save()). Returns false with *error saying what is wrong with the address. */
bool view_named_read(const struct params_context *context, const char *address, int width_px, int height_px, struct view *view,
                     struct message_error *error);
/* Checks that the plant has everything that an address names, except baselines, which are temporary. Returns false with *error
   saying what is wrong. */
bool view_named_check(const struct scene *scene, const char *address, struct message_error *error);
/* Callback for each view of the plant file whose address is wrong, with the reason. */
typedef void view_named_say(void *arg, const struct named_view *view, const char *wrong);
void view_named_check_all(const struct scene *scene, view_named_say *say, void *arg);

#endif
