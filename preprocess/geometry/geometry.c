/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cuts an asset's mesh out of a model. */
#include "preprocess/geometry/geometry.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/math/search.h"
#include "base/mem.h"
#include "plant/models/nodes.h"
#include "plant/models/transform.h"
#include "preprocess/geometry/geometry_impl.h"

#define MAX_TRIANGLES 50000000ull /* maximum number of triangles of an asset */
#define MAX_SIZE_M 1e7
/* Size in metres of a model above which an asset's origin is the median of its vertices: at the far ends of such a model,
   single-precision positions would be accurate to only half a millimetre. */
#define COARSE_SIZE_M 1e4
/* If a sensor names several nodes, its position counts as unambiguous as long as the nodes are at most this far apart along
   each axis, metres. */
#define SAME_PLACE_M 1e-3
#define SHOWN_NODES 6
/* smallest accepted size of a model in metres: a smaller one certainly has the wrong unit, and fourth powers of its lengths
   would underflow */
#define MIN_SIZE_M 1e-6

/* --- selecting nodes ----------------------------------------------------------------------------------------------------- */

/* Converts a model's nodes to the form that node patterns are matched against. The caller frees the array with mem_free. */
static struct model_node *nodes_of(const struct gltf_model *model)
{
    struct model_node *nodes = mem_array(model->node_count, sizeof(*nodes));
    for (uint32_t i = 0; i < model->node_count; i++) {
        const struct gltf_node *node = &model->nodes[i];
        bool instanced = node->mesh < 0 && i + 1 < node->end && node[1].number == node->number;
        int mesh = instanced ? node[1].mesh : node->mesh;
        nodes[i] = (struct model_node){ .name = node->name,
                                        .mesh = mesh >= 0 && model->meshes[mesh].name ? model->meshes[mesh].name : "",
                                        .parent = node->parent,
                                        .end = node->end,
                                        .number = node->number };
    }
    return nodes;
}

/* Returns an array that says for each node of the model whether it belongs to the asset; the caller frees it with mem_free.
 * Returns NULL with the reason in why if a pattern matches no node. */
static bool *taken_nodes(const struct gltf_model *model, const char *patterns, char *why)
{
    struct model_node *nodes = nodes_of(model);
    bool *taken = mem_array(model->node_count + 1u, sizeof(*taken));
    if (!nodes_take(patterns, nodes, model->node_count, taken, why, MODEL_WHY_BYTES)) {
        mem_free(taken);
        taken = NULL;
    }
    mem_free(nodes);
    return taken;
}

static int by_material(const void *a, const void *b)
{
    const struct node_primitive *p = a, *q = b;
    if (p->blend != q->blend)
        return p->blend - q->blend;
    if (p->primitive->material != q->primitive->material)
        return p->primitive->material < q->primitive->material ? -1 : 1;
    return p->order < q->order ? -1 : 1;
}

static void add_parts(struct node_primitives *parts, struct geometry *geometry, const struct gltf_model *model,
                      const struct gltf_node *node)
{
    const struct gltf_mesh *mesh = &model->meshes[node->mesh];
    geometry->skipped_lines += mesh->skipped_lines;
    geometry->skipped_points += mesh->skipped_points;
    for (uint32_t i = 0; i < mesh->primitive_count; i++) {
        const struct gltf_primitive *primitive = &model->primitives[mesh->first_primitive + i];
        bool blend = primitive->material >= 0 && model->materials[primitive->material].alpha == ASSET_ALPHA_BLEND;
        mem_grow(&parts->at, &parts->capacity, parts->count + 1, sizeof(*parts->at));
        parts->at[parts->count] =
            (struct node_primitive){ .node = node, .primitive = primitive, .order = (uint32_t)parts->count, .blend = blend };
        parts->count++;
    }
}

static bool no_triangles(const struct geometry *geometry, const char *pattern, char *why)
{
    return wrong(why, "%s%.120s%s has no triangles to show, only %u line primitives and %u point primitives", pattern ? "'" : "the model",
                 pattern ? pattern : "", pattern ? "'" : "", geometry->skipped_lines, geometry->skipped_points);
}

