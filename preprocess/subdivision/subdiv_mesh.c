/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Splits mesh edges at new vertices, and the triangles at these edges. */
#include "preprocess/subdivision/subdiv_mesh.h"

#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

bool subdiv_mesh_init(struct subdiv_mesh *mesh, struct geometry *geometry)
{
    *mesh = (struct subdiv_mesh){ .geometry = geometry };
    mesh->position_capacity = mesh->normal_capacity = mesh->texcoord_capacity = geometry->vertex_count;
    mesh->second_capacity = mesh->color_capacity = geometry->vertex_count;
    edge_table_init(&mesh->edges, geometry->index_count);
    edge_table_init(&mesh->vertex_edges, geometry->vertex_count / 8 + 16);
    if (!welded_init(&mesh->welded, (const float(*)[3])geometry->positions_m, geometry->vertex_count))
        return false;
    mesh->place_capacity = mesh->of_vertex_capacity = geometry->vertex_count;
    return true;
}

void subdiv_mesh_finish(struct subdiv_mesh *mesh)
{
    welded_finish(&mesh->welded);
    edge_table_finish(&mesh->edges);
    edge_table_finish(&mesh->vertex_edges);
    mem_free(mesh->cuts);
    mem_free(mesh->vertex_middles);
    mem_free(mesh->tris);
    mem_free(mesh->next);
    mem_free(mesh->made.at);
    mem_free(mesh->open.at);
    *mesh = (struct subdiv_mesh){ 0 };
}

/* --- lists of triangles --------------------------------------------------------------------------------------------------- */

#define DIGIT_BITS 11

/* Radix sort, lowest digit first. */
static void sort_numbers(uint32_t *numbers, size_t count)
{
    uint32_t *other = mem_array(count, sizeof(*other)), *from = numbers, *to = other, most = 0;
    for (size_t i = 0; i < count; i++)
        most |= numbers[i];
    for (unsigned shift = 0; shift < 32 && most >> shift; shift += DIGIT_BITS) {
        size_t first[(1 << DIGIT_BITS) + 1] = { 0 };
        for (size_t i = 0; i < count; i++)
            first[(from[i] >> shift & ((1 << DIGIT_BITS) - 1)) + 1]++;
        for (size_t d = 0; d < 1 << DIGIT_BITS; d++)
            first[d + 1] += first[d];
        for (size_t i = 0; i < count; i++)
            to[first[from[i] >> shift & ((1 << DIGIT_BITS) - 1)]++] = from[i];
        uint32_t *sorted = to;
        to = from;
        from = sorted;
    }
    if (from != numbers)
        memcpy(numbers, from, count * sizeof(*numbers));
    mem_free(other);
}

void subdiv_mesh_sort(struct subdiv_list *list)
{
    size_t kept = 0;
    if (list->sorted || list->count == 0)
        return;
    sort_numbers(list->at, list->count);
    for (size_t i = 0; i < list->count; i++)
        if (i == 0 || list->at[i] != list->at[i - 1])
            list->at[kept++] = list->at[i];
    list->count = kept;
    list->sorted = true;
}

void subdiv_mesh_list_all(struct subdiv_mesh *mesh)
{
    mesh->made.count = 0;
    for (size_t t = 0; t < mesh->tri_count; t++)
        subdiv_mesh_list(&mesh->made, (uint32_t)t);
}

/* --- triangles ------------------------------------------------------------------------------------------------------------ */

static uint32_t place_of(const struct subdiv_mesh *mesh, uint32_t vertex)
{
    return mesh->welded.of_vertex[vertex];
}

static void note_origin(struct subdiv_mesh *mesh, uint32_t edge, uint32_t origin)
{
    if (mesh->loads == 1 && mesh->cuts[edge].origin[0] != origin)
        mesh->cuts[edge].origin[1] = origin;
}

static uint32_t edge_of(struct subdiv_mesh *mesh, uint32_t a, uint32_t b, uint32_t origin)
{
    size_t before = mesh->edges.count;
    uint32_t e = edge_table_add(&mesh->edges, place_of(mesh, a), place_of(mesh, b));
    if (mesh->edges.count > before) {
        mem_grow(&mesh->cuts, &mesh->cut_capacity, mesh->edges.count, sizeof(*mesh->cuts));
        mesh->cuts[e] = (struct subdiv_edge){
            .a = a, .b = b, .origin = { origin, TRIMESH_NONE }, .middle = TRIMESH_NONE, .corner = TRIMESH_NONE, .share = 0.5f, .error = -1
        };
    } else {
        note_origin(mesh, e, origin);
    }
    return e;
}

#define LOOK_UP TRIMESH_NONE

