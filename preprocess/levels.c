/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Simplifies an asset step by step. Vertices are welded by place first: split normals would stall the simplifier. */
#include "preprocess/levels.h"

#include <math.h>
#include <meshoptimizer.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/deviation.h"
#include "preprocess/places.h"

#define LEVEL_WORTH 0.7    /* of the triangles of the level before, at most */
#define LEAST_TRIANGLES 60 /* fewer are not simplified */
#define OVERSHOOT 1.3      /* of the error asked for, is put up with */
#define TRIES 4
#define NEAR 0.01 /* of the size: levels with smaller errors keep open borders as they are, or hair gaps between patches would open */

/* A level is drawn where its error is about a pixel: where the asset is some 1700, 600, 200, 60, 20 pixels large. */
static const double errors_of_size[] = { 0.0004, 0.0012, 0.004, 0.012, 0.04 };

struct key { /* what keeps vertices apart for the simplifier: a border of material or texture is then a seam, which it keeps */
    float position[3], texcoord[2];
    uint32_t primitive;
    uint8_t color[4];
};

struct simplifier {
    const struct geometry *geometry;
    struct workers *workers;
    size_t knot_count;
    uint32_t *knot; /* of each vertex: vertices with equal keys are one knot */
    float (*positions_m)[3];
    uint32_t *primitive;        /* of each knot */
    uint32_t *first, *vertices; /* of each knot: its vertices */
    char *used;                 /* vertices of the level before */
    uint32_t *part;             /* of each knot: pieces that hang together by place */
    size_t part_count;
    float *part_size_m;
    struct deviation finest;
    double size_m;
};

/* --- knots ---------------------------------------------------------------------------------------------------------------- */

static void fill_keys(const struct geometry *g, struct key *keys)
{
    for (uint32_t p = 0; p < g->primitive_count; p++) {
        const struct asset_primitive *primitive = &g->primitives[p];
        const struct asset_material *m = &g->materials[primitive->material];
        bool textured = m->base_color_texture != ASSET_NO_TEXTURE || m->metallic_roughness_texture != ASSET_NO_TEXTURE ||
                        m->normal_texture != ASSET_NO_TEXTURE || m->occlusion_texture != ASSET_NO_TEXTURE ||
                        m->emissive_texture != ASSET_NO_TEXTURE;
        for (uint32_t i = primitive->first_index; i < primitive->first_index + primitive->index_count; i++) {
            uint32_t v = g->indices[i];
            struct key *key = &keys[v];
            memcpy(key->position, g->positions_m[v], sizeof(key->position));
            key->primitive = p;
            if (textured && g->texcoords)
                memcpy(key->texcoord, g->texcoords[v], sizeof(key->texcoord));
            if (g->colors)
                memcpy(key->color, g->colors[v], sizeof(key->color));
        }
    }
}

static void list_vertices(struct simplifier *s, const struct key *keys)
{
    for (uint32_t v = 0; v < s->geometry->vertex_count; v++) {
        uint32_t k = s->knot[v];
        memcpy(s->positions_m[k], keys[v].position, sizeof(*s->positions_m));
        s->primitive[k] = keys[v].primitive;
        s->first[k + 2]++;
    }
    for (size_t k = 2; k < s->knot_count + 2; k++)
        s->first[k] += s->first[k - 1];
    for (uint32_t v = 0; v < s->geometry->vertex_count; v++)
        s->vertices[s->first[s->knot[v] + 1]++] = v;
}

static bool make_knots(struct simplifier *s)
{
    size_t count = s->geometry->vertex_count;
    struct key *keys = mem_try_array(count, sizeof(*keys));
    s->knot = mem_try_array(count, sizeof(*s->knot));
    s->positions_m = mem_try_array(count, sizeof(*s->positions_m));
    s->primitive = mem_try_array(count, sizeof(*s->primitive));
    s->first = mem_try_array(count + 2, sizeof(*s->first));
    s->vertices = mem_try_array(count, sizeof(*s->vertices));
    s->used = mem_try_array(count, 1);
    bool good = keys && s->knot && s->positions_m && s->primitive && s->first && s->vertices && s->used;
    if (good) {
        fill_keys(s->geometry, keys);
        s->knot_count = meshopt_generateVertexRemap(s->knot, NULL, count, keys, count, sizeof(*keys));
        list_vertices(s, keys);
        memset(s->used, 1, count);
    }
    mem_free(keys);
    return good;
}

