/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cameras in messages and queries: `camera`, `fit`, and the camera of a snapshot. Pure. */
#ifndef MESSAGE_FIT_MESSAGE_H
#define MESSAGE_FIT_MESSAGE_H
#include "message/message.h"

/* Reads `id`, `side` and `projection` into *out. Returns false with *error naming the member that is wrong. */
bool fit_parse(const struct plant *plant, const json_t *o, struct fit_message *out, struct message_error *error);
/* Reads the members of a `camera` message, all but seq, into *out. Returns false with *error naming the member that is wrong. */
bool camera_parse(const json_t *object, struct camera *out, struct message_error *error);
/* Moves the camera so that each half of the view shows all that the fit asks for. */
void fit_apply(const struct scene *scene, const struct fit_message *fit, const struct view *view, struct camera *camera);
/* Sets view->camera by the members `camera`, `projection`, `height_m`, `fit` and `side` of a query; without them the plant's own camera,
   or one that shows all of it. bare: the picture has no legend and no clock, which a fit otherwise leaves room for. All else of the view
   must be set. In either half of a split view the plant's own camera shows as much of the plant as it does at 16:9. Returns
   false with *error naming the member that is wrong. */
bool view_query_camera(const struct scene *scene, const struct plant *plant, const json_t *o, bool bare, struct view *view,
                       struct message_error *error);

#endif
