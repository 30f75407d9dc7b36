/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bakes sun and sky light with depth maps and compute shaders. */
#include "render/light.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "gpu/program.h"
#include "render/matrix.h"

enum { SKY_DIRECTIONS = 32, SKY_MAP_PX = 1024, SUN_MAP_PX = 4096, GROUND_PX = 256 };

/* As in shaders/bake.comp. */
struct directions_block {
    float map_from_plant[SKY_DIRECTIONS][16];
    float direction[SKY_DIRECTIONS][4];
};

/* Depth maps from all round, needed only while the first set is baked. */
struct sky_maps {
    GLuint maps, directions;
    double texel_m;
};

static void find_ground(struct light *light)
{
    const struct stage *stage = light->stage;
    const struct scene *scene = stage->scene;
    int up = stage->up[1] > 0 ? 1 : 2, across[2] = { 0, up == 1 ? 2 : 1 };
    double side_m = 0.6 * stage->radius_m;
    for (int i = 0; i < 2; i++)
        side_m = fmax(side_m, scene->bounds_max_m[across[i]] - scene->bounds_min_m[across[i]]);
    side_m += 1.2 * stage->radius_m;
    light->ground_height_m = scene->bounds_min_m[up] - 0.001 * stage->radius_m; /* nothing of the plant in its plane */
    memset(light->plant_from_ground, 0, sizeof(light->plant_from_ground));
    for (int i = 0; i < 2; i++) {
        light->plant_from_ground[4 * i + across[i]] = side_m;
        light->plant_from_ground[12 + across[i]] = stage->middle_m[across[i]] - 0.5 * side_m;
    }
    light->plant_from_ground[8 + up] = 1;
    light->plant_from_ground[12 + up] = light->ground_height_m;
    light->plant_from_ground[15] = 1;
}

bool light_init(struct light *light, const struct stage *stage)
{
    struct log *log = stage->gl->log;
    *light = (struct light){ .stage = stage };
    light->sky_program = program_create(log, program_params(.compute = "bake.comp", .defines = "#define SKY\n"));
    light->sun_program = program_create(log, program_params(.compute = "bake.comp"));
    light->ground_sky_program = program_create(log, program_params(.compute = "bake.comp", .defines = "#define GROUND\n#define SKY\n"));
    light->ground_sun_program = program_create(log, program_params(.compute = "bake.comp", .defines = "#define GROUND\n"));
    find_ground(light);
    return light->sky_program && light->sun_program && light->ground_sky_program && light->ground_sun_program;
}

static void set_finish(struct light_set *set, size_t assets)
{
    glDeleteTextures(1, &set->sun_map);
    glDeleteTextures(1, &set->ground);
    if (set->baked)
        glDeleteBuffers((GLsizei)assets, set->baked);
    mem_free(set->baked);
    *set = (struct light_set){ 0 };
}

void light_finish(struct light *light)
{
    for (int i = 0; i < LIGHT_SETS; i++)
        if (light->stage)
            set_finish(&light->sets[i], light->stage->scene->asset_count);
    program_destroy(&light->sky_program);
    program_destroy(&light->sun_program);
    program_destroy(&light->ground_sky_program);
    program_destroy(&light->ground_sun_program);
}

