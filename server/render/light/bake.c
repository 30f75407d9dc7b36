/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bakes light with depth maps and compute shaders, in small steps. A step draws one asset into one depth map, or lights a few
   thousand vertices, or some rows of the ground texture. */
#include "render/light/bake.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "gpu/program.h"
#include "render/light/bake_faces.h"
#include "render/light/sun_frame.h"
#include "render/matrix.h"

enum { SKY_DIRECTIONS = 32, SKY_MAP_PX = 1024, SUN_MAP_PX = 4096 };
/* constant openness (visible part of the sky, 0..255) in a rough light set, which is baked fast because openness is not computed */
static const uint8_t ROUGH_OPENNESS = 190;
/* A triangle counts as large, and is also lit at points inside, if its longest edge has at least this length. Unit: texels of
   the depth maps that tell from which directions of the sky light reaches a point */
static const double LARGE_FACE_TEXELS = 8;
/* empty border of the sun's shadow map, as a fraction of its width: a filtered lookup also reads the texels around a point */
static const double SUN_MARGIN = 0.002;
/* minimum of openness (0: no sky is visible, 1: the whole sky) at any point, if the assets that the user hides are as large as
   the whole plant; proportionally lower if they are smaller */
static const double OPEN_AT_LEAST = 0.6;
/* Size of one step of a bake, for GL on the processor; a GPU bakes everything in one step. Names that end in _VERTICES: number
   of vertices, or of sample points in large triangles; in _ROWS: rows of the ground texture. SKY_: steps of bakes that include
   openness; SUN_: steps of bakes of sunlight only. */
enum { SKY_VERTICES = 4096, SUN_VERTICES = 65536, SKY_ROWS = 8, SUN_ROWS = 128 };

/* Must match shaders/bake.comp. */
struct directions_block {
    float map_from_plant[SKY_DIRECTIONS][16];
    float direction[SKY_DIRECTIONS][4];
};

struct bake {
    const struct gpu_scene *gpu_scene;
    const struct bake_programs *programs;
    const double *plant_from_ground;
    struct light_set set;
    /* assets that the plant file shows at start. Only these are drawn into the depth maps that tell from which directions of
       the sky light reaches a point, because openness is that of the whole plant, whatever users hide */
    struct visibility start;
    bool with_sky;
    struct directions_block *directions;
    GLuint sky_maps, directions_buffer, framebuffer;
    double sky_texel_m, sun_clip_from_plant[16];
    enum { BAKE_SKY_MAPS, BAKE_SUN_MAP, BAKE_GROUND, BAKE_FACES, BAKE_VERTICES, BAKE_DONE } part;
    int direction, row;
    size_t asset, place, vertex;
    /* large triangles of the current asset; light is sampled also inside them, because one vertex in a dark corner would darken the whole
       triangle */
    struct bake_faces faces;
};

bool bake_programs_init(struct bake_programs *programs, struct log *log)
{
    programs->sky = program_create(log, program_params(.compute = "bake.comp", .defines = "#define SKY\n"));
    programs->sun = program_create(log, program_params(.compute = "bake.comp"));
    programs->faces_sky = program_create(log, program_params(.compute = "bake.comp", .defines = "#define FACES\n#define SKY\n"));
    programs->faces_sun = program_create(log, program_params(.compute = "bake.comp", .defines = "#define FACES\n"));
    programs->ground_sky = program_create(log, program_params(.compute = "bake.comp", .defines = "#define GROUND\n#define SKY\n"));
    programs->ground_sun = program_create(log, program_params(.compute = "bake.comp", .defines = "#define GROUND\n"));
    return programs->sky && programs->sun && programs->faces_sky && programs->faces_sun && programs->ground_sky && programs->ground_sun;
}

void bake_programs_finish(struct bake_programs *programs)
{
    program_destroy(&programs->sky);
    program_destroy(&programs->sun);
    program_destroy(&programs->faces_sky);
    program_destroy(&programs->faces_sun);
    program_destroy(&programs->ground_sky);
    program_destroy(&programs->ground_sun);
}

void light_set_finish(struct light_set *set, const struct gpu_scene *gpu_scene)
{
    glDeleteTextures(1, &set->sun_map);
    glDeleteTextures(1, &set->ground);
    for (size_t i = 0; set->baked && i < gpu_scene->scene->asset_count; i++)
        pool_unref(&set->baked[i]);
    mem_free(set->baked);
    pool_destroy(&set->pool);
    *set = (struct light_set){ 0 };
}

