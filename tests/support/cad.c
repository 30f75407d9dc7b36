/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Generates shapes, and copies of them with the faults that CAD exports have. */
#include "tests/support/cad.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tests/support/owned.h"
#include "tests/support/sweep.h"

#define PI 3.14159265358979323846
#define PATCHES 14
#define NONE UINT32_MAX

void cad_random_start(struct cad_random *random)
{
    random->state = sweep_seed();
    fflush(stdout);
}

double cad_random(struct cad_random *random)
{
    random->state = random->state * 6364136223846793005ull + 1442695040888963407ull;
    return (double)(random->state >> 11) / 9007199254740992.0;
}

void cad_finish(struct cad *cad)
{
    mem_free(cad->positions);
    mem_free(cad->triangles);
    *cad = (struct cad){ 0 };
}

static void release_cad(void *resource)
{
    cad_finish(resource);
    mem_free(resource);
}

struct cad *test_cad(void)
{
    struct cad *cad = mem_new(sizeof(*cad));
    owned_add(release_cad, cad);
    return cad;
}

static uint32_t add_vertex(struct cad *cad, double x, double y, double z)
{
    mem_grow(&cad->positions, &cad->position_capacity, cad->vertex_count + 1, sizeof(*cad->positions));
    float *p = cad->positions[cad->vertex_count];
    p[0] = (float)x;
    p[1] = (float)y;
    p[2] = (float)z;
    return (uint32_t)cad->vertex_count++;
}

static uint32_t copy_vertex(struct cad *to, const struct cad *from, uint32_t v)
{
    const float *p = from->positions[v];
    return add_vertex(to, (double)p[0], (double)p[1], (double)p[2]);
}

static void add_triangle(struct cad *cad, uint32_t a, uint32_t b, uint32_t c)
{
    mem_grow(&cad->triangles, &cad->index_capacity, 3 * cad->triangle_count + 3, sizeof(*cad->triangles));
    memcpy(cad->triangles + 3 * cad->triangle_count++, (const uint32_t[3]){ a, b, c }, 3 * sizeof(uint32_t));
}

static void add_quad(struct cad *cad, struct cad_random *random, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    bool other = cad_random(random) < 0.5;
    add_triangle(cad, a, b, other ? d : c);
    add_triangle(cad, other ? b : a, c, d);
}

/* --- grids ------------------------------------------------------------------------------------------------------------------ */

struct cad_grid {
    int across, up; /* number of the grid's cells in each direction */
    bool round_u, round_v;
    double jitter;
    int hole_first, hole_wide, hole_high;
    double size[3]; /* dimensions of the shape, which the callback `surface` receives */
    void (*surface)(const double size[3], double u, double v, double out[3]);
};

static uint32_t grid_vertex(struct cad *cad, struct cad_random *random, const struct cad_grid *g, int i, int j, uint32_t *ids)
{
    int columns = g->round_u ? g->across : g->across + 1, rows = g->round_v ? g->up : g->up + 1;
    i %= columns;
    j %= rows;
    uint32_t *id = &ids[j * columns + i];
    if (*id != NONE)
        return *id;
    bool border = (!g->round_u && (i == 0 || i == g->across)) || (!g->round_v && (j == 0 || j == g->up));
    double du = border ? 0 : (cad_random(random) - 0.5) * g->jitter, dv = border ? 0 : (cad_random(random) - 0.5) * g->jitter, p[3];
    g->surface(g->size, (i + du) / g->across, (j + dv) / g->up, p);
    return *id = add_vertex(cad, p[0], p[1], p[2]);
}

static void make_grid(struct cad *cad, struct cad_random *random, const struct cad_grid *g)
{
    size_t count = (size_t)(g->across + 1) * (size_t)(g->up + 1);
    uint32_t *ids = mem_array(count, sizeof(*ids));
    memset(ids, 0xff, count * sizeof(*ids));
    for (int j = 0; j < g->up; j++)
        for (int i = 0; i < g->across; i++) {
            if (i >= g->hole_first && i < g->hole_first + g->hole_wide && j < g->hole_high)
                continue;
            uint32_t a = grid_vertex(cad, random, g, i, j, ids), b = grid_vertex(cad, random, g, i + 1, j, ids);
            uint32_t c = grid_vertex(cad, random, g, i + 1, j + 1, ids), d = grid_vertex(cad, random, g, i, j + 1, ids);
            add_quad(cad, random, a, b, c, d);
        }
    mem_free(ids);
}

