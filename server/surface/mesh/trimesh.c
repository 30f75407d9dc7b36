/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds triangle meshes with shared points: welds vertices, splits triangles, finds connected components. */
#include "surface/mesh/trimesh.h"

#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

/* --- edges --------------------------------------------------------------------------------------------------------------- */

static uint64_t hash64(uint64_t x)
{
    x ^= x >> 31;
    x *= 0x7fb5d329728ea185ull;
    x ^= x >> 27;
    x *= 0x81dadef4bc2dd44dull;
    return x ^ x >> 33;
}

void edge_table_init(struct edge_table *table, size_t expected)
{
    size_t size = 16;
    while (size < expected * 2)
        size *= 2;
    *table = (struct edge_table){ .mask = size - 1 };
    table->keys = mem_array(size, sizeof(*table->keys));
    table->numbers = mem_array(size, sizeof(*table->numbers));
}

void edge_table_finish(struct edge_table *table)
{
    mem_free(table->keys);
    mem_free(table->numbers);
    *table = (struct edge_table){ 0 };
}

/* Returns the key of an edge in the hash table: (lower index + 1, higher index). It is never 0, which marks an empty slot. */
static uint64_t edge_key(uint32_t a, uint32_t b)
{
    return a < b ? (uint64_t)(a + 1) << 32 | b : (uint64_t)(b + 1) << 32 | a;
}

static size_t edge_slot(const struct edge_table *table, uint64_t key)
{
    size_t slot = hash64(key) & table->mask;
    while (table->keys[slot] && table->keys[slot] != key)
        slot = (slot + 1) & table->mask;
    return slot;
}

static void edge_table_double(struct edge_table *table)
{
    struct edge_table grown;
    edge_table_init(&grown, table->mask + 1);
    for (size_t i = 0; i <= table->mask; i++)
        if (table->keys[i]) {
            size_t slot = edge_slot(&grown, table->keys[i]);
            grown.keys[slot] = table->keys[i];
            grown.numbers[slot] = table->numbers[i];
        }
    grown.count = table->count;
    edge_table_finish(table);
    *table = grown;
}

uint32_t edge_table_add(struct edge_table *table, uint32_t a, uint32_t b)
{
    if (table->count * 4 > table->mask * 3)
        edge_table_double(table);
    uint64_t key = edge_key(a, b);
    size_t slot = edge_slot(table, key);
    if (!table->keys[slot]) {
        table->keys[slot] = key;
        table->numbers[slot] = (uint32_t)table->count++;
    }
    return table->numbers[slot];
}

uint32_t edge_table_find(const struct edge_table *table, uint32_t a, uint32_t b)
{
    size_t slot = edge_slot(table, edge_key(a, b));
    return table->keys[slot] ? table->numbers[slot] : TRIMESH_NONE;
}

void edge_table_prefetch(const struct edge_table *table, uint32_t a, uint32_t b)
{
    size_t slot = hash64(edge_key(a, b)) & table->mask;
    __builtin_prefetch(&table->keys[slot]);
    __builtin_prefetch(&table->numbers[slot]);
}

#define AHEAD 8 /* prefetch distance in triangles */
void edge_table_prefetch_ahead(const struct edge_table *table, const uint32_t (*tris)[3], size_t tri, size_t tri_count)
{
    for (int i = 0; i < 3 && tri + AHEAD < tri_count; i++)
        edge_table_prefetch(table, tris[tri + AHEAD][i], tris[tri + AHEAD][(i + 1) % 3]);
}

/* --- building ------------------------------------------------------------------------------------------------------------ */

void trimesh_finish(struct trimesh *mesh)
{
    mem_free(mesh->points);
    mem_free(mesh->tris);
    mem_free(mesh->tri_source);
    mem_free(mesh->tri_times);
    *mesh = (struct trimesh){ 0 };
}

void trimesh_stop_counting(struct trimesh *mesh)
{
    mem_free(mesh->tri_times);
    mesh->tri_times = NULL;
    mesh->times_capacity = 0;
}

void trimesh_copy(struct trimesh *copy, const struct trimesh *mesh)
{
    mem_grow(&copy->points, &copy->point_capacity, mesh->point_count, sizeof(*copy->points));
    mem_grow(&copy->tris, &copy->tri_capacity, mesh->tri_count, sizeof(*copy->tris));
    mem_grow(&copy->tri_source, &copy->source_capacity, mesh->tri_count, sizeof(*copy->tri_source));
    memcpy(copy->points, mesh->points, mesh->point_count * sizeof(*copy->points));
    memcpy(copy->tris, mesh->tris, mesh->tri_count * sizeof(*copy->tris));
    memcpy(copy->tri_source, mesh->tri_source, mesh->tri_count * sizeof(*copy->tri_source));
    trimesh_stop_counting(copy);
    copy->point_count = mesh->point_count;
    copy->tri_count = mesh->tri_count;
}

