/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Repairs faces of thin parts that simplification has flattened to zero thickness. Such a face may only have vertices of the
 * opposite side, whose normals point away from it, so that it is lit wrongly. Its corners are moved to vertices of its own
 * side. */
#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "preprocess/levels/levels_impl.h"

/* a corner is repaired if the cosine between the face normal and the closest vertex normal in its weld (group of vertices) is
 * at most this */
#define AWAY (-0.5f)
#define ALONG 0.7f /* minimum cosine between the face normal and the normal of the vertex that the corner is moved to */
/* maximum length of a move, in multiples of the allowed error; above 1, because the thickness of a slanted sheet exceeds its error */
#define BESIDE 1.25f
#define NONE UINT32_MAX

struct corner_need { /* a face corner to repair: it needs a vertex whose normal points to the face's front */
    size_t corner;
    float normal[3]; /* normal of the corner's face */
    float score;     /* score of the best replacement so far: 2 - distance / maximum distance */
    uint32_t weld;   /* weld (group of equal vertices) of the best replacement so far; NONE: none yet */
    size_t next;     /* index in `needs` of the next corner with the same weld (group of equal vertices); SIZE_MAX: none */
};

struct facing_pass {
    const struct welds *welds;
    const char *used;
    const float *most_m;
    struct corner_need *needs;
    size_t count, capacity;
    size_t *first; /* by weld (group of equal vertices): index in `needs` of its first corner; SIZE_MAX: none */
};

void levels_normal(const struct welds *welds, const uint32_t corners[3], float n[3])
{
    double at[3][3], m[3];
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < 3; i++)
            at[c][i] = (double)welds->positions_m[corners[c]][i];
    vec_normal(at[0], at[1], at[2], m);
    double length2 = vec_dot(m, m);
    for (int i = 0; i < 3; i++)
        n[i] = length2 > 0 ? (float)(m[i] / sqrt(length2)) : 0;
}

static float cosine_of(const struct welds *welds, uint32_t vertex, const float n[3])
{
    const float *m = welds->geometry->normals[vertex];
    return vecf_dot(n, m);
}

uint32_t levels_vertex(const struct welds *welds, const char *used, uint32_t weld, const float n[3], bool one_side)
{
    uint32_t best = UINT32_MAX;
    float best_score = -INFINITY;
    for (uint32_t i = welds->first[weld]; i < welds->first[weld + 1]; i++) {
        uint32_t vertex = welds->vertices[i];
        float dot = cosine_of(welds, vertex, n), score = one_side ? dot : fabsf(dot) + 1e-3f * dot;
        if (used[vertex] && score > best_score) {
            best = vertex;
            best_score = score;
        }
    }
    return best;
}

/* Returns the cosine between the face normal n and the normal of the vertex that levels_vertex() chooses from the weld (group
 * of equal vertices); -1: no vertex of the weld is used. */
static float look(const struct facing_pass *facing, uint32_t weld, const float n[3], bool one_side)
{
    uint32_t vertex = levels_vertex(facing->welds, facing->used, weld, n, one_side);
    return vertex == UINT32_MAX ? -1 : cosine_of(facing->welds, vertex, n);
}

static float distance_m(const struct welds *welds, uint32_t a, uint32_t b)
{
    const float *p = welds->positions_m[a], *q = welds->positions_m[b];
    return hypotf(p[0] - q[0], hypotf(p[1] - q[1], p[2] - q[2]));
}

void levels_find_contrary(const struct welds *welds, char *contrary)
{
    const struct geometry *g = welds->geometry;
    for (uint32_t i = 0; i < g->index_count; i += 3) {
        float n[3];
        const uint32_t *v = g->indices + i, of[3] = { welds->of_vertex[v[0]], welds->of_vertex[v[1]], welds->of_vertex[v[2]] };
        levels_normal(welds, of, n);
        for (int c = 0; c < 3; c++)
            contrary[welds->part[of[0]]] |= cosine_of(welds, v[c], n) < 0;
    }
}

