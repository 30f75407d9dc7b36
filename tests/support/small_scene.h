/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scene in static memory, made without files, for tests of messages about a scene: two assets, two groups, three tags and one
   source. */
#ifndef TESTS_SMALL_SCENE_H
#define TESTS_SMALL_SCENE_H
#include "scene/scene.h"

const struct scene *small_scene(void);

#endif
