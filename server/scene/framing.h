/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From where to look at the plant, at one asset or at one sensor. Thread: any. */
#ifndef SCENE_FRAMING_H
#define SCENE_FRAMING_H
#include "scene/scene.h"

/* Where one stands. Front is south, left is west (in a Z-up frame x is east and y is north; in a Y-up one, z is south). */
enum side { SIDE_NOW, SIDE_TOP, SIDE_BOTTOM, SIDE_FRONT, SIDE_BACK, SIDE_LEFT, SIDE_RIGHT, SIDE_ISO };

struct framing {
    int asset, tag; /* -1: not asked for; both: the whole plant */
    enum side side; /* SIDE_NOW: as the camera looks now; a sensor from outside its asset */
    struct camera_window window; /* that it fills */
};

/* False: no asset and no tag that stands on one has this name. Assets come first. NULL: the whole plant.
   Sets every field. */
bool framing_find(const struct plant *plant, const char *name, struct framing *framing);
/* Turns the camera to look at all of it, with the lens it has. */
void framing_look(const struct scene *scene, const struct framing *framing, double aspect, struct camera *camera);
/* Moves a perspective camera, without turning it, until the window of a picture of that aspect shows all of the plant that it sees now at
   16:9. Leaves the camera as it is where the window shows that already. A window of zeros: the whole picture. */
void framing_keep(const struct scene *scene, double aspect, const struct camera_window *window, struct camera *camera);

#endif
