/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Splits mesh edges near sensors in half until they are short enough, and finds the mesh points that each sensor's disc covers. */
#include "preprocess/influence/influence_mesh.h"

#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

/* a mesh edge at distance D from the nearest sensor may be GRADING * D long, or half the disc's radius if that is longer */
#define GRADING 0.7
/* maximum number of mesh points added per sensor; if the disc's radius is so small that it takes more, edges stay longer than
 * GRADING allows */
#define MAX_ADDED 1000
/* Mesh edges are split where they cross the rim of a disc, so that the disc's points reach its rim. To avoid very short edges,
 * points whose distance from the rim is below this share of the radius count as on it. */
#define RIM_SLACK 0.02
/* maximum number of mesh points added to shorten edges far from sensors too (only if edge_m, the maximum edge length
   everywhere, is finite) */
#define MAX_ADDED_EVENLY 400000

/* --- refinement near sensors ------------------------------------------------------------------------------------------------- */

static double nearest_m(const struct influence_mesh *mesh, const double point[3])
{
    double best_m = INFINITY;
    for (size_t s = 0; s < mesh->source_count; s++)
        best_m = min_of(best_m, vec_distance(mesh->sources_m[s], point));
    return best_m;
}

struct halving {
    struct influence_mesh *of;
    /* radius_m: radius of a sensor's disc; edge_m: maximum edge length everywhere; near_m: by mesh point, distance to the nearest sensor */
    double radius_m, edge_m, *near_m;
    size_t near_capacity, limit;
    struct edge_table edges; /* mesh edges to be split */
    uint32_t *middle;        /* by edge to split: index of the mesh point at which it is split */
    size_t middle_capacity;
};

static uint32_t add_middle(struct halving *halving, uint32_t a, uint32_t b)
{
    struct trimesh *mesh = &halving->of->mesh;
    double point[3];
    for (int axis = 0; axis < 3; axis++)
        point[axis] = (mesh->points[a][axis] + mesh->points[b][axis]) / 2;
    uint32_t added = trimesh_add_point(mesh, point);
    mem_grow(&halving->near_m, &halving->near_capacity, mesh->point_count, sizeof(*halving->near_m));
    halving->near_m[added] = nearest_m(halving->of, point);
    return added;
}

static void mark_edges(struct halving *halving)
{
    const struct trimesh *mesh = &halving->of->mesh;
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t a = mesh->tris[t][i], b = mesh->tris[t][(i + 1) % 3];
            double near_m = min_of(halving->near_m[a], halving->near_m[b]);
            if (vec_distance(mesh->points[a], mesh->points[b]) <=
                    max_of(halving->radius_m / 2, min_of(GRADING * near_m, halving->edge_m)) ||
                mesh->point_count >= halving->limit)
                continue;
            size_t before = halving->edges.count;
            uint32_t edge = edge_table_add(&halving->edges, a, b);
            if (edge < before)
                continue;
            mem_grow(&halving->middle, &halving->middle_capacity, edge + 1, sizeof(*halving->middle));
            halving->middle[edge] = add_middle(halving, a, b);
        }
}

/* Splits a triangle into two, three or four, depending on how many of its edges are split. */
static void cut_triangle(struct halving *halving, size_t t)
{
    struct trimesh *mesh = &halving->of->mesh;
    uint32_t p[3], m[3], source = mesh->tri_source[t];
    int cut = 0, at = 0;
    memcpy(p, mesh->tris[t], sizeof(p));
    for (int i = 0; i < 3; i++) {
        uint32_t edge = edge_table_find(&halving->edges, p[i], p[(i + 1) % 3]);
        m[i] = edge == TRIMESH_NONE ? TRIMESH_NONE : halving->middle[edge];
        cut += m[i] != TRIMESH_NONE;
    }
    if (cut == 0)
        return;
    /* rotates the corners so that the only split edge comes first; if two edges are split, the only unsplit one */
    for (int i = 0; i < 3; i++)
        if ((m[i] != TRIMESH_NONE) == (cut == 1))
            at = i;
    const uint32_t a = p[at], b = p[(at + 1) % 3], c = p[(at + 2) % 3];
    const uint32_t ab = m[at], bc = m[(at + 1) % 3], ca = m[(at + 2) % 3];
    uint32_t *first = mesh->tris[t];
    if (cut == 1) {
        memcpy(first, (const uint32_t[3]){ a, ab, c }, sizeof(p));
        trimesh_add_tri(mesh, ab, b, c, source);
    } else if (cut == 2) {
        memcpy(first, (const uint32_t[3]){ bc, c, ca }, sizeof(p));
        trimesh_add_tri(mesh, a, b, bc, source);
        trimesh_add_tri(mesh, a, bc, ca, source);
    } else {
        memcpy(first, (const uint32_t[3]){ ab, bc, ca }, sizeof(p));
        trimesh_add_tri(mesh, a, ab, ca, source);
        trimesh_add_tri(mesh, ab, b, bc, source);
        trimesh_add_tri(mesh, bc, c, ca, source);
    }
}