/* --- parts ---------------------------------------------------------------------------------------------------------------- */

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

static void number_parts(struct simplifier *s, const struct places *places, uint32_t *parent)
{
    const struct geometry *g = s->geometry;
    uint32_t *number = mem_array(places->count, sizeof(*number));
    memset(number, 0xff, places->count * sizeof(*number));
    for (uint32_t v = 0; v < g->vertex_count; v++) {
        uint32_t root = root_of(parent, places->of_vertex[v]);
        if (number[root] == UINT32_MAX)
            number[root] = (uint32_t)s->part_count++;
        s->part[s->knot[v]] = number[root];
    }
    mem_free(number);
}

static void measure_parts(struct simplifier *s)
{
    float(*low)[3] = mem_array(s->part_count, sizeof(*low)), (*high)[3] = mem_array(s->part_count, sizeof(*high));
    s->part_size_m = mem_array(s->part_count, sizeof(*s->part_size_m));
    for (size_t p = 0; p < s->part_count; p++)
        for (int axis = 0; axis < 3; axis++) {
            low[p][axis] = INFINITY;
            high[p][axis] = -INFINITY;
        }
    for (size_t k = 0; k < s->knot_count; k++)
        for (int axis = 0; axis < 3; axis++) {
            low[s->part[k]][axis] = fminf(low[s->part[k]][axis], s->positions_m[k][axis]);
            high[s->part[k]][axis] = fmaxf(high[s->part[k]][axis], s->positions_m[k][axis]);
        }
    for (size_t p = 0; p < s->part_count; p++)
        s->part_size_m[p] = hypotf(high[p][0] - low[p][0], hypotf(high[p][1] - low[p][1], high[p][2] - low[p][2]));
    mem_free(low);
    mem_free(high);
}

static bool make_parts(struct simplifier *s)
{
    const struct geometry *g = s->geometry;
    struct places places;
    if (!places_init(&places, (const float(*)[3])g->positions_m, g->vertex_count))
        return false;
    uint32_t *parent = mem_array(places.count, sizeof(*parent));
    for (uint32_t i = 0; i < places.count; i++)
        parent[i] = i;
    for (uint32_t i = 0; i < g->index_count; i += 3)
        for (uint32_t c = 1; c < 3; c++)
            parent[root_of(parent, places.of_vertex[g->indices[i + c]])] = root_of(parent, places.of_vertex[g->indices[i]]);
    s->part = mem_array(s->knot_count, sizeof(*s->part));
    number_parts(s, &places, parent);
    mem_free(parent);
    places_finish(&places);
    measure_parts(s);
    return true;
}

/* The places of parts no larger than error_m, all within error_m of larger ones: dropped[part]. */
static void find_small_parts(const struct simplifier *s, const uint32_t *indices, size_t index_count, double error_m, char *dropped)
{
    uint32_t *large = mem_array(index_count, sizeof(*large));
    size_t count = 0, small = 0;
    memset(dropped, 0, s->part_count);
    for (size_t i = 0; i < index_count; i += 3)
        if ((double)s->part_size_m[s->part[indices[i]]] > error_m) {
            memcpy(large + count, indices + i, 3 * sizeof(*large));
            count += 3;
        } else {
            dropped[s->part[indices[i]]] = 1;
            small++;
        }
    if (count && small) {
        struct deviation rest;
        deviation_init(&rest, (const float(*)[3])s->positions_m, large, count / 3);
        for (size_t k = 0; k < s->knot_count; k++) {
            const double p[3] = { (double)s->positions_m[k][0], (double)s->positions_m[k][1], (double)s->positions_m[k][2] };
            struct bvh_place place;
            if (!dropped[s->part[k]])
                continue;
            bvh_nearest(rest.bvh, p, error_m, NULL, NULL, &place);
            if (place.tri == TRIMESH_NONE)
                dropped[s->part[k]] = 0;
        }
        deviation_finish(&rest);
    }
    if (!count)
        memset(dropped, 0, s->part_count);
    mem_free(large);
}

static size_t drop_small_parts(const struct simplifier *s, uint32_t *indices, size_t index_count, double error_m)
{
    char *dropped = mem_array(s->part_count, 1);
    size_t kept = 0;
    find_small_parts(s, indices, index_count, error_m, dropped);
    for (size_t i = 0; i < index_count; i += 3)
        if (!dropped[s->part[indices[i]]]) {
            memmove(indices + kept, indices + i, 3 * sizeof(*indices));
            kept += 3;
        }
    mem_free(dropped);
    return kept;
}