static uint64_t count_triangles(const struct gltf_model *model, const bool *taken)
{
    uint64_t corners = 0;
    for (uint32_t i = 0; i < model->node_count; i++)
        corners += taken[i] && model->nodes[i].mesh >= 0 ? model->meshes[model->nodes[i].mesh].index_count : 0;
    return corners / 3;
}

uint64_t geometry_triangles(const struct gltf_model *model, const struct geometry_params *params)
{
    char why[MODEL_WHY_BYTES];
    bool *taken = taken_nodes(model, params->nodes, why);
    uint64_t triangles = taken ? count_triangles(model, taken) : 0;
    mem_free(taken);
    return triangles;
}

bool node_primitives_find(struct node_primitives *parts, struct geometry *geometry, const struct gltf_model *model,
                          const struct geometry_params *params, char *why)
{
    bool *taken = taken_nodes(model, params->nodes, why);
    if (!taken)
        return false;
    uint64_t triangles = count_triangles(model, taken);
    for (uint32_t i = 0; i < model->node_count && triangles <= MAX_TRIANGLES; i++) {
        geometry->node_count += taken[i];
        if (taken[i] && model->nodes[i].mesh >= 0)
            add_parts(parts, geometry, model, &model->nodes[i]);
    }
    mem_free(taken);
    if (triangles > MAX_TRIANGLES)
        return wrong(why, "the asset has %llu triangles; at most %llu are possible: split the asset, or export the model coarser",
                     (unsigned long long)triangles, MAX_TRIANGLES);
    if (geometry->node_count == 0)
        return wrong(why, model->node_count ? "the asset's patterns (`nodes`) exclude every node of the model"
                                            : "the glTF model's scene has no nodes, so there is nothing to show");
    if (triangles == 0)
        return no_triangles(geometry, params->nodes, why);
    qsort(parts->at, parts->count, sizeof(*parts->at), by_material);
    return true;
}

/* --- boxes --------------------------------------------------------------------------------------------------------------- */

struct node_box {
    double low[3], high[3];
};

static const struct node_box empty_box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };

static void box_add_primitive(struct node_box *box, const struct gltf_primitive *primitive, const double world[16])
{
    /* All vertices count for the bounding box: the glTF reader has already removed those that no triangle uses. */
    for (uint32_t i = 0; i < primitive->vertex_count; i++) {
        const float *p = primitive->positions[i];
        double q[3];
        transform_point(world, (const double[3]){ (double)p[0], (double)p[1], (double)p[2] }, q);
        for (int axis = 0; axis < 3; axis++) {
            box->low[axis] = fmin(box->low[axis], q[axis]);
            box->high[axis] = fmax(box->high[axis], q[axis]);
        }
    }
}

/* Computes the median of the asset's vertices. The median becomes the asset's origin, so that a stray vertex far away does not
 * cost precision where most of the asset is. */
static void median_of(const struct node_primitives *parts, const struct geometry_params *params, double median_m[3])
{
    size_t count = 0, at = 0;
    for (size_t i = 0; i < parts->count; i++)
        count += parts->at[i].primitive->vertex_count;
    double *places = mem_array(3 * count, sizeof(*places));
    for (size_t i = 0; i < parts->count; i++) {
        double world[16], place[3];
        primitive_world(params, parts->at[i].node, world);
        for (uint32_t v = 0; v < parts->at[i].primitive->vertex_count; v++, at++) {
            const float *p = parts->at[i].primitive->positions[v];
            transform_point(world, (const double[3]){ (double)p[0], (double)p[1], (double)p[2] }, place);
            for (int axis = 0; axis < 3; axis++)
                places[(size_t)axis * count + at] = place[axis];
        }
    }
    for (size_t axis = 0; axis < 3; axis++) {
        qsort(places + axis * count, count, sizeof(*places), compare_doubles);
        median_m[axis] = places[axis * count + count / 2];
    }
    mem_free(places);
}

