/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds triangles inside another, closed part, or covered by one, by counting how often rays from the triangle intersect the part. */
#include "surface/repair/interior.h"

#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/mesh/bvh.h"

#define RAYS 5
#define RAYS_INSIDE 4 /* minimum number of the RAYS test rays that must indicate that a point is inside a part for it to count as inside */
/* A region is a set of points that are connected without passing another part. Only one in VOTE_EVERY triangles of a region is tested for
   being inside; if the results agree, they hold for the whole region. */
#define VOTE_EVERY 16
/* distance of test points from a triangle that lies on the surface of another part; there is one test point on each side. Unit:
   reach (distance up to which a part counts as touching, parts.h) */
#define BESIDE 1.5
/* distance of test points from a triangle that may be inside its own part; there is one test point on each side. Unit: reach
   (distance up to which a part counts as touching, parts.h) */
#define BARELY 0.05
#define FLUSH 0.9 /* minimum cosine between the normals of two touching faces for them to count as lying on each other */
/* minimum height of a triangle for its normal to count as reliable. Unit: reach (distance up to which a part counts as
   touching, parts.h) */
#define SLIVER 2.0

struct solid { /* closed part of the surface, in its state before surface sampling */
    uint32_t part;
    /* true: the part is a thin plate. A triangle that ends inside it is near both sides of the plate, so distances do not show on which
       side the triangle is */
    bool is_thin;
    bool winds; /* true: the body intersects itself, so the winding number decides which points are inside */
    double low[3], high[3];
    struct trimesh mesh;     /* triangles of the part; their arrays belong to struct solids */
    const signed char *side; /* by triangle: orientation, like body_parts.side */
    struct bvh *bvh;
};

struct solids {
    struct solid *at;
    size_t count;
    uint32_t (*tris)[3];    /* triangles of all closed parts of the surface, the parts one after the other */
    signed char *sides;     /* by element of `tris`: 1: its winding faces outwards, -1: reversed, 0: it bounds no body */
    struct solid **of_part; /* by part: the part as a struct solid; NULL: the part is not closed */
};

static void solids_finish(struct solids *solids)
{
    for (size_t i = 0; i < solids->count; i++)
        bvh_destroy(&solids->at[i].bvh);
    mem_free(solids->at);
    mem_free(solids->tris);
    mem_free(solids->sides);
    mem_free(solids->of_part);
}

static void solid_init(struct solid *solid)
{
    for (int axis = 0; axis < 3; axis++) {
        solid->low[axis] = INFINITY;
        solid->high[axis] = -INFINITY;
        for (size_t t = 0; t < solid->mesh.tri_count; t++)
            for (int i = 0; i < 3; i++) {
                double x = solid->mesh.points[solid->mesh.tris[t][i]][axis];
                solid->low[axis] = min_of(solid->low[axis], x);
                solid->high[axis] = max_of(solid->high[axis], x);
            }
    }
    solid->bvh = bvh_create(&solid->mesh);
}

static void solids_init(struct solids *solids, const struct body_parts *parts)
{
    const struct trimesh *mesh = &parts->solid;
    uint32_t *first = mem_array(parts->count + 1, sizeof(*first));
    *solids = (struct solids){ .at = mem_array(parts->count, sizeof(*solids->at)),
                               .tris = mem_array(mesh->tri_count, sizeof(*solids->tris)),
                               .sides = mem_array(mesh->tri_count, 1),
                               .of_part = mem_array(parts->count, sizeof(struct solid *)) };
    for (size_t t = 0; t < mesh->tri_count; t++)
        first[parts->of_tri[t] + 1]++;
    for (size_t p = 0; p < parts->count; p++) {
        if (parts->closed[p]) {
            solids->of_part[p] = &solids->at[solids->count++];
            *solids->of_part[p] = (struct solid){
                .part = (uint32_t)p,
                .is_thin = parts->thin[p],
                .winds = parts->crossed[p],
                .mesh = { .points = mesh->points,
                          .point_count = mesh->point_count,
                          .tris = solids->tris + first[p],
                          .tri_count = first[p + 1] },
                .side = solids->sides + first[p],
            };
        }
        first[p + 1] += first[p];
    }
    for (size_t t = 0; t < mesh->tri_count; t++) {
        uint32_t at = first[parts->of_tri[t]]++;
        memcpy(solids->tris[at], mesh->tris[t], sizeof(*mesh->tris));
        solids->sides[at] = parts->side[t];
    }
    for (size_t i = 0; i < solids->count; i++)
        solid_init(&solids->at[i]);
    mem_free(first);
}

