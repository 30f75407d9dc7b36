/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Simplifies a part (connected component) by edge collapses, each of which merges a mesh point into a neighbour. The collapse
 * that moves the surface least comes first. Each triangle keeps a list of the original vertices ("places") nearest to it
 * (Ciampalini et al., Multiresolution decimation based on global error, The Visual Computer 1997). The error of a collapse is
 * the largest of these distances: from each place of the affected triangles to the nearest new triangle, and from sample points
 * of the new triangles to the original surface. It is computed only when the collapse reaches the top of the heap. Until then, a
 * lower bound determines the collapse's position in the heap. */
#include "preprocess/levels/levels_bounded.h"

#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

#define RING 48    /* maximum number of triangles around a mesh point that may be merged into another */
#define TURN 0.4   /* minimum cosine of the angle by which an edge collapse may turn a triangle's normal */
#define BORDER 0.5 /* how far open borders and seams (of material or texture) may move, as a share of the allowed error */
/* error added per metre by which a triangle's longest edge grows, because subdivision must split long edges later */
#define STRETCH 0.05
#define NONE UINT32_MAX

struct bounded_face {
    uint32_t point[3], weld[3]; /* mesh points and welds (groups of equal vertices) at the corners; all NONE: the face was removed */
    uint32_t first;             /* index of the first original vertex ("place") in the face's list; next_place[] links the others */
    /* triangle of the original surface nearest to this face in the last distance test; tested first in the next one */
    uint32_t near;
    double normal[3], length; /* normal, not normalised; its length, which is twice the triangle's area */
    double longest_m;         /* length of the face's longest edge */
};

struct removal_candidate { /* heap entry: a mesh point that may be merged into the point `target` */
    float error_m;         /* error of merging the point into `target`: exact if is_known, else a lower bound */
    uint32_t point, stamp, target;
    bool is_known; /* error_m is exact */
};

struct bounded {
    const struct welds *welds;
    const struct bvh *first;
    double (*points)[3];
    float *moved_m; /* by mesh point: how far the open borders and seams there have moved so far */
    /* corner[point]: head of the list of face corners at a mesh point (3 * face + 0 to 2); next[corner]: the next corner in the list */
    uint32_t *corner;
    uint32_t *next;
    /* by mesh point: incremented when the triangles around it change; a heap entry with an older value is outdated */
    uint32_t *stamp;
    struct bounded_face *faces;
    size_t point_count, face_count, left;
    double (*places)[3];
    uint32_t *next_place;
    struct removal_candidate *heap;
    size_t heap_count, heap_capacity;
};

/* --- heap ---------------------------------------------------------------------------------------------------------------------- */

static bool is_before(const struct removal_candidate *a, const struct removal_candidate *b)
{
    return a->error_m != b->error_m ? a->error_m < b->error_m : a->point < b->point;
}

static void push(struct bounded *b, struct removal_candidate turn)
{
    size_t i = b->heap_count++;
    mem_grow(&b->heap, &b->heap_capacity, b->heap_count, sizeof(*b->heap));
    for (; i > 0 && is_before(&turn, &b->heap[(i - 1) / 2]); i = (i - 1) / 2)
        b->heap[i] = b->heap[(i - 1) / 2];
    b->heap[i] = turn;
}

static struct removal_candidate pop(struct bounded *b)
{
    struct removal_candidate top = b->heap[0], last = b->heap[--b->heap_count];
    size_t i = 0;
    for (size_t child; (child = 2 * i + 1) < b->heap_count; i = child) {
        child += child + 1 < b->heap_count && is_before(&b->heap[child + 1], &b->heap[child]);
        if (!is_before(&b->heap[child], &last))
            break;
        b->heap[i] = b->heap[child];
    }
    b->heap[i] = last;
    return top;
}

/* --- ring: triangles around a point ---------------------------------------------------------------------------------------------- */

struct ring_wedge {               /* one of the triangles around a mesh point */
    uint32_t face, at;            /* at: index (0 to 2) of the face's corner at the point */
    uint32_t weld;                /* weld (group of equal vertices) of the face's corner at the point */
    uint32_t points[2], welds[2]; /* points and welds (groups of equal vertices) at the face's other two corners, in winding order */
};

