/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fixture for glTF tests: a folder in which a test writes models, and the model that it read last. */
#include "tests/support/gltf_case.h"

#include <stdio.h>

#include "base/mem.h"
#include "tests/support/temp.h"

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
