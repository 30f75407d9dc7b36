/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides which parts (connected components) a far level may omit: small parts that lie on larger ones, and groups of parts
 * that are together smaller than a pixel. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/levels/box_groups.h"
#include "preprocess/levels/levels_impl.h"
#include "surface/mesh/bvh.h"

#define MUCH_LARGER 4.0f /* minimum size ratio of a larger part to a small part that lies on it */
#define MAX_PX 8.0f      /* largest size in pixels at which a part that lies on another part is left out */
/* factor from the distance between the part and the larger parts to the expected error of omitting it; above 1, because the
 * larger parts are simplified too */
#define OVER 1.1f
#define SMALL 0.1   /* maximum size of a part that is omitted because it lies on others, relative to the asset's size */
#define AROUND 4.0f /* small parts closer together than this many times their size form a group, which is omitted as a whole */
#define PROBES 4    /* number of points on each edge of a small part's triangles at which the distance from larger parts is measured */

#define CLASSES_MAX 20
#define FEWER 0.75 /* a size class (struct size_class) is made only if it has at most this share of the previous class's triangles */

/* Size class: the triangles of all parts larger than than_m, with their own bounding volume hierarchy. In a hierarchy of all
 * triangles, each search for a larger part would first find the small part itself and its neighbours. */
struct size_class {
    float than_m;
    struct trimesh mesh; /* triangles of the size class, over the points of the whole mesh */
    struct bvh *bvh;
};

struct omission_search {
    const struct welds *welds;
    struct trimesh mesh;
    struct size_class classes[CLASSES_MAX]; /* size classes, by increasing than_m */
    size_t class_count;
    uint32_t *part;         /* by triangle: its part (connected component) */
    uint32_t *first, *tris; /* indices of triangles, grouped by part (connected component) */
    struct omission *omissions;
};

static void list_tris(struct omission_search *search)
{
    const struct geometry *g = search->welds->geometry;
    size_t tris = g->index_count / 3, parts = search->welds->part_count;
    search->part = mem_array(tris, sizeof(*search->part));
    search->tris = mem_array(tris, sizeof(*search->tris));
    search->first = mem_array(parts + 2, sizeof(*search->first));
    for (size_t k = 0; k < search->welds->count; k++) {
        const float *p = search->welds->positions_m[k];
        trimesh_add_point(&search->mesh, (const double[3]){ (double)p[0], (double)p[1], (double)p[2] });
    }
    for (uint32_t t = 0; t < tris; t++) {
        const uint32_t *v = g->indices + 3 * (size_t)t, *of = search->welds->of_vertex;
        trimesh_add_tri(&search->mesh, of[v[0]], of[v[1]], of[v[2]], t);
        search->part[t] = search->welds->part[of[v[0]]];
        search->first[search->part[t] + 2]++;
    }
    for (size_t p = 2; p < parts + 2; p++)
        search->first[p] += search->first[p - 1];
    for (uint32_t t = 0; t < tris; t++)
        search->tris[search->first[search->part[t] + 1]++] = t;
}

/* --- finding small parts that lie on larger ones -------------------------------------------------------------------------- */

static bool may_lie_on_others(const struct welds *welds, size_t part)
{
    return (double)welds->size_m[part] <= SMALL * welds->whole_m;
}

static size_t count_larger(const struct omission_search *search, float than_m)
{
    size_t count = 0;
    for (size_t t = 0; t < search->mesh.tri_count; t++)
        count += search->welds->size_m[search->part[t]] > than_m;
    return count;
}

static void add_class(struct omission_search *search, float than_m, size_t count)
{
    struct size_class *class = &search->classes[search->class_count++];
    const struct trimesh *all = &search->mesh;
    *class = (struct size_class){ .than_m = than_m, .mesh = { .points = all->points, .point_count = all->point_count } };
    class->mesh.tris = mem_array(count, sizeof(*class->mesh.tris));
    class->mesh.tri_source = mem_array(count, sizeof(*class->mesh.tri_source));
    for (uint32_t t = 0; t < all->tri_count; t++)
        if (search->welds->size_m[search->part[t]] > than_m) {
            memcpy(class->mesh.tris[class->mesh.tri_count], all->tris[t], sizeof(*all->tris));
            class->mesh.tri_source[class->mesh.tri_count++] = t;
        }
    class->bvh = bvh_create(&class->mesh);
}

/* Builds the size classes (struct size_class). A search for parts larger than a limit uses the class with the largest than_m up
 * to that limit. */
static void make_classes(struct omission_search *search)
{
    const struct welds *welds = search->welds;
    float least_m = INFINITY, most_m = (float)(MUCH_LARGER * SMALL * welds->whole_m);
    for (size_t p = 0; p < welds->part_count; p++)
        least_m = may_lie_on_others(welds, p) ? fminf(least_m, MUCH_LARGER * welds->size_m[p]) : least_m;
    if (isinf(least_m))
        return;
    size_t last = count_larger(search, least_m);
    add_class(search, least_m, last);
    for (float than_m = fmaxf(2 * least_m, 1e-5f * most_m); than_m <= most_m && search->class_count < CLASSES_MAX; than_m *= 2) {
        size_t count = count_larger(search, than_m);
        if ((double)count <= FEWER * (double)last) {
            add_class(search, than_m, count);
            last = count;
        }
    }
}

static void finish_classes(struct omission_search *search)
{
    for (size_t c = 0; c < search->class_count; c++) {
        bvh_destroy(&search->classes[c].bvh);
        mem_free(search->classes[c].mesh.tris);
        mem_free(search->classes[c].mesh.tri_source);
    }
}

struct larger {
    const struct omission_search *search;
    const struct size_class *class;
    float than_m;
    uint32_t near; /* the triangle nearest to the previous point, which is tested first; TRIMESH_NONE: none */
};

