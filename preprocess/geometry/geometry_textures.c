/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes the texture images of an asset. */
#include <string.h>

#include "base/image/image.h"
#include "base/mem.h"
#include "preprocess/geometry/geometry_impl.h"

#define TEXTURE_MAX_PX 2048u

static bool add_texture(struct geometry *geometry, const struct gltf_model *model, uint32_t texture, size_t *texel_capacity, char *why)
{
    const struct gltf_texture *from = &model->textures[texture];
    const struct gltf_image *encoded = &model->images[from->image];
    struct image image;
    char image_why[IMAGE_WHY_BYTES];
    if (!image_decode(&image, encoded->bytes, encoded->size, TEXTURE_MAX_PX, image_why))
        return wrong(why, "image %u '%.80s': %s", from->image, encoded->name, image_why);
    size_t bytes = 4 * (size_t)image.width_px * image.height_px;
    geometry->textures[geometry->texture_count++] = (struct asset_texture){ .offset = geometry->texel_bytes,
                                                                            .width_px = image.width_px,
                                                                            .height_px = image.height_px,
                                                                            .srgb = from->srgb,
                                                                            .wrap_repeat = from->wrap_repeat };
    mem_grow(&geometry->texels, texel_capacity, geometry->texel_bytes + bytes, 1);
    memcpy(geometry->texels + geometry->texel_bytes, image.rgba, bytes);
    geometry->texel_bytes += bytes;
    mem_free(image.rgba);
    return true;
}

bool geometry_join_textures(struct geometry *geometry, const struct gltf_model *model, char *why)
{
    uint32_t *number = mem_array(model->texture_count, sizeof(*number));
    size_t texel_capacity = 0;
    bool good = true;
    geometry->textures = mem_array(model->texture_count, sizeof(*geometry->textures));
    memset(number, 0xff, model->texture_count * sizeof(*number));
    for (uint32_t m = 0; good && m < geometry->material_count; m++) {
        struct asset_material *material = &geometry->materials[m];
        uint32_t *uses[] = { &material->base_color_texture, &material->metallic_roughness_texture, &material->normal_texture,
                             &material->occlusion_texture, &material->emissive_texture };
        for (int i = 0; good && i < 5; i++) {
            bool second = material->second >> i & 1;
            if (*uses[i] == ASSET_NO_TEXTURE || !(second ? geometry->second_texcoords : geometry->texcoords)) {
                *uses[i] = ASSET_NO_TEXTURE;
                material->second &= ~(1u << i);
                continue;
            }
            if (number[*uses[i]] == ASSET_NO_TEXTURE) {
                number[*uses[i]] = geometry->texture_count;
                good = add_texture(geometry, model, *uses[i], &texel_capacity, why);
            }
            *uses[i] = number[*uses[i]];
        }
    }
    mem_free(number);
    return good;
}