/* Writes the point at which the edge from a (inside a disc) to b (outside) crosses the disc's rim. */
static void find_crossing(const struct influence_mesh *mesh, const double a[3], const double b[3], double radius_m, double out[3])
{
    double low = 0, high = 1;
    for (int i = 0; i < 12; i++) {
        double middle = (low + high) / 2;
        for (int axis = 0; axis < 3; axis++)
            out[axis] = a[axis] + middle * (b[axis] - a[axis]);
        *(nearest_m(mesh, out) < radius_m ? &low : &high) = middle;
    }
}

/* Marks the edges that cross the rim of a disc, which are then split at the crossing. */
static void mark_rims(struct halving *halving)
{
    const struct trimesh *mesh = &halving->of->mesh;
    const double inside_m = (1 - RIM_SLACK) * halving->radius_m, outside_m = (1 + RIM_SLACK) * halving->radius_m;
    for (size_t t = 0, count = mesh->tri_count; t < count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t a = mesh->tris[t][i], b = mesh->tris[t][(i + 1) % 3];
            const bool turned = halving->near_m[a] > halving->near_m[b];
            const uint32_t inner = turned ? b : a, outer = turned ? a : b;
            if (!(halving->near_m[inner] < inside_m && halving->near_m[outer] > outside_m))
                continue;
            size_t before = halving->edges.count;
            uint32_t edge = edge_table_add(&halving->edges, a, b);
            if (edge < before)
                continue;
            mem_grow(&halving->middle, &halving->middle_capacity, edge + 1, sizeof(*halving->middle));
            halving->middle[edge] = add_middle(halving, a, b);
            find_crossing(halving->of, mesh->points[inner], mesh->points[outer], halving->radius_m,
                          halving->of->mesh.points[halving->middle[edge]]);
            halving->near_m[halving->middle[edge]] = halving->radius_m;
        }
}

/* Splits the edges that the callback `mark` adds to halving->edges. Returns the number of points added. */
static size_t split_edges(struct halving *halving, void (*mark)(struct halving *halving))
{
    const struct trimesh *mesh = &halving->of->mesh;
    size_t before = mesh->point_count;
    edge_table_init(&halving->edges, 1024);
    mark(halving);
    for (size_t t = 0, count = mesh->tri_count; halving->edges.count && t < count; t++)
        cut_triangle(halving, t);
    edge_table_finish(&halving->edges);
    return mesh->point_count - before;
}

static void refine(struct influence_mesh *mesh, double radius_m, double edge_m)
{
    struct halving halving = { .of = mesh, .radius_m = radius_m, .edge_m = edge_m };
    halving.limit = mesh->mesh.point_count + MAX_ADDED * mesh->source_count + (isfinite(edge_m) ? MAX_ADDED_EVENLY : 0);
    mem_grow(&halving.near_m, &halving.near_capacity, mesh->mesh.point_count, sizeof(*halving.near_m));
    for (size_t p = 0; p < mesh->mesh.point_count; p++)
        halving.near_m[p] = nearest_m(mesh, mesh->mesh.points[p]);
    while (split_edges(&halving, mark_edges) > 0)
        ;
    split_edges(&halving, mark_rims);
    mem_free(halving.near_m);
    mem_free(halving.middle);
    for (size_t t = 0; t < mesh->mesh.tri_count; t++)
        for (int i = 0; i < 3; i++)
            mesh->longest_m = max_of(mesh->longest_m, vec_distance(mesh->mesh.points[mesh->mesh.tris[t][i]],
                                                                   mesh->mesh.points[mesh->mesh.tris[t][(i + 1) % 3]]));
}

/* --- lists of triangles ------------------------------------------------------------------------------------------------------ */

