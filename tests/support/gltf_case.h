/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One test's folder for models, and the model that was last read from it. */
#ifndef TESTS_GLTF_CASE_H
#define TESTS_GLTF_CASE_H
#include "preprocess/geometry/geometry.h"

struct gltf_case {
    char *folder;
    struct gltf_model model; /* where good */
    char why[MODEL_WHY_BYTES];
    bool good;
};

/* For cmocka: the state is a struct gltf_case. */
int gltf_case_set_up(void **state);
int gltf_case_tear_down(void **state);
/* In place of what was read before; why says what is wrong where it is not good. */
void gltf_case_read(struct gltf_case *c, const char *path);
void gltf_case_load(struct gltf_case *c, const char *name, const void *bytes, size_t size); /* from a file of the folder, written for it */

#endif
