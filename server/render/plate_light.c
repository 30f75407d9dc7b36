/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light on surfaces, eight at a time: shaders/still.frag, light.glsl, pbr.glsl, environment.glsl and shadow.glsl once more. */
#include <math.h>
#include <string.h>

#include "render/draft_look.h"
#include "render/matrix.h"
#include "render/plate_impl.h"

typedef struct {
    lanes x, y, z;
} vec;

struct spot { /* eight of them */
    lanes attributes[8]; /* NORMAL_X ... */
    lanes material[8];
    lanes x, y, depth; /* in the picture */
    lanes weights[3];
    uint32_t vertices[LANES][3];
    lanes_int back; /* -1: looks away */
    vec normal;
};

DRAFT_INLINE lanes all(float x)
{
    return (lanes){ 0 } + x;
}

DRAFT_INLINE lanes least_of(lanes a, lanes b)
{
    return lanes_choose(a < b, a, b);
}

DRAFT_INLINE lanes most_of(lanes a, lanes b)
{
    return lanes_choose(a > b, a, b);
}

DRAFT_INLINE lanes root(lanes x)
{
    lanes out;
    for (int i = 0; i < LANES; i++)
        out[i] = sqrtf(x[i]);
    return out;
}

DRAFT_INLINE vec times(vec a, lanes by)
{
    return (vec){ a.x * by, a.y * by, a.z * by };
}

DRAFT_INLINE vec plus(vec a, vec b)
{
    return (vec){ a.x + b.x, a.y + b.y, a.z + b.z };
}

DRAFT_INLINE vec multiplied(vec a, vec b)
{
    return (vec){ a.x * b.x, a.y * b.y, a.z * b.z };
}

DRAFT_INLINE vec between(vec a, vec b, lanes part)
{
    return (vec){ a.x + (b.x - a.x) * part, a.y + (b.y - a.y) * part, a.z + (b.z - a.z) * part };
}