static void list_triangles(struct influence_mesh *mesh, size_t visible_count)
{
    const struct trimesh *from = &mesh->mesh;
    mesh->piece_first = mem_array(visible_count + 2, sizeof(*mesh->piece_first));
    mesh->pieces = mem_array(from->tri_count, sizeof(*mesh->pieces));
    mesh->fan_first = mem_array(from->point_count + 2, sizeof(*mesh->fan_first));
    mesh->fans = mem_array(3 * from->tri_count, sizeof(*mesh->fans));
    for (size_t t = 0; t < from->tri_count; t++) {
        mesh->piece_first[from->tri_source[t] + 2]++;
        for (int i = 0; i < 3; i++)
            mesh->fan_first[from->tris[t][i] + 2]++;
    }
    for (size_t i = 2; i < visible_count + 2; i++)
        mesh->piece_first[i] += mesh->piece_first[i - 1];
    for (size_t i = 2; i < from->point_count + 2; i++)
        mesh->fan_first[i] += mesh->fan_first[i - 1];
    for (uint32_t t = 0; t < from->tri_count; t++) {
        mesh->pieces[mesh->piece_first[from->tri_source[t] + 1]++] = t;
        for (int i = 0; i < 3; i++)
            mesh->fans[mesh->fan_first[from->tris[t][i] + 1]++] = t;
    }
}

/* Computes the barycentric coordinates of a point in the plane of a triangle. */
static void barycentric(const struct trimesh *mesh, const uint32_t corners[3], const double point[3], double weights[3])
{
    const double *a = mesh->points[corners[0]];
    double u[3], v[3], w[3];
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = mesh->points[corners[1]][axis] - a[axis];
        v[axis] = mesh->points[corners[2]][axis] - a[axis];
        w[axis] = point[axis] - a[axis];
    }
    double uu = vec_dot(u, u), uv = vec_dot(u, v), vv = vec_dot(v, v), uw = vec_dot(u, w), vw = vec_dot(v, w);
    double area = uu * vv - uv * uv;
    weights[1] = area > 0 ? (vv * uw - uv * vw) / area : 0;
    weights[2] = area > 0 ? (uu * vw - uv * uw) / area : 0;
    weights[0] = 1 - weights[1] - weights[2];
}

/* Returns the mesh triangle ("piece") of surface triangle `tri` that contains the point or is nearest to it. weights: the
 * point's barycentric weights, not negative. */
static uint32_t piece_of(const struct influence_mesh *mesh, uint32_t tri, const double point[3], double weights[3])
{
    double best = -INFINITY, sum = 0;
    uint32_t found = mesh->pieces[mesh->piece_first[tri]];
    for (uint32_t i = mesh->piece_first[tri]; i < mesh->piece_first[tri + 1]; i++) {
        double w[3];
        barycentric(&mesh->mesh, mesh->mesh.tris[mesh->pieces[i]], point, w);
        double least = min_of(w[0], min_of(w[1], w[2]));
        if (least <= best)
            continue;
        best = least;
        found = mesh->pieces[i];
        memcpy(weights, w, sizeof(w));
    }
    for (int i = 0; i < 3; i++)
        sum += weights[i] = max_of(weights[i], 0);
    for (int i = 0; i < 3; i++)
        weights[i] /= sum;
    return found;
}

/* --- discs ------------------------------------------------------------------------------------------------------------------- */

/* Collects the mesh points of a sensor's disc: searches along the surface from the nearest corner, so as not to include the
 * other side of a thin wall. */
static void spread_disc(struct influence_mesh *mesh, size_t sensor, double radius_m, char *seen)
{
    const struct trimesh *from = &mesh->mesh;
    const double *place_m = mesh->sources_m[sensor];
    struct influence_disc *disc = &mesh->discs[sensor];
    double weights[3] = { 1, 0, 0 }, whole = 0;
    size_t capacity = 0;
    const uint32_t *corners = from->tris[piece_of(mesh, mesh->source_tris[sensor], place_m, weights)];
    int heaviest = weights[1] > weights[0] ? 1 : 0;
    heaviest = weights[2] > weights[heaviest] ? 2 : heaviest;
    mem_grow(&disc->points, &capacity, 1, sizeof(*disc->points));
    disc->points[disc->count++] = corners[heaviest];
    seen[corners[heaviest]] = 1;
    for (size_t next = 0; next < disc->count; next++)
        for (uint32_t f = mesh->fan_first[disc->points[next]], p = disc->points[next]; f < mesh->fan_first[p + 1]; f++)
            for (int i = 0; i < 3; i++) {
                uint32_t to = from->tris[mesh->fans[f]][i];
                if (seen[to] || vec_distance(from->points[to], place_m) > (1 + RIM_SLACK) * radius_m)
                    continue;
                seen[to] = 1;
                mem_grow(&disc->points, &capacity, disc->count + 1, sizeof(*disc->points));
                disc->points[disc->count++] = to;
            }
    disc->shares = mem_array(disc->count, sizeof(*disc->shares));
    for (size_t i = 0; i < disc->count; i++) {
        for (uint32_t f = mesh->fan_first[disc->points[i]]; f < mesh->fan_first[disc->points[i] + 1]; f++)
            disc->shares[i] += trimesh_tri_area(from, mesh->fans[f]);
        whole += disc->shares[i];
        seen[disc->points[i]] = 0;
    }
    for (size_t i = 0; i < disc->count; i++)
        disc->shares[i] /= whole;
}

