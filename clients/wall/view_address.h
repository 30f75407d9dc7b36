/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads what a page's address has after `#`, which views with names are kept as. Pure; tested with the cases of the page
   (protocol/vectors/wall/addresses.json). */
#ifndef WALL_VIEW_ADDRESS_H
#define WALL_VIEW_ADDRESS_H
#include <jansson.h>

#include "scene/camera.h"

/* Returns the parameters that it gives, as in `params` of the protocol; what is invalid is left out. The caller owns the object. */
json_t *view_address_params(const char *text);
/* Returns its camera, as in `camera` of the protocol without type and number, or NULL. The caller owns it. */
json_t *view_address_camera(const char *text);
/* Returns a camera as it is said to the server, without type and number. The caller owns it. */
json_t *view_address_camera_message(const struct camera *camera);

#endif