static void on_plate(const double size[3], double u, double v, double out[3])
{
    out[0] = u * size[0];
    out[1] = v * size[1];
    out[2] = 0;
}

static void on_cylinder(const double size[3], double u, double v, double out[3])
{
    out[0] = cos(2 * PI * u);
    out[1] = sin(2 * PI * u);
    out[2] = v * size[0];
}

static void on_torus(const double size[3], double u, double v, double out[3])
{
    double r = 1 + size[0] * cos(2 * PI * v);
    out[0] = r * cos(2 * PI * u);
    out[1] = r * sin(2 * PI * u);
    out[2] = size[0] * sin(2 * PI * v);
}

/* Shape of a pipe of radius size[0]: its axis follows an arc of 135 degrees about (0, 1), then the same arc again, rotated by
   half a turn about its end, so that the pipe is S-shaped. */
static void on_bent_pipe(const double size[3], double u, double v, double out[3])
{
    const double bend = 0.75 * PI;
    double s = (u < 0.5 ? u : 1 - u) * 2 * bend, x = sin(s), y = 1 - cos(s), nx = -sin(s), ny = cos(s);
    if (u >= 0.5) { /* second half: the first bend, rotated by half a turn about its end */
        x = 2 * sin(bend) - x;
        y = 2 * (1 - cos(bend)) - y;
    }
    out[0] = x + size[0] * cos(2 * PI * v) * nx;
    out[1] = y + size[0] * cos(2 * PI * v) * ny;
    out[2] = size[0] * sin(2 * PI * v);
}

void cad_plate(struct cad *cad, struct cad_random *random, int across, int up, double width, double height, double jitter)
{
    make_grid(cad, random,
              &(struct cad_grid){ .across = across, .up = up, .jitter = jitter, .size = { width, height }, .surface = on_plate });
}

void cad_slotted_plate(struct cad *cad, struct cad_random *random, int across, int up, double width, double height, int first, int wide,
                       int high)
{
    make_grid(cad, random,
              &(struct cad_grid){ .across = across,
                                  .up = up,
                                  .size = { width, height },
                                  .surface = on_plate,
                                  .hole_first = first,
                                  .hole_wide = wide,
                                  .hole_high = high });
}

void cad_cylinder(struct cad *cad, struct cad_random *random, int around, int along, double length, double jitter)
{
    make_grid(cad, random,
              &(struct cad_grid){
                  .across = around, .up = along, .round_u = true, .jitter = jitter, .size = { length }, .surface = on_cylinder });
}

void cad_torus(struct cad *cad, struct cad_random *random, int around, int tube, double tube_radius, double jitter)
{
    make_grid(cad, random,
              &(struct cad_grid){ .across = around,
                                  .up = tube,
                                  .round_u = true,
                                  .round_v = true,
                                  .jitter = jitter,
                                  .size = { tube_radius },
                                  .surface = on_torus });
}

void cad_bent_pipe(struct cad *cad, struct cad_random *random, int along, int around, double pipe_radius, double jitter)
{
    make_grid(cad, random,
              &(struct cad_grid){
                  .across = along, .up = around, .round_v = true, .jitter = jitter, .size = { pipe_radius }, .surface = on_bent_pipe });
}

void cad_append(struct cad *cad, const struct cad *other, const double move[3])
{
    uint32_t first = (uint32_t)cad->vertex_count;
    mem_grow(&cad->positions, &cad->position_capacity, cad->vertex_count + other->vertex_count, sizeof(*cad->positions));
    mem_grow(&cad->triangles, &cad->index_capacity, 3 * (cad->triangle_count + other->triangle_count), sizeof(*cad->triangles));
    for (size_t v = 0; v < other->vertex_count; v++)
        for (int axis = 0; axis < 3; axis++)
            cad->positions[cad->vertex_count + v][axis] = (float)((double)other->positions[v][axis] + move[axis]);
    for (size_t i = 0; i < 3 * other->triangle_count; i++)
        cad->triangles[3 * cad->triangle_count + i] = first + other->triangles[i];
    cad->vertex_count += other->vertex_count;
    cad->triangle_count += other->triangle_count;
}

/* --- blocks: surfaces of sets of cubic cells ------------------------------------------------------------------------------------- */