static bool find_origin(struct geometry *geometry, const struct node_primitives *parts, const struct geometry_params *params, char *why)
{
    struct node_box box = empty_box;
    for (size_t i = 0; i < parts->count; i++) {
        double world[16];
        primitive_world(params, parts->at[i].node, world);
        box_add_primitive(&box, parts->at[i].primitive, world);
    }
    double size_m = 0;
    for (int axis = 0; axis < 3; axis++) {
        double side_m = box.high[axis] - box.low[axis];
        geometry->origin_m[axis] = (box.low[axis] + box.high[axis]) / 2;
        size_m = fmax(size_m, side_m);
        if (!isfinite(geometry->origin_m[axis]) || side_m > MAX_SIZE_M)
            return wrong(why, "the asset extends %g m along axis %d, more than the maximum of %g m: check the model's "
                              "unit", side_m, axis, MAX_SIZE_M);
    }
    if (size_m > COARSE_SIZE_M)
        median_of(parts, params, geometry->origin_m);
    return size_m >= MIN_SIZE_M ||
           wrong(why, "the asset is only %g m in size, less than the minimum of %g m: check the model's unit", size_m, MIN_SIZE_M);
}

double (*geometry_node_boxes(const struct gltf_model *model, const struct geometry_params *params))[2][3]
{
    struct node_box *boxes = mem_array(model->node_count, sizeof(*boxes));
    for (uint32_t i = model->node_count; i-- > 0;) {
        const struct gltf_node *node = &model->nodes[i];
        struct node_box own = empty_box;
        double world[16];
        primitive_world(params, node, world);
        for (uint32_t p = 0; node->mesh >= 0 && p < model->meshes[node->mesh].primitive_count; p++)
            box_add_primitive(&own, &model->primitives[model->meshes[node->mesh].first_primitive + p], world);
        for (uint32_t child = i + 1; child < node->end; child = model->nodes[child].end)
            for (int axis = 0; axis < 3; axis++) {
                own.low[axis] = fmin(own.low[axis], boxes[child].low[axis]);
                own.high[axis] = fmax(own.high[axis], boxes[child].high[axis]);
            }
        boxes[i] = own;
    }
    return (double(*)[2][3])boxes;
}

static void place_of_node(const struct gltf_model *model, const struct geometry_params *params, uint32_t found, double place_m[3])
{
    struct node_box box = empty_box;
    double world[16];
    for (uint32_t i = found; i < model->nodes[found].end; i++) {
        const struct gltf_node *node = &model->nodes[i];
        primitive_world(params, node, world);
        for (uint32_t p = 0; node->mesh >= 0 && p < model->meshes[node->mesh].primitive_count; p++)
            box_add_primitive(&box, &model->primitives[model->meshes[node->mesh].first_primitive + p], world);
    }
    primitive_world(params, &model->nodes[found], world);
    for (int axis = 0; axis < 3; axis++)
        place_m[axis] = box.low[axis] <= box.high[axis] ? (box.low[axis] + box.high[axis]) / 2 : world[12 + axis];
}

static bool several_places(const struct gltf_model *model, const char *pattern, const uint32_t *found, size_t count, char *why)
{
    char numbers[120] = "";
    for (size_t i = 0, length = 0; i < count && i < SHOWN_NODES; i++)
        length += (size_t)snprintf(numbers + length, sizeof(numbers) - length, "%s#%u", i ? ", " : "", model->nodes[found[i]].number);
    return wrong(why, "the model has %zu nodes named '%.200s' at different places (%s%s): select one node by its number or path", count,
                 pattern, numbers, count > SHOWN_NODES ? ", ..." : "");
}

/* Removes the nodes outside the sensor's asset from the nodes found for a sensor, unless all are outside. */
static size_t prefer_own(const struct gltf_model *model, const struct geometry_params *params, uint32_t *found, size_t count)
{
    char why[MODEL_WHY_BYTES];
    bool *taken = count > 1 ? taken_nodes(model, params->nodes, why) : NULL;
    size_t own = 0;
    for (size_t i = 0; taken && i < count; i++)
        own += taken[found[i]];
    for (size_t i = 0, next = 0; own > 0 && i < count; i++)
        if (taken[found[i]])
            found[next++] = found[i];
    mem_free(taken);
    return own > 0 ? own : count;
}

