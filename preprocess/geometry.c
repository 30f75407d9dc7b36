/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cutting an asset out of a model. */
#include "preprocess/geometry.h"

#include <fnmatch.h>
#include <math.h>
#include <meshoptimizer.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "plant/transform.h"
#include "preprocess/image_shim.h"
#include "preprocess/normals.h"

#define TEXTURE_MAX_PX 2048u
#define MAX_CORNERS 1200000000ull /* indices of one asset */

static bool wrong(char *why, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
static bool wrong(char *why, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(why, MODEL_WHY_BYTES, fmt, ap);
    va_end(ap);
    return false;
}

/* --- which nodes --------------------------------------------------------------------------------------------------------- */

/* Model units and axes to metres and Z up: (x, y, z) of a Y-up model is (x, -z, y). */
static void frame_of(const struct geometry_params *params, double out[16])
{
    double u = params->unit_m;
    memcpy(out, transform_identity, 16 * sizeof(*out));
    out[0] = out[5] = out[10] = u;
    if (params->up == AXIS_Y) {
        out[5] = out[10] = 0;
        out[6] = u;
        out[9] = -u;
    }
}

static void world_of(const struct geometry_params *params, const struct gltf_node *node, double out[16])
{
    double frame[16];
    frame_of(params, frame);
    transform_multiply(frame, node->world, out);
}

static bool node_matches(const struct geometry_params *params, const struct gltf_node *node)
{
    return !params->nodes || fnmatch(params->nodes, node->name, 0) == 0;
}

struct part { /* one primitive under one node */
    const struct gltf_node *node;
    const struct gltf_primitive *primitive;
    uint32_t order;
    bool blend;
};

static int by_material(const void *a, const void *b)
{
    const struct part *p = a, *q = b;
    if (p->blend != q->blend)
        return p->blend - q->blend;
    if (p->primitive->material != q->primitive->material)
        return p->primitive->material < q->primitive->material ? -1 : 1;
    return p->order < q->order ? -1 : 1;
}

struct parts {
    struct part *at;
    size_t count, capacity;
    uint32_t node_count;
};

static void add_parts(struct parts *parts, const struct gltf_model *model, const struct gltf_node *node)
{
    const struct gltf_mesh *mesh = &model->meshes[node->mesh];
    for (uint32_t i = 0; i < mesh->primitive_count; i++) {
        const struct gltf_primitive *primitive = &model->primitives[mesh->first_primitive + i];
        bool blend = primitive->material >= 0 && model->materials[primitive->material].alpha == ASSET_ALPHA_BLEND;
        mem_grow(&parts->at, &parts->capacity, parts->count + 1, sizeof(*parts->at));
        parts->at[parts->count] = (struct part){ .node = node, .primitive = primitive, .order = (uint32_t)parts->count, .blend = blend };
        parts->count++;
    }
}

/* A node that matches brings its whole sub-tree, once. Sorted by material, blended ones last. */
static bool find_parts(struct parts *parts, const struct gltf_model *model, const struct geometry_params *params, char *why)
{
    for (uint32_t i = 0; i < model->node_count;) {
        if (!node_matches(params, &model->nodes[i])) {
            i++;
            continue;
        }
        for (uint32_t end = model->nodes[i].end; i < end; i++) {
            parts->node_count++;
            if (model->nodes[i].mesh >= 0)
                add_parts(parts, model, &model->nodes[i]);
        }
    }
    if (parts->node_count == 0)
        return params->nodes ? wrong(why, "no node's name matches '%s'", params->nodes) : wrong(why, "the scene has no node");
    uint64_t corners = 0;
    for (size_t i = 0; i < parts->count; i++)
        corners += parts->at[i].primitive->index_count;
    if (corners == 0)
        return wrong(why, "%s%s%s has no triangles", params->nodes ? "'" : "the model", params->nodes ? params->nodes : "",
                     params->nodes ? "'" : "");
    if (corners > MAX_CORNERS)
        return wrong(why, "%llu triangles are more than %llu", (unsigned long long)(corners / 3), MAX_CORNERS / 3);
    qsort(parts->at, parts->count, sizeof(*parts->at), by_material);
    return true;
}

/* --- boxes --------------------------------------------------------------------------------------------------------------- */

struct box {
    double low[3], high[3];
};

static const struct box empty_box = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };

static void box_add_primitive(struct box *box, const struct gltf_primitive *primitive, const double world[16])
{
    for (uint32_t i = 0; i < primitive->index_count; i++) {
        const float *p = primitive->positions[primitive->indices[i]];
        double q[3];
        transform_point(world, (const double[3]){ (double)p[0], (double)p[1], (double)p[2] }, q);
        for (int axis = 0; axis < 3; axis++) {
            box->low[axis] = fmin(box->low[axis], q[axis]);
            box->high[axis] = fmax(box->high[axis], q[axis]);
        }
    }
}

static bool find_origin(struct geometry *geometry, const struct parts *parts, const struct geometry_params *params, char *why)
{
    struct box box = empty_box;
    for (size_t i = 0; i < parts->count; i++) {
        double world[16];
        world_of(params, parts->at[i].node, world);
        box_add_primitive(&box, parts->at[i].primitive, world);
    }
    for (int axis = 0; axis < 3; axis++) {
        geometry->origin_m[axis] = (box.low[axis] + box.high[axis]) / 2;
        if (!isfinite(geometry->origin_m[axis]) || box.high[axis] - box.low[axis] > 1e7)
            return wrong(why, "its size is %g m along axis %d", box.high[axis] - box.low[axis], axis);
    }
    return true;
}

bool geometry_node_place(const struct gltf_model *model, const struct geometry_params *params, const char *name, double place_m[3])
{
    uint32_t inside_end = 0;
    const struct gltf_node *found = NULL;
    bool found_inside = false;
    for (uint32_t i = 0; i < model->node_count; i++) {
        const struct gltf_node *node = &model->nodes[i];
        if (node_matches(params, node) && node->end > inside_end)
            inside_end = node->end;
        bool inside = i < inside_end;
        if (strcmp(node->name, name) == 0 && (!found || (inside && !found_inside))) {
            found = node;
            found_inside = inside;
        }
    }
    if (!found)
        return false;
    struct box box = empty_box;
    for (uint32_t i = (uint32_t)(found - model->nodes); i < found->end; i++) {
        const struct gltf_node *node = &model->nodes[i];
        double world[16];
        world_of(params, node, world);
        for (uint32_t p = 0; node->mesh >= 0 && p < model->meshes[node->mesh].primitive_count; p++)
            box_add_primitive(&box, &model->primitives[model->meshes[node->mesh].first_primitive + p], world);
    }
    double world[16];
    world_of(params, found, world);
    for (int axis = 0; axis < 3; axis++)
        place_m[axis] = box.low[axis] <= box.high[axis] ? (box.low[axis] + box.high[axis]) / 2 : world[12 + axis];
    return true;
}

/* --- one part: its triangles in the asset frame, welded and in an order that suits a vertex cache --------------------------- */

struct vertex { /* every attribute, so that vertices are welded only where all agree */
    float position[3], normal[3], texcoord[2];
    uint8_t color[4];
};

struct mesh {
    struct vertex *vertices; /* one per corner at first */
    unsigned *indices;
    size_t vertex_count, index_count;
};

static void mesh_finish(struct mesh *mesh)
{
    mem_free(mesh->vertices);
    mem_free(mesh->indices);
    *mesh = (struct mesh){ 0 };
}

static double determinant(const double m[16])
{
    return m[0] * (m[5] * m[10] - m[9] * m[6]) - m[4] * (m[1] * m[10] - m[9] * m[2]) + m[8] * (m[1] * m[6] - m[5] * m[2]);
}

/* Rows of the inverse transpose, up to a positive factor: the cofactors, turned round where the transform mirrors. */
static void normal_matrix(const double m[16], double out[9])
{
    double sign = determinant(m) < 0 ? -1 : 1;
    for (int c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++) {
            int c1 = (c + 1) % 3, c2 = (c + 2) % 3, r1 = (r + 1) % 3, r2 = (r + 2) % 3;
            out[3 * c + r] = sign * (m[4 * c1 + r1] * m[4 * c2 + r2] - m[4 * c1 + r2] * m[4 * c2 + r1]);
        }
}