struct interior_search {
    const struct trimesh *mesh;
    const uint32_t *part;
    const struct body_parts *parts;
    const struct solids *solids;
    const size_t *asked; /* triangles to test */
    char *hidden;
};

/* directions of the test rays: irregular, so that hardly any model has faces parallel to them */
static const double directions[RAYS][3] = {
    { 0.3572, 0.6129, 0.7048 },    { -0.7741, 0.2417, 0.5851 }, { 0.1693, -0.8846, 0.4345 },
    { -0.4419, -0.3251, -0.8361 }, { 0.8523, 0.2951, -0.4318 },
};

#define HITS 32
struct hits { /* intersections of one ray */
    const struct solid *solid;
    const double *direction;
    double same_m;
    int count, turns; /* intersections of a ray with the part. count: total number; turns: number of exits minus number of entries */
    struct ray_hits { /* the first points hit */
        double t;
        int faces;
        bool bounds;
    } at[HITS];
};

static void count_hit(void *arg, uint32_t tri, double t)
{
    struct hits *hits = arg;
    if (hits->solid->winds) {
        double n[3];
        trimesh_normal(&hits->solid->mesh, tri, n);
        hits->turns += vec_dot(n, hits->direction) > 0 ? hits->solid->side[tri] : -hits->solid->side[tri];
        return;
    }
    for (int i = 0; i < hits->count && i < HITS; i++)
        if (fabs(hits->at[i].t - t) < hits->same_m) {
            hits->at[i].faces++;
            return;
        }
    if (hits->count < HITS)
        hits->at[hits->count] = (struct ray_hits){ .t = t, .faces = 1, .bounds = hits->solid->side[tri] != 0 };
    hits->count++;
}

/* Returns whether the ray's origin is inside the solid: the ray then intersects the solid an odd number of times. Two faces at one point
 * are a wall between two bodies, which a ray leaves and enters there, so they count twice. In a solid that intersects itself, the
 * numbers of entries and exits must differ. */
static bool says_inside(const struct hits *hits)
{
    int bounds = hits->count > HITS ? hits->count - HITS : 0;
    for (int i = 0; i < hits->count && i < HITS; i++)
        bounds += hits->at[i].faces == 1 ? hits->at[i].bounds : hits->at[i].faces;
    return hits->solid->winds ? hits->turns != 0 : bounds % 2 == 1;
}

static bool is_near(const struct solid *solid, const double place[3], double margin_m)
{
    for (int axis = 0; axis < 3; axis++)
        if (place[axis] < solid->low[axis] - margin_m || place[axis] > solid->high[axis] + margin_m)
            return false;
    return true;
}

static bool is_inside(const struct solid *solid, const double place[3], double same_m)
{
    int outside = 0, inside = 0;
    if (!is_near(solid, place, 0))
        return false;
    for (int r = 0; r < RAYS && outside <= RAYS - RAYS_INSIDE && inside < RAYS_INSIDE; r++) {
        struct hits hits;
        hits.solid = solid;
        hits.direction = directions[r];
        hits.same_m = same_m;
        hits.count = hits.turns = 0;
        bvh_ray(solid->bvh, place, directions[r], count_hit, &hits);
        bool says = says_inside(&hits);
        inside += says;
        outside += !says;
    }
    return inside >= RAYS_INSIDE;
}

/* triangle being tested: its centre and normal, and the solid of its part; `own` NULL: the part is not closed */
struct interior_face {
    double middle[3], normal[3];
    double height_m; /* height over its longest edge */
    const struct solid *own;
};

/* Returns whether the face separates two bodies: whether the inside of `one` is on one side of the face, and the inside of
   `other` on the other. */