bool trimesh_has(const struct trimesh *mesh, uint32_t tri, uint32_t point)
{
    const uint32_t *v = mesh->tris[tri];
    return v[0] == point || v[1] == point || v[2] == point;
}

uint32_t trimesh_add_point(struct trimesh *mesh, const double point[3])
{
    mem_grow(&mesh->points, &mesh->point_capacity, mesh->point_count + 1, sizeof(*mesh->points));
    memcpy(mesh->points[mesh->point_count], point, sizeof(*mesh->points));
    return (uint32_t)mesh->point_count++;
}

void trimesh_add_tri(struct trimesh *mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t source)
{
    mem_grow(&mesh->tris, &mesh->tri_capacity, mesh->tri_count + 1, sizeof(*mesh->tris));
    mem_grow(&mesh->tri_source, &mesh->source_capacity, mesh->tri_count + 1, sizeof(*mesh->tri_source));
    if (mesh->tri_times) {
        mem_grow(&mesh->tri_times, &mesh->times_capacity, mesh->tri_count + 1, sizeof(*mesh->tri_times));
        mesh->tri_times[mesh->tri_count] = 1;
    }
    uint32_t *tri = mesh->tris[mesh->tri_count];
    tri[0] = a;
    tri[1] = b;
    tri[2] = c;
    mesh->tri_source[mesh->tri_count++] = source;
}

/* Hash grid for finding points near enough to be welded (merged). The side of its cells is twice the welding distance, so that
 * a lookup reads only the eight cells that may contain such points. */
struct weld_grid {
    double cell_m;
    uint32_t *heads, *next;
    size_t mask;
};

static size_t grid_slot(const struct weld_grid *grid, const int64_t cell[3])
{
    return hash64((uint64_t)cell[0] * 0x9e3779b97f4a7c15ull ^ hash64((uint64_t)cell[1]) ^
                  hash64((uint64_t)cell[2] + 0x632be59bd9b4e019ull)) &
           grid->mask;
}

static uint32_t grid_find(const struct weld_grid *grid, const struct trimesh *mesh, const double p[3], double within_m)
{
    int64_t low[3];
    for (int axis = 0; axis < 3; axis++)
        low[axis] = (int64_t)floor(p[axis] / grid->cell_m - 0.5);
    for (int corner = 0; corner < 8; corner++) {
        const int64_t cell[3] = { low[0] + (corner & 1), low[1] + (corner >> 1 & 1), low[2] + (corner >> 2) };
        for (uint32_t i = grid->heads[grid_slot(grid, cell)]; i != TRIMESH_NONE; i = grid->next[i])
            if (vec_distance2(mesh->points[i], p) <= within_m * within_m)
                return i;
    }
    return TRIMESH_NONE;
}

static void grid_add(struct weld_grid *grid, const double p[3], uint32_t point)
{
    int64_t cell[3];
    for (int axis = 0; axis < 3; axis++)
        cell[axis] = (int64_t)floor(p[axis] / grid->cell_m);
    size_t slot = grid_slot(grid, cell);
    grid->next[point] = grid->heads[slot];
    grid->heads[slot] = point;
}

static bool grid_init(struct weld_grid *grid, size_t count, double within_m)
{
    *grid = (struct weld_grid){ .cell_m = within_m > 0 ? 2 * within_m : 1e-30, .mask = 15 };
    while (grid->mask < count)
        grid->mask = grid->mask * 2 + 1;
    grid->heads = mem_try_array(grid->mask + 1, sizeof(*grid->heads));
    grid->next = mem_try_array(count, sizeof(*grid->next));
    if (grid->heads && grid->next)
        memset(grid->heads, 0xff, (grid->mask + 1) * sizeof(*grid->heads));
    return grid->heads && grid->next;
}

static void grid_finish(struct weld_grid *grid)
{
    mem_free(grid->heads);
    mem_free(grid->next);
}