struct point_ring {
    uint32_t point;
    struct ring_wedge wedges[RING];
    int count; /* number of wedges (triangles around the point); RING + 1: too many to store */
    /* by edge from the ring's point: the point at the other end; in one of the edge's triangles, the welds (groups of equal
     * vertices) at the near end (here) and the far end (there) */
    uint32_t ends[2 * RING], weld_here[2 * RING], weld_there[2 * RING];
    bool is_feature[2 * RING]; /* by edge from the ring's point: it is an open border or a seam of material or texture */
    int end_count, feature_count;
    double longest_m; /* longest edge of the triangles around the point */
};

static struct ring_wedge wedge_of(const struct bounded *b, uint32_t corner)
{
    const struct bounded_face *face = &b->faces[corner / 3];
    uint32_t at = corner % 3, next = (at + 1) % 3, last = (at + 2) % 3;
    return (struct ring_wedge){
        corner / 3, at, face->weld[at], { face->point[next], face->point[last] }, { face->weld[next], face->weld[last] }
    };
}

static void list_ring(struct bounded *b, uint32_t point, struct point_ring *ring)
{
    uint32_t *link = &b->corner[point];
    ring->point = point;
    ring->count = 0;
    ring->longest_m = 0;
    while (*link != NONE && ring->count <= RING) {
        uint32_t corner = *link;
        const struct bounded_face *face = &b->faces[corner / 3];
        /* the corner's point was merged into another point, or its face was removed: unlink the corner from the point's list */
        if (face->point[corner % 3] != point) {
            *link = b->next[corner];
            continue;
        }
        if (ring->count < RING)
            ring->wedges[ring->count] = wedge_of(b, corner);
        ring->count++;
        ring->longest_m = max_of(ring->longest_m, face->longest_m);
        link = &b->next[corner];
    }
}

static void list_ends(struct point_ring *ring)
{
    int times[2 * RING];
    ring->end_count = ring->feature_count = 0;
    for (int c = 0; c < ring->count; c++)
        for (int i = 0; i < 2; i++) {
            const struct ring_wedge *wedge = &ring->wedges[c];
            int e = 0;
            while (e < ring->end_count && ring->ends[e] != wedge->points[i])
                e++;
            if (e == ring->end_count) {
                ring->ends[ring->end_count++] = wedge->points[i];
                ring->weld_here[e] = wedge->weld;
                ring->weld_there[e] = wedge->welds[i];
                times[e] = 0;
                ring->is_feature[e] = false;
            }
            times[e]++;
            ring->is_feature[e] |= ring->weld_here[e] != wedge->weld || ring->weld_there[e] != wedge->welds[i];
        }
    for (int e = 0; e < ring->end_count; e++) {
        ring->is_feature[e] |= times[e] == 1;
        ring->feature_count += ring->is_feature[e];
    }
}

static double distance_to(const double p[3], const double a[3], const double b[3], const double c[3])
{
    double w[3], at[3];
    triangle_nearest(p, a, b, c, w);
    for (int i = 0; i < 3; i++)
        at[i] = w[0] * a[i] + w[1] * b[i] + w[2] * c[i];
    return vec_distance(p, at);
}

static bool has_end(const struct ring_wedge *wedge, uint32_t end)
{
    return wedge->points[0] == end || wedge->points[1] == end;
}

/* Returns the weld (group of equal vertices) that a corner at the ring's point gets when this point is merged into the target:
 * the target's weld in a triangle that contains both points. Returns NONE if no weld or several welds fit. */
static uint32_t weld_after(const struct point_ring *ring, int target, uint32_t weld)
{
    uint32_t found = NONE;
    if (!ring->is_feature[target] && ring->weld_here[target] == weld)
        return ring->weld_there[target];
    for (int c = 0; c < ring->count; c++)
        for (int i = 0; i < 2; i++)
            if (ring->wedges[c].points[i] == ring->ends[target] && ring->wedges[c].weld == weld) {
                if (found != NONE && found != ring->wedges[c].welds[i])
                    return NONE;
                found = ring->wedges[c].welds[i];
            }
    return found;
}

/* Computes the corner positions of a triangle around a point after the point is merged into `target`. */
static void moved_face(const struct bounded *b, const struct ring_wedge *wedge, uint32_t target, const double *at[3])
{
    at[wedge->at] = b->points[target];
    at[(wedge->at + 1) % 3] = b->points[wedge->points[0]];
    at[(wedge->at + 2) % 3] = b->points[wedge->points[1]];
}

/* Returns how far open borders and seams would move if the ring's point were merged into a neighbour, in metres, including
 * earlier moves. 0: the point is on none; INFINITY: the merge is forbidden, because it would break a border or seam. */