DRAFT_INLINE lanes dot(vec a, vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

DRAFT_INLINE vec unit(vec a)
{
    return times(a, 1.0f / root(most_of(dot(a, a), all(1e-30f))));
}

/* --- where ------------------------------------------------------------------------------------------------------------------- */

struct corners { /* of eight triangles, seen from the spots: what the weights are made of */
    float a[3][LANES], b[3][LANES]; /* to the corner, in pixels; by w where the corner has no place in the picture */
    float w[3][LANES];              /* 1/w, or 1 */
    float z[3][LANES], g[3][LANES]; /* depth times g, and g: 1, or w */
};

/* A triangle that the near plane cuts: its corners may lie behind the eye. */
static void see_cut_corner(const struct draft_mesh *mesh, uint32_t v, const struct item *item, int k, int i,
                           struct corners *out)
{
    const float *p = mesh->file->positions_m[v];
    float at[4];
    for (int r = 0; r < 4; r++)
        at[r] = mesh->place[0][r] * p[0] + mesh->place[1][r] * p[1] + mesh->place[2][r] * p[2] + mesh->place[3][r];
    out->a[k][i] = at[0] - item->x * at[3];
    out->b[k][i] = at[1] - item->y * at[3];
    out->w[k][i] = 1;
    out->z[k][i] = at[2];
    out->g[k][i] = at[3];
}

DRAFT_INLINE void see_corners(const struct plate *plate, const struct item *item, int i, struct spot *spot, struct corners *out)
{
    const struct draft *draft = plate->draft;
    const struct draft_triangle *triangle = plate_triangle(draft, item->id);
    bool is_cut = (triangle->vertices[0] | triangle->vertices[1] | triangle->vertices[2]) & EXTRA_VERTEX;
    if (is_cut) {
        const struct draft_mesh *mesh = &draft->meshes[plate->draws[triangle->mark & ~MARK_BACK].mesh];
        const struct draft_chunk *chunk = &draft->chunks[item->id >> ID_BITS];
        const uint32_t *source = mesh->file->indices + chunk->extra[triangle->vertices[0] & ~EXTRA_VERTEX].source;
        for (int k = 0; k < 3; k++) {
            spot->vertices[i][k] = mesh->first_vertex + source[k];
            see_cut_corner(mesh, source[k], item, k, i, out);
        }
        return;
    }
    for (int k = 0; k < 3; k++) {
        const struct draft_vertex *vertex = &draft->vertices[triangle->vertices[k]];
        spot->vertices[i][k] = triangle->vertices[k];
        out->a[k][i] = vertex->x - item->x;
        out->b[k][i] = vertex->y - item->y;
        out->w[k][i] = vertex->inverse_w;
        out->z[k][i] = vertex->depth;
        out->g[k][i] = 1;
    }
}

DRAFT_INLINE lanes load(const float at[LANES])
{
    return *(const lanes *)at;
}

/* Weights of the corners with perspective, kept within the triangle; the spot moves to the place that they have. */
DRAFT_INLINE void weigh(struct spot *spot, const struct corners *corners)
{
    lanes e[3], sum, depth = all(0), over = all(0), x = all(0), y = all(0);
    for (int k = 0; k < 3; k++) {
        int p = (k + 1) % 3, q = (k + 2) % 3;
        e[k] = load(corners->a[p]) * load(corners->b[q]) - load(corners->a[q]) * load(corners->b[p]);
    }
    lanes sign = lanes_choose(e[0] + e[1] + e[2] < 0.0f, all(-1), all(1));
    for (int k = 0; k < 3; k++) {
        e[k] = most_of(e[k] * sign, all(0));
        depth += e[k] * load(corners->z[k]);
        over += e[k] * load(corners->g[k]);
        x += e[k] * load(corners->a[k]);
        y += e[k] * load(corners->b[k]);
        spot->weights[k] = e[k] * load(corners->w[k]);
    }
    sum = spot->weights[0] + spot->weights[1] + spot->weights[2];
    lanes_int flat = ~((sum > 0.0f) & (over > 0.0f));
    sum = lanes_choose(flat, all(1), 1.0f / sum);
    for (int k = 0; k < 3; k++)
        spot->weights[k] = lanes_choose(flat, all(k == 0), spot->weights[k] * sum);
    over = lanes_choose(flat, all(1), 1.0f / over);
    spot->depth = lanes_choose(flat, load(corners->z[0]) / load(corners->g[0]), depth * over);
    spot->x += lanes_choose(flat, all(0), x * over);
    spot->y += lanes_choose(flat, all(0), y * over);
}

DRAFT_INLINE void turn(float rows[LANES][8], lanes columns[8])
{
    for (int c = 0; c < 8; c++)
        for (int i = 0; i < LANES; i++)
            columns[c][i] = rows[i][c];
}

/* Up to eight items; the last one fills what is left. */
DRAFT_INLINE void look(const struct plate *plate, const struct item *items, size_t count, bool with_material, struct spot *spot)
{
    struct corners corners;
    float rows[LANES][8], materials[LANES][8];
    for (int i = 0; i < LANES; i++) {
        const struct item *item = &items[(size_t)i < count ? (size_t)i : count - 1];
        see_corners(plate, item, i, spot, &corners);
        spot->x[i] = item->x;
        spot->y[i] = item->y;
        uint32_t mark = plate_triangle(plate->draft, item->id)->mark;
        spot->back[i] = mark & MARK_BACK ? -1 : 0;
        if (with_material)
            memcpy(materials[i], &plate->draws[mark & ~MARK_BACK].material, sizeof(lanes));
    }
    weigh(spot, &corners);
    for (int i = 0; i < LANES; i++) {
        lanes sum = all(0);
        for (int k = 0; k < 3; k++)
            sum += plate->attributes[spot->vertices[i][k]] * spot->weights[k][i];
        memcpy(rows[i], &sum, sizeof(sum));
    }
    turn(rows, spot->attributes);
    if (with_material)
        turn(materials, spot->material);
    spot->normal = unit((vec){ spot->attributes[NORMAL_X], spot->attributes[NORMAL_Y], spot->attributes[NORMAL_Z] });
}

DRAFT_INLINE vec view_of(const struct plate *plate, const struct spot *spot)
{
    const float(*m)[3] = plate->draft->ray_from_pixel;
    lanes ray[3];
    for (int r = 0; r < 3; r++)
        ray[r] = -(spot->x * m[0][r] + spot->y * m[1][r] + m[2][r]);
    return unit((vec){ ray[0], ray[1], ray[2] });
}

/* Two-sided surfaces from behind. */
DRAFT_INLINE vec facing(const struct spot *spot, vec view)
{
    lanes sign = lanes_choose(spot->back & (dot(spot->normal, view) < 0.0f), all(-1), all(1));
    return times(spot->normal, sign);
}

/* --- the sun ----------------------------------------------------------------------------------------------------------------- */

/* Four taps on a turned square. s, t, depth: 0..1 over the map, a step off the surface. Outside it nothing stands in the light. */
DRAFT_INLINE lanes sun_visible(const struct draft_light *light, lanes s, lanes t, lanes depth)
{
    const float spread = 1.7f / (float)light->sun_map_px, u = 0.88f * spread, v = 0.47f * spread;
    depth = lanes_clamp(depth, 0, 1);
    lanes sum = sun_tap(light, s + u, t + v, depth) + sun_tap(light, s - u, t - v, depth);
    sum += sun_tap(light, s - v, t + u, depth) + sun_tap(light, s + v, t - u, depth);
    return lanes_choose((s > 0.0f) & (s < 1.0f) & (t > 0.0f) & (t < 1.0f), 0.25f * sum, all(1));
}

DRAFT_INLINE lanes sun_at(const struct plate *plate, const struct spot *spot, vec n)
{
    const float(*m)[4] = plate->sun_from_pixel;
    const float(*step)[3] = plate->sun_from_normal;
    lanes at[4], place[3];
    for (int r = 0; r < 4; r++)
        at[r] = spot->x * m[0][r] + spot->y * m[1][r] + spot->depth * m[2][r] + m[3][r];
    lanes over = 1.0f / at[3];
    for (int r = 0; r < 3; r++)
        place[r] = at[r] * over + n.x * step[0][r] + n.y * step[1][r] + n.z * step[2][r];
    return sun_visible(plate->draft->light, place[0], place[1], place[2]);
}

DRAFT_INLINE vec towards_sun(const struct plate *plate)
{
    const float *sun = plate->draft->block.sun;
    return (vec){ all(sun[0]), all(sun[1]), all(sun[2]) };
}

/* --- the field --------------------------------------------------------------------------------------------------------------- */

static uint32_t pack_weights(float w1, float w2)
{
    return (uint32_t)(w1 * 65535 + 0.5f) | (uint32_t)(w2 * 65535 + 0.5f) << 16;
}

DRAFT_KERNEL void plate_shade_field(const struct plate *plate, struct recolor_band *band, const struct item *items, size_t count,
                                    const struct shaded_items *out)
{
    const float *shade = plate->draft->block.shade;
    for (size_t first = 0; first < count; first += LANES) {
        struct spot spot;
        size_t some = count - first < LANES ? count - first : LANES;
        look(plate, items + first, some, false, &spot);
        vec n = facing(&spot, view_of(plate, &spot));
        lanes sun = most_of(dot(n, towards_sun(plate)), all(0));
        if (lanes_any(sun > 0.0f))
            sun *= sun_at(plate, &spot, n);
        lanes light = lanes_clamp(0.52f * spot.attributes[AMBIENT] + 0.48f * sun, 0, 1);
        lanes_int row = lanes_whole(lanes_clamp(light * shade[0] + shade[1], 0, shade[2]));
        for (size_t i = 0; i < some; i++) {
            out->triangles[first + i] = recolor_triangle(band, spot.vertices[i]);
            out->weights[first + i] = pack_weights(spot.weights[1][i], spot.weights[2][i]);
            out->rows[first + i] = (uint8_t)row[i];
        }
    }
}

/* --- other surfaces ---------------------------------------------------------------------------------------------------------- */

struct brdf {
    lanes scale, bias;
};

DRAFT_INLINE struct brdf brdf_at(const struct plate_surroundings *surroundings, lanes n_v, lanes roughness)
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

DRAFT_INLINE vec sky_irradiance(const struct plate_surroundings *surroundings, vec n)
{
    lanes terms[ENVIRONMENT_TERMS] = { all(1),    n.y, n.z, n.x, n.x * n.y, n.y * n.z, 3.0f * n.z * n.z - 1.0f,
                                       n.x * n.z, n.x * n.x - n.y * n.y };
    lanes sum[3] = { all(0), all(0), all(0) };
    for (int t = 0; t < ENVIRONMENT_TERMS; t++)
        for (int c = 0; c < 3; c++)
            sum[c] += terms[t] * surroundings->irradiance[t][c];
    return (vec){ most_of(sum[0], all(0)), most_of(sum[1], all(0)), most_of(sum[2], all(0)) };
}

typedef float four __attribute__((vector_size(16), aligned(4)));

DRAFT_INLINE four texel_between(const float (*texels)[4], float x, float y)
{
    int x0 = (int)x, y0 = (int)y, right = x0 + 1 < ENVIRONMENT_PX ? 1 : 0, below = y0 + 1 < ENVIRONMENT_PX ? ENVIRONMENT_PX : 0;
    float a = x - (float)x0, b = y - (float)y0;
    const float(*at)[4] = &texels[y0 * ENVIRONMENT_PX + x0];
    four p = *(const four *)at[0], q = *(const four *)at[right], r = *(const four *)at[below], s = *(const four *)at[below + right];
    four upper = p + (q - p) * a, lower = r + (s - r) * a;
    return upper + (lower - upper) * b;
}

/* What surfaces of that roughness mirror. */
DRAFT_INLINE vec mirrored(const struct plate_surroundings *surroundings, vec r, lanes roughness)
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

DRAFT_INLINE vec grey(lanes x)
{
    return (vec){ x, x, x };
}

DRAFT_INLINE vec reflected_more(vec f0, struct brdf brdf)
{
    lanes lost = 1.0f - brdf.scale - brdf.bias;
    lanes f[3] = { f0.x, f0.y, f0.z }, out[3];
    for (int c = 0; c < 3; c++) {
        lanes mean = f[c] + (1.0f - f[c]) * (1 / 21.0f);
        out[c] = (f[c] * brdf.scale + brdf.bias) * mean / (1.0f - lost * mean) * lost;
    }
    return (vec){ out[0], out[1], out[2] };
}

DRAFT_INLINE vec sky_shade(const struct plate_surroundings *surroundings, const struct surface *s, vec v)
{
    lanes n_v = lanes_clamp(dot(s->normal, v), 0, 1), a2 = s->roughness * s->roughness;
    struct brdf brdf = brdf_at(surroundings, n_v, s->roughness);
    vec f0 = between(grey(all(0.04f)), s->base, s->metallic), diffuse = times(s->base, 1.0f - s->metallic);
    vec clear = reflected_more(grey(all(0.04f)), brdf), more = between(clear, reflected_more(s->base, brdf), s->metallic);
    vec once = plus(times(f0, brdf.scale), grey(brdf.bias));
    vec left = plus(grey(1.0f - 0.04f * brdf.scale - brdf.bias), times(clear, all(-1)));
    vec soft = multiplied(plus(more, multiplied(diffuse, left)), sky_irradiance(surroundings, s->normal));
    vec reflected = plus(times(s->normal, 2.0f * dot(s->normal, v)), times(v, all(-1)));
    vec seen = mirrored(surroundings, between(reflected, s->normal, a2), s->roughness);
    return times(plus(soft, multiplied(once, seen)), 0.55f * s->open);
}

DRAFT_INLINE lanes ggx_visible(lanes n_l, lanes n_v, lanes n_h, lanes alpha)
{
    lanes a2 = alpha * alpha, d = n_h * n_h * (a2 - 1.0f) + 1.0f;
    lanes v = 0.5f / most_of(n_l * root(n_v * n_v * (1.0f - a2) + a2) + n_v * root(n_l * n_l * (1.0f - a2) + a2), all(1e-4f));
    return a2 / (d * d) * v;
}

DRAFT_INLINE vec sun_shade(const struct surface *s, vec v, vec l)
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

DRAFT_INLINE vec tone_map(vec c)
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

DRAFT_INLINE lanes srgb_from_linear(const struct plates *plates, lanes x)
{
    lanes at = lanes_clamp(x, 0, 1) * TONES, part = at - whole_part(at), out;
    lanes_int first = lanes_whole(at);
    for (int i = 0; i < LANES; i++)
        out[i] = plates->tones[first[i]];
    lanes next = out;
    for (int i = 0; i < LANES; i++)
        next[i] = plates->tones[first[i] < TONES ? first[i] + 1 : TONES];
    return out + (next - out) * part;
}

DRAFT_INLINE lanes grey_of(vec c)
{
    return 0.30f * c.x + 0.59f * c.y + 0.11f * c.z;
}

DRAFT_INLINE vec mute(vec c)
{
    return between(between(grey(grey_of(c)), c, all(0.30f)), grey(all(0.88f)), all(0.48f));
}

DRAFT_KERNEL void plate_shade_surfaces(const struct plate *plate, const struct item *items, size_t count, uint32_t *colors)
{
    const struct plates *plates = plate->plates;
    bool muted = plate->draft->block.up[3] > 0.5f, greys = view_is_operator(plate->picture->view);
    for (size_t first = 0; first < count; first += LANES) {
        struct spot spot;
        size_t some = count - first < LANES ? count - first : LANES;
        look(plate, items + first, some, true, &spot);
        vec v = view_of(plate, &spot), l = towards_sun(plate), n = facing(&spot, v);
        const lanes *m = spot.material;
        struct surface surface = {
            .base = { m[BASE] * spot.attributes[TINT], m[BASE + 1] * spot.attributes[TINT + 1], m[BASE + 2] * spot.attributes[TINT + 2] },
            .normal = n,
            .metallic = m[METALLIC],
            .roughness = m[ROUGHNESS],
            .open = spot.attributes[OPEN],
            .sun_visible = all(0),
        };
        if (lanes_any(dot(n, l) > 0.0f))
            surface.sun_visible = sun_at(plate, &spot, n);
        vec c = plus(sky_shade(&plates->surroundings, &surface, v), sun_shade(&surface, v, l));
        c = tone_map(plus(c, (vec){ m[EMISSIVE], m[EMISSIVE + 1], m[EMISSIVE + 2] }));
        c = (vec){ srgb_from_linear(plates, c.x), srgb_from_linear(plates, c.y), srgb_from_linear(plates, c.z) };
        c = muted ? mute(c) : c;
        c = greys ? grey(grey_of(c)) : c;
        lanes_int red = lanes_whole(c.x * 255.0f + 0.5f), green = lanes_whole(c.y * 255.0f + 0.5f);
        lanes_int packed = lanes_whole(c.z * 255.0f + 0.5f) | green << 8 | red << 16;
        for (size_t i = 0; i < some; i++)
            colors[first + i] = (uint32_t)packed[i];
    }
}

/* --- sky and ground ---------------------------------------------------------------------------------------------------------- */

DRAFT_INLINE lanes margin(lanes at)
{
    lanes away = most_of(at - 0.5f, 0.5f - at), t = lanes_clamp((away - 0.5f) * (1 / (0.3f - 0.5f)), 0, 1);
    return t * t * (3.0f - 2.0f * t);
}

DRAFT_INLINE lanes open_at(const struct plate *plate, lanes u, lanes v)
{
    const uint8_t *open = plate->plates->light.open;
    int side = plate->draft->light->ground_px;
    float last = (float)side - 1;
    lanes x = lanes_clamp(u * (float)side - 0.5f, 0, last), y = lanes_clamp(v * (float)side - 0.5f, 0, last), out;
    for (int i = 0; i < LANES; i++) {
        int x0 = (int)x[i], y0 = (int)y[i], right = x0 + 1 < side ? 1 : 0, below = y0 + 1 < side ? side : 0;
        const uint8_t *at = open + y0 * side + x0;
        float a = x[i] - (float)x0, upper = at[0] + a * (float)(at[right] - at[0]);
        float lower = at[below] + a * (float)(at[below + right] - at[below]);
        out[i] = upper + (y[i] - (float)y0) * (lower - upper);
    }
    return out * (1 / 255.0f);
}

/* What shadow leaves of the ground's brightness, 0..256: shaders/ground.frag. */
DRAFT_INLINE lanes_int ground_at(const struct plate *plate, lanes x, float y)
{
    const float(*g)[3] = plate->draft->ground_from_pixel;
    const float(*m)[4] = plate->sun_from_ground;
    lanes u = x * g[0][0] + (y * g[0][1] + g[0][2]), v = x * g[1][0] + (y * g[1][1] + g[1][2]);
    lanes w = x * g[2][0] + (y * g[2][1] + g[2][2]);
    lanes over = 1.0f / lanes_choose(w > 0.0f, w, all(1)), place[3];
    u *= over;
    v *= over;
    lanes_int inside = (w > 0.0f) & (u > 0.0f) & (u < 1.0f) & (v > 0.0f) & (v < 1.0f), whole = (lanes_int){ 0 } + 256;
    if (!lanes_any(inside))
        return whole;
    for (int r = 0; r < 3; r++)
        place[r] = u * m[0][r] + v * m[1][r] + (m[3][r] + plate->ground_step[r]);
    lanes sun = sun_visible(plate->draft->light, place[0], place[1], place[2]);
    lanes dark = least_of(0.20f * (1.0f - sun) + 0.42f * (1.0f - open_at(plate, u, v)), all(0.5f));
    return lanes_choose_int(inside, lanes_whole((1.0f - margin(u) * margin(v) * dark) * 256.0f + 0.5f), whole);
}

DRAFT_KERNEL void plate_shade_sky(const struct plate *plate, int row, const uint8_t *wanted, uint32_t *colors)
{
    const struct draft *draft = plate->draft;
    struct heights heights = { 0 };
    for (int column = 0; column < draft->width_px; column += LANES) {
        uint64_t any;
        memcpy(&any, wanted + column, sizeof(any));
        if (column % STRETCH == 0)
            heights = heights_from(draft, column, row);
        if (!any)
            continue;
        lanes_int color = backdrop_at(draft, &heights, column, row);
        if (draft->has_ground)
            color = darkened(color, ground_at(plate, LANES_IOTA + ((float)column + 0.5f), (float)row + 0.5f));
        color &= 0xffffff;
        memcpy(colors + column, &color, sizeof(color));
    }
}