/* --- maps ---------------------------------------------------------------------------------------------------------------------- */

/* Creates a depth map: a texture whose lookups compare a depth with the stored one. Points outside the map count as lit. kind:
   GL_TEXTURE_2D, or GL_TEXTURE_2D_ARRAY with `layers` layers. */
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

static int sun_map_px(const struct gpu_scene *gpu_scene)
{
    return SUN_MAP_PX < gpu_scene->gl->max_texture_px ? SUN_MAP_PX : gpu_scene->gl->max_texture_px;
}

/* Draws the depth of one asset into a depth map, if `shown` includes the asset. layer: layer of the map; -1: the map is not an
   array. error_m: largest geometric error of the level of detail that is drawn. */
static void draw_on_map(struct bake *bake, GLuint map, int layer, int size_px, const double clip_from_plant[16],
                        const struct visibility *shown, double error_m)
{
    const struct gpu_scene *gpu_scene = bake->gpu_scene;
    if (layer < 0)
        glNamedFramebufferTexture(bake->framebuffer, GL_DEPTH_ATTACHMENT, map, 0);
    else
        glNamedFramebufferTextureLayer(bake->framebuffer, GL_DEPTH_ATTACHMENT, map, 0, layer);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, bake->framebuffer);
    glViewport(0, 0, size_px, size_px);
    glEnable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    if (bake->asset == 0)
        glClear(GL_DEPTH_BUFFER_BIT);
    if (visibility_of(shown, (int)bake->asset) == ASSET_SHOWN)
        gpu_scene_draw_depth(gpu_scene, clip_from_plant, &shown->clip, (int)bake->asset, error_m, false);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
}

/* Returns the i-th of SKY_DIRECTIONS directions evenly distributed over the sphere (Fibonacci lattice). Directions from below have less
   than half the sky's brightness, because their light is reflected from the ground. */
static void sky_direction(const struct gpu_scene *gpu_scene, int i, double towards[3], float *brightness)
{
    double height = 1 - (2 * i + 1.0) / SKY_DIRECTIONS, angle = i * 2.399963229728653, flat = sqrt(1 - height * height);
    double a = flat * cos(angle), b = flat * sin(angle);
    bool y_up = gpu_scene->up[1] > 0;
    towards[0] = a;
    towards[1] = y_up ? height : b;
    towards[2] = y_up ? -b : height;
    *brightness = (float)(height > 0 ? 0.92 + 0.12 * height : 0.42);
}

static void find_directions(struct bake *bake)
{
    const struct gpu_scene *gpu_scene = bake->gpu_scene;
    double to_middle[16], matrix[16];
    bake->directions = mem_new(sizeof(*bake->directions));
    matrix_translation(gpu_scene->middle_m, to_middle);
    for (int i = 0; i < SKY_DIRECTIONS; i++) {
        double towards[3];
        sky_direction(gpu_scene, i, towards, &bake->directions->direction[i][3]);
        matrix_parallel(gpu_scene->middle_m, gpu_scene->radius_m, towards, matrix);
        matrix_texture_from_clip(matrix, matrix);
        matrix_multiply(matrix, to_middle, matrix);
        matrix_to_float(matrix, bake->directions->map_from_plant[i]);
        for (int c = 0; c < 3; c++)
            bake->directions->direction[i][c] = (float)towards[c];
    }
}

static void sky_map_bit(struct bake *bake)
{
    const struct gpu_scene *gpu_scene = bake->gpu_scene;
    double towards[3], clip_from_plant[16];
    float brightness;
    sky_direction(gpu_scene, bake->direction, towards, &brightness);
    matrix_parallel(gpu_scene->middle_m, gpu_scene->radius_m, towards, clip_from_plant);
    draw_on_map(bake, bake->sky_maps, bake->direction, SKY_MAP_PX, clip_from_plant, &bake->start, 0.5 * bake->sky_texel_m);
    if (++bake->asset < bake->gpu_scene->scene->asset_count)
        return;
    bake->asset = 0;
    if (++bake->direction == SKY_DIRECTIONS)
        bake->part = BAKE_SUN_MAP;
}

static void sun_map_bit(struct bake *bake)
{
    const struct light_set *set = &bake->set;
    draw_on_map(bake, set->sun_map, -1, sun_map_px(bake->gpu_scene), bake->sun_clip_from_plant, &set->key.shown, 0.5 * set->texel_m);
    if (++bake->asset < bake->gpu_scene->scene->asset_count)
        return;
    bake->asset = 0;
    bake->part = BAKE_GROUND;
}

