/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads RVM files in two passes. The first converts chunks to primitives. After that it is known which faces are covered, and
 * the second pass converts primitives to triangles. */
#include "preprocess/import/rvm.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "preprocess/import/encoding.h"
#include "preprocess/import/rvm_losses.h"
#include "preprocess/import/rvm_shape.h"

enum { MAX_DEPTH = 1000, HEADER = 24 };

struct primitive {
    struct rvm_shape shape;
    int node;
    size_t byte; /* byte offset of the primitive's chunk in the file */
    /* indices of the primitive's first contour and first point in the reader's arrays; not pointers, because the arrays still grow */
    size_t first_contour, first_point;
};

struct facet_face {
    struct rvm_face flat;
    int axis[3]; /* normal of the face's plane in hundredths, as integers so that equal planes compare equal */
    double offset_m;
    size_t primitive;
    int number;
};

struct rvm_reader {
    const uint8_t *bytes;
    size_t count, at, chunk_end;
    struct cad_model *model;
    struct rvm_counts *counts;
    struct primitive *primitives;
    struct rvm_contour *contours;
    double (*points)[3];
    struct facet_face *faces;
    struct rvm_losses losses;
    size_t primitive_count, primitive_room, contour_count, contour_room, point_count, point_room, face_count, face_room;
    int stack[MAX_DEPTH], depth;
    char *encoding; /* text encoding given in the RVM file's header; NULL: none */
    char *why;
    size_t why_bytes;
};