struct block {
    int size[3];
    bool (*filled)(const int size[3], const int cell[3]);
};

static bool inside(const struct block *block, const int cell[3])
{
    for (int axis = 0; axis < 3; axis++)
        if (cell[axis] < 0 || cell[axis] >= block->size[axis])
            return false;
    return block->filled(block->size, cell);
}

static uint32_t block_vertex(struct cad *cad, const struct block *block, const int at[3], uint32_t *ids)
{
    uint32_t *id = &ids[(at[0] * (block->size[1] + 1) + at[1]) * (block->size[2] + 1) + at[2]];
    if (*id == NONE)
        *id = add_vertex(cad, at[0], at[1], at[2]);
    return *id;
}

/* Adds one side of a cell, at the higher or lower end of an axis, wound so that it faces outwards. */
static void block_side(struct cad *cad, struct cad_random *random, const struct block *block, const int cell[3], int axis, int high,
                       uint32_t *ids)
{
    uint32_t corners[4];
    for (int k = 0; k < 4; k++) {
        int turn = high ? k : 3 - k, at[3] = { cell[0], cell[1], cell[2] };
        at[axis] += high;
        at[(axis + 1) % 3] += turn == 1 || turn == 2;
        at[(axis + 2) % 3] += turn >= 2;
        corners[k] = block_vertex(cad, block, at, ids);
    }
    add_quad(cad, random, corners[0], corners[1], corners[2], corners[3]);
}

static void make_block(struct cad *cad, struct cad_random *random, const struct block *block)
{
    const int *size = block->size;
    size_t count = (size_t)(size[0] + 1) * (size_t)(size[1] + 1) * (size_t)(size[2] + 1);
    uint32_t *ids = mem_array(count, sizeof(*ids));
    memset(ids, 0xff, count * sizeof(*ids));
    for (int x = 0; x < size[0]; x++)
        for (int y = 0; y < size[1]; y++)
            for (int z = 0; z < size[2]; z++)
                for (int side = 0; side < 6; side++) {
                    int cell[3] = { x, y, z }, beside[3] = { x, y, z };
                    beside[side / 2] += side % 2 ? 1 : -1;
                    if (inside(block, cell) && !inside(block, beside))
                        block_side(cad, random, block, cell, side / 2, side % 2, ids);
                }
    mem_free(ids);
}

static bool in_cube(const int size[3], const int cell[3])
{
    (void)size, (void)cell;
    return true;
}

static bool in_thin_box(const int size[3], const int cell[3])
{
    return cell[0] == 0 || cell[0] == size[0] - 1 || cell[1] == 0 || cell[1] == size[1] - 1 || cell[2] == 0;
}

void cad_sphere(struct cad *cad, struct cad_random *random, int cells)
{
    make_block(cad, random, &(struct block){ { cells, cells, cells }, in_cube });
    for (size_t v = 0; v < cad->vertex_count; v++) { /* projects the cube onto the sphere, with its squares spaced evenly in angle */
        double p[3], length = 0;
        for (int axis = 0; axis < 3; axis++) {
            p[axis] = tan((2 * (double)cad->positions[v][axis] / cells - 1) * PI / 4);
            length += p[axis] * p[axis];
        }
        for (int axis = 0; axis < 3; axis++)
            cad->positions[v][axis] = (float)(p[axis] / sqrt(length));
    }
}

static void make_scaled_block(struct cad *cad, struct cad_random *random, const struct block *block, double cell)
{
    make_block(cad, random, block);
    for (size_t v = 0; v < cad->vertex_count; v++)
        for (int axis = 0; axis < 3; axis++)
            cad->positions[v][axis] = (float)(cell * (double)cad->positions[v][axis]);
}

void cad_thin_box(struct cad *cad, struct cad_random *random, int x, int y, int z, double cell)
{
    make_scaled_block(cad, random, &(struct block){ { x, y, z }, in_thin_box }, cell);
}

void cad_box(struct cad *cad, struct cad_random *random, int x, int y, int z, double cell)
{
    make_scaled_block(cad, random, &(struct block){ { x, y, z }, in_cube }, cell);
}

/* --- pipes ---------------------------------------------------------------------------------------------------------------------- */

static uint32_t add_ring(struct cad *cad, double radius, double z, int around)
{
    uint32_t first = (uint32_t)cad->vertex_count;
    for (int i = 0; i < around; i++)
        add_vertex(cad, radius * cos(2 * PI * i / around), radius * sin(2 * PI * i / around), z);
    return first;
}

