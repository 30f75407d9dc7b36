/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shades surfaces of refined frames, eight at a time; a C version of shaders/refined.frag, light.glsl, pbr.glsl and environment.glsl.
   resolve_field.c shades fields in all looks but the glossy one. */
#include "render/soft/kernels.h"
#include "render/soft/pbr.h"
#include "render/soft/section_colors.h"
#include "render/soft/surface_points.h"

/* --- textures ------------------------------------------------------------------------------------------------------------------ */

/* Writes the vector, in plant coordinates, from one pixel's surface point to the next pixel's. by: change of the three corner
   weights per pixel. */
static void place_slopes(const struct refined *refined, const struct soft_triangle *triangle, const float by[3], float out[3])
{
    const struct soft_mesh *mesh = &refined->raster.meshes[triangle->mesh];
    const double *placement = refined->raster.soft->gpu_scene->scene->assets[mesh->asset].placement;
    float of_file[3] = { 0 };
    for (int i = 0; i < 3; i++)
        for (int c = 0; c < 3; c++)
            of_file[c] += by[i] * mesh->file->positions_m[triangle->vertices[i]][c];
    for (int r = 0; r < 3; r++)
        out[r] = (float)placement[r] * of_file[0] + (float)placement[4 + r] * of_file[1] + (float)placement[8 + r] * of_file[2];
}