static double border_of(const struct bounded *b, const struct point_ring *ring, int target)
{
    int other = -1;
    if (ring->feature_count == 0)
        return 0;
    if (ring->feature_count != 2 || !ring->is_feature[target])
        return INFINITY;
    for (int e = 0; e < ring->end_count; e++)
        if (ring->is_feature[e] && e != target)
            other = e;
    return (double)b->moved_m[ring->point] +
           vec_segment_distance(b->points[ring->point], b->points[ring->ends[target]], b->points[ring->ends[other]]);
}

static double longest_edge(const double *const at[3])
{
    return sqrt(max_of(vec_distance2(at[0], at[1]), max_of(vec_distance2(at[1], at[2]), vec_distance2(at[2], at[0]))));
}

/* Returns a lower bound of the error of merging the ring's point into a neighbour, in metres. INFINITY: the merge is forbidden,
 * or its error is at least most_m. */
static double bound_of(const struct bounded *b, const struct point_ring *ring, int target, double most_m)
{
    uint32_t to = ring->ends[target];
    double nearest_m = INFINITY, border_m = border_of(b, ring, target) / BORDER, longer_m = 0;
    for (int c = 0; c < ring->count; c++) {
        const struct ring_wedge *wedge = &ring->wedges[c];
        const struct bounded_face *face = &b->faces[wedge->face];
        const double *at[3];
        double normal[3], from[3];
        if (border_m + STRETCH * longer_m >= most_m)
            return INFINITY;
        if (has_end(wedge, to))
            continue;
        moved_face(b, wedge, to, at);
        vec_normal(at[0], at[1], at[2], normal);
        double length = vec_length(normal);
        if (!(vec_dot(normal, face->normal) > TURN * (length * face->length)) || weld_after(ring, target, wedge->weld) == NONE)
            return INFINITY;
        longer_m = max_of(longer_m, longest_edge(at) - ring->longest_m);
        vec_sub(b->points[ring->point], at[0], from);
        nearest_m = min_of(nearest_m, fabs(vec_dot(from, normal)) / length);
    }
    return max_of(nearest_m, border_m) + STRETCH * longer_m;
}

/* Returns the larger of error_m and the distance of `point` from the original surface. Tests triangle *near first; *near
 * receives the nearest triangle. */
static double raise(const struct bounded *b, const double point[3], double error_m, uint32_t *near)
{
    struct bvh_place place;
    if (error_m > 0 && bvh_any_within(b->first, point, error_m, NULL, NULL, near))
        return error_m;
    bvh_nearest(b->first, point, INFINITY, NULL, NULL, &place);
    return max_of(error_m, place.distance_m);
}

struct moved { /* a triangle after an edge collapse */
    const double *at[3];
    const struct ring_wedge *wedge;
};

/* Returns the distance from an original vertex ("place") to the nearest of the triangles that a collapse would move. Stops at a
 * triangle within enough_m: the result is then any value up to enough_m. Tests the place's own triangle first. */
static double distance_to_any(const double place[3], const struct moved *moved, int count, int own, double enough_m)
{
    double nearest_m = INFINITY;
    for (int i = 0; i < count && nearest_m > enough_m; i++) {
        int f = i == 0 ? own : i <= own ? i - 1 : i;
        const double *const *at = moved[f].at;
        if (i == 0 || !triangle_is_farther(place, at[0], at[1], at[2], nearest_m))
            nearest_m = min_of(nearest_m, distance_to(place, at[0], at[1], at[2]));
    }
    return nearest_m;
}

/* Returns the largest of error_m and the two distances that make up the error of a collapse: from the affected original
 * vertices ("places") to the triangles after the collapse, and from these triangles to the original surface. Stops as soon as
 * the result exceeds enough_m. */