static void join_rings(struct cad *cad, struct cad_random *random, uint32_t below, uint32_t above, int around)
{
    for (int i = 0; i < around; i++) {
        uint32_t a = (uint32_t)i, b = (uint32_t)((i + 1) % around);
        add_quad(cad, random, below + a, below + b, above + b, above + a);
    }
}

static void close_end(struct cad *cad, struct cad_random *random, uint32_t outer, double radius, double z, int around, int rings, bool top)
{
    for (int r = 1; r < rings; r++) {
        uint32_t inner = add_ring(cad, radius * (1 - (double)r / rings), z, around);
        join_rings(cad, random, top ? outer : inner, top ? inner : outer, around);
        outer = inner;
    }
    uint32_t centre = add_vertex(cad, 0, 0, z);
    for (int i = 0; i < around; i++) {
        uint32_t a = outer + (uint32_t)i, b = outer + (uint32_t)((i + 1) % around);
        add_triangle(cad, top ? a : b, top ? b : a, centre);
    }
}

void cad_closed_pipe(struct cad *cad, struct cad_random *random, double radius, double length, int around, int along, int rings,
                     double turn_rad, const double centre[3])
{
    size_t start = cad->vertex_count;
    uint32_t bottom = add_ring(cad, radius, -length / 2, around), last = bottom;
    for (int j = 1; j <= along; j++) {
        uint32_t next = add_ring(cad, radius, length * ((double)j / along - 0.5), around);
        join_rings(cad, random, last, next, around);
        last = next;
    }
    close_end(cad, random, bottom, radius, -length / 2, around, rings, false);
    close_end(cad, random, last, radius, length / 2, around, rings, true);
    for (size_t v = start; v < cad->vertex_count; v++) {
        float *p = cad->positions[v];
        double x = (double)p[0], z = (double)p[2];
        p[0] = (float)(cos(turn_rad) * x + sin(turn_rad) * z + centre[0]);
        p[1] = (float)((double)p[1] + centre[1]);
        p[2] = (float)(cos(turn_rad) * z - sin(turn_rad) * x + centre[2]);
    }
}

/* Adds a ring of vertices around the curve of a figure eight at s: 0 is the eight's left end, 0.5 its right end, in between
   lies the crossing, and 1 is the left end again. */
static uint32_t add_eight_ring(struct cad *cad, double s, double radius, int around)
{
    uint32_t first = (uint32_t)cad->vertex_count;
    double a = 2 * PI * (s < 1 ? s : 0), tx = sin(a), ty = 0.07 * cos(a) - 1.2 * cos(2 * a), length = hypot(tx, ty);
    for (int i = 0; i < around; i++) {
        double b = 2 * PI * i / around + 0.9 * sin(a + 0.4);
        add_vertex(cad, -cos(a) - radius * cos(b) * ty / length, 0.07 * sin(a) - 0.6 * sin(2 * a) + radius * cos(b) * tx / length,
                   0.2 * radius * sin(a) + radius * sin(b));
    }
    return first;
}

static void cap(struct cad *cad, uint32_t ring, int around, double x, bool turned)
{
    uint32_t middle = add_vertex(cad, x, 0, 0);
    for (int i = 0; i < around; i++) {
        uint32_t a = ring + (uint32_t)i, b = ring + (uint32_t)((i + 1) % around);
        add_triangle(cad, turned ? b : a, turned ? a : b, middle);
    }
}

void cad_eight(struct cad *cad, struct cad_random *random, int along, int around, double tube_radius, int half)
{
    int begin = half == 2 ? along / 2 : 0, end = half == 1 ? along / 2 : along;
    uint32_t first = add_eight_ring(cad, (double)begin / along, tube_radius, around), last = first;
    for (int j = begin + 1; j <= end; j++) {
        uint32_t next = half || j < end ? add_eight_ring(cad, (double)j / along, tube_radius, around) : first;
        join_rings(cad, random, last, next, around);
        last = next;
    }
    if (half) {
        cap(cad, first, around, half == 1 ? -1 : 1, true);
        cap(cad, last, around, half == 1 ? 1 : -1, false);
    }
}

/* --- faults ---------------------------------------------------------------------------------------------------------------------- */