/* Creates a triangle with corners v; its other properties are copied from `like`. known: indices of its three edges;
 * TRIMESH_NONE: the edge must be looked up by its vertices, which is slow. */
static struct subdiv_tri make_tri(struct subdiv_mesh *mesh, const struct subdiv_tri *like, const uint32_t v[3], const uint32_t known[3])
{
    struct subdiv_tri tri = { .v = { v[0], v[1], v[2] }, .primitive = like->primitive, .origin = like->origin };
    for (int i = 0; i < 3; i++) {
        if (known[i] == LOOK_UP)
            tri.e[i] = edge_of(mesh, v[i], v[(i + 1) % 3], like->origin);
        else
            note_origin(mesh, tri.e[i] = known[i], like->origin);
    }
    return tri;
}

static void enter(struct subdiv_mesh *mesh, size_t t)
{
    bool any_cut = false;
    for (uint32_t i = 0; i < 3; i++) {
        struct subdiv_edge *edge = &mesh->cuts[mesh->tris[t].e[i]];
        uint32_t corner = 3 * (uint32_t)t + i;
        mesh->next[corner] = edge->corner;
        edge->corner = corner;
        any_cut |= subdiv_mesh_is_split(mesh, mesh->tris[t].e[i]);
    }
    subdiv_mesh_list(&mesh->made, (uint32_t)t);
    if (any_cut)
        subdiv_mesh_list(&mesh->open, (uint32_t)t);
}

static void leave(struct subdiv_mesh *mesh, size_t t)
{
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t *link = &mesh->cuts[mesh->tris[t].e[i]].corner;
        while (*link != 3 * (uint32_t)t + i)
            link = &mesh->next[*link];
        *link = mesh->next[*link];
    }
}

static void put_tri(struct subdiv_mesh *mesh, size_t t, const struct subdiv_tri *tri)
{
    leave(mesh, t);
    mesh->tris[t] = *tri;
    enter(mesh, t);
}

/* Appends a triangle to the current level of detail. Returns its index. */
static size_t add_tri(struct subdiv_mesh *mesh, const struct subdiv_tri *like, const uint32_t v[3], const uint32_t known[3])
{
    struct subdiv_tri tri = make_tri(mesh, like, v, known);
    mem_grow(&mesh->tris, &mesh->tri_capacity, mesh->tri_count + 1, sizeof(*mesh->tris));
    mem_grow(&mesh->next, &mesh->next_capacity, 3 * mesh->tri_count + 3, sizeof(*mesh->next));
    mesh->tris[mesh->tri_count] = tri;
    enter(mesh, mesh->tri_count++);
    return mesh->tri_count - 1;
}

static const uint32_t unknown[3] = { LOOK_UP, LOOK_UP, LOOK_UP };

#define AHEAD 8 /* prefetch distance in triangles */
static void prefetch_edges(const struct subdiv_mesh *mesh, const uint32_t v[3])
{
    for (int c = 0; c < 3; c++)
        edge_table_prefetch(&mesh->edges, place_of(mesh, v[c]), place_of(mesh, v[(c + 1) % 3]));
}

void subdiv_mesh_load(struct subdiv_mesh *mesh, const struct level *level)
{
    mesh->tri_count = 0;
    mesh->loads++;
    mesh->made.count = mesh->open.count = 0;
    /* Forgets the measured error of each edge that was not proven to need no split in any level: it must be measured again,
       because the error limit depends on the level of detail. */
    for (size_t e = 0; e < mesh->edges.count; e++) {
        mesh->cuts[e].error = mesh->cuts[e].proven ? mesh->cuts[e].error : -1;
        mesh->cuts[e].corner = TRIMESH_NONE;
    }
    for (uint32_t p = 0; p < level->primitive_count; p++)
        for (uint32_t i = 0; i < level->primitives[p].index_count; i += 3) {
            uint32_t at = level->primitives[p].first_index + i;
            const uint32_t *v = level->indices + at;
            const struct subdiv_tri like = { .primitive = p, .origin = at / 3 };
            if (i + 3 * AHEAD < level->primitives[p].index_count)
                prefetch_edges(mesh, v + (size_t)3 * AHEAD);
            add_tri(mesh, &like, v, unknown);
        }
}