static double error_of(struct bounded *b, const struct point_ring *ring, uint32_t to, double error_m, double enough_m)
{
    struct moved moved[RING];
    int count = 0, own[RING];
    for (int c = 0; c < ring->count; c++) {
        own[c] = count;
        if (!has_end(&ring->wedges[c], to)) {
            moved[count].wedge = &ring->wedges[c];
            moved_face(b, &ring->wedges[c], to, moved[count++].at);
        }
    }
    for (int c = 0; c < ring->count && error_m <= enough_m; c++)
        for (uint32_t s = b->faces[ring->wedges[c].face].first; s != NONE && error_m <= enough_m; s = b->next_place[s])
            error_m = max_of(error_m, distance_to_any(b->places[s], moved, count, own[c] < count ? own[c] : 0, error_m));
    /* measure each triangle as it will be after the collapse: at its centre, and at the midpoint of the edge not shared with
     * the next of these triangles */
    for (int f = 0; f < count && error_m <= enough_m; f++) {
        const double *const *at = moved[f].at;
        uint32_t m = moved[f].wedge->at, *near = &b->faces[moved[f].wedge->face].near;
        double middle[2][3];
        for (int i = 0; i < 3; i++) {
            middle[0][i] = (at[0][i] + at[1][i] + at[2][i]) / 3;
            middle[1][i] = 0.5 * (at[m][i] + at[(m + 1) % 3][i]);
        }
        error_m = raise(b, middle[0], error_m, near);
        error_m = raise(b, middle[1], error_m, near);
    }
    return error_m;
}

/* --- collapsing ------------------------------------------------------------------------------------------------------------------ */

/* Finds the neighbour whose merge with the point has the smallest lower bound of the error, and pushes this merge onto the heap. */
static void offer(struct bounded *b, uint32_t point)
{
    struct point_ring ring;
    struct removal_candidate turn = { INFINITY, point, ++b->stamp[point], NONE, false };
    list_ring(b, point, &ring);
    if (ring.count == 0 || ring.count > RING)
        return;
    list_ends(&ring);
    for (int e = 0; e < ring.end_count; e++) {
        float error_m = (float)bound_of(b, &ring, e, (double)turn.error_m);
        if (error_m < turn.error_m) {
            turn.error_m = error_m;
            turn.target = ring.ends[e];
        }
    }
    if (turn.target != NONE)
        push(b, turn);
}

static void add_place(struct bounded *b, uint32_t face, uint32_t place)
{
    b->next_place[place] = b->faces[face].first;
    b->faces[face].first = place;
}

static void measure_face(const struct bounded *b, struct bounded_face *face)
{
    const double *const at[3] = { b->points[face->point[0]], b->points[face->point[1]], b->points[face->point[2]] };
    vec_normal(at[0], at[1], at[2], face->normal);
    face->length = vec_length(face->normal);
    face->longest_m = longest_edge(at);
}

/* Assigns the original vertex `place` to the nearest of the listed faces of the simplified surface; of equally near faces, to
   the first. Returns that face's index in the list. Tests the face `last` first, because successive places are close
   together. */
static int rehome(struct bounded *b, const uint32_t *faces, int count, int last, uint32_t place)
{
    double nearest_m = INFINITY;
    int best = last;
    for (int i = 0; i < count; i++) {
        int f = i == 0 ? last : i <= last ? i - 1 : i;
        const uint32_t *v = b->faces[faces[f]].point;
        const double *at[3] = { b->points[v[0]], b->points[v[1]], b->points[v[2]] };
        if (i > 0 && triangle_is_farther(b->places[place], at[0], at[1], at[2], nearest_m))
            continue;
        double away_m = distance_to(b->places[place], at[0], at[1], at[2]);
        if (away_m < nearest_m || (away_m == nearest_m && f < best)) {
            nearest_m = away_m;
            best = f;
        }
    }
    add_place(b, faces[best], place);
    return best;
}

static void collapse(struct bounded *b, const struct point_ring *ring, int target)
{
    uint32_t to = ring->ends[target], places = NONE, kept[RING], after[RING];
    int count = 0, last = 0;
    float border_m = (float)border_of(b, ring, target);
    for (int c = 0; c < ring->count; c++)
        after[c] = weld_after(ring, target, ring->wedges[c].weld);
    for (int c = 0; c < ring->count; c++) {
        const struct ring_wedge *wedge = &ring->wedges[c];
        struct bounded_face *face = &b->faces[wedge->face];
        uint32_t corner = 3 * wedge->face + wedge->at;
        while (face->first != NONE) {
            uint32_t place = face->first;
            face->first = b->next_place[place];
            b->next_place[place] = places;
            places = place;
        }
        if (has_end(wedge, to)) {
            face->point[0] = face->point[1] = face->point[2] = NONE;
            b->left--;
            continue;
        }
        face->point[wedge->at] = to;
        face->weld[wedge->at] = after[c];
        measure_face(b, face);
        b->next[corner] = b->corner[to];
        b->corner[to] = corner;
        kept[count++] = wedge->face;
    }
    b->corner[ring->point] = NONE;
    while (places != NONE) {
        uint32_t place = places;
        places = b->next_place[place];
        last = rehome(b, kept, count, last, place);
    }
    for (int e = 0; e < ring->end_count && border_m > 0; e++)
        if (ring->is_feature[e])
            b->moved_m[ring->ends[e]] = fmaxf(b->moved_m[ring->ends[e]], border_m);
    for (int e = 0; e < ring->end_count; e++)
        offer(b, ring->ends[e]);
}