const char *const cad_fault_names[CAD_FAULTS] = { "clean",       "triangle soup", "hair gaps", "repeated, turned", "hanging vertices",
                                                  "non-manifold" };

static double size_of(const struct cad *cad)
{
    double sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t v = 0; v < cad->vertex_count; v++) {
            low = fmin(low, (double)cad->positions[v][axis]);
            high = fmax(high, (double)cad->positions[v][axis]);
        }
        sum += (high - low) * (high - low);
    }
    return sqrt(sum);
}

static void middle_of(const struct cad *cad, size_t t, double out[3])
{
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = 0;
        for (int i = 0; i < 3; i++)
            out[axis] += (double)cad->positions[cad->triangles[3 * t + (size_t)i]][axis] / 3;
    }
}

static void copy_vertices(struct cad *to, const struct cad *from, uint32_t *vertex_of)
{
    for (uint32_t v = 0; v < from->vertex_count; v++)
        vertex_of[v] = copy_vertex(to, from, v);
}

static void break_to_soup(struct cad *to, const struct cad *from, uint32_t *vertex_of)
{
    for (size_t t = 0; t < from->triangle_count; t++) {
        uint32_t v[3];
        for (size_t i = 0; i < 3; i++)
            v[i] = vertex_of[from->triangles[3 * t + i]] = copy_vertex(to, from, from->triangles[3 * t + i]);
        add_triangle(to, v[0], v[1], v[2]);
    }
}

static int *choose_patches(const struct cad *from, struct cad_random *random)
{
    int *patch = mem_array(from->triangle_count, sizeof(*patch));
    double seeds[PATCHES][3];
    for (int s = 0; s < PATCHES; s++)
        middle_of(from, (size_t)(cad_random(random) * (double)from->triangle_count), seeds[s]);
    for (size_t t = 0; t < from->triangle_count; t++) {
        double middle[3], best = INFINITY;
        middle_of(from, t, middle);
        for (int s = 0; s < PATCHES; s++) {
            double d2 = 0;
            for (int axis = 0; axis < 3; axis++)
                d2 += (middle[axis] - seeds[s][axis]) * (middle[axis] - seeds[s][axis]);
            if (d2 < best) {
                best = d2;
                patch[t] = s;
            }
        }
    }
    return patch;
}

/* Splits the shape into patches with vertices of their own, as CAD exports have them. At the seams, moves vertices towards the
   centre of one of their triangles, which opens gaps between patches. */
static void break_to_patches(struct cad *to, const struct cad *from, struct cad_random *random, uint32_t *vertex_of)
{
    int *patch = choose_patches(from, random), *owner = mem_array(from->vertex_count, sizeof(*owner));
    uint32_t *ids = mem_array(from->vertex_count * PATCHES, sizeof(*ids));
    double size = size_of(from);
    memset(owner, 0xff, from->vertex_count * sizeof(*owner));
    memset(ids, 0xff, from->vertex_count * PATCHES * sizeof(*ids));
    for (size_t i = 0; i < 3 * from->triangle_count; i++) {
        int *o = &owner[from->triangles[i]];
        *o = *o == -1 || *o == patch[i / 3] ? patch[i / 3] : PATCHES;
    }
    for (size_t t = 0; t < from->triangle_count; t++) {
        uint32_t v[3];
        double middle[3];
        middle_of(from, t, middle);
        for (size_t i = 0; i < 3; i++) {
            uint32_t was = from->triangles[3 * t + i], *id = &ids[(size_t)was * PATCHES + (size_t)patch[t]];
            if (*id == NONE) {
                *id = vertex_of[was] = copy_vertex(to, from, was);
                float *p = to->positions[*id];
                double back = owner[was] == PATCHES ? size * (1e-5 + 9e-5 * cad_random(random)) : 0, length = 0;
                for (int axis = 0; axis < 3; axis++)
                    length += (middle[axis] - (double)p[axis]) * (middle[axis] - (double)p[axis]);
                for (int axis = 0; axis < 3; axis++)
                    p[axis] = (float)((double)p[axis] + back * (middle[axis] - (double)p[axis]) / sqrt(length));
            }
            v[i] = *id;
        }
        add_triangle(to, v[0], v[1], v[2]);
    }
    mem_free(patch);
    mem_free(owner);
    mem_free(ids);
}