void subdiv_mesh_store(const struct subdiv_mesh *mesh, struct level *level)
{
    uint32_t *fill = mem_array(level->primitive_count + 1u, sizeof(*fill));
    mem_free(level->indices);
    level->index_count = 3 * (uint32_t)mesh->tri_count;
    level->indices = mem_array(level->index_count, sizeof(*level->indices));
    for (size_t t = 0; t < mesh->tri_count; t++)
        fill[mesh->tris[t].primitive + 1] += 3;
    for (uint32_t p = 0; p < level->primitive_count; p++) {
        level->primitives[p].first_index = fill[p];
        level->primitives[p].index_count = fill[p + 1];
        fill[p + 1] += fill[p];
    }
    for (size_t t = 0; t < mesh->tri_count; t++) {
        uint32_t *at = &fill[mesh->tris[t].primitive];
        memcpy(level->indices + *at, mesh->tris[t].v, sizeof(mesh->tris[t].v));
        *at += 3;
    }
    mem_free(fill);
}

/* --- vertices ------------------------------------------------------------------------------------------------------------- */

static uint32_t add_place(struct subdiv_mesh *mesh, const float position_m[3])
{
    mem_grow(&mesh->welded.positions_m, &mesh->place_capacity, mesh->welded.count + 1, sizeof(*mesh->welded.positions_m));
    memcpy(mesh->welded.positions_m[mesh->welded.count], position_m, sizeof(*mesh->welded.positions_m));
    return (uint32_t)mesh->welded.count++;
}

/* Interpolates the texture coordinates of the newest vertex, if the geometry has texture coordinates. */
static void add_texcoord(float (**texcoords)[2], size_t *capacity, uint32_t vertex, const uint32_t *from, const double *weights, int count)
{
    float mixed[2] = { 0 };
    if (!*texcoords)
        return;
    mem_grow(texcoords, capacity, vertex + 1u, sizeof(**texcoords));
    for (int i = 0; i < count; i++)
        for (int c = 0; c < 2; c++)
            mixed[c] += (float)weights[i] * (*texcoords)[from[i]][c];
    memcpy((*texcoords)[vertex], mixed, sizeof(mixed));
}

/* Adds a vertex at a position, interpolating its attributes from other vertices. */
static uint32_t add_vertex(struct subdiv_mesh *mesh, uint32_t place, const uint32_t *from, const double *weights, int count)
{
    struct geometry *g = mesh->geometry;
    uint32_t vertex = g->vertex_count++;
    float normal[3] = { 0 }, color[4] = { 0 };
    mem_grow(&mesh->welded.of_vertex, &mesh->of_vertex_capacity, g->vertex_count, sizeof(*mesh->welded.of_vertex));
    mem_grow(&g->positions_m, &mesh->position_capacity, g->vertex_count, sizeof(*g->positions_m));
    mem_grow(&g->normals, &mesh->normal_capacity, g->vertex_count, sizeof(*g->normals));
    if (g->colors)
        mem_grow(&g->colors, &mesh->color_capacity, g->vertex_count, sizeof(*g->colors));
    for (int i = 0; i < count; i++) {
        float w = (float)weights[i];
        for (int c = 0; c < 3; c++)
            normal[c] += w * g->normals[from[i]][c];
        for (int c = 0; c < 4 && g->colors; c++)
            color[c] += w * (float)g->colors[from[i]][c];
    }
    float length = sqrtf(vecf_dot(normal, normal));
    for (int c = 0; c < 3; c++)
        g->normals[vertex][c] = length > 1e-3f ? normal[c] / length : g->normals[from[0]][c];
    add_texcoord(&g->texcoords, &mesh->texcoord_capacity, vertex, from, weights, count);
    add_texcoord(&g->second_texcoords, &mesh->second_capacity, vertex, from, weights, count);
    for (int c = 0; c < 4 && g->colors; c++)
        g->colors[vertex][c] = (uint8_t)(color[c] + 0.5f);
    memcpy(g->positions_m[vertex], mesh->welded.positions_m[place], sizeof(*g->positions_m));
    mesh->welded.of_vertex[vertex] = place;
    return vertex;
}

/* Returns the vertex at an edge's split point, for the face whose vertices at the edge's ends are a and b. */
static uint32_t middle_vertex(struct subdiv_mesh *mesh, uint32_t edge, uint32_t a, uint32_t b)
{
    const struct subdiv_edge *cut = &mesh->cuts[edge];
    size_t before = mesh->vertex_edges.count;
    uint32_t number = edge_table_add(&mesh->vertex_edges, a, b);
    if (mesh->vertex_edges.count > before) {
        bool forward = place_of(mesh, a) == place_of(mesh, cut->a);
        double t = forward ? (double)cut->share : 1 - (double)cut->share;
        const double weights[2] = { 1 - t, t };
        mem_grow(&mesh->vertex_middles, &mesh->middle_capacity, mesh->vertex_edges.count, sizeof(*mesh->vertex_middles));
        mesh->vertex_middles[number] = add_vertex(mesh, cut->middle, (const uint32_t[2]){ a, b }, weights, 2);
    }
    return mesh->vertex_middles[number];
}

