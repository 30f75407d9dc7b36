/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Copies a baked light set from the GPU to main memory, for the software renderer. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/system/huge_pages.h"
#include "render/soft/soft_impl.h"

/* The sun's shadow map is read from the GPU in bands of 2 MB. Height of a band: SUN_BAND_TILES in tiles, SUN_BAND_ROWS in texels. */
enum { SUN_BAND_TILES = 32, SUN_BAND_ROWS = SUN_BAND_TILES * SUN_TILE_STEP_PX + 1 };

static bool fail(const struct soft *soft, const char *what)
{
    log_err(soft->gpu_scene->gl->log, "cannot draw pictures of a moving camera: %s cannot be read back from the GPU: out of memory", what);
    return false;
}

/* --- light ------------------------------------------------------------------------------------------------------------------ */

void soft_free_light(const struct soft *soft, struct soft_light *light)
{
    for (size_t i = 0; light->baked && i < soft->gpu_scene->scene->asset_count; i++)
        mem_free(light->baked[i]);
    mem_free(light->baked);
    mem_free(light->sun_map);
    mem_free(light->sun_bounds);
    mem_free(light->ground);
    mem_free(light->open);
    *light = (struct soft_light){ 0 };
}

static bool read_baked(const struct soft *soft, struct soft_light *light, const struct light_set *set)
{
    const struct gpu_scene *gpu_scene = soft->gpu_scene;
    light->baked = mem_array(gpu_scene->scene->asset_count, sizeof(*light->baked));
    for (size_t i = 0; i < gpu_scene->scene->asset_count; i++) {
        size_t vertices = gpu_scene->of_asset[i]->mesh.vertex_count;
        light->baked[i] = mem_try_array(vertices, 4);
        if (!light->baked[i])
            return fail(soft, "light");
        glGetNamedBufferSubData(set->baked[i]->page->buffer, (GLintptr)pool_offset(set->baked[i]), (GLsizeiptr)(4 * vertices),
                                light->baked[i]);
    }
    return true;
}

struct sun_band { /* one band of the sun's shadow map: its rows of texels, and the first row of the next band */
    uint16_t *rows;
    int width_px, row_count;
};

/* Copies the texels of tile (u, v) of the shadow map. The map's last row and column serve as their own lower and right
   neighbours. Returns the tile's smallest and largest depth, as in soft_light.sun_bounds. */
static uint32_t fill_sun_tile(const struct sun_band *band, int u, int v, uint16_t *to)
{
    static const uint16_t nothing[SUN_TILE_TEXELS];
    const int last_u = band->width_px - 1, last_v = band->row_count - 1;
    uint16_t texels[SUN_TILE_TEXELS];
    for (int y = 0; y < SUN_TILE_PX; y++) {
        const uint16_t *row = band->rows + (size_t)(v + y < last_v ? v + y : last_v) * (size_t)band->width_px;
        uint16_t *out = texels + y * SUN_TILE_PX;
        if (u + SUN_TILE_PX <= band->width_px)
            memcpy(out, row + u, SUN_TILE_PX * sizeof(*out));
        else
            for (int x = 0; x < SUN_TILE_PX; x++)
                out[x] = row[u + x < last_u ? u + x : last_u];
    }
    if (memcmp(texels, nothing, sizeof(texels)) == 0)
        return 0; /* a tile without surfaces is not written; both of its bounds (smallest and largest depth) are 0 */
    memcpy(to, texels, sizeof(texels));
    return soft_sun_bounds(texels);
}

/* Reads the shadow map band by band through one buffer. Tiles without any surface are not written: untouched zero pages cost no memory, and
   skipping them halves the time for a half-empty map. */
static void fill_sun_tiles(struct soft_light *light, GLuint map, struct sun_band *band)
{
    const int size = light->sun_map_px, tiles = light->sun_tiles;
    uint16_t *to = light->sun_map;
    uint32_t *bounds = light->sun_bounds;
    for (int first = 0; first < tiles; first += SUN_BAND_TILES) {
        const int begin = first * SUN_TILE_STEP_PX, count = tiles - first < SUN_BAND_TILES ? tiles - first : SUN_BAND_TILES;
        band->row_count = size - begin < SUN_BAND_ROWS ? size - begin : SUN_BAND_ROWS;
        glGetTextureSubImage(map, 0, 0, begin, 0, size, band->row_count, 1, GL_DEPTH_COMPONENT, GL_UNSIGNED_SHORT,
                             (GLsizei)(sizeof(*band->rows) * (size_t)size * (size_t)band->row_count), band->rows);
        for (int tile = 0; tile < count * tiles; tile++, to += SUN_TILE_TEXELS)
            *bounds++ = fill_sun_tile(band, tile % tiles * SUN_TILE_STEP_PX, tile / tiles * SUN_TILE_STEP_PX, to);
    }
}

