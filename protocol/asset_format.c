/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks the bytes of an asset file and makes a struct asset_view, which has pointers to the file's sections. */
#include "protocol/asset_format.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/asset_format_impl.h"
#include "protocol/distance_code.h"
#include "protocol/distance_pack.h"

#define WHY_BYTES 200
#define TEXTURE_MAX_PX 16384u

static const char *const section_names[ASSET_SECTION_COUNT] = {
    "positions", "normals",   "texcoords", "second texcoords", "colors",  "indices",  "primitives", "levels",
    "clusters",  "materials", "textures",  "texels",           "sensors", "geodesic", "names",
};

struct format_check {
    struct asset_view view;
    const char *bytes;
    size_t size;
    char *why;
};

static bool wrong(struct format_check *c, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
static bool wrong(struct format_check *c, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(c->why, WHY_BYTES, fmt, ap);
    va_end(ap);
    return false;
}

static bool finite_all(const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return false;
    return true;
}

static bool header_good(struct format_check *c, bool fresh)
{
    const struct asset_header *h = (const struct asset_header *)c->bytes;
    if ((uintptr_t)c->bytes % ASSET_ALIGN != 0)
        return wrong(c, "cannot read an asset file from plantcast-prep: its bytes in memory are not aligned to %u bytes", ASSET_ALIGN);
    if (c->size < sizeof(h->magic) || memcmp(h->magic, ASSET_MAGIC, sizeof(h->magic)) != 0)
        return wrong(c, "not an asset file from plantcast-prep: the file does not begin with %s", ASSET_MAGIC);
    if (c->size < sizeof(*h))
        return wrong(c, "damaged asset file from plantcast-prep: truncated to %zu bytes, but the header alone has %zu", c->size,
                     sizeof(*h));
    if (h->version != ASSET_VERSION)
        return wrong(c, "the asset file from plantcast-prep has format version %u, but this program reads version %u", h->version,
                     ASSET_VERSION);
    if (h->header_bytes != sizeof(*h))
        return wrong(c, "damaged asset file from plantcast-prep: the header has %u bytes, expected %zu", h->header_bytes, sizeof(*h));
    if (h->file_bytes != c->size)
        return wrong(c, "damaged asset file from plantcast-prep: %s: the file has %zu bytes, but its header says %llu",
                     h->file_bytes > c->size ? "truncated" : "too long", c->size, (unsigned long long)h->file_bytes);
    uint64_t sum = fresh ? h->checksum : asset_checksum(c->bytes, c->size);
    if (sum != h->checksum)
        return wrong(c, "damaged asset file from plantcast-prep: its checksum is %016llx, but its header says %016llx",
                     (unsigned long long)sum, (unsigned long long)h->checksum);
    c->view.header = h;
    return true;
}

static bool counts_good(struct format_check *c)
{
    const struct asset_header *h = c->view.header;
    if (h->vertex_count < 3 || h->index_count < 3 || h->primitive_count < 1 || h->level_count < 1 || h->material_count < 1)
        return wrong(c,
                     "damaged asset file from plantcast-prep: it has nothing to draw: %u vertices, %u indices, %u primitives, %u levels, "
                     "%u materials",
                     h->vertex_count, h->index_count, h->primitive_count, h->level_count, h->material_count);
    if (h->index_count % 3 != 0)
        return wrong(c, "damaged asset file from plantcast-prep: the number of indices, %u, is not a multiple of 3", h->index_count);
    for (int axis = 0; axis < 3; axis++)
        if (!isfinite(h->origin_m[axis]))
            return wrong(c, "damaged asset file from plantcast-prep: a coordinate of the asset's origin is infinite or not a number");
    return true;
}

/* Returns the number of blocks of vertices into which the file divides the distances. */
static size_t block_count(const struct asset_header *h)
{
    return (h->vertex_count + ASSET_DISTANCE_BLOCK - 1) / ASSET_DISTANCE_BLOCK;
}

/* Returns whether a section contains packed distances (distance_pack.h) that can be unpacked. */
static bool packed_good(const struct format_check *c, const struct asset_section_entry *s)
{
    const struct asset_header *h = c->view.header;
    const size_t blocks = block_count(h), table = (blocks + 1) * sizeof(uint64_t);
    const uint64_t *offsets = (const uint64_t *)(const void *)(c->bytes + s->offset);
    if (h->sensor_count < DISTANCE_PACK_MIN_SENSORS || s->bytes < table || offsets[0] < table || offsets[blocks] != s->bytes)
        return false;
    for (size_t b = 0; b < blocks; b++)
        if (offsets[b] > offsets[b + 1] || offsets[b + 1] > s->bytes ||
            !distance_pack_good((const uint8_t *)offsets + offsets[b], offsets[b + 1] - offsets[b], h->sensor_count))
            return false;
    return true;
}

static bool sections_good(struct format_check *c)
{
    const struct asset_header *h = c->view.header;
    uint64_t end = sizeof(*h);
    for (int i = 0; i < ASSET_SECTION_COUNT; i++) {
        const struct asset_section_entry *s = &h->sections[i];
        bool optional;
        uint64_t need = asset_section_bytes(h, i, &optional);
        if (s->offset % ASSET_ALIGN != 0 || s->offset < end || s->offset > c->size || s->bytes > c->size - s->offset)
            return wrong(c,
                         "damaged asset file from plantcast-prep: section `%s`: bytes %llu..%llu+%llu lie outside the file or overlap "
                         "another section",
                         section_names[i], (unsigned long long)s->offset, (unsigned long long)s->offset, (unsigned long long)s->bytes);
        if (i == ASSET_GEODESIC && s->bytes != need && packed_good(c, s))
            need = s->bytes;
        if (need != UINT64_MAX && s->bytes != need && !(optional && s->bytes == 0))
            return wrong(c, "damaged asset file from plantcast-prep: section `%s` has %llu bytes, expected %llu", section_names[i],
                         (unsigned long long)s->bytes, (unsigned long long)need);
        end = s->offset + s->bytes;
    }
    return true;
}

static const void *section(const struct format_check *c, enum asset_section which)
{
    const struct asset_section_entry *s = &c->view.header->sections[which];
    return s->bytes ? c->bytes + s->offset : NULL;
}

static void view_point(struct format_check *c)
{
    struct asset_view *v = &c->view;
    v->positions_m = section(c, ASSET_POSITIONS);
    v->normals = section(c, ASSET_NORMALS);
    v->texcoords = section(c, ASSET_TEXCOORDS);
    v->second_texcoords = section(c, ASSET_SECOND_TEXCOORDS);
    v->colors = section(c, ASSET_COLORS);
    v->indices = section(c, ASSET_INDICES);
    v->primitives = section(c, ASSET_PRIMITIVES);
    v->levels = section(c, ASSET_LEVELS);
    v->clusters = section(c, ASSET_CLUSTERS);
    v->materials = section(c, ASSET_MATERIALS);
    v->textures = section(c, ASSET_TEXTURES);
    v->texels = section(c, ASSET_TEXELS);
    v->sensors = section(c, ASSET_SENSORS);
    bool optional, plain = v->header->sections[ASSET_GEODESIC].bytes == asset_section_bytes(v->header, ASSET_GEODESIC, &optional);
    v->geodesic = plain ? section(c, ASSET_GEODESIC) : NULL;
    v->packed = plain ? NULL : section(c, ASSET_GEODESIC);
    v->names = section(c, ASSET_NAMES);
}

static bool names_good(struct format_check *c)
{
    uint64_t bytes = c->view.header->sections[ASSET_NAMES].bytes;
    if (bytes == 0 || c->view.names[bytes - 1] != 0)
        return wrong(c, "damaged asset file from plantcast-prep: section `names`: the last name does not end with a 0 byte");
    return true;
}

static bool name_good(const struct format_check *c, uint32_t name)
{
    return name < c->view.header->sections[ASSET_NAMES].bytes;
}

static bool vertices_good(struct format_check *c)
{
    const struct asset_view *v = &c->view;
    const struct asset_header *h = v->header;
    if (!finite_all(h->bounds_min_m, 3) || !finite_all(h->bounds_max_m, 3))
        return wrong(c, "damaged asset file from plantcast-prep: the asset's bounding box is infinite or has invalid numbers");
    for (uint32_t i = 0; i < h->vertex_count; i++) {
        for (int axis = 0; axis < 3; axis++) {
            float x = v->positions_m[i][axis];
            if (!isfinite(x))
                return wrong(c, "damaged asset file from plantcast-prep: vertex %u: the position is infinite or not a number", i);
            if (x < h->bounds_min_m[axis] || x > h->bounds_max_m[axis])
                return wrong(
                    c, "damaged asset file from plantcast-prep: vertex %u: coordinate %g m lies outside the asset's bounding box, %g..%g m",
                    i, (double)x, (double)h->bounds_min_m[axis], (double)h->bounds_max_m[axis]);
        }
        const float *n = v->normals[i];
        float length2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        if (!(length2 > 0.98f && length2 < 1.02f))
            return wrong(c, "damaged asset file from plantcast-prep: vertex %u: the normal has length %g, expected 1", i,
                         sqrt((double)length2));
        if ((v->texcoords && !finite_all(v->texcoords[i], 2)) || (v->second_texcoords && !finite_all(v->second_texcoords[i], 2)))
            return wrong(c, "damaged asset file from plantcast-prep: vertex %u: a texture coordinate is infinite or not a number", i);
    }
    return true;
}

static bool primitive_good(struct format_check *c, uint32_t number, uint32_t vertex_limit)
{
    const struct asset_view *v = &c->view;
    const struct asset_primitive *p = &v->primitives[number];
    if (p->index_count % 3 != 0 || p->first_index > v->header->index_count || p->index_count > v->header->index_count - p->first_index)
        return wrong(c,
                     "damaged asset file from plantcast-prep: primitive %u: starts at index %u and has %u indices, but the file has only "
                     "%u, or the number is not a multiple of 3",
                     number, p->first_index, p->index_count, v->header->index_count);
    if (p->material >= v->header->material_count)
        return wrong(c, "damaged asset file from plantcast-prep: primitive %u: refers to material %u, but there are only %u materials",
                     number, p->material, v->header->material_count);
    if (!name_good(c, p->name))
        return wrong(c, "damaged asset file from plantcast-prep: primitive %u: its name at byte %u lies outside the section `names`",
                     number, p->name);
    for (uint32_t i = p->first_index; i < p->first_index + p->index_count; i++)
        if (v->indices[i] >= vertex_limit)
            return wrong(
                c, "damaged asset file from plantcast-prep: primitive %u: index %u refers to vertex %u, but there are only %u vertices",
                number, i, v->indices[i], vertex_limit);
    return true;
}

static bool levels_good(struct format_check *c)
{
    const struct asset_view *v = &c->view;
    const struct asset_header *h = v->header;
    uint32_t next = 0, vertices = h->vertex_count;
    float error_m = 0;
    for (uint32_t i = 0; i < h->level_count; i++) {
        const struct asset_level *l = &v->levels[i];
        if (l->first_primitive != next || l->primitive_count == 0 || l->primitive_count > h->primitive_count - next)
            return wrong(c,
                         "damaged asset file from plantcast-prep: level of detail %u starts at primitive %u and has %u primitives, "
                         "expected a start at primitive %u of %u",
                         i, l->first_primitive, l->primitive_count, next, h->primitive_count);
        if (l->vertex_count > vertices || (i == 0 && l->vertex_count != vertices))
            return wrong(c, "damaged asset file from plantcast-prep: level of detail %u uses the first %u vertices, expected %s%u", i,
                         l->vertex_count, i ? "at most " : "", vertices);
        uint32_t coarser = i + 1 < h->level_count ? v->levels[i + 1].vertex_count : 0;
        if (coarser <= l->vertex_count && l->added_count > l->vertex_count - coarser)
            return wrong(
                c, "damaged asset file from plantcast-prep: level of detail %u adds %u vertices, but only %u vertices belong to this level",
                i, l->added_count, l->vertex_count - coarser);
        if (!isfinite(l->error_m) || l->error_m < error_m || (i == 0 && l->error_m != 0))
            return wrong(c, "damaged asset file from plantcast-prep: level of detail %u deviates from the model by %g m, expected %s%g m",
                         i, (double)l->error_m, i ? "at least " : "", (double)error_m);
        for (uint32_t p = 0; p < l->primitive_count; p++)
            if (!primitive_good(c, next + p, l->vertex_count))
                return false;
        next += l->primitive_count;
        vertices = l->vertex_count;
        error_m = l->error_m;
    }
    if (next != h->primitive_count)
        return wrong(c, "damaged asset file from plantcast-prep: only %u of %u primitives belong to a level of detail", next,
                     h->primitive_count);
    return true;
}

/* Checks a cluster's bounding box and normal cone. If a box or cone were too small, a visible cluster might not be drawn. */
static bool cluster_good(struct format_check *c, uint32_t number)
{
    const struct asset_view *v = &c->view;
    const struct asset_cluster *cluster = &v->clusters[number];
    const float *axis = cluster->cone_axis, cutoff = cluster->cone_cutoff;
    if (!finite_all(cluster->low_m, 6) || !finite_all(axis, 3) || !(cutoff >= 0 && cutoff <= 1))
        return wrong(c,
                     "damaged asset file from plantcast-prep: cluster %u of triangles: the bounding box or normal cone has invalid "
                     "numbers, or cutoff %g is outside 0..1",
                     number, (double)cutoff);
    for (uint32_t i = cluster->first_index; i < cluster->first_index + cluster->index_count; i++)
        for (int a = 0; a < 3; a++) {
            float x = v->positions_m[v->indices[i]][a];
            if (x < cluster->low_m[a] || x > cluster->high_m[a])
                return wrong(c,
                             "damaged asset file from plantcast-prep: cluster %u of triangles: the vertex of index %u, at %g m, lies "
                             "outside the cluster's bounding box, %g..%g m",
                             number, i, (double)x, (double)cluster->low_m[a], (double)cluster->high_m[a]);
        }
    if (cutoff == 1)
        return true;
    if (fabs(asset_length(axis) - 1) > 1e-3)
        return wrong(
            c, "damaged asset file from plantcast-prep: cluster %u of triangles: the axis of the normal cone has length %g, expected 1",
            number, asset_length(axis));
    double least = asset_cluster_least_dot(cluster, v->positions_m, v->indices, axis);
    if (least < sqrt(1 - (double)cutoff * (double)cutoff) - 1e-3)
        return wrong(
            c, "damaged asset file from plantcast-prep: cluster %u of triangles: a triangle's normal lies outside the normal cone (%g)",
            number, least);
    return true;
}

static bool clusters_good(struct format_check *c)
{
    const struct asset_view *v = &c->view;
    uint32_t next = 0, count = v->header->cluster_count;
    for (uint32_t p = 0; p < v->header->primitive_count; p++) {
        uint32_t at = v->primitives[p].first_index, end = at + v->primitives[p].index_count;
        for (; at < end; next++) {
            const struct asset_cluster *cluster = next < count ? &v->clusters[next] : NULL;
            if (!cluster || cluster->first_index != at || cluster->index_count == 0 || cluster->index_count % 3 != 0 ||
                cluster->index_count > end - at)
                return wrong(c,
                             "damaged asset file from plantcast-prep: cluster %u of %u has indices %u+%u, outside the expected range "
                             "%u..%u (primitive %u)",
                             next, count, cluster ? cluster->first_index : 0, cluster ? cluster->index_count : 0, at, end, p);
            if (!cluster_good(c, next))
                return false;
            at += cluster->index_count;
        }
    }
    if (next != count)
        return wrong(c, "damaged asset file from plantcast-prep: only %u of %u clusters belong to a primitive", next, count);
    return true;
}

static bool texture_good(const struct format_check *c, uint32_t texture, bool second)
{
    return texture == ASSET_NO_TEXTURE ||
           (texture < c->view.header->texture_count && (second ? c->view.second_texcoords : c->view.texcoords));
}

static bool unit_range(const float *values, int count)
{
    for (int i = 0; i < count; i++)
        if (!(values[i] >= 0 && values[i] <= 1))
            return false;
    return true;
}

static bool material_good(struct format_check *c, uint32_t number)
{
    const struct asset_material *m = &c->view.materials[number];
    const uint32_t textures[] = { m->base_color_texture, m->metallic_roughness_texture, m->normal_texture, m->occlusion_texture,
                                  m->emissive_texture };
    for (int i = 0; i < 5; i++)
        if (!texture_good(c, textures[i], m->second >> i & 1))
            return wrong(
                c,
                textures[i] < c->view.header->texture_count
                    ? "damaged asset file from plantcast-prep: material %u: the file has no coordinates for texture %u (of %u textures)"
                    : "damaged asset file from plantcast-prep: material %u: refers to texture %u, but there are only %u textures",
                number, textures[i], c->view.header->texture_count);
    if (m->second & ~ASSET_SECOND_MASK)
        return wrong(c,
                     "damaged asset file from plantcast-prep: material %u: unknown flags 0x%x for second texture coordinates (known: 0x%x)",
                     number, m->second, ASSET_SECOND_MASK);
    if (!unit_range(m->base_color, 4) || !unit_range(&m->metallic, 1) || !unit_range(&m->roughness, 1) ||
        !unit_range(&m->occlusion_strength, 1))
        return wrong(
            c, "damaged asset file from plantcast-prep: material %u: the colour, metallic, roughness or occlusion factor is outside 0..1",
            number);
    if (!isfinite(m->normal_scale) || !finite_all(m->emissive, 3) || !isfinite(m->alpha_cutoff))
        return wrong(c,
                     "damaged asset file from plantcast-prep: material %u: the normal scale, emissive colour or alpha cutoff is infinite "
                     "or not a number",
                     number);
    if (m->alpha > ASSET_ALPHA_BLEND || m->double_sided > 1 || !name_good(c, m->name))
        return wrong(
            c, "damaged asset file from plantcast-prep: material %u: alpha mode %u, double_sided %u or name at byte %u is out of range",
            number, m->alpha, m->double_sided, m->name);
    return true;
}

static bool materials_good(struct format_check *c)
{
    const struct asset_header *h = c->view.header;
    uint64_t texel_bytes = h->sections[ASSET_TEXELS].bytes;
    for (uint32_t i = 0; i < h->texture_count; i++) {
        const struct asset_texture *t = &c->view.textures[i];
        if (t->width_px < 1 || t->width_px > TEXTURE_MAX_PX || t->height_px < 1 || t->height_px > TEXTURE_MAX_PX)
            return wrong(c, "damaged asset file from plantcast-prep: texture %u has %u x %u pixels; at most %u x %u are allowed", i,
                         t->width_px, t->height_px, TEXTURE_MAX_PX, TEXTURE_MAX_PX);
        uint64_t need = 4ull * t->width_px * t->height_px;
        if (t->offset > texel_bytes || need > texel_bytes - t->offset)
            return wrong(
                c,
                "damaged asset file from plantcast-prep: texture %u: starts at byte %llu and has %llu bytes, but the section has only %llu",
                i, (unsigned long long)t->offset, (unsigned long long)need, (unsigned long long)texel_bytes);
        if (t->srgb > 1 || t->wrap_repeat > 1)
            return wrong(c, "damaged asset file from plantcast-prep: texture %u: srgb %u or wrap_repeat %u is neither 0 nor 1", i, t->srgb,
                         t->wrap_repeat);
    }
    for (uint32_t i = 0; i < h->material_count; i++)
        if (!material_good(c, i))
            return false;
    return true;
}

/* Checks the positions and indices of sensors. Their geodesic distances need no check, since every 16-bit code is a valid distance. */
static bool sensors_good(struct format_check *c)
{
    const struct asset_view *v = &c->view;
    const struct asset_header *h = v->header;
    for (uint32_t i = 0; i < h->sensor_count; i++) {
        const struct asset_sensor *s = &v->sensors[i];
        if (!finite_all(s->position_m, 3) || !finite_all(s->surface_m, 3) || !isfinite(s->surface_distance_m) || s->surface_distance_m < 0)
            return wrong(c,
                         "damaged asset file from plantcast-prep: sensor %u: its position or distance from the surface is infinite, "
                         "negative or not a number",
                         i);
        if (s->nearest_vertex >= h->vertex_count)
            return wrong(c,
                         "damaged asset file from plantcast-prep: sensor %u: its nearest vertex is %u, but the file has only %u vertices",
                         i, s->nearest_vertex, h->vertex_count);
    }
    return true;
}

static bool check_all(struct asset_view *view, const void *bytes, size_t size, bool fresh, char why[WHY_BYTES])
{
    struct format_check c = { .bytes = bytes, .size = size, .why = why };
    if (!header_good(&c, fresh) || !counts_good(&c) || !sections_good(&c))
        return false;
    view_point(&c);
    if (!names_good(&c) || !vertices_good(&c) || !levels_good(&c) || !clusters_good(&c) || !materials_good(&c) || !sensors_good(&c))
        return false;
    *view = c.view;
    return true;
}

bool asset_view_init(struct asset_view *view, const void *bytes, size_t size, char why[200])
{
    return check_all(view, bytes, size, false, why);
}

bool asset_view_fresh(struct asset_view *view, const void *bytes, size_t size, char why[200])
{
    return check_all(view, bytes, size, true, why);
}

bool asset_view_unpack(struct asset_view *view, uint16_t **codes)
{
    const size_t sensors = view->header->sensor_count, blocks = block_count(view->header);
    *codes = NULL;
    if (!view->packed)
        return true;
    *codes = malloc(asset_distance_count(sensors, view->header->vertex_count) * sizeof(**codes));
    for (size_t b = 0; *codes && b < blocks; b++)
        distance_unpack((const uint8_t *)view->packed + view->packed[b], sensors, *codes + b * sensors * ASSET_DISTANCE_BLOCK);
    view->geodesic = *codes;
    return *codes != NULL;
}