static bool fail(struct rvm_reader *r, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
static bool fail(struct rvm_reader *r, const char *fmt, ...)
{
    char text[160];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    if (r->why[0] == 0)
        snprintf(r->why, r->why_bytes, "byte %zu: %s", r->at, text);
    return false;
}

static bool need(struct rvm_reader *r, size_t bytes)
{
    return bytes <= r->chunk_end - r->at ? true
                                         : fail(r, "the RVM file is damaged: a chunk is shorter than its content: export the model again");
}

static uint32_t peek_word(const uint8_t *at)
{
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static bool read_word(struct rvm_reader *r, uint32_t *word)
{
    if (!need(r, 4))
        return false;
    *word = peek_word(r->bytes + r->at);
    r->at += 4;
    return true;
}

static bool read_float(struct rvm_reader *r, double *out)
{
    uint32_t word;
    float value;
    if (!read_word(r, &word))
        return false;
    memcpy(&value, &word, sizeof(value));
    *out = (double)value;
    return true;
}

/* Reads a word count and that many 4-byte words of text; the text ends at the first zero byte. Returns it in the file's
 * encoding, with control characters replaced by blanks; the caller frees it with mem_free. Returns NULL on failure. */
static char *read_text(struct rvm_reader *r)
{
    uint32_t words;
    if (!read_word(r, &words))
        return NULL;
    if (words > (r->chunk_end - r->at) / 4) {
        fail(r, "the RVM file is damaged: a text of %u bytes is longer than its chunk: export the model again", words * 4U);
        return NULL;
    }
    const char *from = (const char *)r->bytes + r->at;
    size_t length = strnlen(from, words * 4UL);
    char *out = mem_array(length + 1, 1);
    memcpy(out, from, length);
    for (char *c = out; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127)
            *c = ' ';
    r->at += words * 4UL;
    return out;
}

/* --- chunks ----------------------------------------------------------------------------------------------------------------------- */

static bool read_head(struct rvm_reader *r)
{
    uint32_t version;
    if (!read_word(r, &version))
        return false;
    for (int i = 0; i < 4; i++) { /* skip the four texts in the file's header: info, note, date and user */
        char *ignored = read_text(r);
        if (!ignored)
            return false;
        mem_free(ignored);
    }
    if (version < 2)
        return true;
    mem_free(r->encoding);
    r->encoding = read_text(r);
    return r->encoding != NULL;
}

static bool read_color(struct rvm_reader *r)
{
    uint32_t kind, index;
    if (!read_word(r, &kind) || !read_word(r, &index) || !need(r, 4))
        return false;
    cad_model_add_color(r->model, index, r->bytes + r->at);
    return true;
}

static bool begin_group(struct rvm_reader *r)
{
    uint32_t version, material;
    double reference_mm; /* reference point of a group in millimetres; ignored, because primitives have absolute positions */
    char *name = read_word(r, &version) ? read_text(r) : NULL;
    bool good = name != NULL;
    for (int axis = 0; good && axis < 3; axis++)
        good = read_float(r, &reference_mm);
    good = good && read_word(r, &material);
    if (good && r->depth == MAX_DEPTH)
        good = fail(r, "the groups of the RVM file are nested more than %d deep, more than Plantcast supports", MAX_DEPTH);
    if (good) {
        int node = cad_model_add_node(r->model, r->depth > 0 ? r->stack[r->depth - 1] : -1, name);
        r->model->nodes[node].material = material;
        r->stack[r->depth++] = node;
    }
    mem_free(name);
    return good;
}

static bool read_facets(struct rvm_reader *r, struct primitive *primitive)
{
    uint32_t polygons, contours, points;
    primitive->first_contour = r->contour_count;
    primitive->first_point = r->point_count;
    if (!read_word(r, &polygons))
        return false;
    for (uint32_t p = 0; p < polygons; p++) {
        if (!read_word(r, &contours))
            return false;
        for (uint32_t c = 0; c < contours; c++) {
            if (!read_word(r, &points))
                return false;
            if (points > (r->chunk_end - r->at) / HEADER)
                return fail(r, "the RVM file is damaged: a contour of %u points is longer than its chunk: export the model again", points);
            mem_grow(&r->contours, &r->contour_room, r->contour_count + 1, sizeof(*r->contours));
            mem_grow(&r->points, &r->point_room, r->point_count + points, sizeof(*r->points));
            r->contours[r->contour_count++] = (struct rvm_contour){ r->point_count - primitive->first_point, points, c == 0 };
            for (uint32_t i = 0; i < points; i++, r->point_count++) {
                for (int axis = 0; axis < 3; axis++)
                    if (!read_float(r, &r->points[r->point_count][axis]))
                        return false;
                r->at += 12; /* ignore the vertex normal in the file: each polygon's own normal is used */
            }
        }
    }
    primitive->shape.contour_count = r->contour_count - primitive->first_contour;
    return true;
}

static bool read_primitive(struct rvm_reader *r)
{
    uint32_t version, kind;
    double box;
    struct primitive primitive = { .byte = r->at - HEADER };
    if (r->depth == 0)
        return fail(r, "the RVM file is damaged: a primitive (PRIM) is outside every group (CNTB): export the model again");
    if (!read_word(r, &version) || !read_word(r, &kind))
        return false;
    for (int i = 0; i < 12; i++)
        if (!read_float(r, &primitive.shape.to_plant[i]))
            return false;
    for (int i = 0; i < 6; i++)
        if (!read_float(r, &box))
            return false;
    primitive.node = r->stack[r->depth - 1];
    if (kind < RVM_PYRAMID || kind > RVM_FACETS) {
        r->counts->unknown_kinds++;
        rvm_losses_add(&r->losses, primitive.node, RVM_UNKNOWN_KIND, primitive.byte, "Plantcast does not know this kind of RVM primitive");
        return true;
    }
    primitive.shape.kind = (enum rvm_kind)kind;
    for (int i = 0; i < rvm_numbers[kind]; i++)
        if (!read_float(r, &primitive.shape.numbers[i]))
            return false;
    if (kind == RVM_FACETS && !read_facets(r, &primitive))
        return false;
    mem_grow(&r->primitives, &r->primitive_room, r->primitive_count + 1, sizeof(*r->primitives));
    r->primitives[r->primitive_count++] = primitive;
    r->counts->primitives++;
    return true;
}

static bool read_chunk(struct rvm_reader *r, const char *id, bool *ended)
{
    if (!strcmp(id, "HEAD"))
        return read_head(r);
    if (!strcmp(id, "COLR"))
        return read_color(r);
    if (!strcmp(id, "CNTB"))
        return begin_group(r);
    if (!strcmp(id, "CNTE")) { /* ignore an extra CNTE chunk (end of a group): files of AVEVA Marine may end with one */
        r->depth -= r->depth > 0;
        return true;
    }
    if (!strcmp(id, "PRIM"))
        return read_primitive(r);
    bool obstruction = !strcmp(id, "OBST");
    if (obstruction || !strcmp(id, "INSU"))
        rvm_losses_add(&r->losses, r->depth > 0 ? r->stack[r->depth - 1] : -1, obstruction ? RVM_OBSTRUCTION : RVM_INSULATION,
                       r->at - HEADER, NULL);
    else if (!strcmp(id, "END:"))
        *ended = true;
    else if (strcmp(id, "MODL") != 0 && r->counts->unknown_chunks++ == 0)
        snprintf(r->counts->unknown_chunk, sizeof(r->counts->unknown_chunk), "%s at byte %zu", id, r->at - HEADER);
    return true;
}

static bool chunk_id(const uint8_t *at, char id[5])
{
    for (int i = 0; i < 4; i++) {
        if (at[4 * i] || at[4 * i + 1] || at[4 * i + 2] || at[4 * i + 3] < 32 || at[4 * i + 3] > 126)
            return false;
        id[i] = (char)at[4 * i + 3];
    }
    id[4] = 0;
    return true;
}

/* Returns whether the bytes begin like an RVM file. */
static bool is_rvm(const void *bytes, size_t count)
{
    char id[5];
    return count >= HEADER && chunk_id(bytes, id) && !strcmp(id, "HEAD");
}

static bool read_chunks(struct rvm_reader *r)
{
    for (bool ended = false; !ended && r->at < r->count;) {
        char id[5];
        size_t from = r->at;
        if (r->count - from < 16 || !chunk_id(r->bytes + from, id))
            return fail(r, "the RVM file is damaged: expected the header of a chunk: export the model again");
        /* stops at the chunk END: without reading the rest of the chunk's header, because some files omit header fields there */
        if (!strcmp(id, "END:"))
            return true;
        if (r->count - from < HEADER)
            return fail(r, "the RVM file is truncated: it ends within chunk %s: export the model again", id);
        uint32_t next = peek_word(r->bytes + from + 16);
        if (next > r->count)
            return fail(
                r, "the RVM file is truncated: chunk %s should extend to byte %u, but the file has only %zu bytes: export the model again",
                id, next, r->count);
        if (next < from + HEADER)
            return fail(r, "the RVM file is damaged: chunk %s ends before its start, at byte %u: export the model again", id, next);
        r->at = from + HEADER;
        r->chunk_end = next;
        if (!read_chunk(r, id, &ended))
            return false;
        r->at = next;
    }
    r->counts->no_end = true;
    return true;
}

/* Decodes the names of all nodes together, because a short name alone has too few letters for its encoding to be detected. */
static void decode_names(struct rvm_reader *r, size_t first, const char *asked)
{
    struct text all = { 0 };
    struct charset_choice *choice = &r->counts->encoding;
    for (size_t i = first; i < r->model->node_count; i++)
        text_add(&all, "%s\n", r->model->nodes[i].name);
    *choice = encoding_choose(all.at ? all.at : "", all.length, asked, r->encoding ? r->encoding : "");
    for (size_t i = first; i < r->model->node_count && !choice->ascii; i++) {
        char *name = r->model->nodes[i].name;
        r->model->nodes[i].name = charset_convert(name, strlen(name), choice->name, NULL);
        mem_free(name);
    }
    text_finish(&all);
}

/* --- finding faces covered by a face of a neighbouring primitive ---------------------------------------------------------------------- */

static const double near_m = 0.001;

/* Compares flat faces by plane: first by normal, then by distance from the origin. Sorting makes faces in the same plane neighbours. */
static int by_plane(const void *a, const void *b)
{
    const struct facet_face *x = a, *y = b;
    for (int axis = 0; axis < 3; axis++)
        if (x->axis[axis] != y->axis[axis])
            return x->axis[axis] < y->axis[axis] ? -1 : 1;
    return (x->offset_m > y->offset_m) - (x->offset_m < y->offset_m);
}

static bool contains(const struct rvm_face *face, const double point[3])
{
    double d[3];
    vec_sub(point, face->centre_m, d);
    if (face->radius_m > 0)
        return vec_length(d) <= face->radius_m + near_m / 10;
    return fabs(vec_dot(d, face->directions[0])) <= face->half_m[0] + near_m / 10 &&
           fabs(vec_dot(d, face->directions[1])) <= face->half_m[1] + near_m / 10;
}

/* Returns whether `cover` hides `face`: they lie in the same plane with opposite normals, and all of `face` is within `cover`. */
static bool covers(const struct rvm_face *cover, const struct rvm_face *face)
{
    double d[3];
    vec_sub(face->centre_m, cover->centre_m, d);
    if (vec_dot(cover->outward, face->outward) > -0.9999 || fabs(vec_dot(d, cover->outward)) > near_m)
        return false;
    if (face->radius_m > 0 && cover->radius_m > 0)
        return vec_length(d) + face->radius_m <= cover->radius_m + near_m;
    if (face->radius_m > 0)
        return fabs(vec_dot(d, cover->directions[0])) + face->radius_m <= cover->half_m[0] + near_m &&
               fabs(vec_dot(d, cover->directions[1])) + face->radius_m <= cover->half_m[1] + near_m;
    for (int corner = 0; corner < 4; corner++) {
        double at[3];
        for (int axis = 0; axis < 3; axis++)
            at[axis] = face->centre_m[axis] + (corner & 1 ? 1 : -1) * face->half_m[0] * face->directions[0][axis] +
                       (corner & 2 ? 1 : -1) * face->half_m[1] * face->directions[1][axis];
        if (!contains(cover, at))
            return false;
    }
    return true;
}

static void add_faces(struct rvm_reader *r, size_t primitive)
{
    struct rvm_face found[RVM_MAX_FACES];
    int count = rvm_shape_faces(&r->primitives[primitive].shape, found);
    for (int i = 0; i < count; i++) {
        const double *n = found[i].outward;
        double first = fabs(n[0]) > 1e-3 ? n[0] : fabs(n[1]) > 1e-3 ? n[1] : n[2], sign = first < 0 ? -1 : 1;
        mem_grow(&r->faces, &r->face_room, r->face_count + 1, sizeof(*r->faces));
        struct facet_face *face = &r->faces[r->face_count++];
        *face =
            (struct facet_face){ .flat = found[i], .primitive = primitive, .number = i, .offset_m = sign * vec_dot(n, found[i].centre_m) };
        for (int axis = 0; axis < 3; axis++)
            face->axis[axis] = (int)lround(sign * n[axis] * 100);
    }
}

/* Marks faces covered by a face of another primitive: they lie inside the solid, where neither light nor heat reaches. Misses
 * coincident faces whose normals round to different hundredths; both faces then stay in the model, which is harmless. */
static void leave_out_covered_faces(struct rvm_reader *r)
{
    for (size_t p = 0; p < r->primitive_count; p++)
        add_faces(r, p);
    if (r->face_count > 0)
        qsort(r->faces, r->face_count, sizeof(*r->faces), by_plane);
    for (size_t i = 0; i < r->face_count; i++)
        for (size_t k = i + 1; k < r->face_count && !memcmp(r->faces[i].axis, r->faces[k].axis, sizeof(r->faces[i].axis)) &&
                               r->faces[k].offset_m - r->faces[i].offset_m <= near_m;
             k++)
            for (int way = 0; way < 2; way++) {
                const struct facet_face *face = &r->faces[way ? k : i], *cover = &r->faces[way ? i : k];
                uint32_t bit = 1U << face->number, *open = &r->primitives[face->primitive].shape.open_faces;
                if (!(*open & bit) && face->primitive != cover->primitive && covers(&cover->flat, &face->flat)) {
                    *open |= bit;
                    r->counts->covered_faces++;
                    r->counts->covered_m2 += face->flat.radius_m > 0 ? M_PI * face->flat.radius_m * face->flat.radius_m
                                                                     : 4 * face->flat.half_m[0] * face->flat.half_m[1];
                }
            }
}

static void tessellate(struct rvm_reader *r, const struct rvm_params *params)
{
    size_t *primitives = mem_array(r->model->node_count + 1, sizeof(*primitives)); /* by node: number of its primitives */
    for (size_t i = 0; i < r->losses.count; i++)
        if (r->losses.at[i].why)
            primitives[r->losses.at[i].node]++;
    for (size_t i = 0; i < r->primitive_count; i++) {
        const struct primitive *from = &r->primitives[i];
        const char *why = rvm_shape_tessellate(&from->shape, params->chord_m, &r->model->nodes[from->node]);
        primitives[from->node]++;
        r->counts->empty += why != NULL;
        if (why)
            rvm_losses_add(&r->losses, from->node, (int)from->shape.kind, from->byte, why);
    }
    if (params->findings)
        rvm_losses_say(&r->losses, r->model, primitives, params->findings);
    mem_free(primitives);
}

bool rvm_read(struct cad_model *model, const void *bytes, size_t count, const struct rvm_params *params, struct rvm_counts *counts,
              char *why, size_t why_bytes)
{
    struct rvm_reader *r = mem_new(sizeof(*r));
    size_t first = model->node_count;
    *r = (struct rvm_reader){ .bytes = bytes, .count = count, .model = model, .counts = counts, .why = why, .why_bytes = why_bytes };
    *counts = (struct rvm_counts){ 0 };
    why[0] = 0;
    bool good = is_rvm(bytes, count) ? read_chunks(r) : fail(r, "not an RVM file: the file does not begin with HEAD");
    decode_names(r, first, params->encoding);
    for (size_t i = 0; i < r->primitive_count; i++)
        if (r->primitives[i].shape.contour_count > 0) {
            r->primitives[i].shape.contours = r->contours + r->primitives[i].first_contour;
            /* If no primitive of the file has points, r->points is NULL. All contours are then empty, and the pointers stay
               NULL. */
            if (r->points)
                r->primitives[i].shape.points = (const double(*)[3])(r->points + r->primitives[i].first_point);
        }
    if (!params->keep_covered)
        leave_out_covered_faces(r);
    if (good)
        tessellate(r, params);
    rvm_losses_finish(&r->losses);
    mem_free(r->encoding);
    mem_free(r->primitives);
    mem_free(r->contours);
    mem_free(r->points);
    mem_free(r->faces);
    mem_free(r);
    return good;
}