/* --- one step ------------------------------------------------------------------------------------------------------------- */

static void face_normal(const struct simplifier *s, const uint32_t knots[3], float n[3])
{
    const float *a = s->positions_m[knots[0]], *b = s->positions_m[knots[1]], *c = s->positions_m[knots[2]];
    double u[3], v[3], m[3], length2 = 0;
    for (int i = 0; i < 3; i++) {
        u[i] = (double)b[i] - (double)a[i];
        v[i] = (double)c[i] - (double)a[i];
    }
    for (int i = 0; i < 3; i++) {
        m[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
        length2 += m[i] * m[i];
    }
    for (int i = 0; i < 3; i++)
        n[i] = length2 > 0 ? (float)(m[i] / sqrt(length2)) : 0;
}

/* Of a knot's vertices the one whose normal suits the face, also where the face is wound the wrong way. */
static uint32_t choose_vertex(const struct simplifier *s, uint32_t knot, const float n[3])
{
    uint32_t best = UINT32_MAX;
    float best_score = -INFINITY;
    for (uint32_t i = s->first[knot]; i < s->first[knot + 1]; i++) {
        uint32_t v = s->vertices[i];
        const float *m = s->geometry->normals[v];
        float dot = n[0] * m[0] + n[1] * m[1] + n[2] * m[2], score = fabsf(dot) + 1e-3f * dot;
        if (s->used[v] && score > best_score) {
            best = v;
            best_score = score;
        }
    }
    return best;
}

/* From knots to vertices, primitive by primitive in the geometry's order. */
static void write_level(struct simplifier *s, struct level *level, const uint32_t *knots, size_t count)
{
    const struct geometry *g = s->geometry;
    uint32_t *fill = mem_array(g->primitive_count + 1u, sizeof(*fill));
    level->indices = mem_array(count, sizeof(*level->indices));
    level->primitives = mem_array(g->primitive_count, sizeof(*level->primitives));
    level->index_count = (uint32_t)count;
    for (size_t i = 0; i < count; i += 3)
        fill[s->primitive[knots[i]] + 1] += 3;
    for (uint32_t p = 0; p < g->primitive_count; p++) {
        if (fill[p + 1])
            level->primitives[level->primitive_count++] = (struct asset_primitive){
                .first_index = fill[p], .index_count = fill[p + 1], .material = g->primitives[p].material, .name = g->primitives[p].name
            };
        fill[p + 1] += fill[p];
    }
    for (size_t i = 0; i < count; i += 3) {
        float n[3];
        uint32_t *at = &fill[s->primitive[knots[i]]];
        face_normal(s, knots + i, n);
        for (size_t c = 0; c < 3; c++)
            level->indices[(*at)++] = choose_vertex(s, knots[i + c], n);
    }
    memset(s->used, 0, g->vertex_count);
    for (uint32_t i = 0; i < level->index_count; i++)
        s->used[level->indices[i]] = 1;
    for (uint32_t p = 0; p < level->primitive_count; p++)
        meshopt_optimizeVertexCache(level->indices + level->primitives[p].first_index, level->indices + level->primitives[p].first_index,
                                    level->primitives[p].index_count, g->vertex_count);
    mem_free(fill);
}

static double error_of(const struct simplifier *s, const uint32_t *knots, size_t count, double expected_m, double limit_m)
{
    struct deviation coarse;
    deviation_init(&coarse, (const float(*)[3])s->positions_m, knots, count / 3);
    double back_m = deviation_measure(&coarse, &s->finest, expected_m, limit_m, s->workers);
    double there_m = back_m > limit_m ? 0 : deviation_measure(&s->finest, &coarse, expected_m, limit_m, s->workers);
    deviation_finish(&coarse);
    return fmax(there_m, back_m);
}

/* Simplifies `knots` in place, to about error_m. The simplifier's own error is a mean over planes and no bound: what comes out is
   measured, and where it errs by too much it is asked for less. */
static size_t simplify(const struct simplifier *s, uint32_t *knots, size_t count, double error_m, double *measured_m)
{
    const float *positions = &s->positions_m[0][0];
    double scale_m = (double)meshopt_simplifyScale(positions, s->knot_count, sizeof(*s->positions_m)), asked_m = error_m;
    unsigned options = error_m < NEAR * s->size_m ? meshopt_SimplifyLockBorder : 0;
    uint32_t *from = mem_array(count, sizeof(*from));
    count = drop_small_parts(s, knots, count, error_m);
    memcpy(from, knots, count * sizeof(*from));
    size_t left = count;
    for (int i = 1; i <= TRIES; i++) {
        double limit_m = (i < TRIES ? 1 : 2) * OVERSHOOT * error_m;
        left = meshopt_simplify(knots, from, count, positions, s->knot_count, sizeof(*s->positions_m), 0, (float)(asked_m / scale_m),
                                options, NULL);
        if ((double)left > LEVEL_WORTH * (double)count) /* of no use, however exact */
            break;
        *measured_m = left ? error_of(s, knots, left, error_m, limit_m) : INFINITY;
        if (*measured_m <= OVERSHOOT * error_m)
            break;
        asked_m /= 2; /* not by how much it erred: beyond the limit, that depends on which thread looked where */
    }
    mem_free(from);
    return left;
}

/* --- all ------------------------------------------------------------------------------------------------------------------ */

static void copy_finest(struct level *level, const struct geometry *g)
{
    *level = (struct level){ .index_count = g->index_count, .primitive_count = g->primitive_count };
    level->indices = mem_array(g->index_count, sizeof(*level->indices));
    level->primitives = mem_array(g->primitive_count, sizeof(*level->primitives));
    memcpy(level->indices, g->indices, g->index_count * sizeof(*level->indices));
    memcpy(level->primitives, g->primitives, g->primitive_count * sizeof(*level->primitives));
}

static double size_of(const struct simplifier *s)
{
    float low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    for (size_t k = 0; k < s->knot_count; k++)
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = fminf(low[axis], s->positions_m[k][axis]);
            high[axis] = fmaxf(high[axis], s->positions_m[k][axis]);
        }
    return (double)hypotf(high[0] - low[0], hypotf(high[1] - low[1], high[2] - low[2]));
}

