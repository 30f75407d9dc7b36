/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of a cmocka test that reads glTF models: a folder for the files, and the model read last. */
#ifndef TESTS_GLTF_CASE_H
#define TESTS_GLTF_CASE_H
#include "preprocess/geometry/geometry.h"

struct gltf_case {
    char *folder;
    struct gltf_model model; /* the model that was read last; valid only if `good` */
    char why[MODEL_WHY_BYTES];
    bool good;
};

/* Set-up and tear-down for cmocka; the state is a struct gltf_case. */
int gltf_case_set_up(void **state);
int gltf_case_tear_down(void **state);
/* Reads the model file at `path` into c->model, which replaces the previous model. If c->good is false afterwards, c->why says
   what is wrong. */
void gltf_case_read(struct gltf_case *c, const char *path);
/* writes the bytes to a file in the folder and reads it */
void gltf_case_load(struct gltf_case *c, const char *name, const void *bytes, size_t size);
/* Cuts the asset of these nodes (NULL: all) from the last model. Returns its geometry, which is freed automatically after the
   test; fails the test if there is none. */
const struct geometry *gltf_case_cut(const struct gltf_case *c, const char *nodes, double unit_m, enum axis up);
/* Writes a vector at right angles to a triangle, towards the side from which its corners run anticlockwise. */
void gltf_case_face_normal(const struct geometry *g, uint32_t triangle, double out[3]);

#endif
