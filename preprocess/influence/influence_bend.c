/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clips the triangles of the solved mesh against each drawn triangle, in the drawn triangle's plane. The first pass uses the
 * mesh triangles in that plane. Later passes use mesh triangles near the plane for the area that is still uncovered. */
#include "preprocess/influence/influence_bend.h"

#include <math.h>
#include <string.h>

#include "base/math/extent.h"
#include "base/math/vec.h"
#include "base/mem.h"
#include "preprocess/influence/polygons.h"
#include "surface/mesh/bvh.h"

/* tolerance for the distance from a drawn triangle's plane, relative to the surface's size; needed because drawn corners are
 * stored in single precision */
#define OFF_PLANE 1e-5
/* overlaps of a drawn and a mesh triangle are ignored up to this area, as a share of the drawn triangle's squared size */
#define LEAST 1e-7
/* largest share of a drawn triangle's area (triangle of the asset file) that may stay uncovered without counting as unknown,
   because small overlaps are ignored */
#define COVERED 1e-3
#define SAME 1e-7 /* distance, as a share of a triangle's size, below which two places (corners of overlaps) count as duplicates */
#define LEAST_FACING 0.5
/* number of recent places (corners of overlaps) that a new place is compared with; duplicates come from mesh triangles visited
 * shortly after each other */
enum { LOOK_BACK = 64 };

struct finding {
    struct influence_bend *bend;
    size_t most;
    double in_plane_m, near_m;
    const struct trimesh *visible, *hidden;
    struct bvh *visible_bvh, *hidden_bvh;
    /* state for the current triangle of the asset file ("drawn triangle"): */
    uint32_t tri;
    /* origin of the plane's coordinates; two axes in the drawn triangle's plane, and its normal */
    double origin[3], axes[3][3];
    double corners[3][2], size_m;
    struct extent extent;
    size_t first; /* index of the drawn triangle's first place (corner of an overlap) */
    /* by mesh point: 1 + index of the last drawn triangle with a place (corner of an overlap) at this point; 0: none */
    uint32_t *taken_by;
    /* polygons; left: area not yet covered before the current pass; cut: the part of `left` that the current pass has not covered */
    struct polygons left, cut;
    /* state of the current pass: */
    const struct trimesh *mesh;
    double off_m;
    bool full;
};

/* --- places -------------------------------------------------------------------------------------------------------------------- */

static void flatten(const struct finding *finding, const double point[3], double out[2], double *off_m)
{
    double from[3];
    vec_sub(point, finding->origin, from);
    out[0] = vec_dot(from, finding->axes[0]);
    out[1] = vec_dot(from, finding->axes[1]);
    *off_m = fabs(vec_dot(from, finding->axes[2]));
}

/* Computes the barycentric weights of point `at`; they sum to 1 and are not negative: rounding noise becomes 0. */
static void weights_in(const double corners[3][2], const double at[2], float weights[3])
{
    double sum = 0, w[3], whole = polygon_cross(corners[0], corners[1], corners[2]);
    for (int i = 0; i < 3; i++) {
        w[i] = polygon_cross(corners[(i + 1) % 3], corners[(i + 2) % 3], at);
        w[i] = w[i] > SAME * whole ? w[i] : 0;
        sum += w[i];
    }
    for (int i = 0; i < 3; i++)
        weights[i] = (float)(w[i] / sum);
}

/* Normalises an anchor (three mesh points and their weights): replaces points of zero weight by the point of largest weight. A
 * position on an edge or corner thus gets the same anchor from every adjacent triangle. */
static void tidy(struct influence_anchor *anchor)
{
    int heaviest = 0;
    for (int i = 1; i < 3; i++)
        heaviest = anchor->weights[i] > anchor->weights[heaviest] ? i : heaviest;
    for (int i = 0; i < 3; i++)
        if (anchor->weights[i] == 0)
            anchor->points[i] = anchor->points[heaviest];
}

static bool has_point(const struct influence_anchor *anchor, uint32_t point)
{
    return anchor->points[0] == point || anchor->points[1] == point || anchor->points[2] == point;
}

static bool same_points(const struct influence_anchor *a, const struct influence_anchor *b)
{
    for (int i = 0; i < 3; i++)
        if (!has_point(a, b->points[i]) || !has_point(b, a->points[i]))
            return false;
    return true;
}

static bool is_single(const struct influence_anchor *anchor)
{
    return anchor->points[0] == anchor->points[1] && anchor->points[0] == anchor->points[2];
}

