/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cameras in messages and queries: `camera`, `fit`, and the camera of a picture requested over HTTP. Pure. */
#ifndef MESSAGE_FIT_MESSAGE_H
#define MESSAGE_FIT_MESSAGE_H
#include "message/message.h"

/* Parses the members `id`, `side` and `projection` of a `fit` message into *out. Returns false with *error naming the wrong member. */
bool fit_parse(const struct plant *plant, const json_t *o, struct fit_message *out, struct message_error *error);
/* Parses the members of a `camera` message, except seq, into *out. Returns false with *error naming the wrong member. */
bool camera_parse(const json_t *object, struct camera *out, struct message_error *error);
/* Moves the camera so that each half of the view shows the asset, tag or plant named in the `fit` message. */
void fit_apply(const struct scene *scene, const struct fit_message *fit, const struct view *view, struct camera *camera);
/* Sets view->camera from the members `camera`, `projection`, `height_m`, `fit` and `side` of the JSON object `o`. Without them,
   the view gets the plant's initial camera or, if the plant file has none, one that shows the whole plant. bare: the picture
   has no legend and no clock, so `fit` leaves no room for them. Call it last, after all other members of the view are set. Each
   half of a split view shows as much of the plant as the initial camera shows at 16:9. Returns false with *error naming the
   wrong member. */
bool view_query_camera(const struct scene *scene, const struct plant *plant, const json_t *o, bool bare, struct view *view,
                       struct message_error *error);

#endif