static int index_of(const struct point_ring *ring, uint32_t end)
{
    for (int e = 0; e < ring->end_count; e++)
        if (ring->ends[e] == end)
            return e;
    return -1;
}

/* Returns whether an edge collapse would make the surface touch itself along an edge: then both ends of the collapsed edge have
 * a common neighbour that is in no triangle with both (link condition; Dey et al., Topology preserving edge contraction, Publ.
 * Inst. Math. 1999). */
static bool would_touch(struct bounded *b, const struct point_ring *ring, int target)
{
    struct point_ring there;
    int common = 0, shared = 0;
    for (int c = 0; c < ring->count; c++)
        shared += has_end(&ring->wedges[c], ring->ends[target]);
    list_ring(b, ring->ends[target], &there);
    if (there.count > RING)
        return true;
    list_ends(&there);
    for (int e = 0; e < ring->end_count; e++)
        common += index_of(&there, ring->ends[e]) >= 0;
    return common > shared;
}

/* Pops the first collapse from the heap and drops it if it is outdated. If its exact error is known, and therefore the
 * smallest, collapses the edge; otherwise computes the exact error and pushes the collapse back unless it is still the first.
 * */
static void take_turn(struct bounded *b, double error_m)
{
    struct removal_candidate turn = pop(b);
    struct point_ring ring;
    if (turn.stamp != b->stamp[turn.point])
        return;
    list_ring(b, turn.point, &ring);
    list_ends(&ring);
    int target = index_of(&ring, turn.target);
    if (!turn.is_known) {
        turn.error_m = (float)error_of(b, &ring, turn.target, (double)turn.error_m, error_m);
        turn.is_known = (double)turn.error_m <= error_m;
        if (!turn.is_known || (b->heap_count > 0 && b->heap[0].error_m < turn.error_m)) {
            push(b, turn);
            return;
        }
    }
    if (!would_touch(b, &ring, target))
        collapse(b, &ring, target);
}

void bounded_simplify(struct bounded *b, double error_m)
{
    while (b->heap_count > 0 && (double)b->heap[0].error_m <= error_m && b->left > 2)
        take_turn(b, error_m);
}

/* --- all ------------------------------------------------------------------------------------------------------------------------ */

static void place_of(const struct welds *welds, uint32_t weld, double place[3])
{
    for (int axis = 0; axis < 3; axis++)
        place[axis] = (double)welds->positions_m[weld][axis];
}

/* map from welds (groups of equal vertices) to the mesh points of one part */
struct point_numbers {
    /* by weld index minus low: 1 + index of the weld's point, 0: none; range of weld indices in the map */
    uint32_t *of, low, high;
};

static struct point_numbers number_points(struct bounded *b, const uint32_t *corners, size_t count)
{
    const struct welds *welds = b->welds;
    struct point_numbers numbers = { NULL, NONE, 0 };
    for (size_t i = 0; i < count; i++) {
        uint32_t there = welds->first_there[corners[i]];
        numbers.low = there < numbers.low ? there : numbers.low;
        numbers.high = there > numbers.high ? there : numbers.high;
    }
    numbers.of = mem_array((size_t)numbers.high - numbers.low + 1, sizeof(*numbers.of));
    for (size_t i = 0; i < count; i++) {
        uint32_t there = welds->first_there[corners[i]], *at = &numbers.of[there - numbers.low];
        if (*at == 0) {
            *at = (uint32_t)++b->point_count;
            place_of(welds, there, b->points[b->point_count - 1]);
        }
        b->faces[i / 3].point[i % 3] = *at - 1;
        b->faces[i / 3].weld[i % 3] = corners[i];
    }
    b->face_count = count / 3;
    return numbers;
}

/* Removes triangles without area, because they are invisible. */
static void drop_empty(struct bounded *b)
{
    size_t kept = 0;
    for (size_t f = 0; f < b->face_count; f++) {
        const uint32_t *v = b->faces[f].point;
        if (v[0] != v[1] && v[1] != v[2] && v[2] != v[0])
            b->faces[kept++] = b->faces[f];
    }
    b->face_count = b->left = kept;
}

