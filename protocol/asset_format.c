/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Asset files: bytes checked into a view, and parts laid out into bytes. */
#include "protocol/asset_format.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#define XXH_STATIC_LINKING_ONLY /* the hash state on the stack */
#include <xxhash.h>

#define WHY_BYTES 200
#define TEXTURE_MAX_PX 16384u

static const char *const section_names[ASSET_SECTION_COUNT] = {
    "positions", "normals",  "texcoords", "colors",  "indices",  "primitives", "levels",
    "materials", "textures", "texels",    "sensors", "geodesic", "names",
};

static uint64_t align_up(uint64_t n)
{
    return (n + ASSET_ALIGN - 1) / ASSET_ALIGN * ASSET_ALIGN;
}

static uint64_t checksum(const void *bytes, size_t size)
{
    struct asset_header header;
    memcpy(&header, bytes, sizeof(header));
    header.checksum = 0;
    XXH3_state_t state;
    XXH3_INITSTATE(&state);
    XXH3_64bits_reset(&state);
    XXH3_64bits_update(&state, &header, sizeof(header));
    XXH3_64bits_update(&state, (const char *)bytes + sizeof(header), size - sizeof(header));
    return XXH3_64bits_digest(&state);
}

/* --- checking ------------------------------------------------------------------------------------------------------------ */

struct check {
    struct asset_view view;
    const char *bytes;
    size_t size;
    char *why;
};

