/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Triangles inside another, closed part, by counting what rays meet. */
#include "surface/hidden.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "surface/bvh.h"
#include "surface/vec.h"

#define OPEN_OF_SIZE 0.05 /* open edges together, in roots of the part's area: a hair gap's leftovers, not a pipe's end */
#define RAYS 5
#define RAYS_INSIDE 4 /* so many must agree */
#define VOTE_EVERY 16 /* of a region's triangles, one of so many is asked */

void hidden_closed_parts(const struct trimesh *mesh, const uint32_t *part, size_t parts, char *closed)
{
    struct edge_table edges;
    double *area_m2 = mem_array(parts, sizeof(*area_m2)), *open_m = mem_array(parts, sizeof(*open_m));
    unsigned char *faces = mem_array(mesh->tri_count * 3, 1);
    edge_table_init(&edges, mesh->tri_count * 3 / 2);
    for (size_t t = 0; t < mesh->tri_count; t++) {
        const uint32_t *v = mesh->tris[t];
        double ab[3], ac[3], n[3];
        vec_sub(mesh->points[v[1]], mesh->points[v[0]], ab);
        vec_sub(mesh->points[v[2]], mesh->points[v[0]], ac);
        vec_cross(ab, ac, n);
        area_m2[part[t]] += sqrt(vec_dot(n, n)) / 2;
        for (int i = 0; i < 3; i++) {
            uint32_t e = edge_table_add(&edges, v[i], v[(i + 1) % 3]);
            faces[e] = (unsigned char)(faces[e] < 3 ? faces[e] + 1 : 3);
        }
    }
    for (size_t t = 0; t < mesh->tri_count; t++) {
        double open = 0;
        bool fin = false; /* it stands on an edge that is closed without it */
        for (int i = 0; i < 3; i++) {
            const uint32_t a = mesh->tris[t][i], b = mesh->tris[t][(i + 1) % 3], e = edge_table_find(&edges, a, b);
            open += faces[e] == 1 ? vec_distance(mesh->points[a], mesh->points[b]) : 0;
            fin = fin || faces[e] > 2;
        }
        open_m[part[t]] += fin ? 0 : open;
    }
    for (size_t p = 0; p < parts; p++)
        closed[p] = open_m[p] <= OPEN_OF_SIZE * sqrt(area_m2[p]);
    edge_table_finish(&edges);
    mem_free(area_m2);
    mem_free(open_m);
    mem_free(faces);
}

struct solid { /* a closed part, as it was before it was cut up */
    uint32_t part;
    double low[3], high[3];
    struct trimesh mesh; /* its triangles; the arrays belong to others */
    struct bvh *bvh;
};

struct solids {
    struct solid *at;
    size_t count;
    uint32_t (*tris)[3]; /* of all solids, part by part */
};

