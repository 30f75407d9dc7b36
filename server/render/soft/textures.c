/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Textures in main memory: computes mipmap levels, each half the size of the previous one, and samples them. */
#include "render/soft/textures.h"

#include <math.h>

#include "base/image/srgb.h"
#include "base/mem.h"
#include "render/soft/lanes.h"

/* --- texels ------------------------------------------------------------------------------------------------------------------- */

static int side_of(int finest_px, int level)
{
    return finest_px >> level > 0 ? finest_px >> level : 1;
}

static quad texel(const struct soft_texture *texture, const uint8_t at[4])
{
    return (quad){ texture->linear[at[0]], texture->linear[at[1]], texture->linear[at[2]], (float)at[3] * (1 / 255.0f) };
}

/* Wraps a texel coordinate around (repeat) or clamps it to 0..side-1. x may lie at most one texel outside that range. */
static int within(int x, int side, bool repeat)
{
    if (repeat)
        return x < 0 ? x + side : x < side ? x : x - side;
    return x < 0 ? 0 : x < side ? x : side - 1;
}

/* Returns the bilinear mean of the four texels around (x, y) of a mipmap level. x, y: in texels, 0 at the centre of the first texel. */
static quad between_texels(const struct soft_texture *texture, int level, float x, float y)
{
    int width = side_of(texture->width_px, level), height = side_of(texture->height_px, level);
    float first_x = floorf(x), first_y = floorf(y);
    int left = within((int)first_x, width, texture->repeat), right = within((int)first_x + 1, width, texture->repeat);
    int top = within((int)first_y, height, texture->repeat), bottom = within((int)first_y + 1, height, texture->repeat);
    const uint8_t(*upper)[4] = texture->levels[level] + (size_t)top * (size_t)width;
    const uint8_t(*lower)[4] = texture->levels[level] + (size_t)bottom * (size_t)width;
    quad a = texel(texture, upper[left]), b = texel(texture, lower[left]);
    a += (texel(texture, upper[right]) - a) * (x - first_x);
    b += (texel(texture, lower[right]) - b) * (x - first_x);
    return a + (b - a) * (y - first_y);
}

/* --- making --------------------------------------------------------------------------------------------------------------------- */

struct texture_making {
    struct soft_materials *materials;
    uint8_t bytes[1 << 14]; /* table that converts linear light, 0..1, to an sRGB byte */
};

static void make_level(const struct texture_making *making, const struct soft_texture *texture, int level, uint8_t (*out)[4])
{
    int width = side_of(texture->width_px, level), height = side_of(texture->height_px, level);
    float by_x = (float)side_of(texture->width_px, level - 1) / (float)width;
    float by_y = (float)side_of(texture->height_px, level - 1) / (float)height;
    bool srgb = texture->linear == making->materials->linear;
    for (int i = 0; i < width * height; i++) {
        float x = ((float)(i % width) + 0.5f) * by_x - 0.5f, y = ((float)(i / width) + 0.5f) * by_y - 0.5f;
        quad color = between_texels(texture, level - 1, x, y);
        for (int c = 0; c < 4; c++)
            out[i][c] =
                srgb && c < 3 ? making->bytes[(int)(color[c] * (sizeof(making->bytes) - 1) + 0.5f)] : (uint8_t)(color[c] * 255 + 0.5f);
    }
}

static void make_levels(void *arg, size_t begin, size_t end)
{
    const struct texture_making *making = arg;
    for (size_t i = begin; i < end; i++) {
        const struct soft_texture *texture = &making->materials->textures[i];
        uint8_t(*out)[4] = texture->coarse;
        for (int level = 1; level < texture->level_count && texture->coarse; level++) {
            make_level(making, texture, level, out);
            out += side_of(texture->width_px, level) * side_of(texture->height_px, level);
        }
    }
}

static bool describe_texture(const struct soft_materials *materials, const struct asset_view *file, const struct asset_texture *from,
                             struct soft_texture *texture)
{
    size_t coarse = 0;
    *texture = (struct soft_texture){ .levels = { (const uint8_t(*)[4])(file->texels + from->offset) },
                                      .linear = from->srgb ? materials->linear : materials->plain,
                                      .width_px = (int)from->width_px,
                                      .height_px = (int)from->height_px,
                                      .level_count = 1,
                                      .repeat = from->wrap_repeat != 0 };
    size_t starts[TEXTURE_LEVELS] = { 0 };
    for (int l = 1; l < TEXTURE_LEVELS && (texture->width_px >> l > 0 || texture->height_px >> l > 0); l++) {
        starts[l] = coarse;
        coarse += (size_t)side_of(texture->width_px, l) * (size_t)side_of(texture->height_px, l);
        texture->level_count++;
    }
    texture->coarse = mem_try_array(coarse, sizeof(*texture->coarse));
    for (int l = 1; l < texture->level_count && texture->coarse; l++)
        texture->levels[l] = (const uint8_t(*)[4])(texture->coarse + starts[l]);
    return texture->coarse || coarse == 0;
}

static void describe_material(const struct asset_material *from, const struct soft_texture *textures, struct soft_material *material)
{
    const uint32_t maps[MODEL_MAPS] = { from->base_color_texture, from->metallic_roughness_texture, from->normal_texture,
                                        from->occlusion_texture, from->emissive_texture };
    *material = (struct soft_material){ .of = from, .blended = from->alpha == ASSET_ALPHA_BLEND };
    for (int i = 0; i < MODEL_MAPS; i++)
        if (maps[i] != ASSET_NO_TEXTURE) {
            material->maps[i] = &textures[maps[i]];
            material->mapped = true;
        }
    material->cut_out = from->alpha == ASSET_ALPHA_MASK && material->maps[MODEL_BASE_COLOR];
}