static bool turn_normal(const double matrix[9], const float normal[3], float out[3])
{
    double n[3], length2 = 0;
    for (int r = 0; r < 3; r++) {
        n[r] = matrix[r] * (double)normal[0] + matrix[3 + r] * (double)normal[1] + matrix[6 + r] * (double)normal[2];
        length2 += n[r] * n[r];
    }
    if (!(length2 > 0) || !isfinite(length2))
        return false;
    for (int r = 0; r < 3; r++)
        out[r] = (float)(n[r] / sqrt(length2));
    return true;
}

static bool has_area(const float (*p)[3], const uint32_t v[3])
{
    double n[3], ab[3], ac[3];
    for (int i = 0; i < 3; i++) {
        ab[i] = (double)p[v[1]][i] - (double)p[v[0]][i];
        ac[i] = (double)p[v[2]][i] - (double)p[v[0]][i];
    }
    n[0] = ab[1] * ac[2] - ab[2] * ac[1];
    n[1] = ab[2] * ac[0] - ab[0] * ac[2];
    n[2] = ab[0] * ac[1] - ab[1] * ac[0];
    return n[0] * n[0] + n[1] * n[1] + n[2] * n[2] > 0;
}

/* Indices of triangles with an area, wound so that the outside stays outside under a mirroring transform. */
static size_t take_triangles(const struct gltf_primitive *primitive, const float (*positions)[3], bool mirrored, uint32_t *out,
                             uint32_t *degenerate)
{
    size_t count = 0;
    for (uint32_t i = 0; i < primitive->index_count; i += 3) {
        const uint32_t *v = primitive->indices + i;
        if (!has_area(positions, v)) {
            ++*degenerate;
            continue;
        }
        out[count++] = v[0];
        out[count++] = v[mirrored ? 2 : 1];
        out[count++] = v[mirrored ? 1 : 2];
    }
    return count;
}

static void fill_vertex(const struct gltf_primitive *primitive, uint32_t v, const float (*positions)[3], const double normals[9],
                        const float *computed, struct vertex *out)
{
    memcpy(out->position, positions[v], sizeof(out->position));
    if (!primitive->normals || !turn_normal(normals, primitive->normals[v], out->normal))
        memcpy(out->normal, computed, sizeof(out->normal));
    for (int i = 0; i < 3; i++) {
        out->position[i] += 0.0f; /* -0 is 0, or equal places would not weld */
        out->normal[i] += 0.0f;
    }
    if (primitive->texcoords)
        memcpy(out->texcoord, primitive->texcoords[v], sizeof(out->texcoord));
    if (primitive->colors)
        memcpy(out->color, primitive->colors[v], sizeof(out->color));
    else
        memset(out->color, 255, sizeof(out->color));
}

static bool mesh_weld(struct mesh *mesh)
{
    unsigned *remap = mem_try_array(mesh->index_count, sizeof(*remap));
    mesh->indices = mem_try_array(mesh->index_count, sizeof(*mesh->indices));
    bool good = remap && mesh->indices;
    if (good) {
        size_t unique =
            meshopt_generateVertexRemap(remap, NULL, mesh->index_count, mesh->vertices, mesh->index_count, sizeof(*mesh->vertices));
        meshopt_remapIndexBuffer(mesh->indices, NULL, mesh->index_count, remap);
        meshopt_remapVertexBuffer(mesh->vertices, mesh->vertices, mesh->index_count, sizeof(*mesh->vertices), remap);
        meshopt_optimizeVertexCache(mesh->indices, mesh->indices, mesh->index_count, unique);
        mesh->vertex_count =
            meshopt_optimizeVertexFetch(mesh->vertices, mesh->indices, mesh->index_count, mesh->vertices, unique, sizeof(*mesh->vertices));
    }
    mem_free(remap);
    return good;
}

