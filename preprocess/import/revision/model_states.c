/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares a part's shape in the old and in the new model: vertex by vertex if the vertex counts are equal, otherwise by bounding boxes. */
#include "preprocess/import/revision/model_states.h"

#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "plant/models/transform.h"
#include "preprocess/geometry/rigid_fit.h"
#include "surface/mesh/bvh.h"

/* number of vertices per primitive to which a part's rigid motion is fitted; the motion is then checked on all vertices */
enum { SAMPLES = 64 };

/* --- reading ------------------------------------------------------------------------------------------------------------------ */

static bool read_state(struct model_state *state, const char *path, char why[MODEL_WHY_BYTES])
{
    struct model_source source;
    if (!model_outline_read(&state->outline, path, why, MODEL_WHY_BYTES))
        return false;
    bool good = model_source_open(&source, path, why);
    if (good) {
        good = gltf_load(&state->model, &source, why);
        model_source_finish(&source);
    }
    state->read = good;
    if (!good) {
        model_outline_finish(&state->outline);
        return false;
    }
    uint32_t at = 0;
    state->first = mem_array(state->outline.header.count + 1, sizeof(*state->first));
    for (size_t i = 0; i < state->outline.header.count; i++) {
        while (at < state->model.node_count && state->model.nodes[at].number != state->outline.header.nodes[i].number)
            at++;
        state->first[i] = at;
        at += at < state->model.node_count;
    }
    return true;
}

bool model_states_read(struct model_states *states, const char *before, const char *after, char why[MODEL_WHY_BYTES])
{
    *states = (struct model_states){ 0 };
    if (!read_state(&states->before, before, why) || !read_state(&states->after, after, why))
        return false;
    node_pairs_find(&states->pairs, &states->before.outline, &states->after.outline);
    return true;
}

static void finish_state(struct model_state *state)
{
    if (!state->read)
        return;
    model_outline_finish(&state->outline);
    gltf_free(&state->model);
    mem_free(state->first);
}

void model_states_finish(struct model_states *states)
{
    finish_state(&states->before);
    finish_state(&states->after);
    node_pairs_finish(&states->pairs);
    *states = (struct model_states){ 0 };
}

/* --- lists of parts (a part is one primitive of one instance of a node) --- */

struct state_part {
    const struct gltf_primitive *primitive;
    const double *world;
};

struct state_parts {
    struct state_part *at;
    size_t count, capacity;
};

static void add_parts(const struct model_state *state, int node, struct state_parts *out)
{
    const struct gltf_model *model = &state->model;
    uint32_t number = state->outline.header.nodes[node].number, first = state->first[node];
    for (uint32_t i = first; i < model->node_count && i < model->nodes[first].end; i++) {
        const struct gltf_node *at = &model->nodes[i];
        if (at->number != number || at->mesh < 0)
            continue;
        const struct gltf_mesh *mesh = &model->meshes[at->mesh];
        for (uint32_t k = 0; k < mesh->primitive_count; k++) {
            mem_grow(&out->at, &out->capacity, out->count + 1, sizeof(*out->at));
            out->at[out->count++] = (struct state_part){ &model->primitives[mesh->first_primitive + k], at->world };
        }
    }
}

static void vertex_of(const struct state_part *part, uint32_t vertex, double out[3])
{
    const float *at = part->primitive->positions[vertex];
    transform_point(part->world, (const double[3]){ (double)at[0], (double)at[1], (double)at[2] }, out);
}

/* Compares two lists of parts (primitives), from the indices a_first and b_first on. Returns whether they are equally long and
 * corresponding parts have equal vertex and index counts. */
static bool alike(const struct state_parts *a, size_t a_first, const struct state_parts *b, size_t b_first)
{
    bool same = a->count - a_first == b->count - b_first;
    for (size_t i = 0; same && a_first + i < a->count; i++) {
        const struct gltf_primitive *x = a->at[a_first + i].primitive, *y = b->at[b_first + i].primitive;
        same = x->vertex_count == y->vertex_count && x->index_count == y->index_count;
    }
    return same;
}

/* --- motion ------------------------------------------------------------------------------------------------------------------- */

/* Tests for a pure translation: whether all vertices of a part moved by the same vector within the tolerance. This is tested
 * before fitting a rotation, because the fit would add a small rotation to a pure translation. */
static bool find_shift(const double (*from)[3], const double (*to)[3], size_t count, double tolerance, double motion[16])
{
    double shift[3], other[3], apart[3];
    vec_sub(to[0], from[0], shift);
    for (size_t i = 1; i < count; i++) {
        vec_sub(to[i], from[i], other);
        vec_sub(other, shift, apart);
        if (vec_length(apart) > tolerance)
            return false;
    }
    memcpy(motion, transform_identity, sizeof(transform_identity));
    memcpy(motion + 12, shift, sizeof(shift));
    return true;
}

static void fit(const struct state_parts *before, const struct state_parts *after, double tolerance, double motion[16])
{
    size_t count = 0;
    double(*from)[3] = mem_array(before->count * SAMPLES, sizeof(*from)), (*to)[3] = mem_array(before->count * SAMPLES, sizeof(*to));
    for (size_t i = 0; i < before->count; i++) {
        uint32_t vertices = before->at[i].primitive->vertex_count, step = vertices / SAMPLES + 1;
        for (uint32_t v = 0; v < vertices; v += step, count++) {
            vertex_of(&before->at[i], v, from[count]);
            vertex_of(&after->at[i], v, to[count]);
        }
    }
    if (!find_shift((const double(*)[3])from, (const double(*)[3])to, count, tolerance, motion))
        rigid_fit((const double(*)[3])from, (const double(*)[3])to, count, motion);
    mem_free(from);
    mem_free(to);
}