/* Returns whether the place (corner of an overlap) is at a corner of the drawn triangle that takes its value from a mesh point
 * there. The solved field and the drawn field are then equal there, so the place needs no check. */
static bool is_corner(const struct finding *finding, const struct bend_place *place)
{
    const struct bend_drawn *drawn = &finding->bend->drawn;
    for (size_t i = 0; i < 3; i++) {
        const struct influence_anchor *corner = &drawn->anchors[drawn->triangles[3 * (size_t)finding->tri + i]];
        if (place->weights[i] == 1 && corner->points[0] == place->anchor.points[0] && corner->weights[0] == 1)
            return true;
    }
    return false;
}

/* Returns whether the place (corner of an overlap) needs no check: both fields are equal there (is_corner()), or it duplicates
 * another place of the drawn triangle. May miss a duplicate, which only costs time. */
static bool is_known(struct finding *finding, const struct bend_place *place)
{
    const struct influence_bend *bend = finding->bend;
    if (is_single(&place->anchor)) {
        uint32_t *taken_by = &finding->taken_by[place->anchor.points[0]];
        bool known = *taken_by == finding->tri + 1 || is_corner(finding, place);
        *taken_by = finding->tri + 1;
        return known;
    }
    for (size_t i = bend->count; i > finding->first && i + LOOK_BACK > bend->count; i--) {
        const struct bend_place *other = &bend->places[i - 1];
        if (fabsf(other->weights[0] - place->weights[0]) <= (float)SAME && fabsf(other->weights[1] - place->weights[1]) <= (float)SAME &&
            same_points(&other->anchor, &place->anchor))
            return true;
    }
    return false;
}

static void add_place(struct finding *finding, const double at[2], const double piece[3][2], const uint32_t points[3])
{
    struct influence_bend *bend = finding->bend;
    struct bend_place place = { .tri = finding->tri };
    weights_in((const double(*)[2])finding->corners, at, place.weights);
    weights_in(piece, at, place.anchor.weights);
    memcpy(place.anchor.points, points, sizeof(place.anchor.points));
    tidy(&place.anchor);
    if (is_known(finding, &place))
        return;
    if (bend->count >= finding->most) {
        finding->full = true;
        return;
    }
    mem_grow(&bend->places, &bend->capacity, bend->count + 1, sizeof(*bend->places));
    bend->places[bend->count++] = place;
}

/* --- passes -------------------------------------------------------------------------------------------------------------------- */

/* Processes a mesh triangle whose box is near the drawn triangle: removes the area it covers from finding->cut. If a triangle
 * of the solved mesh (not a hidden one) overlaps finding->left, adds the overlap's corners as places (points at which the error
 * is measured). */
static void visit(void *arg, uint32_t tri)
{
    struct finding *finding = arg;
    const bool solved = finding->mesh == finding->visible;
    const uint32_t *points = finding->mesh->tris[tri];
    const double(*at)[3] = (const double(*)[3])finding->mesh->points;
    double piece[3][2], normal[3], off_m;
    vec_normal(at[points[0]], at[points[1]], at[points[2]], normal);
    double facing = vec_dot(normal, finding->axes[2]), least = LEAST_FACING * vec_length(normal);
    /* Skips a triangle of the solved mesh that faces another way than the drawn triangle. A hidden triangle may also face the
       opposite way. */
    if (finding->full || !((solved ? facing : fabs(facing)) > least))
        return;
    uint32_t order[3] = { points[0], points[facing > 0 ? 1 : 2], points[facing > 0 ? 2 : 1] };
    for (int i = 0; i < 3; i++) {
        flatten(finding, at[order[i]], piece[i], &off_m);
        if (off_m > finding->off_m)
            return;
    }
    if (!(polygon_cross(piece[0], piece[1], piece[2]) > 0))
        return;
    struct polygon in;
    const double least_m2 = LEAST * finding->size_m * finding->size_m;
    bool covers = false;
    for (size_t i = 0; i < finding->left.count; i++) {
        if (!polygon_in_triangle(&finding->left.of[i], (const double(*)[2])piece, &in) || !(polygon_area(&in) > least_m2))
            continue;
        covers = true;
        for (int k = 0; solved && k < in.count; k++)
            add_place(finding, in.at[k], (const double(*)[2])piece, order);
    }
    const size_t before = finding->cut.count;
    if (!covers)
        return;
    for (size_t i = 0; i < before; i++) {
        struct polygon polygon = finding->cut.of[i];
        polygons_add_outside(&finding->cut, &polygon, (const double(*)[2])piece, least_m2);
    }
    finding->cut.count -= before;
    memmove(finding->cut.of, finding->cut.of + before, finding->cut.count * sizeof(*finding->cut.of));
}

