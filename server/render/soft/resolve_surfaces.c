/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light on surfaces without a field, eight at a time: shaders/refined.frag, light.glsl, pbr.glsl and environment.glsl once more. */
#include "render/soft/pbr.h"
#include "render/soft/section_colors.h"
#include "render/soft/surface_points.h"

SOFT_INLINE lanes srgb_from_linear(const struct refiner *refiner, lanes x)
{
    lanes at = lanes_clamp(x, 0, 1) * TONES, part = at - whole_part(at), out;
    lanes_int first = lanes_whole(at);
    for (int i = 0; i < LANES; i++)
        out[i] = refiner->tones[first[i]];
    lanes next = out;
    for (int i = 0; i < LANES; i++)
        next[i] = refiner->tones[first[i] < TONES ? first[i] + 1 : TONES];
    return out + (next - out) * part;
}

/* --- glossy ------------------------------------------------------------------------------------------------------------------- */

static uint32_t color_of_field(const struct refined *refined, const struct item *item, const struct spot *spot, size_t lane)
{
    static const struct scalar nothing = { .lacking = 255 };
    const struct soft *soft = refined->soft;
    const struct soft_mesh *mesh = &soft->meshes[item->triangle.mesh];
    struct resolve_lines lines = { soft->block.lines[0], soft->lines };
    struct resolve_place place = { .row = (uint8_t)soft->block.shade[1], .x = item->x, .y = item->y };
    for (int k = 0; k < 3; k++) {
        place.scalars[k] = mesh->scalars ? &mesh->scalars[item->triangle.vertices[k]] : &nothing;
        place.weights[k] = spot->weights[k][lane];
    }
    if (lines.line_px > 0) {
        double weights[3][3];
        soft_weights(mesh, item->triangle.vertices, weights);
        place.slopes = visibility_slopes_of(weights);
    }
    return resolve_place(soft->block.scale, soft->colormap, &lines, soft->block.scale[3], &place);
}

/* Where a glossy frame shows the field, that is the surface's colour: GLOSSY in shaders/refined.frag. Returns where. */
SOFT_INLINE lanes_int gloss(const struct refined *refined, const struct item *items, size_t count, const struct spot *spot,
                            struct surface *surface)
{
    const float *linear = refined->refiner->linear;
    lanes_int glossy = { 0 };
    for (size_t i = 0; i < count && refined->context->view->look == LOOK_GLOSSY; i++) {
        if (!refined->soft->meshes[items[i].triangle.mesh].has_field)
            continue;
        uint32_t color = color_of_field(refined, &items[i], spot, i);
        glossy[i] = -1;
        surface->base.x[i] = linear[color >> 16 & 0xff];
        surface->base.y[i] = linear[color >> 8 & 0xff];
        surface->base.z[i] = linear[color & 0xff];
    }
    surface->metallic = lanes_choose(glossy, all(0), surface->metallic);
    surface->open = lanes_choose(glossy, (float)GLOSSY_OPEN + (1 - (float)GLOSSY_OPEN) * surface->open, surface->open);
    return glossy;
}

/* --- textures ------------------------------------------------------------------------------------------------------------------ */

/* How the place on the plant changes from pixel to pixel. */
static void place_slopes(const struct refined *refined, const struct soft_triangle *triangle, const float by[3], float out[3])
{
    const struct soft_mesh *mesh = &refined->soft->meshes[triangle->mesh];
    const double *placement = refined->refiner->gpu_scene->scene->assets[mesh->asset].placement;
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

/* As mapped_normal in shaders/refined.frag. */
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
                      struct surface *surface, vec *glow)
{
    const struct soft_material *material = &refined->soft->materials[triangle->material];
    const struct asset_view *file = refined->soft->meshes[triangle->mesh].file;
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

/* What textures make of these surfaces. alphas: NULL: not asked for. */
SOFT_INLINE void wear(const struct refined *refined, const struct item *items, size_t count, const struct spot *spot,
                      struct surface *surface, vec *glow, float *alphas)
{
    for (size_t i = 0; i < count; i++) {
        const struct soft_triangle *triangle = &items[i].triangle;
        const struct soft_material *material = &refined->soft->materials[triangle->material];
        const struct soft_mesh *mesh = &refined->soft->meshes[triangle->mesh];
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

SOFT_KERNEL void refined_shade_surfaces(const struct refined *refined, const struct item *items, size_t count, uint32_t *colors,
                                        float *alphas)
{
    const struct refiner *refiner = refined->refiner;
    float bright = refined->soft->block.up[3]; /* of context; 0: as it is */
    bool greys = view_is_operator(refined->context->view);
    for (size_t first = 0; first < count; first += LANES) {
        struct spot spot;
        size_t some = count - first < LANES ? count - first : LANES;
        look(refined, items + first, some, true, &spot);
        vec v = view_of(refined, &spot), l = towards_sun(refined), n = facing(&spot, v);
        const lanes *m = spot.material;
        struct surface surface = {
            .base = { m[BASE] * spot.attributes[TINT], m[BASE + 1] * spot.attributes[TINT + 1], m[BASE + 2] * spot.attributes[TINT + 2] },
            .normal = n,
            .metallic = m[METALLIC],
            .roughness = m[ROUGHNESS],
            .open = lanes_choose(is_turned(&spot, v), most_of(spot.attributes[OPEN], all((float)OPEN_BEHIND)), spot.attributes[OPEN]),
            .sun_visible = all(0),
        };
        vec glow = { m[EMISSIVE], m[EMISSIVE + 1], m[EMISSIVE + 2] };
        if (lanes_any(dot(n, l) > 0.0f))
            surface.sun_visible = sun_at(refined, &spot, n);
        wear(refined, items + first, some, &spot, &surface, &glow, alphas ? alphas + first : NULL);
        lanes_int glossy = gloss(refined, items + first, some, &spot, &surface);
        lanes sky_part = lanes_choose(glossy, all((float)GLOSSY_SKY), all(1));
        lanes sun_part = lanes_choose(glossy, all((float)GLOSSY_SUN), all(1));
        vec c = plus(times(sky_shade(&refined->surroundings, &surface, v), sky_part), times(sun_shade(&surface, v, l), sun_part));
        c = tone_map(plus(c, glow));
        c = (vec){ srgb_from_linear(refiner, c.x), srgb_from_linear(refiner, c.y), srgb_from_linear(refiner, c.z) };
        vec muted = bright > 0 ? times(mute(c), all(bright)) : c;
        muted = greys ? grey(grey_of(muted)) : muted;
        lanes_int packed = lanes_choose_int(glossy, pack_color(c.x, c.y, c.z), pack_color(muted.x, muted.y, muted.z));
        if (lanes_any(spot.back & spot.cut)) {
            lanes_int inside = inside_color((lanes[3]){ v.x, v.y, v.z }, (lanes[3]){ spot.normal.x, spot.normal.y, spot.normal.z },
                                            refined->soft->block.up);
            packed = lanes_choose_int(spot.back & spot.cut, inside, packed);
        }
        for (size_t i = 0; i < some; i++)
            colors[first + i] = (uint32_t)packed[i];
    }
}
