/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A prepared plant loaded from its file, with a renderer and random readings. */
#ifndef TESTS_SUPPORT_SITE_H
#define TESTS_SUPPORT_SITE_H
#include "tests/support/rig.h"

#define SITE_DEMO "build/demo/plant.yaml" /* plant file of the demo, which `make demo` prepares */

struct site {
    struct rig *rig;
    struct plant *plant;
    struct scene *scene;
    struct field *field;
    struct renderer *renderer;
    struct snapshot *snapshot;
    uint64_t random;
};

bool site_is_there(const char *model); /* returns whether ../shared/data/models has the model */
/* Loads a plant. name: folder into which the plant is first prepared, once for all programs that run at the same time; NULL:
   the plant is already prepared. Returns false on failure. */
bool site_init(struct site *site, struct rig *rig, const char *path, const char *name);
void site_finish(struct site *site);
/* Places the camera on a random side of a random asset that has a field, at a distance of `away` times the asset's size. */
void site_look_at_some(struct site *site, double away, struct view *view);

#endif