static void make_coarse(struct simplifier *s, struct levels *levels)
{
    const struct geometry *g = s->geometry;
    uint32_t *last = mem_array(g->index_count, sizeof(*last)), *next = mem_array(g->index_count, sizeof(*next));
    size_t last_count = g->index_count;
    for (size_t i = 0; i < last_count; i++)
        last[i] = s->knot[g->indices[i]];
    deviation_init(&s->finest, (const float(*)[3])s->positions_m, last, last_count / 3);
    for (size_t e = 0; e < sizeof(errors_of_size) / sizeof(*errors_of_size) && last_count > 3 * LEAST_TRIANGLES; e++) {
        double error_m = 0;
        memcpy(next, last, last_count * sizeof(*next));
        size_t count = simplify(s, next, last_count, errors_of_size[e] * s->size_m, &error_m);
        if (count == 0 || (double)count > LEVEL_WORTH * (double)last_count || error_m > 2 * OVERSHOOT * errors_of_size[e] * s->size_m)
            continue;
        struct level *level = &levels->at[levels->count++];
        write_level(s, level, next, count);
        level->error_m = fmaxf((float)error_m, (level - 1)->error_m);
        memcpy(last, next, count * sizeof(*last));
        last_count = count;
    }
    deviation_finish(&s->finest);
    mem_free(last);
    mem_free(next);
}

bool levels_make(struct levels *levels, const struct geometry *geometry, struct workers *workers)
{
    struct simplifier s = { .geometry = geometry, .workers = workers };
    *levels = (struct levels){ .count = 1 };
    bool good = make_knots(&s) && make_parts(&s);
    if (good) {
        copy_finest(&levels->at[0], geometry);
        s.size_m = size_of(&s);
        make_coarse(&s, levels);
    }
    mem_free(s.knot);
    mem_free(s.positions_m);
    mem_free(s.primitive);
    mem_free(s.first);
    mem_free(s.vertices);
    mem_free(s.used);
    mem_free(s.part);
    mem_free(s.part_size_m);
    return good;
}

void levels_finish(struct levels *levels)
{
    for (size_t i = 0; i < levels->count; i++) {
        mem_free(levels->at[i].indices);
        mem_free(levels->at[i].primitives);
    }
    *levels = (struct levels){ 0 };
}
