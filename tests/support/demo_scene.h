/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The prepared demo plant with a field and a renderer, for benchmarks. */
#ifndef TESTS_DEMO_SCENE_H
#define TESTS_DEMO_SCENE_H
#include "base/mem.h"
#include "render/renderer.h"
#include "scene/scene_create.h"

#define DEMO_SCENE_PLANT "build/demo/plant.yaml"

struct demo_scene {
    struct log *log;
    struct plant *plant;
    struct scene *scene;
    struct workers *workers;
    struct field *field;
    struct snapshot *snapshot; /* all readings are zero */
    struct gl *gl;
    struct renderer *renderer;
};

/* Opens the demo plant. Returns false if it is not prepared (make demo) or no renderer can be made. Call demo_scene_close() in
   both cases. */
static inline bool demo_scene_open(struct demo_scene *demo)
{
    struct diag diag = { 0 };
    demo->log = log_create(LOG_ERROR);
    demo->plant = plant_load(DEMO_SCENE_PLANT, &diag);
    diag_finish(&diag);
    if (!demo->plant)
        return false;
    char *folder = plant_prepared_folder(demo->plant);
    demo->scene = scene_create(demo->log, demo->plant, folder);
    mem_free(folder);
    if (!demo->scene)
        return false;
    demo->snapshot = snapshot_create(demo->plant->tag_count);
    demo->workers = workers_create(0);
    demo->field = field_create(demo->workers, demo->scene);
    demo->gl = gl_create(demo->log, GL_AUTO, NULL);
    if (demo->gl)
        demo->renderer = renderer_create(demo->log, demo->gl, demo->scene, demo->field);
    return demo->renderer != NULL;
}

static inline void demo_scene_close(struct demo_scene *demo)
{
    renderer_destroy(&demo->renderer);
    gl_destroy(&demo->gl);
    field_destroy(&demo->field);
    workers_destroy(&demo->workers);
    snapshot_destroy(&demo->snapshot);
    scene_destroy(&demo->scene);
    plant_destroy(&demo->plant);
    log_destroy(&demo->log);
}

#endif