bool soft_materials_init(struct soft_materials *materials, const struct gl_model *models, size_t model_count, struct workers *workers)
{
    struct texture_making *making;
    size_t material_count = 0, texture_count = 0;
    bool good = true;
    for (size_t m = 0; m < model_count; m++) {
        material_count += models[m].material_count;
        texture_count += models[m].texture_count;
    }
    *materials = (struct soft_materials){ .at = mem_array(material_count, sizeof(*materials->at)),
                                          .textures = mem_array(texture_count, sizeof(*materials->textures)) };
    for (int i = 0; i < 256; i++) {
        materials->linear[i] = (float)linear_from_srgb(i / 255.0);
        materials->plain[i] = (float)i * (1 / 255.0f);
    }
    struct soft_material *material = materials->at;
    for (size_t m = 0; m < model_count; m++) {
        const struct asset_view *file = &models[m].file->view;
        const struct soft_texture *first = materials->textures + materials->texture_count;
        for (size_t i = 0; i < models[m].texture_count; i++)
            good &= describe_texture(materials, file, &file->textures[i], &materials->textures[materials->texture_count++]);
        for (size_t i = 0; i < models[m].material_count; i++)
            describe_material(&file->materials[i], first, material++);
    }
    making = mem_new(sizeof(*making));
    making->materials = materials;
    for (size_t i = 0; i < sizeof(making->bytes) && texture_count > 0; i++)
        making->bytes[i] = (uint8_t)(255 * srgb_from_linear((double)i / (sizeof(making->bytes) - 1)) + 0.5);
    workers_for(workers, materials->texture_count, 1, make_levels, making);
    mem_free(making);
    return good;
}

void soft_materials_finish(struct soft_materials *materials)
{
    for (size_t i = 0; i < materials->texture_count; i++)
        mem_free(materials->textures[i].coarse);
    mem_free(materials->textures);
    mem_free(materials->at);
    *materials = (struct soft_materials){ 0 };
}

/* --- looking ------------------------------------------------------------------------------------------------------------------ */

void soft_spread_at(const double weights[3][3], double x, double y, struct soft_spread *spread)
{
    double w[3], sum = 0, sum_x = 0, sum_y = 0;
    for (int i = 0; i < 3; i++) {
        w[i] = weights[i][0] * x + weights[i][1] * y + weights[i][2];
        sum += w[i];
        sum_x += weights[i][0];
        sum_y += weights[i][1];
    }
    double over = sum != 0 ? 1 / sum : 0;
    for (int i = 0; i < 3; i++) {
        double part = w[i] * over;
        spread->at[i] = (float)part;
        spread->by_x[i] = (float)((weights[i][0] - part * sum_x) * over);
        spread->by_y[i] = (float)((weights[i][1] - part * sum_y) * over);
    }
}

void soft_spread_coordinates(const float (*coordinates)[2], const uint32_t vertices[3], const struct soft_spread *spread, float uv[3][2])
{
    for (int c = 0; c < 2; c++) {
        uv[0][c] = uv[1][c] = uv[2][c] = 0;
        for (int i = 0; i < 3 && coordinates; i++) {
            uv[0][c] += spread->at[i] * coordinates[vertices[i]][c];
            uv[1][c] += spread->by_x[i] * coordinates[vertices[i]][c];
            uv[2][c] += spread->by_y[i] * coordinates[vertices[i]][c];
        }
    }
}

/* Returns the mipmap level whose texels are as large as pixels of the frame; the fraction says how far it is between two
   levels. */
static float level_at(const struct soft_texture *texture, float uv[3][2])
{
    float square = 0;
    for (int axis = 1; axis < 3; axis++) {
        float x = uv[axis][0] * (float)texture->width_px, y = uv[axis][1] * (float)texture->height_px;
        square = fmaxf(square, x * x + y * y);
    }
    return fminf(0.5f * log2f(fmaxf(square, 1)), (float)(texture->level_count - 1));
}

static float place_on(const struct soft_texture *texture, float x)
{
    x = texture->repeat ? x - floorf(x) : fminf(x, 1);
    return x > 0 ? x : 0; /* also 0 for NAN */
}

void soft_texture_color(const struct soft_texture *texture, float uv[3][2], float rgba[4])
{
    float at = level_at(texture, uv), u = place_on(texture, uv[0][0]), v = place_on(texture, uv[0][1]);
    int level = (int)at;
    quad color[2];
    for (int i = 0; i < 2 && level + i < texture->level_count; i++)
        color[i] = between_texels(texture, level + i, u * (float)side_of(texture->width_px, level + i) - 0.5f,
                                  v * (float)side_of(texture->height_px, level + i) - 0.5f);
    if (at > (float)level)
        color[0] += (color[1] - color[0]) * (at - (float)level);
    for (int c = 0; c < 4; c++)
        rgba[c] = color[0][c];
}

float soft_alpha(const struct soft_material *material, const struct asset_view *file, const uint32_t vertices[3],
                 const struct soft_spread *spread)
{
    float alpha = material->of->base_color[3], tint = 0, uv[3][2], color[4];
    for (int i = 0; i < 3 && file->colors; i++)
        tint += spread->at[i] * (float)file->colors[vertices[i]][3] * (1 / 255.0f);
    if (file->colors)
        alpha *= tint;
    if (!material->maps[MODEL_BASE_COLOR])
        return alpha;
    soft_spread_coordinates(file->texcoords, vertices, spread, uv);
    soft_texture_color(material->maps[MODEL_BASE_COLOR], uv, color);
    return alpha * color[3];
}