/* Makes one pass over the current drawn triangle: clips its uncovered area finding->left against all mesh triangles within
 * off_m of its plane. Returns the area they cover. */
static double cover(struct finding *finding, const struct trimesh *mesh, const struct bvh *bvh, double off_m)
{
    double before_m2 = polygons_area(&finding->left);
    if (finding->left.count == 0)
        return 0;
    finding->mesh = mesh;
    finding->off_m = off_m;
    finding->cut.count = 0;
    for (size_t i = 0; i < finding->left.count; i++)
        polygons_add(&finding->cut, &finding->left.of[i]);
    bvh_overlaps(bvh, finding->extent.low, finding->extent.high, off_m, visit, finding);
    struct polygons were = finding->left;
    finding->left = finding->cut;
    finding->cut = were;
    return before_m2 - polygons_area(&finding->left);
}

static size_t finest_count(const struct bend_drawn *drawn)
{
    return drawn->level_count > 0 ? drawn->levels[0].triangle_count : drawn->triangle_count;
}

/* Makes a triangle of the asset file the current drawn triangle. Returns its area, or 0 if it is degenerate. */
static double take_triangle(struct finding *finding, const double p[3][3])
{
    double along[3], off_m;
    finding->extent = extent_empty();
    for (int i = 0; i < 3; i++)
        extent_add(&finding->extent, p[i]);
    memcpy(finding->origin, p[0], sizeof(p[0]));
    vec_normal(p[0], p[1], p[2], finding->axes[2]);
    vec_sub(p[1], p[0], along);
    if (!(vec_normalize(finding->axes[2]) > 0) || !(vec_normalize(along) > 0))
        return 0;
    memcpy(finding->axes[0], along, sizeof(along));
    vec_cross(finding->axes[2], finding->axes[0], finding->axes[1]);
    finding->size_m = 0;
    struct polygon whole = { .count = 3 };
    for (int i = 0; i < 3; i++) {
        flatten(finding, p[i], finding->corners[i], &off_m);
        finding->size_m = fmax(finding->size_m, hypot(finding->corners[i][0], finding->corners[i][1]));
        memcpy(whole.at[i], finding->corners[i], sizeof(whole.at[i]));
    }
    finding->left.count = 0;
    polygons_add(&finding->left, &whole);
    finding->first = finding->bend->count;
    return polygon_area(&whole);
}

static void corners_of(const struct bend_drawn *drawn, size_t tri, double p[3][3])
{
    for (size_t i = 0; i < 3; i++)
        for (int axis = 0; axis < 3; axis++)
            p[i][axis] = (double)drawn->positions_m[drawn->triangles[3 * tri + i]][axis];
}

static void find_places(struct finding *finding)
{
    const struct bend_drawn *drawn = &finding->bend->drawn;
    for (size_t t = 0; t < finest_count(drawn) && !finding->full; t++) {
        double p[3][3];
        corners_of(drawn, t, p);
        finding->tri = (uint32_t)t;
        double area_m2 = finding->bend->area_m2[t] = take_triangle(finding, (const double(*)[3])p);
        if (!(area_m2 > 0))
            continue;
        cover(finding, finding->visible, finding->visible_bvh, finding->in_plane_m);
        finding->bend->hidden_m2[t] = cover(finding, finding->hidden, finding->hidden_bvh, finding->in_plane_m);
        cover(finding, finding->visible, finding->visible_bvh, finding->near_m);
        finding->bend->hidden_m2[t] += cover(finding, finding->hidden, finding->hidden_bvh, finding->near_m);
        double left_m2 = polygons_area(&finding->left);
        finding->bend->unknown_m2[t] = left_m2 > COVERED * area_m2 ? left_m2 : 0;
    }
}

/* --- coarser levels ------------------------------------------------------------------------------------------------------------ */

/* barycentric weights (times 3) of the points of a triangle at which the bend is measured: two on each side, at its thirds, and
 * the centre */
enum { SAMPLES = 7 };
static const double samples[SAMPLES][3] = { { 2, 1, 0 }, { 1, 2, 0 }, { 0, 2, 1 }, { 0, 1, 2 }, { 1, 0, 2 }, { 2, 0, 1 }, { 1, 1, 1 } };

/* Adds sample points of a coarse level's triangle as places (points at which the error is measured). Where the finest level
 * records areas, a coarse level records numbers of sample points. */
