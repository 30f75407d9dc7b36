/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light on surfaces without a field, eight at a time: shaders/refined.frag, light.glsl, pbr.glsl and environment.glsl once more. */
#include "render/soft/section_colors.h"
#include "render/soft/surface_points.h"

static const float OPEN_BEHIND = 0.7f; /* as in shaders/refined.frag */

struct brdf {
    lanes scale, bias;
};

SOFT_INLINE struct brdf brdf_at(const struct refined_surroundings *surroundings, lanes n_v, lanes roughness)
{
    struct brdf out;
    lanes u = lanes_clamp(n_v * BRDF_PX - 0.5f, 0, BRDF_PX - 1), v = lanes_clamp(roughness * BRDF_PX - 0.5f, 0, BRDF_PX - 1);
    for (int i = 0; i < LANES; i++) {
        int x = (int)u[i], y = (int)v[i], right = x + 1 < BRDF_PX ? 1 : 0, below = y + 1 < BRDF_PX ? BRDF_PX : 0;
        float a = u[i] - (float)x, b = v[i] - (float)y;
        const float(*texel)[2] = &surroundings->brdf[y * BRDF_PX + x];
        float at[2];
        for (int c = 0; c < 2; c++) {
            float upper = texel[0][c] + a * (texel[right][c] - texel[0][c]);
            float lower = texel[below][c] + a * (texel[below + right][c] - texel[below][c]);
            at[c] = upper + b * (lower - upper);
        }
        out.scale[i] = at[0];
        out.bias[i] = at[1];
    }
    return out;
}

SOFT_INLINE vec sky_irradiance(const struct refined_surroundings *surroundings, vec n)
{
    lanes terms[ENVIRONMENT_TERMS] = {
        all(1), n.y, n.z, n.x, n.x * n.y, n.y * n.z, 3.0f * n.z * n.z - 1.0f, n.x * n.z, n.x * n.x - n.y * n.y
    };
    lanes sum[3] = { all(0), all(0), all(0) };
    for (int t = 0; t < ENVIRONMENT_TERMS; t++)
        for (int c = 0; c < 3; c++)
            sum[c] += terms[t] * surroundings->irradiance[t][c];
    return (vec){ most_of(sum[0], all(0)), most_of(sum[1], all(0)), most_of(sum[2], all(0)) };
}

typedef float four __attribute__((vector_size(16), aligned(4)));

SOFT_INLINE four texel_between(const float (*texels)[4], float x, float y)
{
    int x0 = (int)x, y0 = (int)y, right = x0 + 1 < ENVIRONMENT_PX ? 1 : 0, below = y0 + 1 < ENVIRONMENT_PX ? ENVIRONMENT_PX : 0;
    float a = x - (float)x0, b = y - (float)y0;
    const float(*at)[4] = &texels[y0 * ENVIRONMENT_PX + x0];
    four p = *(const four *)at[0], q = *(const four *)at[right], r = *(const four *)at[below], s = *(const four *)at[below + right];
    four upper = p + (q - p) * a, lower = r + (s - r) * a;
    return upper + (lower - upper) * b;
}

/* What surfaces of that roughness mirror. */
SOFT_INLINE vec mirrored(const struct refined_surroundings *surroundings, vec r, lanes roughness)
{
    const float(*texels)[4] = (const float(*)[4])surroundings->texels;
    const float side = ENVIRONMENT_PX, layers = ENVIRONMENT_LAYERS;
    lanes ax = most_of(r.x, -r.x), ay = most_of(r.y, -r.y), az = most_of(r.z, -r.z), over = 1.0f / (ax + ay + az);
    lanes u = r.x * over, v = r.y * over, one = all(1);
    lanes folded_u = (one - most_of(v, -v)) * lanes_choose(u >= 0.0f, one, -one);
    lanes folded_v = (one - most_of(u, -u)) * lanes_choose(v >= 0.0f, one, -one);
    u = lanes_choose(r.z < 0.0f, folded_u, u);
    v = lanes_choose(r.z < 0.0f, folded_v, v);
    u = lanes_clamp((u * 0.5f + 0.5f) * (side - 1), 0, side - 1);
    v = lanes_clamp((v * 0.5f + 0.5f) * (side - 1), 0, side - 1);
    lanes layer = lanes_clamp(roughness * (layers - 1), 0, layers - 1);
    vec out;
    for (int i = 0; i < LANES; i++) {
        int upper = (int)layer[i], lower = upper + 1 < ENVIRONMENT_LAYERS ? upper + 1 : upper;
        four a = texel_between(texels + upper * ENVIRONMENT_PX * ENVIRONMENT_PX, u[i], v[i]);
        four b = texel_between(texels + lower * ENVIRONMENT_PX * ENVIRONMENT_PX, u[i], v[i]);
        a += (b - a) * (layer[i] - (float)upper);
        out.x[i] = a[0];
        out.y[i] = a[1];
        out.z[i] = a[2];
    }
    return out;
}

struct surface {
    vec base, normal;
    lanes metallic, roughness, open, sun_visible;
};

SOFT_INLINE vec grey(lanes x)
{
    return (vec){ x, x, x };
}