static bool is_between(const struct interior_face *face, const double normal[3], const struct solid *one, const struct solid *other,
                       double beside_m, double same_m)
{
    for (int turn = 0; turn < 2; turn++) {
        double above[3], below[3], step_m = turn ? -beside_m : beside_m;
        for (int axis = 0; axis < 3; axis++) {
            above[axis] = face->middle[axis] + step_m * normal[axis];
            below[axis] = face->middle[axis] - step_m * normal[axis];
        }
        if (is_inside(one, above, same_m) && is_inside(other, below, same_m))
            return true;
        if (one == other)
            return false;
    }
    return false;
}

static char is_hidden_by(const struct interior_face *face, const struct solid *solid, double reach_m)
{
    struct bvh_place at;
    double n[3];
    if (!is_near(solid, face->middle, reach_m))
        return INTERIOR_NOT;
    bvh_nearest(solid->bvh, face->middle, reach_m, NULL, NULL, &at);
    if (at.tri == TRIMESH_NONE)
        return is_inside(solid, face->middle, BARELY * reach_m) ? INTERIOR_INSIDE : INTERIOR_NOT;
    trimesh_normal(&solid->mesh, at.tri, n);
    double length = vec_length(n);
    for (int axis = 0; axis < 3; axis++)
        n[axis] /= length;
    /* lies: the tested face is parallel to the nearest face of the part, and so lies on it. flush: the same, but also true if
       the tested face is a sliver, whose normal is arbitrary */
    bool lies = fabs(vec_dot(n, face->normal)) > FLUSH, flush = lies || face->height_m < SLIVER * reach_m;
    if (face->own && flush && is_between(face, n, solid, face->own, BESIDE * reach_m, BARELY * reach_m))
        return INTERIOR_INSIDE;
    bool across = solid->is_thin && !lies && at.distance_m > BARELY * reach_m;
    return across && is_inside(solid, face->middle, BARELY * reach_m) ? INTERIOR_ACROSS : INTERIOR_NOT;
}

static double longest_side(const struct trimesh *mesh, size_t t)
{
    const uint32_t *v = mesh->tris[t];
    double ab = vec_distance(mesh->points[v[0]], mesh->points[v[1]]), bc = vec_distance(mesh->points[v[1]], mesh->points[v[2]]);
    return max_of(max_of(ab, bc), vec_distance(mesh->points[v[2]], mesh->points[v[0]]));
}

static char tri_is_hidden(const struct interior_search *s, size_t t)
{
    const uint32_t *v = s->mesh->tris[t], part = s->part[t];
    struct interior_face face = { .own = s->solids->of_part[part] };
    double reach_m = s->parts->reach_m[part];
    trimesh_normal(s->mesh, t, face.normal);
    double length = sqrt(vec_dot(face.normal, face.normal));
    for (int axis = 0; axis < 3; axis++) {
        face.middle[axis] = (s->mesh->points[v[0]][axis] + s->mesh->points[v[1]][axis] + s->mesh->points[v[2]][axis]) / 3;
        face.normal[axis] /= length > 0 ? length : 1;
    }
    face.height_m = length / longest_side(s->mesh, t);
    char found = INTERIOR_NOT;
    for (size_t i = 0; i < s->solids->count; i++) {
        const struct solid *solid = &s->solids->at[i];
        char hidden = solid->part == part ? INTERIOR_NOT : is_hidden_by(&face, solid, min_of(reach_m, s->parts->reach_m[solid->part]));
        if (hidden == INTERIOR_INSIDE)
            return hidden;
        found = hidden == INTERIOR_ACROSS ? hidden : found;
    }
    bool within =
        face.own && s->parts->tangled[part] && is_between(&face, face.normal, face.own, face.own, 2 * BARELY * reach_m, BARELY * reach_m);
    return within ? INTERIOR_INSIDE : found;
}

static void search_some(void *arg, size_t begin, size_t end)
{
    struct interior_search *s = arg;
    for (size_t i = begin; i < end; i++)
        s->hidden[s->asked[i]] = tri_is_hidden(s, s->asked[i]);
}