static bool weld_points(struct trimesh *mesh, const float (*positions)[3], size_t vertex_count, double weld_m, uint32_t *vertex_point)
{
    struct weld_grid grid;
    bool good = grid_init(&grid, vertex_count, weld_m);
    for (size_t v = 0; good && v < vertex_count; v++) {
        const double p[3] = { (double)positions[v][0], (double)positions[v][1], (double)positions[v][2] };
        uint32_t point = grid_find(&grid, mesh, p, weld_m);
        if (point == TRIMESH_NONE) {
            point = trimesh_add_point(mesh, p);
            grid_add(&grid, p, point);
        }
        vertex_point[v] = point;
    }
    grid_finish(&grid);
    return good;
}

bool trimesh_find_twins(const struct trimesh *mesh, double within_m, uint32_t *target)
{
    struct weld_grid grid;
    bool good = grid_init(&grid, mesh->point_count, within_m);
    for (uint32_t i = 0; good && i < mesh->point_count; i++) {
        target[i] = grid_find(&grid, mesh, mesh->points[i], within_m);
        if (target[i] == TRIMESH_NONE) {
            target[i] = i;
            grid_add(&grid, mesh->points[i], i);
        }
    }
    grid_finish(&grid);
    return good;
}

static void sort3(uint32_t v[3])
{
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2 - i; j++)
            if (v[j] > v[j + 1]) {
                uint32_t swap = v[j];
                v[j] = v[j + 1];
                v[j + 1] = swap;
            }
}

/* Returns a number for a triangle's set of three points, counted from 0 in order of first occurrence. Triangles with the same
 * three points, in any order, get the same number, which reveals duplicates. */
static uint32_t tri_number(struct edge_table *pairs, struct edge_table *seen, const uint32_t tri[3])
{
    uint32_t v[3] = { tri[0], tri[1], tri[2] };
    sort3(v);
    uint32_t pair = edge_table_add(pairs, v[0], v[1]);
    /* The table `seen` ignores the order of a key's two numbers. The number for the pair of points is made even and that for
       the third point odd, so that two different triangles never have the same key. */
    return edge_table_add(seen, pair * 2u, v[2] * 2u + 1u);
}

static bool tri_has_area(const struct trimesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    if (a == b || b == c || c == a)
        return false;
    double ab[3], ac[3], bc[3], n[3];
    vec_sub(mesh->points[b], mesh->points[a], ab);
    vec_sub(mesh->points[c], mesh->points[a], ac);
    vec_sub(mesh->points[c], mesh->points[b], bc);
    vec_cross(ab, ac, n);
    double longest2 = max_of(vec_dot(ab, ab), max_of(vec_dot(ac, ac), vec_dot(bc, bc)));
    /* A triangle flatter than a millionth of its longest edge is removed. Its third corner then is a hanging vertex (a vertex that lies
       inside an edge, not at its end), which repair.h inserts into the edge. */
    return vec_length(n) > 1e-6 * longest2;
}

void trimesh_clean(struct trimesh *mesh, size_t *degenerate, size_t *repeated)
{
    struct edge_table pairs, seen;
    edge_table_init(&pairs, mesh->tri_count * 3 / 2);
    edge_table_init(&seen, mesh->tri_count);
    size_t kept = 0;
    for (size_t t = 0; t < mesh->tri_count; t++) {
        const uint32_t *v = mesh->tris[t];
        if (!tri_has_area(mesh, v[0], v[1], v[2])) {
            ++*degenerate;
            continue;
        }
        uint32_t number = tri_number(&pairs, &seen, v);
        if (number < kept) {
            ++*repeated;
            if (mesh->tri_times)
                mesh->tri_times[number] += mesh->tri_times[t];
            continue;
        }
        if (mesh->tri_times)
            mesh->tri_times[kept] = mesh->tri_times[t];
        memmove(mesh->tris[kept], v, sizeof(*mesh->tris));
        mesh->tri_source[kept++] = mesh->tri_source[t];
    }
    mesh->tri_count = kept;
    edge_table_finish(&pairs);
    edge_table_finish(&seen);
}

bool trimesh_weld(struct trimesh *mesh, const struct trimesh_model *model, double weld_m, uint32_t *vertex_point, size_t *degenerate,
                  size_t *repeated)
{
    *mesh = (struct trimesh){ 0 };
    *degenerate = *repeated = 0;
    if (!weld_points(mesh, model->positions, model->vertex_count, weld_m, vertex_point))
        return false;
    mem_grow(&mesh->tri_times, &mesh->times_capacity, model->triangle_count, sizeof(*mesh->tri_times));
    for (size_t t = 0; t < model->triangle_count; t++) {
        const uint32_t *v = model->triangles + 3 * t;
        trimesh_add_tri(mesh, vertex_point[v[0]], vertex_point[v[1]], vertex_point[v[2]], (uint32_t)t);
    }
    trimesh_clean(mesh, degenerate, repeated);
    return true;
}