static bool wrong(struct check *c, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
static bool wrong(struct check *c, const char *fmt, ...)
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

static bool header_good(struct check *c)
{
    const struct asset_header *h = (const struct asset_header *)c->bytes;
    if ((uintptr_t)c->bytes % ASSET_ALIGN != 0)
        return wrong(c, "bytes are not aligned to %u", ASSET_ALIGN);
    if (c->size < sizeof(h->magic) || memcmp(h->magic, ASSET_MAGIC, sizeof(h->magic)) != 0)
        return wrong(c, "not an asset file (magic is not %s)", ASSET_MAGIC);
    if (c->size < sizeof(*h))
        return wrong(c, "truncated: %zu bytes, the header alone has %zu", c->size, sizeof(*h));
    if (h->version != ASSET_VERSION)
        return wrong(c, "version %u, this program reads version %u", h->version, ASSET_VERSION);
    if (h->header_bytes != sizeof(*h))
        return wrong(c, "header of %u bytes, expected %zu", h->header_bytes, sizeof(*h));
    if (h->file_bytes != c->size)
        return wrong(c, "%s: %zu bytes, the header says %llu", h->file_bytes > c->size ? "truncated" : "too long", c->size,
                     (unsigned long long)h->file_bytes);
    uint64_t sum = checksum(c->bytes, c->size);
    if (sum != h->checksum)
        return wrong(c, "checksum %016llx, the header says %016llx", (unsigned long long)sum, (unsigned long long)h->checksum);
    c->view.header = h;
    return true;
}

static bool counts_good(struct check *c)
{
    const struct asset_header *h = c->view.header;
    if (h->vertex_count < 3 || h->index_count < 3 || h->primitive_count < 1 || h->level_count < 1 || h->material_count < 1)
        return wrong(c, "nothing to draw: %u vertices, %u indices, %u primitives, %u levels, %u materials", h->vertex_count, h->index_count,
                     h->primitive_count, h->level_count, h->material_count);
    if (h->index_count % 3 != 0)
        return wrong(c, "%u indices are not whole triangles", h->index_count);
    for (int axis = 0; axis < 3; axis++)
        if (!isfinite(h->origin_m[axis]))
            return wrong(c, "origin is not finite");
    return true;
}

/* Bytes that the section must have; UINT64_MAX: any number; optional ones may also be empty. */
static uint64_t section_bytes(const struct asset_header *h, int section, bool *optional)
{
    *optional = section == ASSET_TEXCOORDS || section == ASSET_COLORS;
    switch (section) {
    case ASSET_POSITIONS: return 12ull * h->vertex_count;
    case ASSET_NORMALS: return 12ull * h->vertex_count;
    case ASSET_TEXCOORDS: return 8ull * h->vertex_count;
    case ASSET_COLORS: return 4ull * h->vertex_count;
    case ASSET_INDICES: return 4ull * h->index_count;
    case ASSET_PRIMITIVES: return (uint64_t)sizeof(struct asset_primitive) * h->primitive_count;
    case ASSET_LEVELS: return (uint64_t)sizeof(struct asset_level) * h->level_count;
    case ASSET_MATERIALS: return (uint64_t)sizeof(struct asset_material) * h->material_count;
    case ASSET_TEXTURES: return (uint64_t)sizeof(struct asset_texture) * h->texture_count;
    case ASSET_SENSORS: return (uint64_t)sizeof(struct asset_sensor) * h->sensor_count;
    case ASSET_GEODESIC: return 4ull * h->sensor_count * h->vertex_count;
    default: return UINT64_MAX;
    }
}

static bool sections_good(struct check *c)
{
    const struct asset_header *h = c->view.header;
    uint64_t end = sizeof(*h);
    for (int i = 0; i < ASSET_SECTION_COUNT; i++) {
        const struct asset_section_entry *s = &h->sections[i];
        bool optional;
        uint64_t need = section_bytes(h, i, &optional);
        if (s->offset % ASSET_ALIGN != 0 || s->offset < end || s->offset > c->size || s->bytes > c->size - s->offset)
            return wrong(c, "section %s: bytes %llu..%llu+%llu lie outside the file or over another section", section_names[i],
                         (unsigned long long)s->offset, (unsigned long long)s->offset, (unsigned long long)s->bytes);
        if (need != UINT64_MAX && s->bytes != need && !(optional && s->bytes == 0))
            return wrong(c, "section %s: %llu bytes, expected %llu", section_names[i], (unsigned long long)s->bytes,
                         (unsigned long long)need);
        end = s->offset + s->bytes;
    }
    return true;
}

static const void *section(const struct check *c, enum asset_section which)
{
    const struct asset_section_entry *s = &c->view.header->sections[which];
    return s->bytes ? c->bytes + s->offset : NULL;
}

static void view_point(struct check *c)
{
    struct asset_view *v = &c->view;
    v->positions_m = section(c, ASSET_POSITIONS);
    v->normals = section(c, ASSET_NORMALS);
    v->texcoords = section(c, ASSET_TEXCOORDS);
    v->colors = section(c, ASSET_COLORS);
    v->indices = section(c, ASSET_INDICES);
    v->primitives = section(c, ASSET_PRIMITIVES);
    v->levels = section(c, ASSET_LEVELS);
    v->materials = section(c, ASSET_MATERIALS);
    v->textures = section(c, ASSET_TEXTURES);
    v->texels = section(c, ASSET_TEXELS);
    v->sensors = section(c, ASSET_SENSORS);
    v->geodesic_m = section(c, ASSET_GEODESIC);
    v->names = section(c, ASSET_NAMES);
}

static bool names_good(struct check *c)
{
    uint64_t bytes = c->view.header->sections[ASSET_NAMES].bytes;
    if (bytes == 0 || c->view.names[bytes - 1] != 0)
        return wrong(c, "section names: the last name has no end");
    return true;
}

static bool name_good(const struct check *c, uint32_t name)
{
    return name < c->view.header->sections[ASSET_NAMES].bytes;
}

static bool vertices_good(struct check *c)
{
    const struct asset_view *v = &c->view;
    const struct asset_header *h = v->header;
    if (!finite_all(h->bounds_min_m, 3) || !finite_all(h->bounds_max_m, 3))
        return wrong(c, "bounds are not finite");
    for (uint32_t i = 0; i < h->vertex_count; i++) {
        for (int axis = 0; axis < 3; axis++) {
            float x = v->positions_m[i][axis];
            if (!isfinite(x))
                return wrong(c, "vertex %u: position is not finite", i);
            if (x < h->bounds_min_m[axis] || x > h->bounds_max_m[axis])
                return wrong(c, "vertex %u: position %g m lies outside the bounds %g..%g m", i, (double)x, (double)h->bounds_min_m[axis],
                             (double)h->bounds_max_m[axis]);
        }
        const float *n = v->normals[i];
        float length2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        if (!(length2 > 0.98f && length2 < 1.02f))
            return wrong(c, "vertex %u: normal of length %g", i, sqrt((double)length2));
        if (v->texcoords && !finite_all(v->texcoords[i], 2))
            return wrong(c, "vertex %u: texture coordinate is not finite", i);
    }
    return true;
}

static bool primitive_good(struct check *c, uint32_t number, uint32_t vertex_limit)
{
    const struct asset_view *v = &c->view;
    const struct asset_primitive *p = &v->primitives[number];
    if (p->index_count % 3 != 0 || p->first_index > v->header->index_count || p->index_count > v->header->index_count - p->first_index)
        return wrong(c, "primitive %u: indices %u+%u of %u", number, p->first_index, p->index_count, v->header->index_count);
    if (p->material >= v->header->material_count)
        return wrong(c, "primitive %u: material %u of %u", number, p->material, v->header->material_count);
    if (!name_good(c, p->name))
        return wrong(c, "primitive %u: name at %u lies outside the names", number, p->name);
    for (uint32_t i = p->first_index; i < p->first_index + p->index_count; i++)
        if (v->indices[i] >= vertex_limit)
            return wrong(c, "primitive %u: index %u names vertex %u of %u", number, i, v->indices[i], vertex_limit);
    return true;
}

static bool levels_good(struct check *c)
{
    const struct asset_view *v = &c->view;
    const struct asset_header *h = v->header;
    uint32_t next = 0, vertices = h->vertex_count;
    float error_m = 0;
    for (uint32_t i = 0; i < h->level_count; i++) {
        const struct asset_level *l = &v->levels[i];
        if (l->first_primitive != next || l->primitive_count == 0 || l->primitive_count > h->primitive_count - next)
            return wrong(c, "level %u: primitives %u+%u, expected them to begin at %u of %u", i, l->first_primitive, l->primitive_count,
                         next, h->primitive_count);
        if (l->vertex_count > vertices || (i == 0 && l->vertex_count != vertices))
            return wrong(c, "level %u: the first %u vertices, expected %s%u", i, l->vertex_count, i ? "at most " : "", vertices);
        uint32_t coarser = i + 1 < h->level_count ? v->levels[i + 1].vertex_count : 0;
        if (coarser <= l->vertex_count && l->added_count > l->vertex_count - coarser)
            return wrong(c, "level %u: %u of its %u vertices are added", i, l->added_count, l->vertex_count - coarser);
        if (!isfinite(l->error_m) || l->error_m < error_m || (i == 0 && l->error_m != 0))
            return wrong(c, "level %u: error of %g m after %g m", i, (double)l->error_m, (double)error_m);
        for (uint32_t p = 0; p < l->primitive_count; p++)
            if (!primitive_good(c, next + p, l->vertex_count))
                return false;
        next += l->primitive_count;
        vertices = l->vertex_count;
        error_m = l->error_m;
    }
    if (next != h->primitive_count)
        return wrong(c, "the levels hold %u primitives of %u", next, h->primitive_count);
    return true;
}

static bool texture_good(const struct check *c, uint32_t texture)
{
    return texture == ASSET_NO_TEXTURE || (texture < c->view.header->texture_count && c->view.texcoords);
}

static bool unit_range(const float *values, int count)
{
    for (int i = 0; i < count; i++)
        if (!(values[i] >= 0 && values[i] <= 1))
            return false;
    return true;
}

static bool material_good(struct check *c, uint32_t number)
{
    const struct asset_material *m = &c->view.materials[number];
    const uint32_t textures[] = { m->base_color_texture, m->metallic_roughness_texture, m->normal_texture, m->occlusion_texture,
                                  m->emissive_texture };
    for (int i = 0; i < 5; i++)
        if (!texture_good(c, textures[i]))
            return wrong(c, "material %u: texture %u of %u%s", number, textures[i], c->view.header->texture_count,
                         c->view.texcoords ? "" : ", without coordinates");
    if (!unit_range(m->base_color, 4) || !unit_range(&m->metallic, 1) || !unit_range(&m->roughness, 1) ||
        !unit_range(&m->occlusion_strength, 1))
        return wrong(c, "material %u: a factor lies outside 0..1", number);
    if (!isfinite(m->normal_scale) || !finite_all(m->emissive, 3) || !isfinite(m->alpha_cutoff))
        return wrong(c, "material %u: a factor is not finite", number);
    if (m->alpha > ASSET_ALPHA_BLEND || m->double_sided > 1 || !name_good(c, m->name))
        return wrong(c, "material %u: alpha mode %u, double_sided %u or name at %u out of range", number, m->alpha, m->double_sided,
                     m->name);
    return true;
}

static bool materials_good(struct check *c)
{
    const struct asset_header *h = c->view.header;
    uint64_t texel_bytes = h->sections[ASSET_TEXELS].bytes;
    for (uint32_t i = 0; i < h->texture_count; i++) {
        const struct asset_texture *t = &c->view.textures[i];
        if (t->width_px < 1 || t->width_px > TEXTURE_MAX_PX || t->height_px < 1 || t->height_px > TEXTURE_MAX_PX)
            return wrong(c, "texture %u: %u x %u pixels, at most %u x %u", i, t->width_px, t->height_px, TEXTURE_MAX_PX, TEXTURE_MAX_PX);
        uint64_t need = 4ull * t->width_px * t->height_px;
        if (t->offset > texel_bytes || need > texel_bytes - t->offset)
            return wrong(c, "texture %u: bytes %llu+%llu of %llu", i, (unsigned long long)t->offset, (unsigned long long)need,
                         (unsigned long long)texel_bytes);
        if (t->srgb > 1 || t->wrap_repeat > 1)
            return wrong(c, "texture %u: srgb %u or wrap_repeat %u is neither 0 nor 1", i, t->srgb, t->wrap_repeat);
    }
    for (uint32_t i = 0; i < h->material_count; i++)
        if (!material_good(c, i))
            return false;
    return true;
}

static bool sensors_good(struct check *c)
{
    const struct asset_view *v = &c->view;
    const struct asset_header *h = v->header;
    for (uint32_t i = 0; i < h->sensor_count; i++) {
        const struct asset_sensor *s = &v->sensors[i];
        if (!finite_all(s->position_m, 3) || !finite_all(s->surface_m, 3) || !isfinite(s->surface_distance_m) || s->surface_distance_m < 0)
            return wrong(c, "sensor %u: place is not finite", i);
        if (s->nearest_vertex >= h->vertex_count)
            return wrong(c, "sensor %u: nearest vertex %u of %u", i, s->nearest_vertex, h->vertex_count);
        const float *distances = v->geodesic_m + (size_t)i * h->vertex_count;
        for (uint32_t j = 0; j < h->vertex_count; j++)
            if (!(distances[j] >= 0))
                return wrong(c, "sensor %u: distance %g m at vertex %u", i, (double)distances[j], j);
    }
    return true;
}

bool asset_view_init(struct asset_view *view, const void *bytes, size_t size, char why[200])
{
    struct check c = { .bytes = bytes, .size = size, .why = why };
    if (!header_good(&c) || !counts_good(&c) || !sections_good(&c))
        return false;
    view_point(&c);
    if (!names_good(&c) || !vertices_good(&c) || !levels_good(&c) || !materials_good(&c) || !sensors_good(&c))
        return false;
    *view = c.view;
    return true;
}

/* --- building ------------------------------------------------------------------------------------------------------------ */

static void bounds_of(const struct asset_parts *parts, struct asset_header *h)
{
    for (int axis = 0; axis < 3; axis++) {
        h->bounds_min_m[axis] = parts->vertex_count ? FLT_MAX : 0;
        h->bounds_max_m[axis] = parts->vertex_count ? -FLT_MAX : 0;
    }
    for (uint32_t i = 0; i < parts->vertex_count; i++)
        for (int axis = 0; axis < 3; axis++) {
            float x = parts->positions_m[i][axis];
            h->bounds_min_m[axis] = x < h->bounds_min_m[axis] ? x : h->bounds_min_m[axis];
            h->bounds_max_m[axis] = x > h->bounds_max_m[axis] ? x : h->bounds_max_m[axis];
        }
}

void *asset_build(const struct asset_parts *parts, size_t *out_bytes)
{
    const struct asset_level all = { .primitive_count = parts->primitive_count, .vertex_count = parts->vertex_count };
    struct asset_header h = {
        .version = ASSET_VERSION,
        .header_bytes = sizeof(h),
        .key = parts->key,
        .vertex_count = parts->vertex_count,
        .index_count = parts->index_count,
        .primitive_count = parts->primitive_count,
        .level_count = parts->levels ? parts->level_count : 1,
        .material_count = parts->material_count,
        .texture_count = parts->texture_count,
        .sensor_count = parts->sensor_count,
    };
    const void *from[ASSET_SECTION_COUNT] = {
        parts->positions_m,
        parts->normals,
        parts->texcoords,
        parts->colors,
        parts->indices,
        parts->primitives,
        parts->levels ? parts->levels : &all,
        parts->materials,
        parts->textures,
        parts->texels,
        parts->sensors,
        parts->geodesic_m,
        parts->names ? parts->names : "",
    };
    memcpy(h.magic, ASSET_MAGIC, sizeof(h.magic));
    memcpy(h.origin_m, parts->origin_m, sizeof(h.origin_m));
    bounds_of(parts, &h);
    uint64_t end = sizeof(h);
    for (int i = 0; i < ASSET_SECTION_COUNT; i++) {
        bool optional;
        uint64_t need = section_bytes(&h, i, &optional);
        if (i == ASSET_TEXELS)
            need = parts->texel_bytes;
        else if (i == ASSET_NAMES)
            need = parts->names ? parts->name_bytes : 1;
        h.sections[i].offset = align_up(end);
        h.sections[i].bytes = from[i] ? need : 0;
        end = h.sections[i].offset + h.sections[i].bytes;
    }
    h.file_bytes = align_up(end);
    char *bytes = aligned_alloc(ASSET_ALIGN, h.file_bytes);
    if (!bytes)
        return NULL;
    memset(bytes, 0, h.file_bytes);
    for (int i = 0; i < ASSET_SECTION_COUNT; i++)
        if (h.sections[i].bytes)
            memcpy(bytes + h.sections[i].offset, from[i], h.sections[i].bytes);
    memcpy(bytes, &h, sizeof(h));
    h.checksum = checksum(bytes, h.file_bytes);
    memcpy(bytes, &h, sizeof(h));
    *out_bytes = h.file_bytes;
    return bytes;
}
