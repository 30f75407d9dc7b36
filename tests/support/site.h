/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A whole plant from its file, prepared, on a renderer, with random readings. */
#ifndef TESTS_SUPPORT_SITE_H
#define TESTS_SUPPORT_SITE_H
#include "tests/support/rig.h"

#define SITE_DEMO "build/demo/plant.yaml" /* `make demo` has prepared it */

struct site {
    struct rig *rig;
    struct plant *plant;
    struct scene *scene;
    struct field *field;
    struct renderer *renderer;
    struct snapshot *snapshot;
    uint64_t random;
};

bool site_is_there(const char *model); /* in ../shared/data/models */
/* name: of the folder that it is prepared into, once for all who run at a time; NULL: it is prepared already. False: failed. */
bool site_init(struct site *site, struct rig *rig, const char *path, const char *name);
void site_finish(struct site *site);
/* The camera: from a random side of a random asset with a field; `away` times as far as it is large. */
void site_look_at_some(struct site *site, double away, struct view *view);

#endif