static bool mesh_of_part(struct mesh *mesh, const struct part *part, const struct geometry_params *params, struct geometry *geometry)
{
    const struct gltf_primitive *primitive = part->primitive;
    double world[16], normals[9];
    float(*positions)[3] = mem_try_array(primitive->vertex_count, sizeof(*positions));
    uint32_t *indices = mem_try_array(primitive->index_count, sizeof(*indices));
    float(*computed)[3] = mem_try_array(primitive->index_count, sizeof(*computed));
    mesh->vertices = mem_try_array(primitive->index_count, sizeof(*mesh->vertices));
    bool good = positions && indices && computed && mesh->vertices;
    world_of(params, part->node, world);
    normal_matrix(world, normals);
    for (uint32_t i = 0; good && i < primitive->vertex_count; i++) {
        const float *p = primitive->positions[i];
        double q[3];
        transform_point(world, (const double[3]){ (double)p[0], (double)p[1], (double)p[2] }, q);
        for (int axis = 0; axis < 3; axis++)
            positions[i][axis] = (float)(q[axis] - geometry->origin_m[axis]);
    }
    if (good) {
        const float(*places)[3] = (const float(*)[3])positions;
        mesh->index_count = take_triangles(primitive, places, determinant(world) < 0, indices, &geometry->degenerate_triangles);
        good = normals_compute(places, primitive->vertex_count, indices, mesh->index_count, computed);
        for (size_t i = 0; good && i < mesh->index_count; i++)
            fill_vertex(primitive, indices[i], places, normals, computed[i], &mesh->vertices[i]);
        geometry->computed_normals += !primitive->normals;
    }
    good = good && (mesh->index_count == 0 || mesh_weld(mesh));
    mem_free(positions);
    mem_free(indices);
    mem_free(computed);
    return good;
}

/* --- putting parts together ------------------------------------------------------------------------------------------------ */

struct room { /* what the arrays of a geometry can hold */
    size_t positions, normals, texcoords, colors, indices, primitives;
    float (*all_texcoords)[2];
    uint8_t (*all_colors)[4];
    bool any_texcoords, any_colors;
};

static uint32_t add_name(struct geometry *geometry, const char *name)
{
    uint32_t at = (uint32_t)geometry->names.length;
    text_add_bytes(&geometry->names, name, strlen(name) + 1);
    return at;
}

static void append(struct geometry *geometry, struct room *room, const struct mesh *mesh, const struct part *part, uint32_t material,
                   uint32_t name)
{
    size_t vertices = geometry->vertex_count + mesh->vertex_count;
    mem_grow(&geometry->positions_m, &room->positions, vertices, sizeof(*geometry->positions_m));
    mem_grow(&geometry->normals, &room->normals, vertices, sizeof(*geometry->normals));
    mem_grow(&room->all_texcoords, &room->texcoords, vertices, sizeof(*room->all_texcoords));
    mem_grow(&room->all_colors, &room->colors, vertices, sizeof(*room->all_colors));
    mem_grow(&geometry->indices, &room->indices, geometry->index_count + mesh->index_count, sizeof(*geometry->indices));
    mem_grow(&geometry->primitives, &room->primitives, geometry->primitive_count + 1u, sizeof(*geometry->primitives));
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const struct vertex *v = &mesh->vertices[i];
        size_t at = geometry->vertex_count + i;
        memcpy(geometry->positions_m[at], v->position, sizeof(v->position));
        memcpy(geometry->normals[at], v->normal, sizeof(v->normal));
        memcpy(room->all_texcoords[at], v->texcoord, sizeof(v->texcoord));
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
    room->any_colors |= part->primitive->colors != NULL;
}

/* What a model without materials looks like: grey paint, seen from both sides since nobody vouches for its faces. */
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

/* The asset's number of a model's material: parts come sorted, so it is the last one or a new one. */
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