/* --- cutting -------------------------------------------------------------------------------------------------------------- */

bool subdiv_mesh_split_edge(struct subdiv_mesh *mesh, uint32_t edge, const float position_m[3])
{
    struct subdiv_edge *cut = &mesh->cuts[edge];
    cut->load = mesh->loads;
    for (uint32_t corner = cut->corner; corner != TRIMESH_NONE; corner = mesh->next[corner])
        subdiv_mesh_list(&mesh->open, corner / 3);
    if (cut->middle != TRIMESH_NONE)
        return false;
    cut->middle = add_place(mesh, position_m);
    return true;
}

static double distance2(const struct subdiv_mesh *mesh, uint32_t a, uint32_t b)
{
    const float *p = mesh->geometry->positions_m[a], *q = mesh->geometry->positions_m[b];
    double x = (double)p[0] - (double)q[0], y = (double)p[1] - (double)q[1], z = (double)p[2] - (double)q[2];
    return x * x + y * y + z * z;
}

/* Splits a triangle in two. The triangle has corners v and edges e; e[0] is split at vertex m. Appends one piece and returns
 * the other. Each piece keeps an unsplit edge, and they share a new one. */
static struct subdiv_tri cut_once(struct subdiv_mesh *mesh, const struct subdiv_tri *old, const uint32_t v[3], const uint32_t e[3],
                                  uint32_t m)
{
    struct subdiv_tri piece = make_tri(mesh, old, (const uint32_t[3]){ v[0], m, v[2] }, (const uint32_t[3]){ LOOK_UP, LOOK_UP, e[2] });
    add_tri(mesh, old, (const uint32_t[3]){ m, v[1], v[2] }, (const uint32_t[3]){ LOOK_UP, e[1], piece.e[1] });
    return piece;
}

static struct subdiv_tri cut_twice(struct subdiv_mesh *mesh, const struct subdiv_tri *old, const uint32_t v[3], const uint32_t e[3],
                                   const uint32_t m[3])
{
    struct subdiv_tri piece = make_tri(mesh, old, (const uint32_t[3]){ m[0], v[1], m[1] }, unknown);
    if (distance2(mesh, v[0], m[1]) < distance2(mesh, m[0], v[2])) {
        size_t t = add_tri(mesh, old, (const uint32_t[3]){ v[0], m[0], m[1] }, (const uint32_t[3]){ LOOK_UP, piece.e[2], LOOK_UP });
        add_tri(mesh, old, (const uint32_t[3]){ v[0], m[1], v[2] }, (const uint32_t[3]){ mesh->tris[t].e[2], LOOK_UP, e[2] });
    } else {
        size_t t = add_tri(mesh, old, (const uint32_t[3]){ v[0], m[0], v[2] }, (const uint32_t[3]){ LOOK_UP, LOOK_UP, e[2] });
        add_tri(mesh, old, (const uint32_t[3]){ m[0], m[1], v[2] }, (const uint32_t[3]){ piece.e[2], LOOK_UP, mesh->tris[t].e[1] });
    }
    return piece;
}

static struct subdiv_tri cut_thrice(struct subdiv_mesh *mesh, const struct subdiv_tri *old, const uint32_t v[3], const uint32_t m[3])
{
    struct subdiv_tri piece = make_tri(mesh, old, m, unknown);
    for (int i = 0; i < 3; i++)
        add_tri(mesh, old, (const uint32_t[3]){ v[i], m[i], m[(i + 2) % 3] },
                (const uint32_t[3]){ LOOK_UP, piece.e[(i + 2) % 3], LOOK_UP });
    return piece;
}

/* Splits a triangle at all its split edges: the first piece replaces it, the others are appended. */
static void split_tri(struct subdiv_mesh *mesh, size_t t)
{
    struct subdiv_tri old = mesh->tris[t];
    int cuts = subdiv_mesh_is_split(mesh, old.e[0]) + subdiv_mesh_is_split(mesh, old.e[1]) + subdiv_mesh_is_split(mesh, old.e[2]),
        first = 0;
    uint32_t v[3], e[3], m[3] = { 0 };
    if (cuts == 1)
        while (!subdiv_mesh_is_split(mesh, old.e[first]))
            first++;
    else if (cuts == 2)
        while (subdiv_mesh_is_split(mesh, old.e[(first + 2) % 3]))
            first++;
    for (int i = 0; i < 3; i++) {
        v[i] = old.v[(first + i) % 3];
        e[i] = old.e[(first + i) % 3];
    }
    for (int i = 0; i < 3; i++)
        if (subdiv_mesh_is_split(mesh, e[i]))
            m[i] = middle_vertex(mesh, e[i], v[i], v[(i + 1) % 3]);
    struct subdiv_tri piece = cuts == 1   ? cut_once(mesh, &old, v, e, m[0])
                              : cuts == 2 ? cut_twice(mesh, &old, v, e, m)
                                          : cut_thrice(mesh, &old, v, m);
    put_tri(mesh, t, &piece);
}

