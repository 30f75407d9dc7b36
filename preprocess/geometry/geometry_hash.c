/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hashes the part of a model that an asset uses. The hash stays the same if a revision changes only other assets. */
#include <string.h>
#define XXH_STATIC_LINKING_ONLY /* makes xxhash.h declare the hash state as a complete type, so that it can be a local variable */
#include <xxhash.h>

#include "base/mem.h"
#include "preprocess/geometry/geometry_impl.h"

struct hashing {
    XXH3_state_t state;
    const struct gltf_model *model;
    uint32_t *texture; /* by texture of the model: 1 + its index among the asset's textures; 0: not used yet */
    uint32_t textures;
};

static void hash_bytes(struct hashing *h, const void *bytes, size_t count)
{
    /* hash the length too, so that moving bytes from one field to the next changes the hash */
    XXH3_64bits_update(&h->state, &count, sizeof(count));
    if (count)
        XXH3_64bits_update(&h->state, bytes, count);
}

static void add_number(struct hashing *h, uint32_t number)
{
    XXH3_64bits_update(&h->state, &number, sizeof(number));
}

/* Hashes a texture's index in the asset, and the texture's content when it is first used. */
static void add_texture(struct hashing *h, uint32_t number)
{
    const struct gltf_model *model = h->model;
    bool is_new = number < model->texture_count && !h->texture[number];
    if (is_new)
        h->texture[number] = ++h->textures;
    add_number(h, number < model->texture_count ? h->texture[number] : 0);
    if (!is_new)
        return;
    const struct gltf_texture *texture = &model->textures[number];
    add_number(h, (uint32_t)texture->srgb << 1 | texture->wrap_repeat);
    if (texture->image < model->image_count)
        hash_bytes(h, model->images[texture->image].bytes, model->images[texture->image].size);
}

static void add_material(struct hashing *h, int material)
{
    add_number(h, material >= 0);
    if (material < 0)
        return;
    struct asset_material plain = h->model->materials[material];
    uint32_t *const textures[] = { &plain.base_color_texture, &plain.metallic_roughness_texture, &plain.normal_texture,
                                   &plain.occlusion_texture, &plain.emissive_texture };
    for (size_t i = 0; i < sizeof(textures) / sizeof(*textures); i++) {
        add_texture(h, *textures[i]);
        *textures[i] = 0;
    }
    plain.name = 0;
    hash_bytes(h, &plain, sizeof(plain));
    hash_bytes(h, h->model->material_names[material], strlen(h->model->material_names[material]));
}

static void add_primitive(struct hashing *h, const struct gltf_primitive *primitive)
{
    size_t vertices = primitive->vertex_count;
    hash_bytes(h, primitive->positions, vertices * sizeof(*primitive->positions));
    hash_bytes(h, primitive->normals, primitive->normals ? vertices * sizeof(*primitive->normals) : 0);
    hash_bytes(h, primitive->texcoords, primitive->texcoords ? vertices * sizeof(*primitive->texcoords) : 0);
    hash_bytes(h, primitive->second_texcoords, primitive->second_texcoords ? vertices * sizeof(*primitive->second_texcoords) : 0);
    hash_bytes(h, primitive->colors, primitive->colors ? vertices * sizeof(*primitive->colors) : 0);
    hash_bytes(h, primitive->indices, primitive->index_count * sizeof(*primitive->indices));
}

bool geometry_hash(uint64_t *out, const struct gltf_model *model, const struct geometry_params *params, char why[MODEL_WHY_BYTES])
{
    struct node_primitives parts = { 0 };
    struct geometry counts = { 0 };
    struct hashing h = { .model = model };
    bool good = node_primitives_find(&parts, &counts, model, params, why);
    XXH3_INITSTATE(&h.state);
    XXH3_64bits_reset(&h.state);
    h.texture = mem_array(model->texture_count + 1u, sizeof(*h.texture));
    /* also hash the counts of nodes, lines and points: the report contains them, so it is outdated if they change */
    const uint32_t numbers[3] = { counts.node_count, counts.skipped_lines, counts.skipped_points };
    hash_bytes(&h, numbers, sizeof(numbers));
    for (size_t i = 0; good && i < parts.count; i++) {
        const struct node_primitive *part = &parts.at[i], *before = i ? part - 1 : NULL;
        bool same_node = before && before->node == part->node;
        bool same_material = before && before->primitive->material == part->primitive->material;
        add_number(&h, (uint32_t)same_node << 1 | same_material);
        if (!same_node) {
            hash_bytes(&h, part->node->world, sizeof(part->node->world));
            hash_bytes(&h, part->node->name, strlen(part->node->name));
        }
        if (!same_material)
            add_material(&h, part->primitive->material);
        add_primitive(&h, part->primitive);
    }
    *out = XXH3_64bits_digest(&h.state);
    mem_free(h.texture);
    mem_free(parts.at);
    return good;
}