static bool middle_of_asset(const struct gltf_model *model, const struct geometry_params *params, double place_m[3],
                            char why[MODEL_WHY_BYTES])
{
    struct node_box box = empty_box;
    bool *taken = taken_nodes(model, params->nodes, why);
    for (uint32_t i = 0; taken && i < model->node_count; i++) {
        const struct gltf_node *node = &model->nodes[i];
        double world[16];
        primitive_world(params, node, world);
        for (uint32_t p = 0; taken[i] && node->mesh >= 0 && p < model->meshes[node->mesh].primitive_count; p++)
            box_add_primitive(&box, &model->primitives[model->meshes[node->mesh].first_primitive + p], world);
    }
    for (int axis = 0; axis < 3; axis++)
        place_m[axis] = box.low[axis] <= box.high[axis] ? (box.low[axis] + box.high[axis]) / 2 : 0;
    bool good = taken != NULL;
    mem_free(taken);
    return good;
}

bool geometry_node_place(const struct gltf_model *model, const struct geometry_params *params, const char *pattern, double place_m[3],
                         char why[MODEL_WHY_BYTES])
{
    if (!*pattern)
        return middle_of_asset(model, params, place_m, why);
    struct model_node *nodes = nodes_of(model);
    uint32_t *found = mem_array(model->node_count, sizeof(*found));
    size_t count = nodes_find(pattern, nodes, model->node_count, found, why, MODEL_WHY_BYTES);
    bool good = count > 0;
    count = prefer_own(model, params, found, count);
    if (good)
        place_of_node(model, params, found[0], place_m);
    for (size_t i = 1; good && i < count; i++) {
        double other_m[3];
        place_of_node(model, params, found[i], other_m);
        for (int axis = 0; good && axis < 3; axis++)
            if (!(fabs(other_m[axis] - place_m[axis]) <= SAME_PLACE_M))
                good = several_places(model, pattern, found, count, why);
    }
    mem_free(found);
    mem_free(nodes);
    return good;
}

/* --- joining primitives ---------------------------------------------------------------------------------------------------- */

/* state while a geometry's arrays are filled: number of elements that fit into each array, and whether any primitive has
   texture coordinates or colours */
struct geometry_room {
    size_t positions, normals, texcoords, second_texcoords, colors, indices, primitives;
    float (*all_texcoords)[2], (*all_second_texcoords)[2];
    uint8_t (*all_colors)[4];
    bool any_texcoords, any_second_texcoords, any_colors;
};

static uint32_t add_name(struct geometry *geometry, const char *name)
{
    uint32_t at = (uint32_t)geometry->names.length;
    text_add_bytes(&geometry->names, name, strlen(name) + 1);
    return at;
}

static void append(struct geometry *geometry, struct geometry_room *room, const struct primitive_mesh *mesh,
                   const struct node_primitive *part, uint32_t material, uint32_t name)
{
    size_t vertices = geometry->vertex_count + mesh->vertex_count;
    mem_grow(&geometry->positions_m, &room->positions, vertices, sizeof(*geometry->positions_m));
    mem_grow(&geometry->normals, &room->normals, vertices, sizeof(*geometry->normals));
    mem_grow(&room->all_texcoords, &room->texcoords, vertices, sizeof(*room->all_texcoords));
    mem_grow(&room->all_second_texcoords, &room->second_texcoords, vertices, sizeof(*room->all_second_texcoords));
    mem_grow(&room->all_colors, &room->colors, vertices, sizeof(*room->all_colors));
    mem_grow(&geometry->indices, &room->indices, geometry->index_count + mesh->index_count, sizeof(*geometry->indices));
    mem_grow(&geometry->primitives, &room->primitives, geometry->primitive_count + 1u, sizeof(*geometry->primitives));
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const struct geometry_vertex *v = &mesh->vertices[i];
        size_t at = geometry->vertex_count + i;
        memcpy(geometry->positions_m[at], v->position, sizeof(v->position));
        memcpy(geometry->normals[at], v->normal, sizeof(v->normal));
        memcpy(room->all_texcoords[at], v->texcoord, sizeof(v->texcoord));
        memcpy(room->all_second_texcoords[at], v->second_texcoord, sizeof(v->second_texcoord));
        memcpy(room->all_colors[at], v->color, sizeof(v->color));
    }
    for (size_t i = 0; i < mesh->index_count; i++)
        geometry->indices[geometry->index_count + i] = geometry->vertex_count + mesh->indices[i];
    geometry->primitives[geometry->primitive_count++] = (struct asset_primitive){
        .first_index = geometry->index_count, .index_count = (uint32_t)mesh->index_count, .material = material, .name = name
    };
    geometry->vertex_count = (uint32_t)vertices;
    geometry->index_count += (uint32_t)mesh->index_count;
    room->any_texcoords |= part->primitive->texcoords != NULL;
    room->any_second_texcoords |= part->primitive->second_texcoords != NULL;
    room->any_colors |= part->primitive->colors != NULL;
}