static void link_corners(struct bounded *b)
{
    memset(b->corner, 0xff, b->point_count * sizeof(*b->corner));
    for (size_t i = 3 * b->face_count; i-- > 0;) {
        uint32_t *first = &b->corner[b->faces[i / 3].point[i % 3]];
        b->next[i] = *first;
        *first = (uint32_t)i;
    }
}

static void measure_faces(struct bounded *b)
{
    for (size_t f = 0; f < b->face_count; f++) {
        measure_face(b, &b->faces[f]);
        b->faces[f].first = NONE;
        b->faces[f].near = TRIMESH_NONE;
    }
}

/* Assigns the original vertices ("places") that are not corners of the part's triangles to the nearest triangle. */
static void take_far_places(struct bounded *b, const uint32_t *places, size_t count)
{
    struct trimesh mesh = { .points = b->points, .point_count = b->point_count, .tri_count = b->face_count };
    mesh.tris = mem_array(b->face_count, sizeof(*mesh.tris));
    for (size_t f = 0; f < b->face_count; f++)
        memcpy(mesh.tris[f], b->faces[f].point, sizeof(*mesh.tris));
    struct bvh *bvh = bvh_create(&mesh);
    for (size_t i = 0; i < count; i++) {
        struct bvh_place place;
        bvh_nearest(bvh, b->places[places[i]], INFINITY, NULL, NULL, &place);
        if (place.tri != TRIMESH_NONE)
            add_place(b, place.tri, places[i]);
    }
    bvh_destroy(&bvh);
    mem_free(mesh.tris);
}

static void take_places(struct bounded *b, const struct point_numbers *numbers, const uint32_t *places, size_t count)
{
    uint32_t *far = mem_array(count, sizeof(*far));
    size_t far_count = 0;
    b->places = mem_array(count, sizeof(*b->places));
    b->next_place = mem_array(count, sizeof(*b->next_place));
    for (size_t s = 0; s < count; s++) {
        uint32_t there = b->welds->first_there[places[s]], corner = NONE;
        place_of(b->welds, there, b->places[s]);
        if (there >= numbers->low && there <= numbers->high && numbers->of[there - numbers->low] > 0)
            corner = b->corner[numbers->of[there - numbers->low] - 1];
        if (corner != NONE)
            add_place(b, corner / 3, (uint32_t)s);
        else
            far[far_count++] = (uint32_t)s;
    }
    if (far_count > 0)
        take_far_places(b, far, far_count);
    mem_free(far);
}

struct bounded *bounded_create(const struct welds *welds, const uint32_t *corners, size_t count, const uint32_t *places, size_t place_count,
                               const struct bvh *first)
{
    struct bounded *b = mem_new(sizeof(*b));
    *b = (struct bounded){ .welds = welds, .first = first };
    b->points = mem_array(count, sizeof(*b->points));
    b->faces = mem_array(count / 3, sizeof(*b->faces));
    b->next = mem_array(count, sizeof(*b->next));
    struct point_numbers numbers = number_points(b, corners, count);
    drop_empty(b);
    b->moved_m = mem_array(b->point_count, sizeof(*b->moved_m));
    b->corner = mem_array(b->point_count, sizeof(*b->corner));
    b->stamp = mem_array(b->point_count, sizeof(*b->stamp));
    link_corners(b);
    measure_faces(b);
    take_places(b, &numbers, places, place_count);
    mem_free(numbers.of);
    for (uint32_t p = 0; p < b->point_count; p++)
        offer(b, p);
    return b;
}

void bounded_destroy(struct bounded **bounded)
{
    struct bounded *b = *bounded;
    if (!b)
        return;
    mem_free(b->points);
    mem_free(b->moved_m);
    mem_free(b->corner);
    mem_free(b->next);
    mem_free(b->stamp);
    mem_free(b->faces);
    mem_free(b->places);
    mem_free(b->next_place);
    mem_free(b->heap);
    mem_free(b);
    *bounded = NULL;
}

size_t bounded_count(const struct bounded *b)
{
    return b->left;
}

void bounded_read(const struct bounded *b, uint32_t *corners)
{
    for (size_t f = 0; f < b->face_count; f++)
        if (b->faces[f].point[0] != NONE) {
            memcpy(corners, b->faces[f].weld, sizeof(b->faces[f].weld));
            corners += 3;
        }
}