void trimesh_rename(struct trimesh *mesh, const uint32_t *target, size_t *degenerate, size_t *repeated)
{
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            mesh->tris[t][i] = target[mesh->tris[t][i]];
    trimesh_clean(mesh, degenerate, repeated);
}

/* --- sampling ------------------------------------------------------------------------------------------------------------ */

static double edge2(const struct trimesh *mesh, uint32_t a, uint32_t b)
{
    return vec_distance2(mesh->points[a], mesh->points[b]);
}

static int longest_side(const struct trimesh *mesh, size_t t)
{
    int longest = 0;
    double best2 = -1;
    for (int i = 0; i < 3; i++) {
        double d2 = edge2(mesh, mesh->tris[t][i], mesh->tris[t][(i + 1) % 3]);
        if (d2 > best2) {
            best2 = d2;
            longest = i;
        }
    }
    return longest;
}

void trimesh_normal(const struct trimesh *mesh, size_t tri, double out[3])
{
    const uint32_t *v = mesh->tris[tri];
    vec_normal(mesh->points[v[0]], mesh->points[v[1]], mesh->points[v[2]], out);
}

double trimesh_tri_area(const struct trimesh *mesh, size_t tri)
{
    double n[3];
    trimesh_normal(mesh, tri, n);
    return vec_length(n) / 2;
}

/* Points that sampling inserts on edges. first, parts: by index of the edge, its first inserted point, and the number of equal parts into
   which the points divide the edge. The points of an edge have consecutive indices, from the edge's end with the lower index. */
struct cuts {
    struct edge_table edges;
    uint32_t *first, *parts;
    size_t first_capacity, parts_capacity;
};

static void cuts_finish(struct cuts *cuts)
{
    edge_table_finish(&cuts->edges);
    mem_free(cuts->first);
    mem_free(cuts->parts);
}

static void cut_edge(struct trimesh *mesh, struct cuts *cuts, uint32_t a, uint32_t b, uint32_t parts)
{
    size_t before = cuts->edges.count;
    uint32_t e = edge_table_add(&cuts->edges, a, b), low = a < b ? a : b, high = a < b ? b : a;
    if (cuts->edges.count == before)
        return;
    mem_grow(&cuts->first, &cuts->first_capacity, cuts->edges.count, sizeof(*cuts->first));
    mem_grow(&cuts->parts, &cuts->parts_capacity, cuts->edges.count, sizeof(*cuts->parts));
    cuts->first[e] = (uint32_t)mesh->point_count;
    cuts->parts[e] = parts;
    for (uint32_t i = 1; i < parts; i++) {
        double point[3];
        vec_mix(mesh->points[low], mesh->points[high], (double)i / parts, point);
        trimesh_add_point(mesh, point);
    }
}

/* Lists the points along the edge from a to b: a and the inserted ones, but not b. Returns their number. */
static size_t side_points(const struct cuts *cuts, uint32_t a, uint32_t b, uint32_t *out)
{
    uint32_t e = edge_table_find(&cuts->edges, a, b);
    size_t count = 0;
    out[count++] = a;
    for (uint32_t i = 1; e != TRIMESH_NONE && i < cuts->parts[e]; i++)
        out[count++] = cuts->first[e] + (a < b ? i : cuts->parts[e] - i) - 1;
    return count;
}

static size_t side_count(const struct cuts *cuts, uint32_t a, uint32_t b)
{
    uint32_t e = edge_table_find(&cuts->edges, a, b);
    return e == TRIMESH_NONE ? 1 : cuts->parts[e];
}

/* Triangulates a triangle whose edges were cut, by closing two chains of points like a zip. One chain is a-b, the side with most points;
 * the other is a-c-b. Each step adds the shorter one of the two possible cross edges. Chain a-b stops before b until the other chain has
 * ended, so that no triangle is flat. Narrow triangles get no points inside, however long they are. */