/* --- regions ------------------------------------------------------------------------------------------------------------------ */

/* Sets mixed[point] to 1 for points where triangles of several parts meet. Only there can a part pass from the outside of
 * another part to its inside. */
static void mix_parts(const struct trimesh *mesh, const uint32_t *part, char *mixed)
{
    uint32_t *of_point = mem_array(mesh->point_count, sizeof(*of_point));
    memset(of_point, 0xff, mesh->point_count * sizeof(*of_point));
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t p = mesh->tris[t][i];
            mixed[p] = mixed[p] || (of_point[p] != TRIMESH_NONE && of_point[p] != part[t]);
            of_point[p] = part[t];
        }
    mem_free(of_point);
}

/* Sets mixed[point] to 1 for points on edges with three faces or more, in parts that have such edges. Only there, and where a part crosses
 * itself, can a part pass from its own outside to its own inside. */
static void mix_branches(const struct trimesh *mesh, const uint32_t *part, const char *tangled, char *mixed)
{
    struct edge_table edges;
    unsigned char *faces = mem_array(mesh->tri_count * 3, 1);
    edge_table_init(&edges, 1024);
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3 && tangled[part[t]]; i++) {
            uint32_t a = mesh->tris[t][i], b = mesh->tris[t][(i + 1) % 3], e = edge_table_add(&edges, a, b);
            faces[e] = (unsigned char)(faces[e] < 3 ? faces[e] + 1 : 3);
            mixed[a] = mixed[a] || faces[e] == 3;
            mixed[b] = mixed[b] || faces[e] == 3;
        }
    edge_table_finish(&edges);
    mem_free(faces);
}

/* Returns the region of each point: the set of points connected to it without passing a marked point (`mixed`). A region is
 * identified by its lowest point index. The caller frees the array. */
static uint32_t *find_regions(const struct trimesh *mesh, const char *mixed)
{
    uint32_t *region = mem_array(mesh->point_count, sizeof(*region));
    for (uint32_t i = 0; i < mesh->point_count; i++)
        region[i] = i;
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t a = mesh->tris[t][i], b = mesh->tris[t][(i + 1) % 3];
            if (!mixed[a] && !mixed[b])
                trimesh_join(region, a, b);
        }
    for (uint32_t i = 0; i < mesh->point_count; i++)
        region[i] = trimesh_root(region, i);
    return region;
}

/* Returns the region of a triangle, which is the region of a corner not marked in `mixed`. (A region is a set of points that
   are connected without passing a marked point.) TRIMESH_NONE: all corners are marked. */
static uint32_t region_of(const struct trimesh *mesh, size_t t, const char *mixed, const uint32_t *region)
{
    for (int i = 0; i < 3; i++)
        if (!mixed[mesh->tris[t][i]])
            return region[mesh->tris[t][i]];
    return TRIMESH_NONE;
}

static bool untouched(const struct trimesh *mesh, size_t t, const char *mixed)
{
    return !mixed[mesh->tris[t][0]] && !mixed[mesh->tris[t][1]] && !mixed[mesh->tris[t][2]];
}

static void ask(struct interior_search *search, struct workers *workers, const size_t *asked, size_t count)
{
    search->asked = asked;
    workers_for(workers, count, 256, search_some, search);
}

/* Completes the search for hidden triangles in regions (sets of connected points) of which only a sample was tested, since
   other triangles may differ from the sample. Wherever hidden and visible triangles of a region meet at a point, tests all
   triangles at that point. Repeats this until all triangles at such points are tested. */
static void ask_beside(struct interior_search *search, struct workers *workers, const char *mixed, size_t *asked, char *was_asked)
{
    const struct trimesh *mesh = search->mesh;
    /* by point: bit 0: the point is a corner of a visible triangle; bit 1: it is a corner of a hidden triangle */
    char *kinds = mem_array(mesh->point_count, 1);
    size_t count;
    do {
        memset(kinds, 0, mesh->point_count);
        count = 0;
        for (size_t t = 0; t < mesh->tri_count; t++)
            for (int i = 0; i < 3; i++)
                kinds[mesh->tris[t][i]] |= search->hidden[t] == INTERIOR_NOT ? 1 : 2;
        for (size_t t = 0; t < mesh->tri_count; t++) {
            bool differ = false;
            for (int i = 0; i < 3 && !was_asked[t]; i++)
                differ = differ || (kinds[mesh->tris[t][i]] == 3 && !mixed[mesh->tris[t][i]]);
            if (!differ)
                continue;
            was_asked[t] = 1;
            asked[count++] = t;
        }
        ask(search, workers, asked, count);
    } while (count);
    mem_free(kinds);
}

