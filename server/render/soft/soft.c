/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State that all frames of the software renderer share: creates it, measures its memory and frees it. */
#include "render/soft/soft.h"

#include <string.h>

#include "base/mem.h"
#include "render/soft/kernels.h"
#include "render/soft/ramp_rows.h"
#include "render/soft/tones.h"

/* default memory limits of the visibility buffers that are kept for recolouring. PREVIEWS_BYTES: for previews, room for about
   five of 1920x1080; REFINED_BYTES: for refined frames, room for about ten */
static const size_t PREVIEWS_BYTES = (size_t)128 << 20, REFINED_BYTES = (size_t)256 << 20;

/* Returns the kernels of the widest instruction set that this machine has. */
static const struct soft_kernels *choose_kernels(void)
{
#ifdef __x86_64__
    enum simd_level level = simd_level();
    if (level == SIMD_HAS_AVX512)
        return &soft_kernels_widest;
    if (level == SIMD_HAS_AVX2)
        return &soft_kernels_wide;
#endif
    return &soft_kernels_plain;
}

static lanes shading_of(const struct asset_material *material)
{
    return (lanes){ material->base_color[0], material->base_color[1], material->base_color[2], material->metallic,
                    material->roughness,     material->emissive[0],   material->emissive[1],   material->emissive[2] };
}

/* Copies the materials of all models, and their colour ramps. Materials with equal ramps share one row of the ramp table. */
static void copy_materials(struct soft *soft)
{
    const struct gpu_scene *gpu_scene = soft->gpu_scene;
    soft->material_of_model = mem_array(gpu_scene->model_count, sizeof(*soft->material_of_model));
    for (size_t m = 0; m < gpu_scene->model_count; m++) {
        soft->material_of_model[m] = (uint32_t)soft->material_count;
        soft->material_count += gpu_scene->models[m].material_count;
    }
    soft->muted_ramps = mem_array(soft->material_count * RAMP_STEPS, sizeof(*soft->muted_ramps));
    soft->own_ramps = mem_array(soft->material_count * RAMP_STEPS, sizeof(*soft->own_ramps));
    soft->shading = mem_array(soft->material_count, sizeof(*soft->shading));
    for (size_t m = 0; m < gpu_scene->model_count; m++) {
        const struct gl_model *model = &gpu_scene->models[m];
        size_t first = soft->material_of_model[m], bytes = model->material_count * RAMP_STEPS * sizeof(uint32_t);
        memcpy(soft->muted_ramps + first * RAMP_STEPS, model->ramp_texels[MODEL_MUTED], bytes);
        memcpy(soft->own_ramps + first * RAMP_STEPS, model->ramp_texels[MODEL_OWN], bytes);
        for (size_t i = 0; i < model->material_count; i++)
            soft->shading[first + i] = shading_of(&model->file->view.materials[i]);
    }
    soft->ramp_of_material = mem_array(soft->material_count, sizeof(*soft->ramp_of_material));
    ramp_rows_pack(soft->muted_ramps, soft->own_ramps, soft->material_count, RAMP_STEPS, MOST_RAMPS, soft->ramp_of_material);
}

struct soft *soft_create(struct workers *workers, const struct gpu_scene *gpu_scene, const struct sky *sky,
                         const struct environments *environments)
{
    struct soft *soft = mem_new(sizeof(*soft));
    soft->workers = workers;
    soft->kernels = choose_kernels();
    soft->gpu_scene = gpu_scene;
    soft->environments = environments;
    soft->kept[TIER_PREVIEW].bound_bytes = PREVIEWS_BYTES;
    soft->kept[TIER_REFINED].bound_bytes = REFINED_BYTES;
    /* keeps the visibility buffer of the newest refined frame even if it exceeds the limit, so that changed readings can always
       be shown by recolouring */
    soft->kept[TIER_REFINED].keeps_newest = true;
    soft->parts = mem_array(gpu_scene->model_count, sizeof(*soft->parts));
    soft->backdrops = sky->texels[0];
    soft->preview.soft = soft;
    copy_materials(soft);
    soft->tones = mem_new(sizeof(*soft->tones));
    soft_tones_init(soft->tones);
    if (!soft_materials_init(&soft->materials, gpu_scene->models, gpu_scene->model_count, workers))
        soft_destroy(&soft);
    return soft;
}

void soft_destroy(struct soft **soft_ptr)
{
    struct soft *soft = *soft_ptr;
    if (!soft)
        return;
    soft_rest(soft);
    soft_materials_finish(&soft->materials);
    mem_free(soft->parts);
    mem_free(soft->muted_ramps);
    mem_free(soft->own_ramps);
    mem_free(soft->ramp_of_material);
    mem_free(soft->material_of_model);
    mem_free(soft->shading);
    mem_free(soft->glossy);
    mem_free(soft->tones);
    mem_free(soft);
    *soft_ptr = NULL;
}

void soft_bound(struct soft *soft, enum tier tier, size_t bytes)
{
    visibility_store_bound(&soft->kept[tier], bytes);
}

size_t soft_kept_bytes(const struct soft *soft)
{
    return soft->kept[TIER_PREVIEW].bytes + soft->kept[TIER_REFINED].bytes;
}

static size_t parts_bytes(const struct soft_parts *parts)
{
    return parts->part_capacity * sizeof(*parts->parts) + parts->vertex_capacity * sizeof(*parts->vertices) +
           parts->place_capacity * sizeof(*parts->places_m) + parts->corner_capacity + parts->plane_capacity * sizeof(*parts->planes) +
           (parts->closed ? parts->vertex_count : 0);
}

size_t soft_room_bytes(const struct soft *soft)
{
    size_t bytes = raster_bytes(&soft->preview) + (soft->spare ? refined_bytes(soft->spare) : 0);
    for (size_t m = 0; m < soft->gpu_scene->model_count; m++)
        for (size_t l = 0; soft->parts[m] && l < soft->gpu_scene->models[m].level_count; l++)
            bytes += sizeof(struct soft_parts) + parts_bytes(&soft->parts[m][l]);
    return bytes;
}

size_t soft_light_bytes(const struct soft *soft)
{
    size_t bytes = 0;
    for (int i = 0; i < SOFT_LIGHTS; i++) {
        const struct soft_light *light = &soft->lights[i];
        size_t side = light->ground ? (size_t)light->ground_px : 0;
        bytes += light->sun_map ? soft_sun_map_bytes(light) + soft_sun_bounds_bytes(light) : 0;
        bytes += side * side * (sizeof(*light->ground) + sizeof(*light->open));
        for (size_t a = 0; light->baked && a < soft->gpu_scene->scene->asset_count; a++)
            bytes += 4 * soft->gpu_scene->of_asset[a]->mesh.vertex_count;
    }
    return bytes;
}

static void drop_parts(struct soft *soft)
{
    for (size_t m = 0; m < soft->gpu_scene->model_count; m++) {
        for (size_t l = 0; soft->parts[m] && l < soft->gpu_scene->models[m].level_count; l++)
            soft_parts_finish(&soft->parts[m][l]);
        mem_free(soft->parts[m]);
        soft->parts[m] = NULL;
    }
}

void soft_drop_spare(struct soft *soft)
{
    refined_destroy(&soft->spare);
}

void soft_rest(struct soft *soft)
{
    soft_drop_spare(soft);
    raster_finish(&soft->preview);
    drop_parts(soft);
    for (int i = 0; i < SOFT_LIGHTS; i++)
        soft_free_light(soft, &soft->lights[i]);
    for (int tier = 0; tier <= TIER_REFINED; tier++)
        visibility_store_finish(&soft->kept[tier]);
}