static void cross(const float a[3], const float b[3], float out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static float dot_of(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Turns the unit normal n by a texel of a normal map, like mapped_normal() in shaders/refined.frag. dx, dy: change of the
   surface point per pixel, metres; uv: from soft_spread_coordinates(). */
static void map_normal(const float dx[3], const float dy[3], float uv[3][2], const float texel[4], float scale, float n[3])
{
    float cross_y[3], cross_x[3], t[3], b[3], m[3];
    cross(dy, n, cross_y);
    cross(n, dx, cross_x);
    for (int i = 0; i < 3; i++) {
        t[i] = cross_y[i] * uv[1][0] + cross_x[i] * uv[2][0];
        b[i] = cross_y[i] * uv[1][1] + cross_x[i] * uv[2][1];
        m[i] = (2 * texel[i] - 1) * (i < 2 ? scale : 1);
    }
    float size = fmaxf(dot_of(t, t), dot_of(b, b)), turned = dot_of(dx, cross_y) < 0 ? -1 : 1;
    if (size < 1e-20f)
        return;
    float over = turned / sqrtf(size);
    for (int i = 0; i < 3; i++)
        t[i] = over * (t[i] * m[0] - b[i] * m[1]) + n[i] * m[2];
    over = 1 / sqrtf(fmaxf(dot_of(t, t), 1e-30f));
    for (int i = 0; i < 3; i++)
        n[i] = t[i] * over;
}

static void wear_maps(const struct refined *refined, const struct soft_triangle *triangle, const struct soft_spread *spread, size_t i,
                      struct pbr_surface *surface, vec *glow)
{
    const struct soft_material *material = &refined->raster.soft->materials.at[triangle->material];
    const struct asset_view *file = refined->raster.meshes[triangle->mesh].file;
    float uv[2][3][2], texels[MODEL_MAPS][4];
    soft_spread_coordinates(file->texcoords, triangle->vertices, spread, uv[0]);
    soft_spread_coordinates(file->second_texcoords, triangle->vertices, spread, uv[1]);
    for (int map = 0; map < MODEL_MAPS; map++)
        if (material->maps[map])
            soft_texture_color(material->maps[map], uv[material->of->second >> map & 1], texels[map]);
    if (material->maps[MODEL_BASE_COLOR]) {
        surface->base.x[i] *= texels[MODEL_BASE_COLOR][0];
        surface->base.y[i] *= texels[MODEL_BASE_COLOR][1];
        surface->base.z[i] *= texels[MODEL_BASE_COLOR][2];
    }
    if (material->maps[MODEL_METALLIC_ROUGHNESS]) {
        surface->roughness[i] *= texels[MODEL_METALLIC_ROUGHNESS][1];
        surface->metallic[i] *= texels[MODEL_METALLIC_ROUGHNESS][2];
    }
    if (material->maps[MODEL_NORMAL]) {
        float dx[3], dy[3], n[3] = { surface->normal.x[i], surface->normal.y[i], surface->normal.z[i] };
        place_slopes(refined, triangle, spread->by_x, dx);
        place_slopes(refined, triangle, spread->by_y, dy);
        map_normal(dx, dy, uv[material->of->second >> MODEL_NORMAL & 1], texels[MODEL_NORMAL], material->of->normal_scale, n);
        surface->normal.x[i] = n[0];
        surface->normal.y[i] = n[1];
        surface->normal.z[i] = n[2];
    }
    if (material->maps[MODEL_OCCLUSION])
        surface->open[i] *= 1 + material->of->occlusion_strength * (texels[MODEL_OCCLUSION][0] - 1);
    if (material->maps[MODEL_EMISSIVE]) {
        glow->x[i] *= texels[MODEL_EMISSIVE][0];
        glow->y[i] *= texels[MODEL_EMISSIVE][1];
        glow->z[i] *= texels[MODEL_EMISSIVE][2];
    }
}

/* Applies textures to eight surfaces: to their colours, normals and emitted light. alphas: receives their opacity, 0..1; NULL: not
   needed. */
SOFT_INLINE void wear(const struct refined *refined, const struct refined_item *items, size_t count, const struct eight_points *spot,
                      struct pbr_surface *surface, vec *glow, float *alphas)
{
    for (size_t i = 0; i < count; i++) {
        const struct soft_triangle *triangle = &items[i].triangle;
        const struct soft_material *material = &refined->raster.soft->materials.at[triangle->material];
        const struct soft_mesh *mesh = &refined->raster.meshes[triangle->mesh];
        struct soft_spread spread;
        double weights[3][3];
        if (!material->mapped && !alphas)
            continue;
        soft_weights(mesh, triangle->vertices, weights);
        soft_spread_at(weights, (double)spot->x[i], (double)spot->y[i], &spread);
        if (material->mapped)
            wear_maps(refined, triangle, &spread, i, surface, glow);
        if (alphas)
            alphas[i] = spot->back[i] & spot->cut[i] ? 1 : soft_alpha(material, mesh->file, triangle->vertices, &spread);
    }
}

/* --- light ---------------------------------------------------------------------------------------------------------------------- */

struct lit { /* eight surfaces */
    struct eight_points spot;
    struct pbr_surface surface;
    vec v, l, glow; /* v, l: unit vectors from the surface point towards the eye and the sun; glow: light that the surface emits */
};

/* Computes the surface points of eight surfaces, their material, and the visible part of the sun. alphas: receives their
   opacity, 0..1; NULL: not needed. */
SOFT_INLINE void see(const struct refined *refined, const struct refined_item *items, size_t count, struct lit *lit, float *alphas)
{
    struct eight_points *spot = &lit->spot;
    look(refined, items, count, true, spot);
    lit->v = view_of(refined, spot);
    lit->l = towards_sun(refined);
    const lanes *m = spot->material;
    vec n = facing(spot, lit->v);
    lit->surface = (struct pbr_surface){
        .base = { m[BASE] * spot->attributes[TINT], m[BASE + 1] * spot->attributes[TINT + 1], m[BASE + 2] * spot->attributes[TINT + 2] },
        .normal = n,
        .metallic = m[METALLIC],
        .roughness = m[ROUGHNESS],
        .open = lanes_choose(is_turned(spot, lit->v), most_of(spot->attributes[OPEN], all((float)OPEN_BEHIND)), spot->attributes[OPEN]),
        .sun_visible = all(0),
    };
    lit->glow = (vec){ m[EMISSIVE], m[EMISSIVE + 1], m[EMISSIVE + 2] };
    if (lanes_any(dot(n, lit->l) > 0.0f))
        lit->surface.sun_visible = sun_at(refined, spot, n);
    wear(refined, items, count, spot, &lit->surface, &lit->glow, alphas);
}

void refined_shade_surfaces(const struct refined *refined, const struct refined_item *items, size_t count, uint32_t *colors, float *alphas)
{
    const struct soft_tones *tones = refined->raster.soft->tones;
    /* brightness factor of assets without a field in the present view; 0: their brightness is unchanged */
    float bright = refined->raster.block.up[3];
    bool greys = view_is_operator(refined->context->view);
    for (size_t first = 0; first < count; first += LANES) {
        struct lit lit;
        size_t some = count - first < LANES ? count - first : LANES;
        see(refined, items + first, some, &lit, alphas ? alphas + first : NULL);
        const struct eight_points *spot = &lit.spot;
        struct sky_light sky = sky_light_at(&refined->surroundings, &lit.surface, lit.v);
        vec v = lit.v, c = plus(sky_shade(&sky, &lit.surface), sun_shade(&lit.surface, v, lit.l));
        c = tone_map(plus(c, lit.glow));
        c = (vec){ srgb_of_light(tones, c.x), srgb_of_light(tones, c.y), srgb_of_light(tones, c.z) };
        c = bright > 0 ? times(mute(c), all(bright)) : c;
        c = greys ? grey(grey_of(c)) : c;
        lanes_int packed = pack_color(c.x, c.y, c.z);
        if (lanes_any(spot->back & spot->cut)) {
            lanes_int inside = inside_color((lanes[3]){ v.x, v.y, v.z }, (lanes[3]){ spot->normal.x, spot->normal.y, spot->normal.z },
                                            refined->raster.block.up);
            packed = lanes_choose_int(spot->back & spot->cut, inside, packed);
        }
        for (size_t i = 0; i < some; i++)
            colors[first + i] = (uint32_t)packed[i];
    }
}

/* --- glossy fields --------------------------------------------------------------------------------------------------------------- */

SOFT_INLINE vec glossy_light(const struct lit *lit, const struct sky_light *sky, float white)
{
    struct pbr_surface surface = lit->surface;
    surface.base = grey(all(white));
    return plus(times(sky_shade(sky, &surface), all((float)GLOSSY_SKY)),
                times(sun_shade(&surface, lit->v, lit->l), all((float)GLOSSY_SUN)));
}

/* Stores the light that a surface reflects in two parts: the light from a black surface, and the additional light from a white one. Light
   from a non-metal is linear in the surface's colour, so the two parts give the light for every colour of the field. */
void refined_shade_gloss(const struct refined *refined, struct visibility_band *band, const struct refined_item *items, size_t count,
                         const struct shaded_items *out)
{
    for (size_t first = 0; first < count; first += LANES) {
        struct lit lit;
        size_t some = count - first < LANES ? count - first : LANES;
        see(refined, items + first, some, &lit, NULL);
        lit.surface.metallic = all(0);
        lit.surface.open = (float)GLOSSY_OPEN + (1 - (float)GLOSSY_OPEN) * lit.surface.open;
        struct sky_light sky = sky_light_at(&refined->surroundings, &lit.surface, lit.v);
        vec besides = glossy_light(&lit, &sky, 0), of_color = plus(glossy_light(&lit, &sky, 1), times(besides, all(-1)));
        besides = plus(besides, lit.glow);
        for (size_t i = 0; i < some; i++) {
            out->gloss[first + i] = (struct visibility_gloss){
                soft_pack_light((float[3]){ of_color.x[i], of_color.y[i], of_color.z[i] }),
                soft_pack_light((float[3]){ besides.x[i], besides.y[i], besides.z[i] }),
            };
            refined_keep_place(refined, band, &items[first + i], lit.spot.weights[1][i], lit.spot.weights[2][i], out, first + i);
            out->rows[first + i] = (uint8_t)refined->raster.block.shade[1];
        }
    }
}
