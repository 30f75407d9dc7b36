/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plantcast-demo OUTDIR: writes the demo plant (plant.glb, plant.yaml, tags.csv), the same bytes each time. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "faults.h"
#include "glb.h"
#include "layout.h"
#include "plant_file.h"
#include "sensors.h"

static int report(int status, const char *path)
{
    if (status < 0)
        fprintf(stderr, "plantcast-demo: %s: %s\n", path, strerror(-status));
    return status < 0;
}

static int write_all(const struct model *model, const struct tags *tags, const char *folder)
{
    char *glb = mem_printf("%s/plant.glb", folder), *yaml = mem_printf("%s/plant.yaml", folder), *csv = mem_printf("%s/tags.csv", folder);
    int failed = report(glb_write(model, glb), glb) | report(tag_list_write(tags, csv), csv) | report(plant_file_write(yaml), yaml);
    mem_free(glb);
    mem_free(yaml);
    mem_free(csv);
    return failed;
}

static size_t triangle_count(const struct model *model)
{
    size_t corners = 0;
    for (size_t i = 0; i < model->node_count; i++)
        corners += model->nodes[i].mesh < 0 ? 0 : model->meshes[model->nodes[i].mesh]->mesh.index_count;
    return corners / 3;
}

int main(int argc, char **argv)
{
    if (argc != 2 || argv[1][0] == '-') {
        fprintf(stderr, "usage: plantcast-demo OUTDIR\nwrites plant.glb, plant.yaml and tags.csv\n");
        return 2;
    }
    if (mkdir(argv[1], 0777) != 0 && errno != EEXIST)
        return report(-errno, argv[1]);
    struct site site = { 0 };
    struct tags tags = { 0 };
    tags_make(&tags);
    layout_build(&site);
    faults_apply(&site.model);
    sensors_place(&site.model, &tags);
    int failed = write_all(&site.model, &tags, argv[1]);
    if (!failed)
        printf("plantcast-demo: %s: %d assets, %zu tags, %zu triangles\n", argv[1], layout_asset_count, tags.count,
               triangle_count(&site.model));
    tags_finish(&tags);
    model_finish(&site.model);
    return failed;
}