static bool join_parts(struct geometry *geometry, const struct parts *parts, const struct gltf_model *model,
                       const struct geometry_params *params, char *why)
{
    struct room room = { 0 };
    const struct gltf_node *named = NULL;
    uint32_t name = 0;
    int last = -2;
    bool good = true;
    geometry->materials = mem_array(model->material_count + 1u, sizeof(*geometry->materials));
    for (size_t i = 0; good && i < parts->count; i++) {
        const struct part *part = &parts->at[i];
        struct mesh mesh = { 0 };
        good = mesh_of_part(&mesh, part, params, geometry);
        if (good && mesh.index_count) {
            uint32_t material = material_number(geometry, model, part->primitive->material, &last);
            if (named != part->node)
                name = add_name(geometry, part->node->name);
            named = part->node;
            append(geometry, &room, &mesh, part, material, name);
        }
        mesh_finish(&mesh);
    }
    if (!good)
        wrong(why, "out of memory");
    else if (geometry->index_count == 0)
        good = wrong(why, "none of its %u triangles has an area", geometry->degenerate_triangles);
    if (room.any_texcoords)
        geometry->texcoords = room.all_texcoords;
    else
        mem_free(room.all_texcoords);
    if (room.any_colors)
        geometry->colors = room.all_colors;
    else
        mem_free(room.all_colors);
    return good;
}

/* --- textures ------------------------------------------------------------------------------------------------------------ */

static bool add_texture(struct geometry *geometry, const struct gltf_model *model, uint32_t texture, size_t *texel_capacity, char *why)
{
    const struct gltf_texture *from = &model->textures[texture];
    const struct gltf_image *encoded = &model->images[from->image];
    struct image image;
    char image_why[IMAGE_WHY_BYTES];
    if (!image_decode(&image, encoded->bytes, encoded->size, TEXTURE_MAX_PX, image_why))
        return wrong(why, "image %u '%.80s': %s", from->image, encoded->name, image_why);
    size_t bytes = 4 * (size_t)image.width_px * image.height_px;
    geometry->textures[geometry->texture_count++] = (struct asset_texture){ .offset = geometry->texel_bytes,
                                                                            .width_px = image.width_px,
                                                                            .height_px = image.height_px,
                                                                            .srgb = from->srgb,
                                                                            .wrap_repeat = from->wrap_repeat };
    mem_grow(&geometry->texels, texel_capacity, geometry->texel_bytes + bytes, 1);
    memcpy(geometry->texels + geometry->texel_bytes, image.rgba, bytes);
    geometry->texel_bytes += bytes;
    mem_free(image.rgba);
    return true;
}

/* The model's texture numbers become the asset's; those used are decoded. */
static bool join_textures(struct geometry *geometry, const struct gltf_model *model, char *why)
{
    uint32_t *number = mem_array(model->texture_count, sizeof(*number));
    size_t texel_capacity = 0;
    bool good = true;
    geometry->textures = mem_array(model->texture_count, sizeof(*geometry->textures));
    memset(number, 0xff, model->texture_count * sizeof(*number));
    for (uint32_t m = 0; good && m < geometry->material_count; m++) {
        struct asset_material *material = &geometry->materials[m];
        uint32_t *uses[] = { &material->base_color_texture, &material->metallic_roughness_texture, &material->normal_texture,
                             &material->occlusion_texture, &material->emissive_texture };
        for (int i = 0; good && i < 5; i++) {
            if (*uses[i] == ASSET_NO_TEXTURE || !geometry->texcoords) {
                *uses[i] = ASSET_NO_TEXTURE;
                continue;
            }
            if (number[*uses[i]] == ASSET_NO_TEXTURE) {
                number[*uses[i]] = geometry->texture_count;
                good = add_texture(geometry, model, *uses[i], &texel_capacity, why);
            }
            *uses[i] = number[*uses[i]];
        }
    }
    mem_free(number);
    return good;
}

bool geometry_cut(struct geometry *geometry, const struct gltf_model *model, const struct geometry_params *params,
                  char why[MODEL_WHY_BYTES])
{
    struct parts parts = { 0 };
    *geometry = (struct geometry){ 0 };
    bool good = find_parts(&parts, model, params, why) && find_origin(geometry, &parts, params, why) &&
                join_parts(geometry, &parts, model, params, why) && join_textures(geometry, model, why);
    geometry->node_count = parts.node_count;
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
    mem_free(geometry->colors);
    mem_free(geometry->indices);
    mem_free(geometry->primitives);
    mem_free(geometry->materials);
    mem_free(geometry->textures);
    mem_free(geometry->texels);
    text_finish(&geometry->names);
    *geometry = (struct geometry){ 0 };
}
