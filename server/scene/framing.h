/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Camera framings of the plant, an asset or a sensor. Call from any thread. */
#ifndef SCENE_FRAMING_H
#define SCENE_FRAMING_H
#include "scene/scene.h"

/* Side from which the camera looks. Front is south, left is west (in a Z-up frame x points east and y north; in a Y-up frame x points east
 * and z south). */
enum side { SIDE_NOW, SIDE_TOP, SIDE_BOTTOM, SIDE_FRONT, SIDE_BACK, SIDE_LEFT, SIDE_RIGHT, SIDE_ISO };

struct framing {
    /* asset: index of the asset to show; tag: index of the tag whose sensor to show; -1: none; both -1: the whole plant */
    int asset, tag;
    enum side side;              /* side from which to look. SIDE_NOW: as the camera looks now, but at a sensor from outside its asset */
    /* rectangle of the picture that the subject (plant, asset or sensor) is to fill; coordinates from -1 to 1 along each axis;
       all zero: the whole picture */
    struct camera_window window;
};

/* Looks up a name: first as an asset, then as a tag on an asset. NULL means the whole plant. Sets every member of the framing.
   Returns false if there is no such name. */
bool framing_find(const struct plant *plant, const char *name, struct framing *framing);
/* Moves the camera to show the framing's subject completely; keeps its lens. */
void framing_look(const struct scene *scene, const struct framing *framing, double aspect, struct camera *camera);
/* Moves a perspective camera, without turning it, until `window` shows everything of the plant that the camera would see in a
   picture with the aspect ratio 16:9. `aspect`: that of the actual picture. Does nothing if the window already shows all that.
   window all zero: the whole picture. */
void framing_keep(const struct scene *scene, double aspect, const struct camera_window *window, struct camera *camera);

#endif