static void find_needs(struct facing_pass *facing, const uint32_t *corners, size_t count, const char *contrary)
{
    float n[3];
    for (size_t i = 0; i < count; i++) {
        uint32_t weld = corners[i];
        if (i % 3 == 0)
            levels_normal(facing->welds, corners + i, n);
        if (contrary[facing->welds->part[weld]] || look(facing, weld, n, false) > AWAY)
            continue;
        mem_grow(&facing->needs, &facing->capacity, facing->count + 1, sizeof(*facing->needs));
        facing->needs[facing->count] = (struct corner_need){ i, { n[0], n[1], n[2] }, ALONG, NONE, facing->first[weld] };
        facing->first[weld] = facing->count++;
    }
}

/* Offers weld `to` (a group of equal vertices) as a replacement to all corners in need at weld `from`. The two welds are the
 * ends of an edge of the model. Each corner takes the nearest weld that has a vertex facing its side. */
static void offer(struct facing_pass *facing, uint32_t from, uint32_t to)
{
    if (facing->first[from] == SIZE_MAX || facing->welds->primitive[from] != facing->welds->primitive[to])
        return;
    float far_m = distance_m(facing->welds, from, to), most_m = BESIDE * facing->most_m[facing->welds->part[from]];
    for (size_t i = facing->first[from]; i != SIZE_MAX && far_m <= most_m; i = facing->needs[i].next) {
        struct corner_need *need = &facing->needs[i];
        float score = 2 - far_m / most_m;
        if (score > need->score && look(facing, to, need->normal, true) >= ALONG) {
            need->score = score;
            need->weld = to;
        }
    }
}

/* Moves corners to the replacements of their welds (groups of equal vertices), except in faces that would flip or lose their area. */
static void move_faces(const struct facing_pass *facing, uint32_t *corners)
{
    for (size_t i = 0; i < facing->count;) {
        size_t at = facing->needs[i].corner / 3 * 3, end = i;
        uint32_t moved[3];
        float n[3];
        memcpy(moved, corners + at, sizeof(moved));
        for (; end < facing->count && facing->needs[end].corner < at + 3; end++)
            if (facing->needs[end].weld != NONE)
                moved[facing->needs[end].corner - at] = facing->needs[end].weld;
        levels_normal(facing->welds, moved, n);
        const float *was = facing->needs[i].normal;
        if (vecf_dot(n, was) > ALONG)
            memcpy(corners + at, moved, sizeof(moved));
        i = end;
    }
}

/* Undoes the repair of a face if no face uses the weld (group of equal vertices) of one of its old corners any more: the next
 * coarser levels may only use welds that this level uses. */
static void keep_knots(const struct facing_pass *facing, const uint32_t *before, uint32_t *corners, size_t count)
{
    char *kept = mem_array(facing->welds->count, 1);
    for (size_t i = 0; i < count; i++)
        kept[corners[i]] = 1;
    for (size_t i = 0; i < count; i += 3)
        if (!kept[before[i]] || !kept[before[i + 1]] || !kept[before[i + 2]])
            memcpy(corners + i, before + i, 3 * sizeof(*corners));
    mem_free(kept);
}

bool levels_face(const struct welds *welds, const char *used, const char *contrary, const float *most_m, uint32_t *corners, size_t count,
                 char *moved)
{
    const struct geometry *g = welds->geometry;
    struct facing_pass facing = { .welds = welds, .used = used, .most_m = most_m };
    bool any = false;
    facing.first = mem_array(welds->count, sizeof(*facing.first));
    memset(facing.first, 0xff, welds->count * sizeof(*facing.first));
    find_needs(&facing, corners, count, contrary);
    for (uint32_t i = 0; i < g->index_count && facing.count; i++) {
        uint32_t from = welds->of_vertex[g->indices[i]], to = welds->of_vertex[g->indices[i % 3 == 2 ? i - 2 : i + 1]];
        offer(&facing, from, to);
        offer(&facing, to, from);
    }
    if (facing.count) {
        uint32_t *before = mem_array(count, sizeof(*before));
        memcpy(before, corners, count * sizeof(*before));
        move_faces(&facing, corners);
        keep_knots(&facing, before, corners, count);
        for (size_t i = 0; i < count; i++)
            any |= moved[welds->part[before[i]]] |= corners[i] != before[i];
        mem_free(before);
    }
    mem_free(facing.needs);
    mem_free(facing.first);
    return any;
}