static bool read_sun_map(const struct soft *soft, struct soft_light *light, GLuint map)
{
    GLint size = 0;
    glGetTextureLevelParameteriv(map, 0, GL_TEXTURE_WIDTH, &size);
    light->sun_map_px = size;
    light->sun_tiles = (size + SUN_TILE_STEP_PX - 1) / SUN_TILE_STEP_PX;
    const size_t bytes = soft_sun_map_bytes(light);
    struct sun_band band = { .rows = mem_try_array((size_t)size * SUN_BAND_ROWS, sizeof(*band.rows)), .width_px = size };
    light->sun_map = mem_try_array(bytes, 1);
    light->sun_bounds = mem_try_array(soft_sun_bounds_bytes(light), 1);
    huge_pages_advise(light->sun_map, bytes);
    bool good = band.rows && light->sun_map && light->sun_bounds;
    if (good) {
        glPixelStorei(GL_PACK_ALIGNMENT, 2);
        fill_sun_tiles(light, map, &band);
        glPixelStorei(GL_PACK_ALIGNMENT, 4);
    }
    mem_free(band.rows);
    return good || fail(soft, "shadows");
}

static double margin(double at)
{
    double t = fmin(fmax((fabs(at - 0.5) - 0.5) / (0.3 - 0.5), 0), 1);
    return t * t * (3 - 2 * t);
}

/* Returns the brightness of a ground texel, 0..255, like shaders/ground.frag. light: sunlight, and openness (visible part of
   the sky); u, v: position on the ground, 0..1. */
static uint8_t ground_factor(const uint8_t light[2], double u, double v)
{
    double dark = fmin(GROUND_SUN * (1 - light[0] / 255.0) + GROUND_SKY * (1 - light[1] / 255.0), GROUND_MOST);
    return (uint8_t)lround(255 * (1 - margin(u) * margin(v) * dark));
}

static bool read_ground(const struct soft *soft, struct soft_light *light, GLuint ground)
{
    GLint size = 0;
    glGetTextureLevelParameteriv(ground, 0, GL_TEXTURE_WIDTH, &size);
    size_t side = (size_t)size;
    uint8_t(*texels)[2] = mem_try_array(side * side, sizeof(*texels)), *factors = mem_try_array(side * side, 1);
    light->ground_px = size;
    light->ground = mem_try_array(side * side, sizeof(*light->ground));
    light->open = mem_try_array(side * side, 1);
    bool good = texels && factors && light->ground && light->open;
    if (good) {
        glGetTextureImage(ground, 0, GL_RG, GL_UNSIGNED_BYTE, (GLsizei)(side * side * 2), texels);
        for (size_t i = 0; i < side * side; i++) {
            light->open[i] = texels[i][1];
            factors[i] = ground_factor(texels[i], ((double)(i % side) + 0.5) / (double)side, ((double)(i / side) + 0.5) / (double)side);
        }
        for (size_t i = 0; i < side * side; i++) {
            size_t right = i % side + 1 < side ? 1 : 0, below = i / side + 1 < side ? side : 0;
            light->ground[i] = factors[i] | (uint32_t)factors[i + right] << 8 | (uint32_t)factors[i + below] << 16 |
                               (uint32_t)factors[i + right + below] << 24;
        }
    }
    mem_free(texels);
    mem_free(factors);
    return good || fail(soft, "the ground");
}

const struct soft_light *soft_get_light(struct soft *soft, const struct light_set *set)
{
    struct soft_light *oldest = &soft->lights[0];
    for (int i = 0; i < SOFT_LIGHTS; i++) {
        struct soft_light *light = &soft->lights[i];
        if (light->id == set->id) {
            light->used = ++soft->uses;
            return light;
        }
        if (light->used < oldest->used)
            oldest = light;
    }
    soft_free_light(soft, oldest);
    oldest->id = set->id;
    oldest->used = ++soft->uses;
    if (read_baked(soft, oldest, set) && read_sun_map(soft, oldest, set->sun_map) && read_ground(soft, oldest, set->ground))
        return oldest;
    soft_free_light(soft, oldest);
    return NULL;
}