/* Returns whether the motion maps every vertex of the old parts to its position in the new parts within the tolerance. *moved
 * receives the largest distance moved by a vertex. */
static bool takes(const double motion[16], const struct state_parts *before, const struct state_parts *after, double tolerance,
                  double *moved)
{
    *moved = 0;
    for (size_t i = 0; i < before->count; i++)
        for (uint32_t v = 0; v < before->at[i].primitive->vertex_count; v++) {
            double from[3], to[3], taken[3];
            vertex_of(&before->at[i], v, from);
            vertex_of(&after->at[i], v, to);
            transform_point(motion, from, taken);
            if (vec_distance(taken, to) > tolerance)
                return false;
            *moved = max_of(*moved, vec_distance(from, to));
        }
    return true;
}

static void box_motion(const struct model_box *before, const struct model_box *after, double tolerance, struct states_motion *out)
{
    double old_size[3], new_size[3], shift[3];
    if (!(before->low[0] <= before->high[0]) || !(after->low[0] <= after->high[0]))
        return;
    vec_sub(before->high, before->low, old_size);
    vec_sub(after->high, after->low, new_size);
    for (int axis = 0; axis < 3; axis++) {
        if (fabs(new_size[axis] - old_size[axis]) > 5 * tolerance + 0.01 * old_size[axis])
            return;
        shift[axis] = (after->low[axis] + after->high[axis] - before->low[axis] - before->high[axis]) / 2;
    }
    out->known = true;
    out->moved = vec_length(shift);
    memcpy(out->motion + 12, shift, sizeof(shift));
}

struct states_motion model_states_motion(const struct model_states *states, const bool *taken, double tolerance)
{
    struct states_motion out = { .change = STATES_CHANGED };
    struct state_parts before = { 0 }, after = { 0 };
    struct model_box old_box = model_box_empty, new_box = model_box_empty;
    memcpy(out.motion, transform_identity, sizeof(transform_identity));
    for (size_t i = 0; i < states->before.outline.header.count; i++) {
        int other = states->pairs.to_new[i];
        size_t old_first = before.count, new_first = after.count;
        if (!taken[i])
            continue;
        model_box_add(&old_box, &states->before.outline.header.boxes[i]);
        add_parts(&states->before, (int)i, &before);
        if (other >= 0) {
            model_box_add(&new_box, &states->after.outline.header.boxes[other]);
            add_parts(&states->after, other, &after);
        }
        out.parts += before.count > old_first;
        out.different += !alike(&before, old_first, &after, new_first);
    }
    if (out.different == 0 && before.count > 0) {
        fit(&before, &after, tolerance, out.motion);
        out.known = takes(out.motion, &before, &after, tolerance, &out.moved);
    }
    if (out.known) {
        out.change = out.moved > tolerance ? STATES_MOVED : STATES_SAME;
    } else {
        memcpy(out.motion, transform_identity, sizeof(transform_identity));
        box_motion(&old_box, &new_box, tolerance, &out);
    }
    mem_free(before.at);
    mem_free(after.at);
    return out;
}

/* --- the nearest part ------------------------------------------------------------------------------------------------------------- */

static double distance_to(const struct state_part *part, const double point[3], double best)
{
    const struct gltf_primitive *primitive = part->primitive;
    for (uint32_t i = 0; i + 2 < primitive->index_count; i += 3) {
        double corners[3][3], weights[3], nearest[3] = { 0 };
        for (int k = 0; k < 3; k++)
            vertex_of(part, primitive->indices[i + (uint32_t)k], corners[k]);
        if (triangle_is_farther(point, corners[0], corners[1], corners[2], best))
            continue;
        triangle_nearest(point, corners[0], corners[1], corners[2], weights);
        for (int k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++)
                nearest[axis] += weights[k] * corners[k][axis];
        best = min_of(best, vec_distance(nearest, point));
    }
    return best;
}

static double distance_to_box(const struct model_box *box, const double point[3])
{
    double d[3];
    for (int axis = 0; axis < 3; axis++)
        d[axis] = max_of(0, max_of(box->low[axis] - point[axis], point[axis] - box->high[axis]));
    return vec_length(d);
}

int model_states_nearest(const struct model_states *states, const bool *taken, const double point[3])
{
    double best = INFINITY;
    int found = -1;
    struct state_parts parts = { 0 };
    for (size_t i = 0; i < states->before.outline.header.count; i++) {
        const struct model_box *box = &states->before.outline.header.boxes[i];
        if (!taken[i] || (box->low[0] <= box->high[0] && distance_to_box(box, point) >= best))
            continue;
        parts.count = 0;
        add_parts(&states->before, (int)i, &parts);
        for (size_t k = 0; k < parts.count; k++) {
            double distance = distance_to(&parts.at[k], point, best);
            if (distance < best) {
                best = distance;
                found = (int)i;
            }
        }
    }
    mem_free(parts.at);
    return found;
}