/* --- the whole --------------------------------------------------------------------------------------------------------------- */

static bool copy_visible(struct influence_mesh *mesh, const struct surface_debug_mesh *look)
{
    struct trimesh *to = &mesh->mesh;
    *to = (struct trimesh){ .point_count = look->point_count, .point_capacity = look->point_count };
    to->points = mem_try_array(look->point_count, sizeof(*to->points));
    if (!to->points)
        return false;
    memcpy(to->points, look->points_m, look->point_count * sizeof(*to->points));
    for (uint32_t t = 0; t < look->visible_count; t++)
        trimesh_add_tri(to, look->tris[t][0], look->tris[t][1], look->tris[t][2], t);
    return true;
}

bool influence_mesh_init(struct influence_mesh *mesh, const struct surface *surface, const double (*places_m)[3], size_t count,
                         double radius_m, double edge_m)
{
    struct surface_debug_mesh look;
    surface_debug_mesh(surface, &look);
    *mesh = (struct influence_mesh){ .source_count = count, .size_m = surface_report(surface)->size_m };
    if (!copy_visible(mesh, &look))
        return false;
    mesh->sources_m = mem_array(count, sizeof(*mesh->sources_m));
    mesh->source_tris = mem_array(count, sizeof(*mesh->source_tris));
    mesh->discs = mem_array(count, sizeof(*mesh->discs));
    for (size_t s = 0; s < count; s++) {
        struct surface_point at;
        surface_find_point(surface, places_m[s], NULL, &at);
        memcpy(mesh->sources_m[s], at.point_m, sizeof(at.point_m));
        mesh->source_tris[s] = at.tri;
    }
    refine(mesh, radius_m, edge_m);
    list_triangles(mesh, look.visible_count);
    intrinsic_init(&mesh->intrinsic, &mesh->mesh);
    char *seen = mem_array(mesh->mesh.point_count, 1);
    for (size_t s = 0; s < count; s++)
        spread_disc(mesh, s, radius_m, seen);
    mem_free(seen);
    return true;
}

void influence_mesh_finish(struct influence_mesh *mesh)
{
    for (size_t s = 0; mesh->discs && s < mesh->source_count; s++) {
        mem_free(mesh->discs[s].points);
        mem_free(mesh->discs[s].shares);
    }
    mem_free(mesh->discs);
    mem_free(mesh->sources_m);
    mem_free(mesh->source_tris);
    mem_free(mesh->piece_first);
    mem_free(mesh->pieces);
    mem_free(mesh->fan_first);
    mem_free(mesh->fans);
    intrinsic_finish(&mesh->intrinsic);
    trimesh_finish(&mesh->mesh);
    *mesh = (struct influence_mesh){ 0 };
}

void influence_mesh_anchor(const struct influence_mesh *mesh, const struct surface_point *place, struct influence_anchor *out)
{
    double weights[3] = { 1, 0, 0 };
    memcpy(out->points, mesh->mesh.tris[piece_of(mesh, place->tri, place->point_m, weights)], sizeof(out->points));
    for (int i = 0; i < 3; i++)
        out->weights[i] = (float)weights[i];
}

void influence_mesh_anchors(const struct influence_mesh *mesh, const struct vertex_embedding *embedding, size_t count,
                            struct influence_anchor *out)
{
    for (size_t v = 0; v < count; v++) {
        struct surface_point hit;
        uint32_t point = vertex_embedding_place(embedding, v, &hit);
        out[v] = (struct influence_anchor){ { point, point, point }, { 1, 0, 0 } };
        if (point != TRIMESH_NONE && mesh->fan_first[point] < mesh->fan_first[point + 1])
            continue;
        influence_mesh_anchor(mesh, &hit, &out[v]);
    }
}