static bool is_larger(const void *arg, uint32_t tri)
{
    const struct larger *larger = arg;
    return larger->search->welds->size_m[larger->search->part[larger->class->mesh.tri_source[tri]]] > larger->than_m;
}

/* Returns the larger of apart_m and the largest distance of points on the edges of triangle `tri` from the larger parts;
 * INFINITY if that distance exceeds limit_m. */
static float look_from(struct larger *larger, uint32_t tri, double limit_m, float apart_m)
{
    const struct trimesh *mesh = &larger->search->mesh;
    const struct bvh *bvh = larger->class->bvh;
    for (int i = 0; i < 3 * PROBES && !isinf(apart_m); i++) {
        const double *a = mesh->points[mesh->tris[tri][i / PROBES]], *b = mesh->points[mesh->tris[tri][(i / PROBES + 1) % 3]];
        double t = (double)(i % PROBES) / PROBES, point[3];
        struct bvh_place place;
        for (int axis = 0; axis < 3; axis++)
            point[axis] = a[axis] + t * (b[axis] - a[axis]);
        if (apart_m > 0 && bvh_any_within(bvh, point, (double)apart_m, is_larger, larger, &larger->near))
            continue;
        bvh_nearest(bvh, point, limit_m, is_larger, larger, &place);
        apart_m = place.tri == TRIMESH_NONE ? INFINITY : fmaxf(apart_m, (float)place.distance_m);
    }
    return apart_m;
}

static void look_for_larger(void *arg, size_t begin, size_t end)
{
    const struct omission_search *search = arg;
    for (size_t p = begin; p < end; p++) {
        float size_m = search->welds->size_m[p], apart_m = 0;
        struct larger larger = { search, search->classes, MUCH_LARGER * size_m, TRIMESH_NONE };
        if (!may_lie_on_others(search->welds, p))
            continue;
        while (larger.class + 1 < search->classes + search->class_count && larger.class[1].than_m <= larger.than_m)
            larger.class ++;
        for (uint32_t i = search->first[p]; i < search->first[p + 1] && !isinf(apart_m); i++)
            apart_m = look_from(&larger, search->tris[i], (double)size_m / 2, apart_m);
        if (!isinf(apart_m))
            search->omissions[p].from_m = fmaxf(OVER * apart_m, size_m / MAX_PX);
    }
}

/* --- isolated parts ------------------------------------------------------------------------------------------------------- */

/* Lists the bounding boxes of small parts without a larger part near them, enlarged by the distance up to which another part
 * counts as near. */
static size_t list_boxes(const struct omission_search *search, struct part_box *boxes)
{
    const struct welds *welds = search->welds;
    size_t count = 0;
    for (uint32_t p = 0; p < welds->part_count; p++) {
        struct part_box *box = &boxes[count];
        if (!isinf(search->omissions[p].from_m) || !may_lie_on_others(welds, p))
            continue;
        box->part = p;
        for (int axis = 0; axis < 3; axis++) {
            box->low_m[axis] = welds->low_m[p][axis] - AROUND / 2 * welds->size_m[p];
            box->high_m[axis] = welds->high_m[p][axis] + AROUND / 2 * welds->size_m[p];
        }
        count++;
    }
    return count;
}

/* Groups neighbouring small parts without a larger part near them. The parts of a group may be omitted from levels of detail
 * whose error is at least the group's size. */
static void look_for_lonely(const struct omission_search *search)
{
    const struct welds *welds = search->welds;
    struct part_box *boxes = mem_array(welds->part_count, sizeof(*boxes)), *crowds = mem_array(welds->part_count, sizeof(*crowds));
    uint32_t *parent = mem_array(welds->part_count, sizeof(*parent));
    size_t count = list_boxes(search, boxes);
    for (uint32_t p = 0; p < welds->part_count; p++) {
        parent[p] = p;
        for (int axis = 0; axis < 3; axis++) {
            crowds[p].low_m[axis] = welds->low_m[p][axis];
            crowds[p].high_m[axis] = welds->high_m[p][axis];
        }
    }
    box_groups_join(boxes, count, parent);
    for (size_t i = 0; i < count; i++) {
        struct part_box *crowd = &crowds[trimesh_root(parent, boxes[i].part)];
        for (int axis = 0; axis < 3; axis++) {
            crowd->low_m[axis] = fminf(crowd->low_m[axis], welds->low_m[boxes[i].part][axis]);
            crowd->high_m[axis] = fmaxf(crowd->high_m[axis], welds->high_m[boxes[i].part][axis]);
        }
    }
    for (size_t i = 0; i < count; i++) {
        const struct part_box *crowd = &crowds[trimesh_root(parent, boxes[i].part)];
        float size_m =
            hypotf(crowd->high_m[0] - crowd->low_m[0], hypotf(crowd->high_m[1] - crowd->low_m[1], crowd->high_m[2] - crowd->low_m[2]));
        search->omissions[boxes[i].part] = (struct omission){ .from_m = size_m, .alone = true };
    }
    mem_free(boxes);
    mem_free(crowds);
    mem_free(parent);
}

void omissions_find(struct omission *omissions, const struct welds *welds, struct workers *workers)
{
    struct omission_search search = { .welds = welds, .omissions = omissions };
    for (size_t p = 0; p < welds->part_count; p++)
        omissions[p] = (struct omission){ .from_m = INFINITY };
    if (welds->part_count < 2)
        return;
    list_tris(&search);
    make_classes(&search);
    workers_for(workers, welds->part_count, 16, look_for_larger, &search);
    look_for_lonely(&search);
    finish_classes(&search);
    trimesh_finish(&search.mesh);
    mem_free(search.part);
    mem_free(search.first);
    mem_free(search.tris);
}