static void zip_tri(struct trimesh *mesh, const struct cuts *cuts, size_t t)
{
    int side = longest_side(mesh, t);
    for (int i = 0; i < 3; i++)
        if (side_count(cuts, mesh->tris[t][i], mesh->tris[t][(i + 1) % 3]) >
            side_count(cuts, mesh->tris[t][side], mesh->tris[t][(side + 1) % 3]))
            side = i;
    uint32_t a = mesh->tris[t][side], b = mesh->tris[t][(side + 1) % 3], c = mesh->tris[t][(side + 2) % 3], source = mesh->tri_source[t];
    size_t ab = side_count(cuts, a, b), acb = side_count(cuts, a, c) + side_count(cuts, c, b);
    if (ab == 1)
        return;
    uint32_t *low = mem_array(ab + acb + 2, sizeof(*low)), *high = low + ab + 1;
    low[side_points(cuts, a, b, low)] = b;
    size_t n = side_points(cuts, a, c, high);
    n += side_points(cuts, c, b, high + n);
    high[n] = b;
    size_t i = 1, j = 1;
    memcpy(mesh->tris[t], (const uint32_t[3]){ a, low[1], high[1] }, sizeof(*mesh->tris));
    while (i < ab) {
        bool high_done = j == acb - 1, low_waits = i == ab - 1;
        if (high_done || (!low_waits && edge2(mesh, low[i + 1], high[j]) < edge2(mesh, low[i], high[j + 1]))) {
            trimesh_add_tri(mesh, low[i], low[i + 1], high[j], source);
            i++;
        } else {
            trimesh_add_tri(mesh, low[i], high[j + 1], high[j], source);
            j++;
        }
    }
    mem_free(low);
}

static void zip_all(struct trimesh *mesh, struct cuts *cuts)
{
    size_t tri_count = mesh->tri_count;
    for (size_t t = 0; t < tri_count && cuts->edges.count; t++)
        zip_tri(mesh, cuts, t);
}

/* One round of halving: each triangle whose height above its longest edge exceeds height_m gets a point in the middle of that edge. Returns
 * false if there was no such triangle. */
static bool halve_round(struct trimesh *mesh, double height_m, size_t point_limit)
{
    struct cuts cuts = { 0 };
    size_t tri_count = mesh->tri_count;
    edge_table_init(&cuts.edges, 1024);
    for (size_t t = 0; t < tri_count && mesh->point_count < point_limit; t++) {
        int side = longest_side(mesh, t);
        uint32_t a = mesh->tris[t][side], b = mesh->tris[t][(side + 1) % 3];
        if (2 * trimesh_tri_area(mesh, t) > height_m * sqrt(edge2(mesh, a, b)))
            cut_edge(mesh, &cuts, a, b, 2);
    }
    zip_all(mesh, &cuts);
    bool any = cuts.edges.count > 0;
    cuts_finish(&cuts);
    return any;
}

static void cut_long_edges(struct trimesh *mesh, double spacing_m, size_t point_limit)
{
    struct cuts cuts = { 0 };
    edge_table_init(&cuts.edges, 1024);
    for (size_t t = 0; t < mesh->tri_count && mesh->point_count < point_limit; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t a = mesh->tris[t][i], b = mesh->tris[t][(i + 1) % 3];
            double parts = ceil(sqrt(edge2(mesh, a, b)) / spacing_m);
            if (parts > 1)
                cut_edge(mesh, &cuts, a, b, (uint32_t)min_of(parts, (double)(point_limit - mesh->point_count) + 2));
        }
    zip_all(mesh, &cuts);
    cuts_finish(&cuts);
}

void trimesh_sample(struct trimesh *mesh, double spacing_m, size_t point_limit)
{
    while (mesh->point_count < point_limit && halve_round(mesh, spacing_m, point_limit))
        ;
    cut_long_edges(mesh, spacing_m, point_limit);
}

/* --- counting ------------------------------------------------------------------------------------------------------------ */

uint32_t trimesh_root(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

void trimesh_join(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = trimesh_root(parent, a);
    b = trimesh_root(parent, b);
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
}

size_t trimesh_components(const struct trimesh *mesh, uint32_t *component)
{
    for (size_t i = 0; i < mesh->point_count; i++)
        component[i] = (uint32_t)i;
    for (size_t t = 0; t < mesh->tri_count; t++) {
        trimesh_join(component, mesh->tris[t][0], mesh->tris[t][1]);
        trimesh_join(component, mesh->tris[t][1], mesh->tris[t][2]);
    }
    char *used = mem_array(mesh->point_count, 1);
    for (size_t t = 0; t < mesh->tri_count; t++)
        used[trimesh_root(component, mesh->tris[t][0])] = 1;
    size_t count = 0;
    for (size_t i = 0; i < mesh->point_count; i++) {
        component[i] = trimesh_root(component, (uint32_t)i);
        count += (size_t)used[i];
    }
    mem_free(used);
    return count;
}

double trimesh_area(const struct trimesh *mesh)
{
    double area = 0;
    for (size_t t = 0; t < mesh->tri_count; t++)
        area += trimesh_tri_area(mesh, t);
    return area;
}