static bool is_open(const struct subdiv_mesh *mesh, size_t t)
{
    const uint32_t *e = mesh->tris[t].e;
    return subdiv_mesh_is_split(mesh, e[0]) || subdiv_mesh_is_split(mesh, e[1]) || subdiv_mesh_is_split(mesh, e[2]);
}

/* Splits the triangles on the list mesh->open. A piece that needs further splits is appended to the list and split in the next
   round. */
size_t subdiv_mesh_apply(struct subdiv_mesh *mesh)
{
    size_t before = mesh->tri_count;
    while (mesh->open.count) {
        struct subdiv_list open = mesh->open;
        mesh->open = (struct subdiv_list){ 0 };
        subdiv_mesh_sort(&open);
        for (size_t i = 0; i < open.count; i++)
            while (is_open(mesh, open.at[i]))
                split_tri(mesh, open.at[i]);
        mem_free(open.at);
    }
    return mesh->tri_count - before;
}

uint32_t subdiv_mesh_insert(struct subdiv_mesh *mesh, size_t tri, const double weights[3], const float position_m[3])
{
    struct subdiv_tri old = mesh->tris[tri];
    uint32_t vertex = add_vertex(mesh, add_place(mesh, position_m), old.v, weights, 3);
    struct subdiv_tri piece = make_tri(mesh, &old, (const uint32_t[3]){ old.v[0], old.v[1], vertex }, unknown);
    put_tri(mesh, tri, &piece);
    add_tri(mesh, &old, (const uint32_t[3]){ old.v[1], old.v[2], vertex }, unknown);
    add_tri(mesh, &old, (const uint32_t[3]){ old.v[2], old.v[0], vertex }, unknown);
    return vertex;
}

/* --- flipping ------------------------------------------------------------------------------------------------------------- */

/* Writes the triangle's three corners in winding order, beginning with the two at `edge`, and its three edges to `e`, beginning
 * with `edge`. */
static void corners_from(const struct subdiv_tri *tri, uint32_t edge, uint32_t v[3], uint32_t e[3])
{
    int first = tri->e[0] == edge ? 0 : tri->e[1] == edge ? 1 : 2;
    for (int i = 0; i < 3; i++) {
        v[i] = tri->v[(first + i) % 3];
        e[i] = tri->e[(first + i) % 3];
    }
}

uint32_t subdiv_mesh_opposite_edge(struct subdiv_mesh *mesh, const uint32_t tris[2], uint32_t edge)
{
    uint32_t v[3], w[3], e[3];
    corners_from(&mesh->tris[tris[0]], edge, v, e);
    corners_from(&mesh->tris[tris[1]], edge, w, e);
    if (v[0] != w[1] || v[1] != w[0] || place_of(mesh, v[2]) == place_of(mesh, w[2]))
        return TRIMESH_NONE;
    return edge_of(mesh, v[2], w[2], mesh->tris[tris[0]].origin);
}

void subdiv_mesh_flip_edge(struct subdiv_mesh *mesh, const uint32_t tris[2], uint32_t edge, uint32_t across)
{
    const struct subdiv_tri old[2] = { mesh->tris[tris[0]], mesh->tris[tris[1]] };
    uint32_t v[3], w[3], e[3], f[3];
    corners_from(&old[0], edge, v, e);
    corners_from(&old[1], edge, w, f);
    struct subdiv_tri turned[2] = { make_tri(mesh, &old[0], (const uint32_t[3]){ v[0], w[2], v[2] },
                                             (const uint32_t[3]){ f[1], across, e[2] }) };
    turned[1] = make_tri(mesh, &old[1], (const uint32_t[3]){ w[2], v[1], v[2] }, (const uint32_t[3]){ f[2], e[1], across });
    put_tri(mesh, tris[0], &turned[0]);
    put_tri(mesh, tris[1], &turned[1]);
}

void subdiv_mesh_normal(const struct subdiv_mesh *mesh, const struct subdiv_edge *edge, double normal[3])
{
    for (int i = 0; i < 3; i++)
        normal[i] = (double)mesh->geometry->normals[edge->a][i] + (double)mesh->geometry->normals[edge->b][i];
}
