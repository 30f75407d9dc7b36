/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds the triangle mesh of one glTF primitive at one node. */
#include <math.h>
#include <meshoptimizer.h>
#include <string.h>

#include "base/mem.h"
#include "plant/models/transform.h"
#include "preprocess/geometry/gaps.h"
#include "preprocess/geometry/geometry_impl.h"
#include "preprocess/geometry/normals.h"
#include "preprocess/geometry/winding.h"

#include "base/math/vec.h"

/* Computes the transform from model units and axes to metres and Z up: (x, y, z) of a Y-up model becomes (x, -z, y). */
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

void primitive_world(const struct geometry_params *params, const struct gltf_node *node, double out[16])
{
    double frame[16];
    frame_of(params, frame);
    transform_multiply(frame, node->world, out);
}

void primitive_mesh_finish(struct primitive_mesh *mesh)
{
    mem_free(mesh->vertices);
    mem_free(mesh->indices);
    *mesh = (struct primitive_mesh){ 0 };
}

static double determinant(const double m[16])
{
    return m[0] * (m[5] * m[10] - m[9] * m[6]) - m[4] * (m[1] * m[10] - m[9] * m[2]) + m[8] * (m[1] * m[6] - m[5] * m[2]);
}

/* Computes the matrix that transforms normals: the inverse transpose of m, except for a positive factor. That is the cofactor
 * matrix of m, negated if m mirrors. */
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
    double n[3];
    vecf_normal(p[v[0]], p[v[1]], p[v[2]], n);
    return vec_dot(n, n) > 0;
}

bool geometry_node_has_area(const struct gltf_model *model, uint32_t number)
{
    const struct gltf_node *node = &model->nodes[number];
    const uint32_t count = node->mesh >= 0 ? model->meshes[node->mesh].primitive_count : 0;
    for (uint32_t p = 0; p < count; p++) {
        const struct gltf_primitive *primitive = &model->primitives[model->meshes[node->mesh].first_primitive + p];
        double corners[3][3];
        /* corners relative to the first one, so that single precision loses no digits; for the same reason, geometry_cut()
         * computes areas near the origin */
        float relative[3][3];
        for (uint32_t i = 0; i < primitive->index_count; i++) {
            const float *at = primitive->positions[primitive->indices[i]];
            transform_point(node->world, (const double[3]){ (double)at[0], (double)at[1], (double)at[2] }, corners[i % 3]);
            for (int axis = 0; axis < 3; axis++)
                relative[i % 3][axis] = (float)(corners[i % 3][axis] - corners[0][axis]);
            if (i % 3 == 2 && has_area((const float(*)[3])relative, (const uint32_t[3]){ 0, 1, 2 }))
                return true;
        }
    }
    return false;
}

/* Writes the indices of all triangles that have an area. If the node's transform mirrors, reverses their winding so that the
 * outside stays outside. Returns the number of indices. */
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

/* Reverses a vertex normal that contradicts its triangle's winding, which defines the outside; some exporters write such
 * normals. Keeps normals that only lean towards a neighbouring face. */
static void turn_outward(const float outward[3], float normal[3])
{
    if (vecf_dot(normal, outward) < -0.2f)
        for (int i = 0; i < 3; i++)
            normal[i] = -normal[i];
}

static void fill_vertex(const struct gltf_primitive *primitive, uint32_t v, const float (*positions)[3], const double normals[9],
                        const float *computed, struct geometry_vertex *out)
{
    memcpy(out->position, positions[v], sizeof(out->position));
    if (!primitive->normals || !turn_normal(normals, primitive->normals[v], out->normal))
        memcpy(out->normal, computed, sizeof(out->normal));
    turn_outward(computed, out->normal);
    for (int i = 0; i < 3; i++) {
        out->position[i] += 0.0f; /* turns -0 into 0, so that equal positions weld */
        out->normal[i] += 0.0f;
    }
    if (primitive->texcoords)
        memcpy(out->texcoord, primitive->texcoords[v], sizeof(out->texcoord));
    if (primitive->second_texcoords)
        memcpy(out->second_texcoord, primitive->second_texcoords[v], sizeof(out->second_texcoord));
    if (primitive->colors)
        memcpy(out->color, primitive->colors[v], sizeof(out->color));
    else
        memset(out->color, 255, sizeof(out->color));
}

static bool mesh_weld(struct primitive_mesh *mesh)
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

bool primitive_mesh(struct primitive_mesh *mesh, const struct node_primitive *part, const struct geometry_params *params,
                    struct geometry *geometry)
{
    const struct gltf_primitive *primitive = part->primitive;
    double world[16], normals[9];
    float(*positions)[3] = mem_try_array(primitive->vertex_count, sizeof(*positions));
    uint32_t *indices = mem_try_array(primitive->index_count, sizeof(*indices));
    float(*computed)[3] = mem_try_array(primitive->index_count, sizeof(*computed));
    mesh->vertices = mem_try_array(primitive->index_count, sizeof(*mesh->vertices));
    bool good = positions && indices && computed && mesh->vertices;
    primitive_world(params, part->node, world);
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
        good = gaps_close(positions, primitive->vertex_count, indices, mesh->index_count, params->tolerance_m, &geometry->closed_gaps) &&
               winding_mend(places, primitive->vertex_count, indices, mesh->index_count, &geometry->turned_triangles) &&
               normals_compute(places, primitive->vertex_count, indices, mesh->index_count, computed);
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
