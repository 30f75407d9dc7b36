/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a client wants to look at, and the camera that does. */
#ifndef MESSAGE_FIT_MESSAGE_H
#define MESSAGE_FIT_MESSAGE_H
#include "message/message.h"

/* Reads `id`, `side` and `projection`. False: *error names the field. */
bool fit_parse(const struct plant *plant, const json_t *o, struct fit *out, struct message_error *error);
/* The camera that a fit asks for, from the one that is there; each half of a view that is split shows all that it asks for. */
void fit_apply(const struct scene *scene, const struct fit *fit, const struct view *view, struct camera *camera);
/* The camera of a picture by its query: `camera`, `projection`, `height_m`, `fit` and `side`; else the plant's own, or one that looks
   at all of it. Nothing that is fitted lies under legend or clock, unless the picture is bare of them. All else of the view is set
   already. In either half of a view that is split the plant's own shows as much of the plant as it does at 16:9. */
bool view_query_camera(const struct scene *scene, const json_t *o, bool bare, struct view *view, struct message_error *error);

#endif