/* --- light that reaches the surfaces --------------------------------------------------------------------------------------------- */

static void set_uniforms(const struct bake *bake, const double plant_from_here[16], size_t first, size_t end)
{
    double around_middle[16];
    float matrix[16], normals[9];
    const double *middle = bake->gpu_scene->middle_m, *towards = bake->set.key.towards;
    matrix_translation((double[3]){ -middle[0], -middle[1], -middle[2] }, around_middle);
    matrix_multiply(around_middle, plant_from_here, around_middle);
    matrix_to_float(around_middle, matrix);
    glUniformMatrix4fv(0, 1, GL_FALSE, matrix);
    matrix_normals(plant_from_here, normals);
    glUniformMatrix3fv(4, 1, GL_FALSE, normals);
    matrix_translation(middle, around_middle);
    matrix_multiply(bake->set.texture_from_plant, around_middle, around_middle);
    matrix_to_float(around_middle, matrix);
    glUniformMatrix4fv(1, 1, GL_FALSE, matrix);
    glUniform4f(8, (float)towards[0], (float)towards[1], (float)towards[2], (float)bake->set.texel_m);
    glUniform1f(9, (float)bake->sky_texel_m);
    glUniform2i(10, (GLint)first, (GLint)end);
    glBindTextureUnit(1, bake->sky_maps);
    glBindTextureUnit(2, bake->set.sun_map);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, bake->directions_buffer);
}

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

static void ground_bit(struct bake *bake)
{
    const struct gpu_scene *gpu_scene = bake->gpu_scene;
    int rows = !gpu_scene->gl->software ? OPENNESS_GROUND_PX : bake->with_sky ? SKY_ROWS : SUN_ROWS;
    const size_t row = OPENNESS_GROUND_PX;
    size_t first = (size_t)bake->row * row, end = smaller(first + (size_t)rows * row, row * row);
    glUseProgram(bake->with_sky ? bake->programs->ground_sky : bake->programs->ground_sun);
    set_uniforms(bake, bake->plant_from_ground, first, end);
    glUniform3f(11, (float)gpu_scene->up[0], (float)gpu_scene->up[1], (float)gpu_scene->up[2]);
    glBindImageTexture(0, bake->set.ground, 0, GL_FALSE, 0, GL_READ_WRITE, GL_RG8);
    glDispatchCompute((GLuint)(end - first + 63) / 64, 1, 1);
    bake->row += rows;
    if (bake->row >= OPENNESS_GROUND_PX)
        bake->part = bake->set.key.rough ? BAKE_VERTICES : BAKE_FACES;
}

static size_t places_in_a_bit(const struct bake *bake)
{
    return !bake->gpu_scene->gl->software ? SIZE_MAX / 2 : bake->with_sky ? SKY_VERTICES : SUN_VERTICES;
}

static void bind_vertices(const struct bake *bake)
{
    const struct gpu_mesh *mesh = &bake->gpu_scene->of_asset[bake->asset]->mesh;
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, mesh->positions);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, mesh->normals);
    const struct pool_slice *baked = bake->set.baked[bake->asset];
    glBindBufferRange(GL_SHADER_STORAGE_BUFFER, 4, baked->page->buffer, (GLintptr)pool_offset(baked), (GLsizeiptr)pool_bytes(baked));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 5, bake->faces.corners);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 6, bake->faces.sums);
}

/* Bakes light at points inside large triangles (see LARGE_FACE_TEXELS), for one step. If memory for the points runs out, light
   is sampled at vertices only. */
