/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nearest surface points, and the small transmitters that stand there. */
#include "sensors.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "shape.h"

/* Thermowell, neck and a round connection head; z is out of the surface. */
static void build_thermometer(struct mesh *mesh, struct frame at)
{
    struct profile stem = { 0 };
    profile_edge(&stem, 0.022, -0.02);
    profile_edge(&stem, 0.022, 0.03);
    profile_edge(&stem, 0.012, 0.035);
    profile_edge(&stem, 0.012, 0.14);
    shape_revolve(mesh, at, &stem, 8, 0);
    struct frame head = frame_facing(frame_point(&at, vec(0, 0, 0.18)), at.x, at.z);
    struct profile box = { 0 };
    profile_edge(&box, 0.0, -0.05);
    profile_edge(&box, 0.045, -0.05);
    profile_edge(&box, 0.05, -0.02);
    profile_edge(&box, 0.05, 0.03);
    profile_edge(&box, 0.042, 0.05);
    profile_edge(&box, 0.0, 0.055);
    shape_revolve(mesh, head, &box, 14, 0);
}

/* A pressure transmitter on its impulse tube. */
static void build_transmitter(struct mesh *mesh, struct frame at)
{
    shape_tube(mesh, frame_moved(at, 0, 0, -0.02), 0.012, 0.012, 0.15, 8, 0);
    shape_hexagon(mesh, at, 0.035, 0.13, 0.18);
    struct frame head = frame_facing(frame_point(&at, vec(0, 0, 0.25)), at.x, at.z);
    shape_cylinder(mesh, frame_moved(head, 0, 0, -0.075), 0.058, 0.15, 14, 0);
    shape_tube(mesh, frame_moved(at, 0, 0, 0.17), 0.025, 0.025, 0.05, 8, 0);
}

static void build_accelerometer(struct mesh *mesh, struct frame at)
{
    shape_hexagon(mesh, at, 0.018, -0.004, 0.012);
    shape_cylinder(mesh, frame_moved(at, 0, 0, 0.01), 0.014, 0.035, 10, 0);
    shape_bar(mesh, frame_point(&at, vec(0, 0, 0.04)), frame_point(&at, vec(0.06, 0, 0.075)), 0.004, 5);
}

static void build_instrument(struct mesh *mesh, struct frame at, enum tag_kind kind)
{
    if (kind == TAG_PRESSURE)
        build_transmitter(mesh, at);
    else if (kind == TAG_VIBRATION)
        build_accelerometer(mesh, at);
    else
        build_thermometer(mesh, at);
}

/* One mesh per kind, shared by all nodes. */
static int instrument_mesh(struct model *model, enum tag_kind kind)
{
    static const char *const names[] = { [TAG_TEMPERATURE] = "thermometer", [TAG_WINDING] = "winding thermometer",
                                         [TAG_PRESSURE] = "pressure transmitter",
                                         [TAG_VIBRATION] = "accelerometer" };
    for (size_t i = 0; i < model->mesh_count; i++)
        if (strcmp(model->meshes[i]->name, names[kind]) == 0)
            return (int)i;
    int mesh = model_add_mesh(model, names[kind], MATERIAL_INSTRUMENT);
    build_instrument(&model->meshes[mesh]->mesh, frame_at(0, 0, 0), kind);
    return mesh;
}

static int must_find(const struct model *model, const char *name)
{
    int node = model_find_node(model, name);
    if (node >= 0)
        return node;
    fprintf(stderr, "plantcast-demo: no node %s\n", name);
    abort();
}

static void place(struct model *model, struct tag *tag)
{
    char *part_name = mem_printf("%s %s", tag->asset, tag->part);
    int asset = must_find(model, tag->asset), part = must_find(model, part_name);
    mem_free(part_name);
    struct vec surface = tag->near, normal = vec(0, 0, 1);
    mesh_nearest(&model->meshes[model->nodes[part].mesh]->mesh, tag->near, &surface, &normal);
    tag->position = frame_point(&model->nodes[asset].at, surface);
    if (!tag->node)
        return;
    struct frame at = frame_facing(surface, normal, vec(0, 0, 1));
    char *fittings_name = mem_printf("%s fittings",
                                     tag->asset); /* such an asset keeps its sub-meshes: the instrument becomes part of one */
    int fittings = model_find_node(model, fittings_name), mesh = -1;
    mem_free(fittings_name);
    if (fittings >= 0)
        build_instrument(&model->meshes[model->nodes[fittings].mesh]->mesh, at, tag->kind);
    else
        mesh = instrument_mesh(model, tag->kind);
    model_add_node(model, tag->name, asset, mesh, at);
}

void sensors_place(struct model *model, struct tags *tags)
{
    for (size_t i = 0; i < tags->count; i++)
        place(model, tags->at + i);
}