static void repeat_and_turn(struct cad *to, const uint32_t v[3], struct cad_random *random)
{
    bool turned = cad_random(random) < 0.33;
    add_triangle(to, v[0], v[turned ? 2 : 1], v[turned ? 1 : 2]);
    if (cad_random(random) < 0.2)
        add_triangle(to, v[0], v[2], v[1]);
    if (cad_random(random) < 0.13)
        add_triangle(to, v[1], v[2], v[0]);
}

static void cut_a_side(struct cad *to, const uint32_t v[3], struct cad_random *random)
{
    if (cad_random(random) >= 0.15) {
        add_triangle(to, v[0], v[1], v[2]);
        return;
    }
    double t = 0.3 + 0.4 * cad_random(random), p[3];
    for (int axis = 0; axis < 3; axis++)
        p[axis] = (double)to->positions[v[0]][axis] * (1 - t) + (double)to->positions[v[1]][axis] * t;
    uint32_t hanging = add_vertex(to, p[0], p[1], p[2]);
    add_triangle(to, v[0], hanging, v[2]);
    add_triangle(to, hanging, v[1], v[2]);
}

static void add_fin(struct cad *to, const uint32_t v[3], struct cad_random *random)
{
    add_triangle(to, v[0], v[1], v[2]);
    if (cad_random(random) >= 0.05)
        return;
    double ab[3], ac[3], foot[3];
    for (int axis = 0; axis < 3; axis++) {
        double a = (double)to->positions[v[0]][axis], b = (double)to->positions[v[1]][axis];
        ab[axis] = b - a;
        ac[axis] = (double)to->positions[v[2]][axis] - a;
        foot[axis] = (a + b) / 2;
    }
    double n[3] = { ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2], ab[0] * ac[1] - ab[1] * ac[0] };
    double twice_area = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), reach = 0.7 / sqrt(twice_area);
    add_triangle(to, v[0], v[1], add_vertex(to, foot[0] + reach * n[0], foot[1] + reach * n[1], foot[2] + reach * n[2]));
}

void cad_break(struct cad *broken, const struct cad *clean, enum cad_fault fault, struct cad_random *random, uint32_t *vertex_of)
{
    *broken = (struct cad){ 0 };
    if (fault == CAD_SOUP) {
        break_to_soup(broken, clean, vertex_of);
        return;
    }
    if (fault == CAD_GAPS) {
        break_to_patches(broken, clean, random, vertex_of);
        return;
    }
    copy_vertices(broken, clean, vertex_of);
    for (size_t t = 0; t < clean->triangle_count; t++) {
        const uint32_t *v = clean->triangles + 3 * t;
        if (fault == CAD_REPEATED)
            repeat_and_turn(broken, v, random);
        else if (fault == CAD_HANGING)
            cut_a_side(broken, v, random);
        else if (fault == CAD_FINS)
            add_fin(broken, v, random);
        else
            add_triangle(broken, v[0], v[1], v[2]);
    }
}

void cad_random_place(struct cad_place *place, struct cad_random *random)
{
    double q[4], length = 0;
    for (int i = 0; i < 4; i++) {
        q[i] = cad_random(random) - 0.5;
        length += q[i] * q[i];
    }
    for (int i = 0; i < 4; i++)
        q[i] /= sqrt(length);
    double x = q[0], y = q[1], z = q[2], w = q[3];
    const double r[9] = { 1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                          2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                          2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y) };
    memcpy(place->rotation, r, sizeof(r));
    place->scale = pow(10, 4 * cad_random(random) - 2);
    for (int axis = 0; axis < 3; axis++)
        place->move[axis] = 3 * place->scale * (cad_random(random) - 0.5);
}

void cad_put_point(const struct cad_place *place, const double p[3], double out[3])
{
    for (int axis = 0; axis < 3; axis++) {
        const double *row = place->rotation + 3 * axis;
        out[axis] = place->scale * (row[0] * p[0] + row[1] * p[1] + row[2] * p[2]) + place->move[axis];
    }
}

void cad_put(struct cad *cad, const struct cad_place *place)
{
    for (size_t v = 0; v < cad->vertex_count; v++) {
        float *p = cad->positions[v];
        double put[3];
        cad_put_point(place, (double[3]){ (double)p[0], (double)p[1], (double)p[2] }, put);
        for (int axis = 0; axis < 3; axis++)
            p[axis] = (float)put[axis];
    }
}