SOFT_INLINE vec reflected_more(vec f0, struct brdf brdf)
{
    lanes lost = 1.0f - brdf.scale - brdf.bias;
    lanes f[3] = { f0.x, f0.y, f0.z }, out[3];
    for (int c = 0; c < 3; c++) {
        lanes mean = f[c] + (1.0f - f[c]) * (1 / 21.0f);
        out[c] = (f[c] * brdf.scale + brdf.bias) * mean / (1.0f - lost * mean) * lost;
    }
    return (vec){ out[0], out[1], out[2] };
}

SOFT_INLINE vec sky_shade(const struct refined_surroundings *surroundings, const struct surface *s, vec v)
{
    lanes n_v = lanes_clamp(dot(s->normal, v), 0, 1), a2 = s->roughness * s->roughness;
    struct brdf brdf = brdf_at(surroundings, n_v, s->roughness);
    vec f0 = between(grey(all(0.04f)), s->base, s->metallic), diffuse = times(s->base, 1.0f - s->metallic);
    vec clear = reflected_more(grey(all(0.04f)), brdf), more = between(clear, reflected_more(s->base, brdf), s->metallic);
    vec once = plus(times(f0, brdf.scale), grey(brdf.bias));
    vec left = plus(grey(1.0f - 0.04f * brdf.scale - brdf.bias), times(clear, all(-1)));
    vec diffused = multiplied(plus(more, multiplied(diffuse, left)), sky_irradiance(surroundings, s->normal));
    vec reflected = plus(times(s->normal, 2.0f * dot(s->normal, v)), times(v, all(-1)));
    vec seen = mirrored(surroundings, between(reflected, s->normal, a2), s->roughness);
    return times(plus(diffused, multiplied(once, seen)), 0.55f * s->open);
}

SOFT_INLINE lanes ggx_visible(lanes n_l, lanes n_v, lanes n_h, lanes alpha)
{
    lanes a2 = alpha * alpha, d = n_h * n_h * (a2 - 1.0f) + 1.0f;
    lanes v = 0.5f / most_of(n_l * root(n_v * n_v * (1.0f - a2) + a2) + n_v * root(n_l * n_l * (1.0f - a2) + a2), all(1e-4f));
    return a2 / (d * d) * v;
}

SOFT_INLINE vec sun_shade(const struct surface *s, vec v, vec l)
{
    lanes n_v = most_of(dot(s->normal, v), all(1e-3f)), n_l = most_of(dot(s->normal, l), all(0));
    lanes roughness = most_of(s->roughness, all(0.1f));
    vec h = unit(plus(v, l)), f0 = between(grey(all(0.04f)), s->base, s->metallic), diffuse = times(s->base, 1.0f - s->metallic);
    lanes x = 1.0f - most_of(dot(v, h), all(0)), x2 = x * x;
    lanes grazing = x2 * x2 * x;
    vec fresnel = between(f0, grey(all(1)), grazing);
    lanes lobe = least_of(ggx_visible(n_l, n_v, most_of(dot(s->normal, h), all(0)), roughness * roughness), all(50));
    vec c = plus(times(diffuse, 0.96f - 0.96f * grazing), times(fresnel, lobe));
    return times(c, n_l * s->sun_visible * 0.78f);
}

SOFT_INLINE vec tone_map(vec c)
{
    const float start = 0.8f - 0.04f, desaturation = 0.15f, d = 1 - start;
    lanes x = least_of(c.x, least_of(c.y, c.z)), off = lanes_choose(x < 0.08f, x - 6.25f * x * x, all(0.04f));
    c = plus(c, grey(-off));
    lanes peak = most_of(c.x, most_of(c.y, c.z)), safe = most_of(peak, all(start));
    lanes new_peak = 1.0f - d * d / (safe + d - start), part = 1.0f - 1.0f / (desaturation * (safe - new_peak) + 1.0f);
    vec rolled = between(times(c, new_peak / safe), grey(new_peak), part);
    lanes_int low = peak < start;
    return (vec){ lanes_choose(low, c.x, rolled.x), lanes_choose(low, c.y, rolled.y), lanes_choose(low, c.z, rolled.z) };
}

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

SOFT_INLINE lanes grey_of(vec c)
{
    return 0.30f * c.x + 0.59f * c.y + 0.11f * c.z;
}

SOFT_INLINE vec mute(vec c)
{
    return between(grey(grey_of(c)), grey(all(0.88f)), all(0.48f));
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
    surface->open = lanes_choose(glossy, 0.3f + 0.7f * surface->open, surface->open);
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
            .open = lanes_choose(is_turned(&spot, v), most_of(spot.attributes[OPEN], all(OPEN_BEHIND)), spot.attributes[OPEN]),
            .sun_visible = all(0),
        };
        vec glow = { m[EMISSIVE], m[EMISSIVE + 1], m[EMISSIVE + 2] };
        if (lanes_any(dot(n, l) > 0.0f))
            surface.sun_visible = sun_at(refined, &spot, n);
        wear(refined, items + first, some, &spot, &surface, &glow, alphas ? alphas + first : NULL);
        lanes_int glossy = gloss(refined, items + first, some, &spot, &surface);
        lanes sky_part = lanes_choose(glossy, all(1.45f), all(1)), sun_part = lanes_choose(glossy, all(0.75f), all(1));
        vec c = plus(times(sky_shade(&refiner->surroundings, &surface, v), sky_part), times(sun_shade(&surface, v, l), sun_part));
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