static void solids_finish(struct solids *solids)
{
    for (size_t i = 0; i < solids->count; i++)
        bvh_destroy(&solids->at[i].bvh);
    mem_free(solids->at);
    mem_free(solids->tris);
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

static void solids_init(struct solids *solids, const struct trimesh *mesh, const uint32_t *part, size_t parts, const char *closed)
{
    uint32_t *first = mem_array(parts + 1, sizeof(*first));
    *solids = (struct solids){ .at = mem_array(parts, sizeof(*solids->at)), .tris = mem_array(mesh->tri_count, sizeof(*solids->tris)) };
    for (size_t t = 0; t < mesh->tri_count; t++)
        first[part[t] + 1]++;
    for (size_t p = 0; p < parts; p++) {
        if (closed[p])
            solids->at[solids->count++] = (struct solid){
                .part = (uint32_t)p,
                .mesh = { .points = mesh->points,
                          .point_count = mesh->point_count,
                          .tris = solids->tris + first[p],
                          .tri_count = first[p + 1] },
            };
        first[p + 1] += first[p];
    }
    for (size_t t = 0; t < mesh->tri_count; t++)
        memcpy(solids->tris[first[part[t]]++], mesh->tris[t], sizeof(*mesh->tris));
    for (size_t i = 0; i < solids->count; i++)
        solid_init(&solids->at[i]);
    mem_free(first);
}

struct search {
    const struct trimesh *mesh;
    const uint32_t *part;
    const struct solids *solids;
    double tolerance_m;
    const size_t *asked; /* triangles to look at */
    char *hidden;
};

/* Directions that no model is aligned to. */
static const double directions[RAYS][3] = {
    { 0.3572, 0.6129, 0.7048 },    { -0.7741, 0.2417, 0.5851 }, { 0.1693, -0.8846, 0.4345 },
    { -0.4419, -0.3251, -0.8361 }, { 0.8523, 0.2951, -0.4318 },
};

static void count_hit(void *arg, uint32_t tri, double t)
{
    (void)tri, (void)t;
    ++*(unsigned *)arg;
}

/* Inside the solid, and not on its surface. */
static bool is_inside(const struct solid *solid, const double place[3], double tolerance_m)
{
    struct bvh_place at;
    int outside = 0;
    for (int axis = 0; axis < 3; axis++)
        if (place[axis] < solid->low[axis] || place[axis] > solid->high[axis])
            return false;
    for (int r = 0; r < RAYS; r++) {
        unsigned hits = 0;
        bvh_ray(solid->bvh, place, directions[r], count_hit, &hits);
        outside += hits % 2 == 0;
        if (outside > RAYS - RAYS_INSIDE)
            return false;
    }
    bvh_nearest(solid->bvh, place, tolerance_m, NULL, NULL, &at);
    return at.tri == TRIMESH_NONE;
}

static bool is_hidden(const struct search *s, const double place[3], uint32_t own)
{
    for (size_t i = 0; i < s->solids->count; i++)
        if (s->solids->at[i].part != own && is_inside(&s->solids->at[i], place, s->tolerance_m))
            return true;
    return false;
}

static bool tri_is_hidden(const struct search *s, size_t t)
{
    const uint32_t *v = s->mesh->tris[t];
    double middle[3];
    for (int axis = 0; axis < 3; axis++)
        middle[axis] = (s->mesh->points[v[0]][axis] + s->mesh->points[v[1]][axis] + s->mesh->points[v[2]][axis]) / 3;
    return is_hidden(s, middle, s->part[t]);
}

static void search_some(void *arg, size_t begin, size_t end)
{
    struct search *s = arg;
    for (size_t i = begin; i < end; i++)
        s->hidden[s->asked[i]] = tri_is_hidden(s, s->asked[i]);
}

/* --- regions ------------------------------------------------------------------------------------------------------------------ */

/* Of each point the one part whose triangles meet there, or TRIMESH_NONE: parts meet. A part passes from outside to inside only there. */
static uint32_t *parts_of_points(const struct trimesh *mesh, const uint32_t *part, char *mixed)
{
    uint32_t *of_point = mem_array(mesh->point_count, sizeof(*of_point));
    memset(of_point, 0xff, mesh->point_count * sizeof(*of_point));
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t p = mesh->tris[t][i];
            mixed[p] = mixed[p] || (of_point[p] != TRIMESH_NONE && of_point[p] != part[t]);
            of_point[p] = part[t];
        }
    return of_point;
}

/* region[point]: points that hang together without passing a point where parts meet. */
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

/* The region that a triangle belongs to, TRIMESH_NONE: all its corners are where parts meet. */
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

static void ask(struct search *search, struct workers *workers, const size_t *asked, size_t count)
{
    search->asked = asked;
    if (workers)
        workers_for(workers, count, 256, search_some, search);
    else
        search_some(search, 0, count);
}

struct vote { /* of a region */
    size_t seen, asked, hidden;
};

void hidden_find(const struct trimesh *mesh, const uint32_t *part, const struct trimesh *solid, const uint32_t *solid_part, size_t parts,
                 const char *closed, double tolerance_m, struct workers *workers, char *hidden)
{
    struct solids solids;
    solids_init(&solids, solid, solid_part, parts, closed);
    char *mixed = mem_array(mesh->point_count, 1);
    uint32_t *of_point = parts_of_points(mesh, part, mixed), *region = find_regions(mesh, mixed);
    size_t *asked = mem_array(mesh->tri_count, sizeof(*asked)), asked_count = 0;
    struct vote *votes = mem_array(mesh->point_count, sizeof(*votes));
    struct search search = { .mesh = mesh, .part = part, .solids = &solids, .tolerance_m = tolerance_m, .hidden = hidden };
    for (size_t t = 0; t < mesh->tri_count; t++) { /* those where parts meet, and of each region some */
        uint32_t r = region_of(mesh, t, mixed, region);
        if (!untouched(mesh, t, mixed) || votes[r].seen++ % VOTE_EVERY == 0)
            asked[asked_count++] = t;
    }
    ask(&search, workers, asked, asked_count);
    for (size_t i = 0; i < asked_count; i++)
        if (untouched(mesh, asked[i], mixed)) {
            struct vote *vote = &votes[region_of(mesh, asked[i], mixed, region)];
            vote->asked++;
            vote->hidden += (size_t)hidden[asked[i]];
        }
    asked_count = 0;
    for (size_t t = 0; t < mesh->tri_count; t++) { /* regions that do not agree with themselves are asked in full */
        const struct vote *vote = untouched(mesh, t, mixed) ? &votes[region_of(mesh, t, mixed, region)] : NULL;
        if (vote && vote->hidden > 0 && vote->hidden < vote->asked)
            asked[asked_count++] = t;
        else if (vote)
            hidden[t] = vote->hidden > 0;
    }
    ask(&search, workers, asked, asked_count);
    solids_finish(&solids);
    mem_free(mixed);
    mem_free(of_point);
    mem_free(region);
    mem_free(asked);
    mem_free(votes);
}
