/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two assets, two groups, three tags and one source in static memory, without any file: for tests of messages about a scene. */
#ifndef TESTS_SMALL_SCENE_H
#define TESTS_SMALL_SCENE_H
#include "scene/scene.h"

const struct scene *small_scene(void);

#endif
