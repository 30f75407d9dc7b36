/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uploads the materials of glTF models (metallic-roughness) and their textures to the GPU. */
#include "render/gl/materials.h"

#include <math.h>
#include <string.h>

#include "base/image/srgb.h"
#include "base/mem.h"
#include "render/soft/ramps.h"

/* Must match shaders/material.glsl. */
struct material_block {
    float base_color[4], factors[4], emissive[4];
};

static GLuint upload_texture(const struct asset_view *view, const struct asset_texture *texture)
{
    GLuint name = 0;
    GLsizei width = (GLsizei)texture->width_px, height = (GLsizei)texture->height_px;
    GLsizei levels = 1 + (GLsizei)floor(log2(fmax(width, height)));
    GLint wrap = texture->wrap_repeat ? GL_REPEAT : GL_CLAMP_TO_EDGE;
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    glTextureStorage2D(name, levels, texture->srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8, width, height);
    glTextureSubImage2D(name, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, view->texels + texture->offset);
    glGenerateTextureMipmap(name);
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(name, GL_TEXTURE_WRAP_S, wrap);
    glTextureParameteri(name, GL_TEXTURE_WRAP_T, wrap);
    return name;
}

/* Computes a texture's mean colour in linear light, for the colour ramps of previews, from about 10,000 evenly spaced texels. */
static void texture_mean(const struct asset_view *view, const struct asset_texture *texture, float mean[3])
{
    const uint8_t *texels = view->texels + texture->offset;
    size_t count = (size_t)texture->width_px * texture->height_px, step = 1 + count / 10007, taken = 0;
    double sum[3] = { 0 };
    for (size_t i = 0; i < count; i += step, taken++)
        for (int c = 0; c < 3; c++) {
            float value = texels[4 * i + c] / 255.0f;
            sum[c] += texture->srgb ? linear_from_srgbf(value) : value;
        }
    for (int c = 0; c < 3; c++)
        mean[c] = (float)(sum[c] / (double)taken);
}

/* Averages the vertex colours of the triangles that use a material, for the colour ramps of previews. */
static void tint_mean(const struct asset_view *view, uint32_t material, float mean[3])
{
    double sum[3] = { 0 };
    size_t taken = 0;
    mean[0] = mean[1] = mean[2] = 1;
    for (uint32_t p = 0; view->colors && p < view->header->primitive_count; p++) {
        const struct asset_primitive *primitive = &view->primitives[p];
        if (primitive->material != material)
            continue;
        for (uint32_t i = 0; i < primitive->index_count; i++, taken++)
            for (int c = 0; c < 3; c++)
                sum[c] += view->colors[view->indices[primitive->first_index + i]][c] / 255.0;
    }
    for (int c = 0; c < 3 && taken; c++)
        mean[c] = (float)(sum[c] / (double)taken);
}

static void material_mean(const struct asset_view *view, uint32_t index, float mean[3])
{
    const struct asset_material *material = &view->materials[index];
    float texture[3] = { 1, 1, 1 }, tint[3];
    if (material->base_color_texture != ASSET_NO_TEXTURE)
        texture_mean(view, &view->textures[material->base_color_texture], texture);
    tint_mean(view, index, tint);
    for (int c = 0; c < 3; c++)
        mean[c] = material->base_color[c] * texture[c] * tint[c];
}

static void fill_block(struct material_block *block, const struct asset_material *material)
{
    memcpy(block->base_color, material->base_color, sizeof(block->base_color));
    memcpy(block->factors, (float[4]){ material->metallic, material->roughness, material->normal_scale, material->occlusion_strength },
           sizeof(block->factors));
    memcpy(block->emissive, material->emissive, sizeof(material->emissive));
    block->emissive[3] = material->alpha == ASSET_ALPHA_MASK ? material->alpha_cutoff : 0;
}

static void find_maps(struct model_material *out, const struct gl_model *model, const struct asset_material *material)
{
    const uint32_t maps[MODEL_MAPS] = { material->base_color_texture, material->metallic_roughness_texture, material->normal_texture,
                                        material->occlusion_texture, material->emissive_texture };
    out->masked = material->alpha == ASSET_ALPHA_MASK;
    out->second = (int)material->second;
    for (int i = 0; i < MODEL_MAPS; i++)
        if (maps[i] != ASSET_NO_TEXTURE) {
            out->maps[i] = model->textures[maps[i]];
            out->mask |= 1 << i;
        }
}

static void make_ramps(struct gl_model *model, const struct environment_light *sky, const double up[3])
{
    const struct asset_view *view = &model->file->view;
    for (int kind = 0; kind < MODEL_RAMPS; kind++) {
        uint32_t *texels = mem_array(model->material_count * MODEL_LIGHT_STEPS, sizeof(*texels));
        for (uint32_t i = 0; i < model->material_count; i++) {
            const struct asset_material *material = &view->materials[i];
            struct ramp_material of = { .metallic = material->metallic, .roughness = material->roughness };
            memcpy(of.emissive, material->emissive, sizeof(of.emissive));
            material_mean(view, i, of.mean);
            ramp_fill(sky, up, &of, kind == MODEL_MUTED, MODEL_LIGHT_STEPS, texels + (size_t)i * MODEL_LIGHT_STEPS);
        }
        model->ramp_texels[kind] = texels;
        glCreateTextures(GL_TEXTURE_2D, 1, &model->ramps[kind]);
        glTextureStorage2D(model->ramps[kind], 1, GL_RGBA8, MODEL_LIGHT_STEPS, (GLsizei)model->material_count);
        glTextureParameteri(model->ramps[kind], GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTextureSubImage2D(model->ramps[kind], 0, 0, 0, MODEL_LIGHT_STEPS, (GLsizei)model->material_count, GL_BGRA, GL_UNSIGNED_BYTE,
                            texels);
    }
}

bool materials_upload(struct gl_model *model, struct gl *gl, const struct environment_light *sky, const double up[3])
{
    const struct asset_view *view = &model->file->view;
    model->texture_count = view->header->texture_count;
    model->material_count = view->header->material_count;
    model->textures = mem_array(model->texture_count, sizeof(*model->textures));
    model->materials = mem_array(model->material_count, sizeof(*model->materials));
    struct material_block *blocks = mem_array(model->material_count, sizeof(*blocks));
    for (size_t i = 0; i < model->texture_count; i++)
        model->textures[i] = upload_texture(view, &view->textures[i]);
    for (uint32_t i = 0; i < model->material_count; i++) {
        fill_block(&blocks[i], &view->materials[i]);
        find_maps(&model->materials[i], model, &view->materials[i]);
    }
    if (gl_no_errors())
        model->material_buffer = mesh_buffer(gl->log, model->file->path, model->material_count * sizeof(*blocks), blocks, 0);
    mem_free(blocks);
    if (!model->material_buffer)
        return false;
    make_ramps(model, sky, up);
    return true;
}

void materials_finish(struct gl_model *model)
{
    if (model->textures)
        glDeleteTextures((GLsizei)model->texture_count, model->textures);
    glDeleteTextures(MODEL_RAMPS, model->ramps);
    for (int kind = 0; kind < MODEL_RAMPS; kind++)
        mem_free(model->ramp_texels[kind]);
    glDeleteBuffers(1, &model->material_buffer);
    mem_free(model->textures);
    mem_free(model->materials);
}
