/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fixture for glTF tests: a folder in which a test writes models, and the model that it read last. */
#include "tests/support/gltf_case.h"

#include "tests/support/test.h"

int gltf_case_set_up(void **state)
{
    struct gltf_case *c = mem_new(sizeof(*c));
    c->folder = temp_folder();
    *state = c;
    return 0;
}

static void forget(struct gltf_case *c)
{
    if (c->good)
        gltf_free(&c->model);
    c->good = false;
}

int gltf_case_tear_down(void **state)
{
    struct gltf_case *c = *state;
    forget(c);
    mem_free(c);
    return 0;
}

void gltf_case_read(struct gltf_case *c, const char *path)
{
    struct model_source source;
    forget(c);
    snprintf(c->why, sizeof(c->why), "not refused");
    if (model_source_open(&source, path, c->why)) {
        c->good = gltf_load(&c->model, &source, c->why);
        model_source_finish(&source);
    }
}

void gltf_case_load(struct gltf_case *c, const char *name, const void *bytes, size_t size)
{
    char *path = temp_write(c->folder, name, bytes, size);
    gltf_case_read(c, path);
}

static void release_geometry(void *geometry)
{
    geometry_finish(geometry);
}

const struct geometry *gltf_case_cut(const struct gltf_case *c, const char *nodes, double unit_m, enum axis up)
{
    char why[MODEL_WHY_BYTES];
    struct geometry *g = test_memory(mem_new(sizeof(*g)));
    if (!geometry_cut(g, &c->model, &(struct geometry_params){ .nodes = nodes, .unit_m = unit_m, .up = up }, why))
        fail_msg("%s", why);
    owned_add(release_geometry, g);
    return g;
}

void gltf_case_face_normal(const struct geometry *g, uint32_t triangle, double out[3])
{
    const float *p[3];
    double ab[3], ac[3];
    for (int c = 0; c < 3; c++)
        p[c] = g->positions_m[g->indices[3 * triangle + (uint32_t)c]];
    for (int axis = 0; axis < 3; axis++) {
        ab[axis] = (double)p[1][axis] - (double)p[0][axis];
        ac[axis] = (double)p[2][axis] - (double)p[0][axis];
    }
    for (int axis = 0; axis < 3; axis++)
        out[axis] = ab[(axis + 1) % 3] * ac[(axis + 2) % 3] - ab[(axis + 2) % 3] * ac[(axis + 1) % 3];
}