/* A depth texture to compare with; outside it nothing stands in the light. */
static GLuint make_map(GLenum kind, int size_px, int layers)
{
    static const float nothing[4] = { 0 };
    GLuint map = 0;
    glCreateTextures(kind, 1, &map);
    if (kind == GL_TEXTURE_2D_ARRAY)
        glTextureStorage3D(map, 1, GL_DEPTH_COMPONENT16, size_px, size_px, layers);
    else
        glTextureStorage2D(map, 1, GL_DEPTH_COMPONENT16, size_px, size_px);
    glTextureParameteri(map, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(map, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(map, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glTextureParameteri(map, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    glTextureParameterfv(map, GL_TEXTURE_BORDER_COLOR, nothing);
    glTextureParameteri(map, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTextureParameteri(map, GL_TEXTURE_COMPARE_FUNC, GL_GEQUAL);
    return map;
}

/* The scene as seen from far away in that direction. layer -1: the texture is not an array. */
static void draw_map(const struct stage *stage, GLuint map, int layer, int size_px, const double towards[3], double texture_from_plant[16])
{
    double clip_from_plant[16];
    GLuint framebuffer = 0;
    matrix_parallel(stage->middle_m, stage->radius_m, towards, clip_from_plant);
    matrix_texture_from_clip(clip_from_plant, texture_from_plant);
    glCreateFramebuffers(1, &framebuffer);
    if (layer < 0)
        glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, map, 0);
    else
        glNamedFramebufferTextureLayer(framebuffer, GL_DEPTH_ATTACHMENT, map, 0, layer);
    glNamedFramebufferDrawBuffer(framebuffer, GL_NONE);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, size_px, size_px);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glClear(GL_DEPTH_BUFFER_BIT);
    stage_draw_depth(stage, clip_from_plant, -1, stage->radius_m / size_px);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glDeleteFramebuffers(1, &framebuffer);
}

/* Evenly over the sphere (Fibonacci lattice). Ground throws back less than half of what the sky gives. */
static void sky_direction(const struct stage *stage, int i, double towards[3], float *brightness)
{
    double height = 1 - (2 * i + 1.0) / SKY_DIRECTIONS, angle = i * 2.399963229728653, flat = sqrt(1 - height * height);
    double a = flat * cos(angle), b = flat * sin(angle);
    bool y_up = stage->up[1] > 0;
    towards[0] = a;
    towards[1] = y_up ? height : b;
    towards[2] = y_up ? -b : height;
    *brightness = (float)(height > 0 ? 0.92 + 0.12 * height : 0.42);
}

static bool sky_maps_init(struct sky_maps *sky, const struct stage *stage)
{
    struct directions_block *block = mem_new(sizeof(*block));
    double to_middle[16];
    matrix_translation(stage->middle_m, to_middle);
    *sky = (struct sky_maps){ .texel_m = 2 * stage->radius_m / SKY_MAP_PX };
    sky->maps = make_map(GL_TEXTURE_2D_ARRAY, SKY_MAP_PX, SKY_DIRECTIONS);
    for (int i = 0; i < SKY_DIRECTIONS; i++) {
        double towards[3], texture_from_plant[16];
        sky_direction(stage, i, towards, &block->direction[i][3]);
        draw_map(stage, sky->maps, i, SKY_MAP_PX, towards, texture_from_plant);
        matrix_multiply(texture_from_plant, to_middle, texture_from_plant);
        matrix_to_float(texture_from_plant, block->map_from_plant[i]);
        for (int c = 0; c < 3; c++)
            block->direction[i][c] = (float)towards[c];
    }
    sky->directions = mesh_buffer(stage->gl->log, "sky directions", sizeof(*block), block, 0);
    mem_free(block);
    return sky->directions != 0;
}

static void sky_maps_finish(struct sky_maps *sky)
{
    glDeleteTextures(1, &sky->maps);
    glDeleteBuffers(1, &sky->directions);
}

static void set_uniforms(const struct light *light, const struct light_set *set, const struct sky_maps *sky,
                         const double plant_from_here[16])
{
    double around_middle[16];
    float matrix[16], normals[9];
    const double *middle = light->stage->middle_m;
    matrix_translation((double[3]){ -middle[0], -middle[1], -middle[2] }, around_middle);
    matrix_multiply(around_middle, plant_from_here, around_middle);
    matrix_to_float(around_middle, matrix);
    glUniformMatrix4fv(0, 1, GL_FALSE, matrix);
    matrix_normals(plant_from_here, normals);
    glUniformMatrix3fv(4, 1, GL_FALSE, normals);
    matrix_translation(middle, around_middle);
    matrix_multiply(set->texture_from_plant, around_middle, around_middle);
    matrix_to_float(around_middle, matrix);
    glUniformMatrix4fv(1, 1, GL_FALSE, matrix);
    glUniform4f(8, (float)set->towards[0], (float)set->towards[1], (float)set->towards[2], (float)set->texel_m);
    glUniform1f(9, sky ? (float)sky->texel_m : 0);
}

static void bake_asset(struct light *light, struct light_set *set, const struct sky_maps *sky, size_t asset)
{
    const struct scene_asset *at = &light->stage->scene->assets[asset];
    const struct mesh *mesh = &light->stage->of_asset[asset]->mesh;
    set_uniforms(light, set, sky, at->placement);
    glUniform1i(10, (GLint)mesh->vertex_count);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, mesh->positions);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, mesh->normals);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4, set->baked[asset]);
    glDispatchCompute(((GLuint)mesh->vertex_count + 63) / 64, 1, 1);
}

