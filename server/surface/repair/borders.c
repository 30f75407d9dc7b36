/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the border edges of a mesh (edges with one face), or only those that became borders because neighbouring triangles were hidden. */
#include "surface/repair/borders.h"

#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

void borders_finish(struct borders *b)
{
    mem_free(b->edges);
    mem_free(b->edge_tri);
    mem_free(b->points);
    mem_free(b->slot);
    mem_free(b->shortest_m);
    mem_free(b->first);
    mem_free(b->at);
    mem_free(b->reach_m);
}

/* Finds border edges (edges with one face). hidden: the hidden triangles; then only border edges that hidden triangles also
   have are found. NULL: all border edges. */
static void find_open_edges(struct borders *b, const struct trimesh *mesh, const struct trimesh *hidden)
{
    struct edge_table edges;
    edge_table_init(&edges, mesh->tri_count * 3 / 2);
    unsigned char *faces = mem_array(mesh->tri_count * 3, 1), *rim = mem_array(mesh->tri_count * 3, 1);
    uint32_t(*numbers)[3] = mem_array(mesh->tri_count, sizeof(*numbers));
    for (size_t t = 0; t < mesh->tri_count; t++) {
        edge_table_prefetch_ahead(&edges, (const uint32_t(*)[3])mesh->tris, t, mesh->tri_count);
        for (int i = 0; i < 3; i++) {
            uint32_t e = numbers[t][i] = edge_table_add(&edges, mesh->tris[t][i], mesh->tris[t][(i + 1) % 3]);
            faces[e] = (unsigned char)(faces[e] < 2 ? faces[e] + 1 : 2);
        }
    }
    for (size_t t = 0; hidden && t < hidden->tri_count; t++) {
        edge_table_prefetch_ahead(&edges, (const uint32_t(*)[3])hidden->tris, t, hidden->tri_count);
        for (int i = 0; i < 3; i++) {
            uint32_t e = edge_table_find(&edges, hidden->tris[t][i], hidden->tris[t][(i + 1) % 3]);
            if (e != TRIMESH_NONE)
                rim[e] = 1;
        }
    }
    for (size_t e = 0; e < edges.count; e++) {
        rim[e] = faces[e] == 1 && (!hidden || rim[e]);
        b->edge_count += rim[e];
    }
    b->edges = mem_array(b->edge_count, sizeof(*b->edges));
    b->edge_tri = mem_array(b->edge_count, sizeof(*b->edge_tri));
    size_t n = 0;
    for (uint32_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t p = mesh->tris[t][i], q = mesh->tris[t][(i + 1) % 3];
            if (!rim[numbers[t][i]])
                continue;
            b->edges[n][0] = p;
            b->edges[n][1] = q;
            b->edge_tri[n++] = t;
        }
    mem_free(faces);
    mem_free(rim);
    mem_free(numbers);
    edge_table_finish(&edges);
}

static void find_border_points(struct borders *b, const struct trimesh *mesh)
{
    b->slot = mem_array(mesh->point_count, sizeof(*b->slot));
    b->points = mem_array(2 * b->edge_count, sizeof(*b->points));
    memset(b->slot, 0xff, mesh->point_count * sizeof(*b->slot));
    for (size_t e = 0; e < b->edge_count; e++)
        for (int i = 0; i < 2; i++) {
            uint32_t p = b->edges[e][i];
            if (b->slot[p] == TRIMESH_NONE) {
                b->slot[p] = (uint32_t)b->point_count;
                b->points[b->point_count++] = p;
            }
        }
    b->shortest_m = mem_array(b->point_count, sizeof(*b->shortest_m));
    for (size_t i = 0; i < b->point_count; i++)
        b->shortest_m[i] = INFINITY;
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                uint32_t s = b->slot[mesh->tris[t][i]];
                if (i != j && s != TRIMESH_NONE)
                    b->shortest_m[s] =
                        min_of(b->shortest_m[s], vec_distance(mesh->points[mesh->tris[t][i]], mesh->points[mesh->tris[t][j]]));
            }
}

static void find_edges_at(struct borders *b)
{
    b->first = mem_array(b->point_count + 2, sizeof(*b->first));
    b->at = mem_array(2 * b->edge_count, sizeof(*b->at));
    for (size_t e = 0; e < b->edge_count; e++)
        for (int i = 0; i < 2; i++)
            b->first[b->slot[b->edges[e][i]] + 2]++;
    for (size_t i = 2; i < b->point_count + 2; i++)
        b->first[i] += b->first[i - 1];
    for (uint32_t e = 0; e < b->edge_count; e++)
        for (int i = 0; i < 2; i++)
            b->at[b->first[b->slot[b->edges[e][i]] + 1]++] = e;
}

static void find_reach(struct borders *b, const struct trimesh *mesh, const struct body_parts *parts)
{
    b->reach_m = mem_array(b->point_count, sizeof(*b->reach_m));
    for (size_t i = 0; i < b->point_count; i++)
        b->reach_m[i] = INFINITY;
    for (size_t e = 0; e < b->edge_count; e++)
        for (int i = 0; i < 2; i++) {
            double *reach_m = &b->reach_m[b->slot[b->edges[e][i]]];
            *reach_m = min_of(*reach_m, parts->reach_m[parts->of_source[mesh->tri_source[b->edge_tri[e]]]]);
        }
}

void borders_init(struct borders *b, const struct trimesh *mesh)
{
    *b = (struct borders){ 0 };
    find_open_edges(b, mesh, NULL);
    find_border_points(b, mesh);
    find_edges_at(b);
}

void borders_init_rims(struct borders *b, const struct trimesh *seen, const struct trimesh *hidden, const struct body_parts *parts)
{
    *b = (struct borders){ 0 };
    find_open_edges(b, seen, hidden);
    find_border_points(b, seen);
    find_edges_at(b);
    find_reach(b, seen, parts);
}
