/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Overlaps in the plane of each drawn triangle (Sutherland & Hodgman, Reentrant polygon clipping, 1974). */
#include "preprocess/influence/influence_bend.h"

#include <math.h>
#include <string.h>

#include "base/extent.h"
#include "base/mem.h"
#include "base/vec.h"
#include "surface/mesh/bvh.h"

#define OFF_PLANE 1e-5 /* of the size of the surface: drawn corners are floats */
#define COVERED 1e-3   /* of a triangle's area: as much may be missing, or covered twice */
#define SAME 1e-7      /* of a triangle's size: such places are one */
#define LEAST_FACING 0.5
#define STEPS 255.0

enum { POLYGON = 9, PLACES_OF_TRIANGLE = 4096 };

struct polygon {
    double at[POLYGON][2];
    int count;
};

struct finding {
    struct influence_bend *bend;
    const struct influence_mesh *mesh;
    size_t most;
    double off_plane_m;
    char *taken; /* by vertex: it has a place */
    /* of the drawn triangle */
    uint32_t tri;
    const uint32_t *vertices;
    double origin[3], axes[3][3]; /* two in its plane, and its normal */
    double corners[3][2], size_m, covered_m2;
    double seen[PLACES_OF_TRIANGLE][2];
    size_t seen_count;
    bool full;
};

/* --- in the plane -------------------------------------------------------------------------------------------------------------- */