static void sample_triangle(struct finding *finding, const struct influence_mesh *mesh, const struct surface *surface, size_t tri,
                            double within_m)
{
    struct influence_bend *bend = finding->bend;
    double p[3][3], normal[3];
    corners_of(&bend->drawn, tri, p);
    vec_normal(p[0], p[1], p[2], normal);
    for (int i = 0; i < SAMPLES && vec_length(normal) > 0; i++) {
        struct bend_place place = { .tri = (uint32_t)tri };
        struct surface_point hit;
        double at[3];
        for (int k = 0; k < 3; k++)
            place.weights[k] = (float)(samples[i][k] / 3);
        for (int axis = 0; axis < 3; axis++)
            at[axis] = (samples[i][0] * p[0][axis] + samples[i][1] * p[1][axis] + samples[i][2] * p[2][axis]) / 3;
        bend->area_m2[tri]++;
        if (!surface_find_point_within(surface, at, normal, within_m, &hit)) {
            bend->unknown_m2[tri]++;
            continue;
        }
        finding->full |= bend->count >= finding->most;
        if (finding->full)
            return;
        influence_mesh_anchor(mesh, &hit, &place.anchor);
        mem_grow(&bend->places, &bend->capacity, bend->count + 1, sizeof(*bend->places));
        bend->places[bend->count++] = place;
    }
}

static void sample_levels(struct finding *finding, const struct influence_mesh *mesh, const struct surface *surface)
{
    const struct bend_drawn *drawn = &finding->bend->drawn;
    size_t tri = finest_count(drawn);
    for (size_t level = 1; level < drawn->level_count; level++)
        for (size_t i = 0; i < drawn->levels[level].triangle_count && !finding->full; i++)
            sample_triangle(finding, mesh, surface, tri++, drawn->levels[level].error_m + finding->near_m);
}

bool influence_bend_init(struct influence_bend *bend, const struct influence_mesh *mesh, const struct surface *surface,
                         const struct bend_drawn *drawn, size_t most)
{
    struct surface_debug_mesh look;
    surface_debug_mesh(surface, &look);
    struct trimesh hidden = { .points = mem_array(look.point_count, sizeof(*hidden.points)), .point_count = look.point_count };
    memcpy(hidden.points, look.points_m, look.point_count * sizeof(*hidden.points));
    for (size_t t = look.visible_count; t < look.tri_count; t++)
        trimesh_add_tri(&hidden, look.tris[t][0], look.tris[t][1], look.tris[t][2], (uint32_t)t);
    *bend = (struct influence_bend){ .drawn = *drawn, .mesh_error = mesh_error_create(mesh), .point_count = mesh->mesh.point_count };
    bend->area_m2 = mem_array(drawn->triangle_count, sizeof(*bend->area_m2));
    bend->hidden_m2 = mem_array(drawn->triangle_count, sizeof(*bend->hidden_m2));
    bend->unknown_m2 = mem_array(drawn->triangle_count, sizeof(*bend->unknown_m2));
    struct finding finding = { .bend = bend, .most = most, .visible = &mesh->mesh, .hidden = &hidden };
    finding.in_plane_m = OFF_PLANE * mesh->size_m;
    finding.near_m = fmax(surface_report(surface)->tolerance_m, finding.in_plane_m);
    finding.visible_bvh = bvh_create(finding.visible);
    finding.hidden_bvh = bvh_create(finding.hidden);
    finding.taken_by = mem_array(mesh->mesh.point_count, sizeof(*finding.taken_by));
    find_places(&finding);
    sample_levels(&finding, mesh, surface);
    mem_free(finding.taken_by);
    bvh_destroy(&finding.visible_bvh);
    bvh_destroy(&finding.hidden_bvh);
    trimesh_finish(&hidden);
    polygons_finish(&finding.left);
    polygons_finish(&finding.cut);
    bend->plus = mem_try_array(bend->count, sizeof(*bend->plus));
    bend->minus = mem_try_array(bend->count, sizeof(*bend->minus));
    return !finding.full && bend->plus && bend->minus && bend->mesh_error;
}

void influence_bend_finish(struct influence_bend *bend)
{
    mem_free(bend->places);
    mem_free(bend->area_m2);
    mem_free(bend->hidden_m2);
    mem_free(bend->unknown_m2);
    mem_free((void *)bend->plus);
    mem_free((void *)bend->minus);
    mesh_error_destroy(&bend->mesh_error);
    *bend = (struct influence_bend){ 0 };
}