/* Material for models without materials: grey and double-sided, because the faces' orientation is not reliable. */
static const struct asset_material plain_material = {
    .base_color = { 0.6f, 0.62f, 0.64f, 1 },
    .roughness = 0.6f,
    .normal_scale = 1,
    .occlusion_strength = 1,
    .alpha_cutoff = 0.5f,
    .base_color_texture = ASSET_NO_TEXTURE,
    .metallic_roughness_texture = ASSET_NO_TEXTURE,
    .normal_texture = ASSET_NO_TEXTURE,
    .occlusion_texture = ASSET_NO_TEXTURE,
    .emissive_texture = ASSET_NO_TEXTURE,
    .double_sided = 1,
};

/* Returns the index of a model's material in the asset, adding the material if it is new. Primitives are sorted by material, so
 * only the material added last needs to be compared. */
static uint32_t material_number(struct geometry *geometry, const struct gltf_model *model, int material, int *last)
{
    if (geometry->material_count && *last == material)
        return geometry->material_count - 1;
    struct asset_material *to = &geometry->materials[geometry->material_count];
    *to = material < 0 ? plain_material : model->materials[material];
    to->name = add_name(geometry, material < 0 ? "" : model->material_names[material]);
    *last = material;
    return geometry->material_count++;
}

static void *kept_if(bool wanted, void *array)
{
    if (!wanted)
        mem_free(array);
    return wanted ? array : NULL;
}

static bool join_parts(struct geometry *geometry, const struct node_primitives *parts, const struct gltf_model *model,
                       const struct geometry_params *params, char *why)
{
    struct geometry_room room = { 0 };
    const struct gltf_node *named = NULL;
    uint32_t name = 0;
    int last = -2;
    bool good = true;
    geometry->materials = mem_array(model->material_count + 1u, sizeof(*geometry->materials));
    for (size_t i = 0; good && i < parts->count; i++) {
        const struct node_primitive *part = &parts->at[i];
        struct primitive_mesh mesh = { 0 };
        good = primitive_mesh(&mesh, part, params, geometry);
        if (good && mesh.index_count) {
            uint32_t material = material_number(geometry, model, part->primitive->material, &last);
            if (named != part->node)
                name = add_name(geometry, part->node->name);
            named = part->node;
            append(geometry, &room, &mesh, part, material, name);
        }
        primitive_mesh_finish(&mesh);
    }
    if (!good)
        wrong(why, "out of memory");
    else if (geometry->index_count == 0)
        good = wrong(why, "none of the asset's %u triangles has an area, so there is nothing to show", geometry->degenerate_triangles);
    geometry->texcoords = kept_if(room.any_texcoords, room.all_texcoords);
    geometry->second_texcoords = kept_if(room.any_second_texcoords, room.all_second_texcoords);
    geometry->colors = kept_if(room.any_colors, room.all_colors);
    return good;
}

bool geometry_cut(struct geometry *geometry, const struct gltf_model *model, const struct geometry_params *params,
                  char why[MODEL_WHY_BYTES])
{
    struct node_primitives parts = { 0 };
    *geometry = (struct geometry){ 0 };
    bool good = node_primitives_find(&parts, geometry, model, params, why) && find_origin(geometry, &parts, params, why) &&
                join_parts(geometry, &parts, model, params, why) && geometry_join_textures(geometry, model, why);
    mem_free(parts.at);
    if (!good)
        geometry_finish(geometry);
    return good;
}

void geometry_finish(struct geometry *geometry)
{
    mem_free(geometry->positions_m);
    mem_free(geometry->normals);
    mem_free(geometry->texcoords);
    mem_free(geometry->second_texcoords);
    mem_free(geometry->colors);
    mem_free(geometry->indices);
    mem_free(geometry->primitives);
    mem_free(geometry->materials);
    mem_free(geometry->textures);
    mem_free(geometry->texels);
    text_finish(&geometry->names);
    *geometry = (struct geometry){ 0 };
}