static double cross(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static void flatten(const struct finding *finding, const double point[3], double out[2], double *off_m)
{
    double from[3];
    for (int axis = 0; axis < 3; axis++)
        from[axis] = point[axis] - finding->origin[axis];
    out[0] = vec_dot(from, finding->axes[0]);
    out[1] = vec_dot(from, finding->axes[1]);
    *off_m = fabs(vec_dot(from, finding->axes[2]));
}

/* What is left of the edge from a to b stays. */
static void clip(struct polygon *polygon, const double a[2], const double b[2])
{
    struct polygon out = { .count = 0 };
    for (int i = 0; i < polygon->count; i++) {
        const double *p = polygon->at[i], *q = polygon->at[(i + 1) % polygon->count];
        double p_in = cross(a, b, p), q_in = cross(a, b, q);
        if (p_in >= 0)
            memcpy(out.at[out.count++], p, sizeof(out.at[0]));
        if ((p_in > 0 && q_in < 0) || (p_in < 0 && q_in > 0)) {
            double t = p_in / (p_in - q_in);
            for (int axis = 0; axis < 2; axis++)
                out.at[out.count][axis] = p[axis] + t * (q[axis] - p[axis]);
            out.count++;
        }
    }
    *polygon = out;
}

static double area_of(const struct polygon *polygon)
{
    double twice = 0;
    for (int i = 2; i < polygon->count; i++)
        twice += cross(polygon->at[0], polygon->at[i - 1], polygon->at[i]);
    return twice / 2;
}

/* None negative, adding up to 1. */
static void weights_in(const double corners[3][2], const double at[2], float weights[3])
{
    double sum = 0, w[3];
    for (int i = 0; i < 3; i++)
        sum += w[i] = fmax(cross(corners[(i + 1) % 3], corners[(i + 2) % 3], at), 0);
    for (int i = 0; i < 3; i++)
        weights[i] = (float)(w[i] / sum);
}

/* --- places -------------------------------------------------------------------------------------------------------------------- */

static bool is_new(struct finding *finding, const double at[2])
{
    for (size_t i = 0; i < finding->seen_count; i++)
        if (hypot(finding->seen[i][0] - at[0], finding->seen[i][1] - at[1]) <= SAME * finding->size_m)
            return false;
    if (finding->seen_count < PLACES_OF_TRIANGLE)
        memcpy(finding->seen[finding->seen_count++], at, sizeof(finding->seen[0]));
    return true;
}

/* The corner of the drawn triangle that lies there; TRIMESH_NONE: none does. */
static uint32_t vertex_at(const struct finding *finding, const double at[2])
{
    for (int i = 0; i < 3; i++)
        if (hypot(finding->corners[i][0] - at[0], finding->corners[i][1] - at[1]) <= SAME * finding->size_m)
            return finding->vertices[i];
    return TRIMESH_NONE;
}

static void add_place(struct finding *finding, const double at[2], const double piece[3][2], const uint32_t points[3])
{
    struct influence_bend *bend = finding->bend;
    uint32_t vertex = vertex_at(finding, at);
    if (!is_new(finding, at) || (vertex != TRIMESH_NONE && finding->taken[vertex]))
        return;
    if (vertex != TRIMESH_NONE)
        finding->taken[vertex] = 1;
    if (bend->count >= finding->most) {
        finding->full = true;
        return;
    }
    mem_grow(&bend->places, &bend->capacity, bend->count + 1, sizeof(*bend->places));
    mem_grow(&bend->anchors, &bend->anchor_capacity, bend->count + 1, sizeof(*bend->anchors));
    bend->places[bend->count].tri = finding->tri;
    bend->places[bend->count].vertex = vertex;
    weights_in((const double(*)[2])finding->corners, at, bend->places[bend->count].weights);
    memcpy(bend->anchors[bend->count].points, points, sizeof(bend->anchors[0].points));
    weights_in(piece, at, bend->anchors[bend->count].weights);
    bend->count++;
}

/* A piece of the mesh whose box meets that of the drawn triangle. */
static void visit(void *arg, uint32_t tri)
{
    struct finding *finding = arg;
    const uint32_t *points = finding->mesh->mesh.tris[tri];
    struct polygon polygon = { .count = 3 };
    double piece[3][2], normal[3], off_m;
    if (finding->full)
        return;
    vec_normal(finding->mesh->mesh.points[points[0]], finding->mesh->mesh.points[points[1]], finding->mesh->mesh.points[points[2]], normal);
    if (!(vec_dot(normal, finding->axes[2]) > LEAST_FACING * sqrt(vec_dot(normal, normal))))
        return;
    for (int i = 0; i < 3; i++) {
        flatten(finding, finding->mesh->mesh.points[points[i]], piece[i], &off_m);
        if (off_m > finding->off_plane_m)
            return;
        memcpy(polygon.at[i], piece[i], sizeof(piece[i]));
    }
    for (int i = 0; i < 3; i++)
        clip(&polygon, finding->corners[i], finding->corners[(i + 1) % 3]);
    double area_m2 = area_of(&polygon);
    if (!(area_m2 > 0) || !(cross(piece[0], piece[1], piece[2]) > 0))
        return;
    finding->covered_m2 += area_m2;
    for (int i = 0; i < polygon.count; i++)
        add_place(finding, polygon.at[i], (const double(*)[2])piece, points);
}

/* Returns its area; 0: it has none. */
static double take_triangle(struct finding *finding, const float (*positions_m)[3], const uint32_t *corners)
{
    double p[3][3], along[3], off_m;
    for (int i = 0; i < 3; i++)
        for (int axis = 0; axis < 3; axis++)
            p[i][axis] = (double)positions_m[corners[i]][axis];
    memcpy(finding->origin, p[0], sizeof(p[0]));
    vec_normal(p[0], p[1], p[2], finding->axes[2]);
    for (int axis = 0; axis < 3; axis++)
        along[axis] = p[1][axis] - p[0][axis];
    double normal_m2 = sqrt(vec_dot(finding->axes[2], finding->axes[2])), along_m = sqrt(vec_dot(along, along));
    if (!(normal_m2 > 0) || !(along_m > 0))
        return 0;
    for (int axis = 0; axis < 3; axis++) {
        finding->axes[2][axis] /= normal_m2;
        finding->axes[0][axis] = along[axis] / along_m;
    }
    vec_cross(finding->axes[2], finding->axes[0], finding->axes[1]);
    finding->size_m = 0;
    for (int i = 0; i < 3; i++) {
        flatten(finding, p[i], finding->corners[i], &off_m);
        finding->size_m = fmax(finding->size_m, hypot(finding->corners[i][0], finding->corners[i][1]));
    }
    finding->covered_m2 = 0;
    finding->seen_count = 0;
    return cross(finding->corners[0], finding->corners[1], finding->corners[2]) / 2;
}

static double size_of(const struct trimesh *mesh)
{
    struct extent extent = extent_empty();
    for (size_t i = 0; i < mesh->point_count; i++)
        extent_add(&extent, mesh->points[i]);
    return mesh->point_count ? extent_size(&extent) : 0;
}

bool influence_bend_init(struct influence_bend *bend, const struct influence_mesh *mesh, const float (*positions_m)[3],
                         size_t vertex_count, const uint32_t *triangles, size_t triangle_count, size_t most)
{
    struct finding *finding = mem_new(sizeof(*finding));
    struct bvh *bvh = bvh_create(&mesh->mesh);
    *bend = (struct influence_bend){ .triangles = triangles, .triangle_count = triangle_count };
    bend->area_m2 = mem_array(triangle_count, sizeof(*bend->area_m2));
    finding->bend = bend;
    finding->mesh = mesh;
    finding->most = most;
    finding->taken = mem_array(vertex_count, 1);
    finding->off_plane_m = OFF_PLANE * size_of(&mesh->mesh);
    for (size_t t = 0; t < triangle_count && !finding->full; t++) {
        const uint32_t *corners = triangles + 3 * t;
        double area_m2 = take_triangle(finding, positions_m, corners);
        struct extent extent = extent_empty();
        finding->tri = (uint32_t)t;
        finding->vertices = corners;
        if (area_m2 <= 0)
            continue;
        for (int i = 0; i < 3; i++)
            extent_addf(&extent, positions_m[corners[i]]);
        bvh_overlaps(bvh, extent.low, extent.high, finding->off_plane_m, visit, finding);
        bool covered = fabs(finding->covered_m2 - area_m2) <= COVERED * area_m2 && finding->seen_count < PLACES_OF_TRIANGLE;
        bend->area_m2[t] = covered ? area_m2 : -area_m2;
    }
    bool good = !finding->full;
    bvh_destroy(&bvh);
    mem_free(finding->taken);
    mem_free(finding);
    return good;
}

void influence_bend_finish(struct influence_bend *bend)
{
    mem_free(bend->places);
    mem_free(bend->anchors);
    mem_free(bend->area_m2);
    *bend = (struct influence_bend){ 0 };
}

/* --- what it comes to ------------------------------------------------------------------------------------------------------------ */

/* Readings that are farthest apart are the worst: all with a share above 0 at MAX and the others at MIN, or the other way round. */
static double worst_of(double plus, double minus, double around)
{
    double level = around * (plus + minus);
    return STEPS * fmax(fabs(plus - level), fabs(minus - level));
}

void influence_bend_measure(const struct influence_bend *bend, const struct influence *influence, size_t vertex_count, double around,
                            float *steps_out, struct bend_report *report)
{
    double *plus = mem_array(bend->count, sizeof(*plus)), *minus = mem_array(bend->count, sizeof(*minus));
    float *steps = mem_array(bend->triangle_count, sizeof(*steps)), *at_vertex = mem_array(vertex_count, sizeof(*at_vertex));
    double all_m2 = 0, over_m2 = 0, unknown_m2 = 0;
    for (size_t s = 0; s < influence->count; s++) {
        const float *share = influence->shares + s * influence->vertex_count;
        for (size_t i = 0; i < bend->count; i++) {
            const struct bend_place *place = &bend->places[i];
            const uint32_t *corners = bend->triangles + 3 * (size_t)place->tri;
            double differs = (double)share[vertex_count + i];
            for (int k = 0; k < 3; k++)
                differs -= (double)place->weights[k] * (double)share[corners[k]];
            *(differs > 0 ? &plus[i] : &minus[i]) += differs;
        }
    }
    for (size_t i = 0; i < bend->count; i++) {
        const struct bend_place *place = &bend->places[i];
        float *most = place->vertex == TRIMESH_NONE ? &steps[place->tri] : &at_vertex[place->vertex];
        *most = fmaxf(*most, (float)worst_of(plus[i], minus[i], around));
    }
    for (size_t t = 0; t < bend->triangle_count; t++) {
        for (int k = 0; k < 3; k++)
            steps[t] = fmaxf(steps[t], at_vertex[bend->triangles[3 * t + k]]);
        double area_m2 = fabs(bend->area_m2[t]);
        bool known = bend->area_m2[t] >= 0;
        all_m2 += area_m2;
        unknown_m2 += known ? 0 : area_m2;
        over_m2 += known && steps[t] > 1 ? area_m2 : 0;
        report->steps = known ? fmax(report->steps, (double)steps[t]) : report->steps;
    }
    report->measured++;
    report->over_share = all_m2 > 0 ? fmax(report->over_share, over_m2 / all_m2) : report->over_share;
    report->unknown_share = all_m2 > 0 ? fmax(report->unknown_share, unknown_m2 / all_m2) : report->unknown_share;
    if (steps_out)
        memcpy(steps_out, steps, bend->triangle_count * sizeof(*steps));
    mem_free(plus);
    mem_free(minus);
    mem_free(steps);
    mem_free(at_vertex);
}

void influence_bend_remove(const struct influence_bend *bend, struct influence *influence, size_t vertex_count)
{
    const size_t all = vertex_count + bend->count;
    for (size_t s = 1; s < influence->count; s++)
        memmove(influence->shares + s * vertex_count, influence->shares + s * all, vertex_count * sizeof(*influence->shares));
    if (influence->deviations) {
        memmove(influence->deviations + vertex_count, influence->deviations + all, vertex_count * sizeof(*influence->deviations));
        influence->deviations[2 * vertex_count] = 0;
    }
    influence->vertex_count = vertex_count;
}