static void faces_bit(struct bake *bake)
{
    const struct scene_asset *asset = &bake->gpu_scene->scene->assets[bake->asset];
    double least_m = LARGE_FACE_TEXELS * bake->sky_texel_m;
    if (bake->place == 0)
        bake_faces_init(&bake->faces, bake->gpu_scene, bake->asset, least_m);
    size_t all = bake->faces.count * BAKE_FACE_SAMPLES, end = smaller(bake->place + places_in_a_bit(bake), all);
    if (all > 0) {
        glUseProgram(bake->with_sky ? bake->programs->faces_sky : bake->programs->faces_sun);
        set_uniforms(bake, asset->placement, bake->place, end);
        glUniform1f(12, (float)least_m);
        bind_vertices(bake);
        glDispatchCompute((GLuint)(end - bake->place + 63) / 64, 1, 1);
    }
    bake->place = end;
    if (end < all)
        return;
    bake->place = 0;
    bake->part = BAKE_VERTICES;
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

static double size_of(const double min_m[3], const double max_m[3])
{
    return sqrt((max_m[0] - min_m[0]) * (max_m[0] - min_m[0]) + (max_m[1] - min_m[1]) * (max_m[1] - min_m[1]) +
                (max_m[2] - min_m[2]) * (max_m[2] - min_m[2]));
}

double bake_least_open(const struct gpu_scene *gpu_scene, const struct visibility *shown)
{
    const struct scene *scene = gpu_scene->scene;
    double missing_m = shown->clip.plane_count > 0 ? gpu_scene->radius_m : 0;
    for (size_t i = 0; i < scene->asset_count; i++)
        if (visibility_of(shown, (int)i) != ASSET_SHOWN && scene->plant->assets[i].start == PLANT_START_SHOWN)
            missing_m = fmax(missing_m, size_of(scene->assets[i].bounds_min_m, scene->assets[i].bounds_max_m));
    return OPEN_AT_LEAST * fmin(missing_m / (2 * gpu_scene->radius_m), 1);
}

static void vertices_bit(struct bake *bake)
{
    const struct scene_asset *asset = &bake->gpu_scene->scene->assets[bake->asset];
    const struct gpu_mesh *mesh = &bake->gpu_scene->of_asset[bake->asset]->mesh;
    size_t end = smaller(bake->vertex + places_in_a_bit(bake), mesh->vertex_count);
    glUseProgram(bake->with_sky ? bake->programs->sky : bake->programs->sun);
    set_uniforms(bake, asset->placement, bake->vertex, end);
    glUniform1i(13, bake->faces.count > 0);
    glUniform1f(14, (float)bake_least_open(bake->gpu_scene, &bake->set.key.shown));
    bind_vertices(bake);
    glDispatchCompute((GLuint)(end - bake->vertex + 63) / 64, 1, 1);
    bake->vertex = end;
    if (end < mesh->vertex_count)
        return;
    bake->vertex = 0;
    bake_faces_finish(&bake->faces);
    bool last = ++bake->asset == bake->gpu_scene->scene->asset_count;
    bake->part = last ? BAKE_DONE : bake->set.key.rough ? BAKE_VERTICES : BAKE_FACES;
}

/* --- life ------------------------------------------------------------------------------------------------------------------------ */

size_t bake_bytes(const struct gpu_scene *gpu_scene)
{
    size_t side = (size_t)sun_map_px(gpu_scene), bytes = 2 * side * side + 2 * OPENNESS_GROUND_PX * OPENNESS_GROUND_PX;
    for (size_t i = 0; i < gpu_scene->scene->asset_count; i++)
        bytes += 4 * gpu_scene->of_asset[i]->mesh.vertex_count;
    return bytes;
}

static bool make_buffers(struct bake *bake, const struct light_set *from, struct openness *kept)
{
    const struct gpu_scene *gpu_scene = bake->gpu_scene;
    struct light_set *set = &bake->set;
    size_t assets = gpu_scene->scene->asset_count;
    size_t texels = 0;
    set->baked = mem_array(assets, sizeof(*set->baked));
    set->pool = pool_create(gpu_scene->gl->log, "light", GL_RGBA8, 4, 0);
    for (size_t i = 0; i < assets; i++)
        texels += gpu_scene->of_asset[i]->mesh.vertex_count;
    pool_expect(set->pool, texels, assets);
    for (size_t i = 0; i < assets; i++) {
        struct pool_slice *slice = set->baked[i] = pool_take(set->pool, gpu_scene->of_asset[i]->mesh.vertex_count);
        if (!slice)
            return false;
        if (set->key.rough)
            glClearNamedBufferSubData(slice->page->buffer, GL_RGBA8UI, (GLintptr)pool_offset(slice), (GLsizeiptr)pool_bytes(slice),
                                      GL_RGBA_INTEGER, GL_UNSIGNED_BYTE, (const uint8_t[]){ 0, 0, ROUGH_OPENNESS, 0 });
        if (from)
            glCopyNamedBufferSubData(from->baked[i]->page->buffer, slice->page->buffer, (GLintptr)pool_offset(from->baked[i]),
                                     (GLintptr)pool_offset(slice), (GLsizeiptr)pool_bytes(slice));
        else if (kept && !openness_upload(kept, gpu_scene, slice))
            return false;
    }
    glCreateTextures(GL_TEXTURE_2D, 1, &set->ground);
    glTextureStorage2D(set->ground, 1, GL_RG8, OPENNESS_GROUND_PX, OPENNESS_GROUND_PX);
    glTextureParameteri(set->ground, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(set->ground, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(set->ground, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    if (set->key.rough)
        glClearTexImage(set->ground, 0, GL_RG, GL_UNSIGNED_BYTE, (const uint8_t[]){ 0, ROUGH_OPENNESS });
    if (from)
        glCopyImageSubData(from->ground, GL_TEXTURE_2D, 0, 0, 0, 0, set->ground, GL_TEXTURE_2D, 0, 0, 0, 0, OPENNESS_GROUND_PX,
                           OPENNESS_GROUND_PX, 1);
    else if (kept)
        openness_upload_ground(kept, set->ground);
    return true;
}

static bool make_sky(struct bake *bake)
{
    find_directions(bake);
    bake->sky_maps = make_map(GL_TEXTURE_2D_ARRAY, SKY_MAP_PX, SKY_DIRECTIONS);
    bake->directions_buffer = mesh_buffer(bake->gpu_scene->gl->log, "sky directions", sizeof(*bake->directions), bake->directions, 0);
    return bake->directions_buffer != 0;
}

struct bake *bake_begin(const struct gpu_scene *gpu_scene, const struct bake_programs *programs, const double plant_from_ground[16],
                        const struct light_key *key, const struct light_set *from, struct openness *kept)
{
    struct bake *bake = mem_new(sizeof(*bake));
    *bake = (struct bake){ .gpu_scene = gpu_scene, .programs = programs, .plant_from_ground = plant_from_ground };
    visibility_start(gpu_scene->scene->plant, &bake->start);
    bake->with_sky = !from && !kept && !key->rough;
    struct sun_frame sun;
    int size_px = sun_map_px(gpu_scene);
    bake->part = bake->with_sky ? BAKE_SKY_MAPS : BAKE_SUN_MAP;
    bake->set.bytes = bake_bytes(gpu_scene);
    bake->sky_texel_m = 2 * gpu_scene->radius_m / SKY_MAP_PX;
    bake->set.key = *key;
    sun_frame_fit(&sun, gpu_scene, key->towards, &key->shown, SUN_MARGIN);
    memcpy(bake->sun_clip_from_plant, sun.clip_from_plant, sizeof(sun.clip_from_plant));
    matrix_texture_from_clip(sun.clip_from_plant, bake->set.texture_from_plant);
    bake->set.texel_m = sun.width_m / size_px;
    bake->set.depth_m = sun.depth_m;
    gl_pass_enter("light");
    glCreateFramebuffers(1, &bake->framebuffer);
    glNamedFramebufferDrawBuffer(bake->framebuffer, GL_NONE);
    bool good = make_buffers(bake, from, kept) && (!bake->with_sky || make_sky(bake));
    bake->set.sun_map = make_map(GL_TEXTURE_2D, size_px, 1);
    if (!gl_pass_leave(gpu_scene->gl, "light") || !good)
        bake_abandon(&bake);
    return bake;
}

const struct light_key *bake_key(const struct bake *bake)
{
    return &bake->set.key;
}

bool bake_step(struct bake *bake)
{
    switch (bake->part) {
    case BAKE_SKY_MAPS: sky_map_bit(bake); break;
    case BAKE_SUN_MAP: sun_map_bit(bake); break;
    case BAKE_GROUND: ground_bit(bake); break;
    case BAKE_FACES: faces_bit(bake); break;
    case BAKE_VERTICES: vertices_bit(bake); break;
    case BAKE_DONE: break;
    }
    return bake->part == BAKE_DONE;
}

bool bake_end(struct bake **bake_ptr, struct light_set *set)
{
    struct bake *bake = *bake_ptr;
    gl_pass_enter("light");
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    bool good = gl_pass_leave(bake->gpu_scene->gl, "light");
    if (good) {
        *set = bake->set;
        bake->set = (struct light_set){ 0 };
    }
    bake_abandon(bake_ptr);
    return good;
}

void bake_abandon(struct bake **bake_ptr)
{
    struct bake *bake = *bake_ptr;
    if (!bake)
        return;
    light_set_finish(&bake->set, bake->gpu_scene);
    bake_faces_finish(&bake->faces);
    glDeleteTextures(1, &bake->sky_maps);
    glDeleteBuffers(1, &bake->directions_buffer);
    glDeleteFramebuffers(1, &bake->framebuffer);
    mem_free(bake->directions);
    mem_free(bake);
    *bake_ptr = NULL;
}
