/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads whole plants from files. */
#include "tests/support/site.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/mem.h"
#include "scene/scene_create.h"
#include "tests/support/owned.h"
#include "tests/support/synthetic.h"
#include "tests/support/whole_field.h"

bool site_is_there(const char *model)
{
    return access(test_printf("../shared/data/models/%s", model), R_OK) == 0;
}

static bool prepare(const char *plant, const char *folder)
{
    const char *programs = getenv("PLANTCAST_BIN");
    char *command = test_printf("mkdir -p '%s' && '%s/plantcast-prep' %s --output '%s' >/dev/null 2>&1", folder,
                               programs ? programs : "build", plant, folder);
    int status = system(command);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

static char *prepared(const char *path, const char *name)
{
    const char *out = getenv("PLANTCAST_OUT");
    if (!name)
        return mem_printf("%.*s.prepared", (int)(strrchr(path, '.') - path), path);
    char *folder = mem_printf("%s/prepared/%s", out ? out : "build/release", name);
    if (!prepare(path, folder)) {
        mem_free(folder);
        folder = NULL;
    }
    return folder;
}

/* Gives each tag a random reading within the range of its group. */
static void fill(struct site *site)
{
    for (size_t i = 0; i < site->plant->tag_count; i++) {
        const struct plant_tag *tag = &site->plant->tags[i];
        if (tag->group < 0)
            continue;
        const struct plant_group *group = &site->plant->groups[tag->group];
        site->snapshot->readings[i] =
            (struct reading){ .value = group->min + (group->max - group->min) * synthetic_random_unit(&site->random) };
    }
}

bool site_init(struct site *site, struct rig *rig, const char *path, const char *name)
{
    struct diag diag = { 0 };
    char *folder = prepared(path, name);
    *site = (struct site){ .rig = rig, .plant = plant_load(path, &diag), .random = 1 };
    diag_print(&diag, stderr);
    diag_finish(&diag);
    site->scene = folder && site->plant ? scene_create(rig->log, site->plant, folder) : NULL;
    mem_free(folder);
    if (!site->scene)
        return false;
    site->field = field_create(rig->workers, site->scene);
    site->renderer = renderer_create(rig->log, rig->gl, site->scene, site->field);
    site->snapshot = snapshot_create(site->plant->tag_count);
    fill(site);
    return site->renderer != NULL;
}

void site_finish(struct site *site)
{
    renderer_destroy(&site->renderer);
    field_destroy(&site->field);
    snapshot_destroy(&site->snapshot);
    scene_destroy(&site->scene);
    plant_destroy(&site->plant);
}

void site_look_at_some(struct site *site, double away, struct view *view)
{
    const struct scene_asset *asset;
    do
        asset = &site->scene->assets[synthetic_random(&site->random) % site->scene->asset_count];
    while (!field_scalars(site->field, (int)(asset - site->scene->assets), &view->field, site->snapshot));
    double size = 0, turn = 6.283 * synthetic_random_unit(&site->random), height = 0.2 + 0.8 * synthetic_random_unit(&site->random);
    for (int c = 0; c < 3; c++) {
        view->camera.target_m[c] = 0.5 * (asset->bounds_min_m[c] + asset->bounds_max_m[c]);
        size = fmax(size, asset->bounds_max_m[c] - asset->bounds_min_m[c]);
    }
    view->camera.eye_m[0] = view->camera.target_m[0] + away * size * cos(turn);
    view->camera.eye_m[1] = view->camera.target_m[1] + away * size * sin(turn);
    view->camera.eye_m[2] = view->camera.target_m[2] + away * size * height;
}