/* results of testing the triangles of one region (set of connected points): number of its triangles, of tested ones, and of
   hidden ones */
struct region_vote {
    size_t seen, asked, hidden;
    char most;
};

/* Returns whether any closed part may hide triangles of other parts, or its own if it intersects itself. */
static bool may_hide(const struct body_parts *parts)
{
    for (size_t p = 0; p < parts->count; p++)
        if (parts->closed[p] && (parts->count > 1 || parts->tangled[p]))
            return true;
    return false;
}

bool interior_find(const struct trimesh *mesh, const uint32_t *part, const struct body_parts *parts, const uint32_t *crossings,
                   size_t crossing_count, struct workers *workers, char *hidden)
{
    struct solids solids;
    memset(hidden, INTERIOR_NOT, mesh->tri_count);
    if (!may_hide(parts))
        return false;
    solids_init(&solids, parts);
    char *mixed = mem_array(mesh->point_count, 1);
    mix_parts(mesh, part, mixed);
    mix_branches(mesh, part, parts->tangled, mixed);
    for (size_t i = 0; i < crossing_count; i++)
        mixed[crossings[i]] = 1;
    uint32_t *region = find_regions(mesh, mixed);
    size_t *asked = mem_array(mesh->tri_count, sizeof(*asked)), asked_count = 0;
    struct region_vote *votes = mem_array(mesh->point_count, sizeof(*votes));
    struct interior_search search = { .mesh = mesh, .part = part, .parts = parts, .solids = &solids, .hidden = hidden };
    /* tests all triangles at marked points, where parts meet, and a sample of the other triangles of each region (set of connected
       points) */
    for (size_t t = 0; t < mesh->tri_count; t++) {
        uint32_t r = region_of(mesh, t, mixed, region);
        if (!untouched(mesh, t, mixed) || votes[r].seen++ % VOTE_EVERY == 0)
            asked[asked_count++] = t;
    }
    ask(&search, workers, asked, asked_count);
    char *was_asked = mem_array(mesh->tri_count, 1);
    for (size_t i = 0; i < asked_count; i++)
        was_asked[asked[i]] = 1;
    for (size_t i = 0; i < asked_count; i++)
        if (untouched(mesh, asked[i], mixed)) {
            struct region_vote *vote = &votes[region_of(mesh, asked[i], mixed, region)];
            vote->asked++;
            vote->hidden += hidden[asked[i]] != INTERIOR_NOT;
            vote->most = hidden[asked[i]] > vote->most ? hidden[asked[i]] : vote->most;
        }
    asked_count = 0;
    /* tests all triangles of a region (set of connected points) in which the sampled triangles disagree */
    for (size_t t = 0; t < mesh->tri_count; t++) {
        const struct region_vote *vote = untouched(mesh, t, mixed) ? &votes[region_of(mesh, t, mixed, region)] : NULL;
        if (vote && vote->hidden > 0 && vote->hidden < vote->asked)
            asked[asked_count++] = t;
        else if (vote)
            hidden[t] = vote->most;
    }
    ask(&search, workers, asked, asked_count);
    for (size_t i = 0; i < asked_count; i++)
        was_asked[asked[i]] = 1;
    ask_beside(&search, workers, mixed, asked, was_asked);
    mem_free(was_asked);
    interior_resolve_across(mesh, hidden);
    solids_finish(&solids);
    mem_free(mixed);
    mem_free(region);
    mem_free(asked);
    mem_free(votes);
    size_t t = 0;
    while (t < mesh->tri_count && hidden[t] == INTERIOR_NOT)
        t++;
    return t < mesh->tri_count;
}