static void bake_ground(struct light *light, struct light_set *set, const struct sky_maps *sky)
{
    glUseProgram(sky ? light->ground_sky_program : light->ground_sun_program);
    set_uniforms(light, set, sky, light->plant_from_ground);
    glUniform1i(10, GROUND_PX * GROUND_PX);
    glUniform3f(11, (float)light->stage->up[0], (float)light->stage->up[1], (float)light->stage->up[2]);
    glBindImageTexture(0, set->ground, 0, GL_FALSE, 0, GL_READ_WRITE, GL_RG8);
    glDispatchCompute(GROUND_PX * GROUND_PX / 64, 1, 1);
}

/* Sky light does not depend on the sun: taken over from a set that is baked, or from `sky`. */
static bool set_buffers(struct light *light, struct light_set *set, const struct light_set *from)
{
    const struct stage *stage = light->stage;
    size_t assets = stage->scene->asset_count;
    set->baked = mem_array(assets, sizeof(*set->baked));
    for (size_t i = 0; i < assets; i++) {
        size_t bytes = 4 * stage->of_asset[i]->mesh.vertex_count;
        set->baked[i] = mesh_buffer(stage->gl->log, stage->scene->assets[i].plant->id, bytes, NULL, 0);
        if (!set->baked[i])
            return false;
        if (from)
            glCopyNamedBufferSubData(from->baked[i], set->baked[i], 0, 0, (GLsizeiptr)bytes);
    }
    glCreateTextures(GL_TEXTURE_2D, 1, &set->ground);
    glTextureStorage2D(set->ground, 1, GL_RG8, GROUND_PX, GROUND_PX);
    glTextureParameteri(set->ground, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(set->ground, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(set->ground, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    if (from)
        glCopyImageSubData(from->ground, GL_TEXTURE_2D, 0, 0, 0, 0, set->ground, GL_TEXTURE_2D, 0, 0, 0, 0, GROUND_PX, GROUND_PX, 1);
    return true;
}

static bool set_init(struct light *light, struct light_set *set, const double towards[3], const struct light_set *from)
{
    const struct stage *stage = light->stage;
    struct sky_maps sky = { 0 };
    int size_px = SUN_MAP_PX < stage->gl->max_texture_px ? SUN_MAP_PX : stage->gl->max_texture_px;
    *set = (struct light_set){ .texel_m = 2 * stage->radius_m / size_px };
    memcpy(set->towards, towards, sizeof(set->towards));
    gl_pass_enter("light");
    bool good = set_buffers(light, set, from) && (from || sky_maps_init(&sky, stage));
    set->sun_map = make_map(GL_TEXTURE_2D, size_px, 1);
    if (good) {
        draw_map(stage, set->sun_map, -1, size_px, towards, set->texture_from_plant);
        glBindTextureUnit(1, sky.maps);
        glBindTextureUnit(2, set->sun_map);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, sky.directions);
        bake_ground(light, set, from ? NULL : &sky);
        glUseProgram(from ? light->sun_program : light->sky_program);
        for (size_t i = 0; i < stage->scene->asset_count; i++)
            bake_asset(light, set, from ? NULL : &sky, i);
        glMemoryBarrier(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
    }
    sky_maps_finish(&sky);
    return gl_pass_leave(stage->gl, "light") && good;
}

const struct light_set *light_get(struct light *light, const double towards[3])
{
    struct light_set *oldest = &light->sets[0], *any = NULL;
    for (int i = 0; i < LIGHT_SETS; i++) {
        struct light_set *set = &light->sets[i];
        if (set->sun_map && !memcmp(set->towards, towards, sizeof(set->towards))) {
            set->used = ++light->uses;
            return set;
        }
        if (set->sun_map && (!any || set->used > any->used))
            any = set;
        if (set->used < oldest->used)
            oldest = set;
    }
    set_finish(oldest, light->stage->scene->asset_count);
    bool good = set_init(light, oldest, towards, any);
    oldest->used = ++light->uses;
    if (good)
        return oldest;
    set_finish(oldest, light->stage->scene->asset_count);
    return NULL;
}
