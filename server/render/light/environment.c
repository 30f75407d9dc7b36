/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Convolves environment maps (pictures of the surroundings) into irradiance and prefiltered reflections, on worker threads. */
#include "render/light/environment.h"

#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "render/light/ggx.h"

/* size in pixels of the image of the built-in sky. The sky varies with elevation only, so a few columns are enough for
   computing its spherical harmonics */
enum { SKY_WIDTH = 8, SKY_HEIGHT = 256 };
enum { BASE_PX = 256, PYRAMID = 6, SAMPLES = 128 };
/* Radiance is clipped at this multiple of the environment map's mean radiance. Brighter spots are the sun or lamps, and the
   renderer adds the sun as a separate light. */
static const double MAX_RADIANCE_FACTOR = 24;
/* Width and height in pixels of the reflection map for each level of roughness. Reflections on rough surfaces are blurred, so
   their maps are computed at low resolution and enlarged. */
static const int layer_px[ENVIRONMENT_LAYERS] = { 128, 128, 128, 64, 64, 32, 32, 32 };

/* An environment map being processed. pixels: an equirectangular image. pyramid: octahedral maps in plant axes made from it, each level
   half the size of the previous one. */
struct environment_source {
    const float (*pixels)[4];
    int width, height;
    /* y_up: true: +y is up in the plant, false: +z; even: true: radiance depends on elevation only, as in the built-in sky */
    bool y_up, even;
    /* factor: exposure and white balance, by colour channel; most: limit of the brightest channel's radiance before the factor
       is applied */
    double factor[3], most;
    float (*pyramid[PYRAMID])[4];
};

/* --- directions ---------------------------------------------------------------------------------------------------------------- */

/* Returns the direction of a texel's centre in the octahedral reflection maps (the array `mirrored`). */
static void texel_direction(int x, int y, int side_px, double towards[3])
{
    double u = (2.0 * x) / (side_px - 1) - 1, v = (2.0 * y) / (side_px - 1) - 1, z = 1 - fabs(u) - fabs(v);
    if (z < 0) {
        double old = u;
        u = copysign(1 - fabs(v), u);
        v = copysign(1 - fabs(old), v);
    }
    double size = sqrt(u * u + v * v + z * z);
    towards[0] = u / size;
    towards[1] = v / size;
    towards[2] = z / size;
}

/* Returns the texel coordinates of a direction in an octahedral map of side_px x side_px texels: each 0 to side_px - 1. */
static void texel_of(const double towards[3], int side_px, double *x, double *y)
{
    double sum = fabs(towards[0]) + fabs(towards[1]) + fabs(towards[2]), u = towards[0] / sum, v = towards[1] / sum;
    if (towards[2] < 0) {
        double old = u;
        u = copysign(1 - fabs(v), u);
        v = copysign(1 - fabs(old), v);
    }
    *x = 0.5 * (u + 1) * (side_px - 1);
    *y = 0.5 * (v + 1) * (side_px - 1);
}

static void bilinear(const float (*texels)[4], int width, int height, double x, double y, bool wrap, double out[3])
{
    int x0 = (int)floor(x), y0 = (int)floor(y);
    double fx = x - x0, fy = y - y0;
    int left = wrap ? (x0 + width) % width : x0 < 0 ? 0 : x0, right = wrap ? (x0 + 1 + width) % width : x0 + 1 < width ? x0 + 1 : width - 1;
    int above = y0 < 0 ? 0 : y0, below = y0 + 1 < height ? y0 + 1 : height - 1;
    const float *a = texels[above * width + left], *b = texels[above * width + right], *c = texels[below * width + left],
                *d = texels[below * width + right];
    for (int i = 0; i < 3; i++)
        out[i] = (1 - fy) * ((1 - fx) * a[i] + fx * b[i]) + fy * ((1 - fx) * c[i] + fx * d[i]);
}

/* --- the source ------------------------------------------------------------------------------------------------------------------ */

/* Radiance of the built-in sky by elevation: bright at the horizon, bluer above, over a light ground. */
static void sky_color(double height, float out[4])
{
    static const double horizon[3] = { 1.13, 1.12, 1.10 }, zenith[3] = { 0.86, 0.96, 1.06 }, ground[3] = { 0.43, 0.42, 0.41 };
    double above = fmin(fmax((height + 0.03) / 0.06, 0), 1), up = sqrt(fmax(height, 0)), band = exp(-pow((height - 0.16) / 0.12, 2));
    above = above * above * (3 - 2 * above);
    for (int i = 0; i < 3; i++) {
        double sky = horizon[i] + (zenith[i] - horizon[i]) * up + 0.45 * band;
        out[i] = (float)(ground[i] + (sky - ground[i]) * above);
    }
    out[3] = 1;
}

static float (*make_sky(void))[4]
{
    float(*pixels)[4] = mem_array(SKY_WIDTH * SKY_HEIGHT, sizeof(*pixels));
    for (int i = 0; i < SKY_WIDTH * SKY_HEIGHT; i++)
        sky_color(cos(M_PI * (i / SKY_WIDTH + 0.5) / SKY_HEIGHT), pixels[i]);
    return pixels;
}

/* Returns the direction, in plant axes, of the centre of a pixel of the equirectangular image. */
static void pixel_direction(const struct environment_source *source, int x, int y, double towards[3])
{
    double down = M_PI * (y + 0.5) / source->height, turn = 2 * M_PI * (x + 0.5) / source->width - M_PI;
    double a = sin(down) * cos(turn), b = -sin(down) * sin(turn), height = cos(down);
    towards[0] = a;
    towards[1] = source->y_up ? height : b;
    towards[2] = source->y_up ? -b : height;
}

static void clipped(const struct environment_source *source, const float pixel[4], double out[3])
{
    double peak = 0, scale = 1;
    for (int i = 0; i < 3; i++) {
        out[i] = isfinite(pixel[i]) && pixel[i] > 0 ? pixel[i] : 0;
        peak = fmax(peak, out[i]);
    }
    if (peak > source->most)
        scale = source->most / peak;
    for (int i = 0; i < 3; i++)
        out[i] *= scale * source->factor[i];
}

/* Writes the real spherical harmonics up to order 2 in the direction n, without their constant factors (term_factors). */
static void terms_of(const double n[3], double terms[ENVIRONMENT_TERMS])
{
    const double all[ENVIRONMENT_TERMS] = {
        1, n[1], n[2], n[0], n[0] * n[1], n[1] * n[2], 3 * n[2] * n[2] - 1, n[0] * n[2], n[0] * n[0] - n[1] * n[1]
    };
    memcpy(terms, all, sizeof(all));
}

/* For each spherical harmonic of terms_of(): the square of its constant factor, times the cosine lobe's coefficient for its
   order, divided by pi (Ramamoorthi and Hanrahan, 2001). */
static const double term_factors[ENVIRONMENT_TERMS] = {
    0.079577472,
    0.238732415 * 2 / 3,
    0.238732415 * 2 / 3,
    0.238732415 * 2 / 3,
    1.092548431 * 1.092548431 / 4,
    1.092548431 * 1.092548431 / 4,
    0.315391565 * 0.315391565 / 4,
    1.092548431 * 1.092548431 / 4,
    0.546274215 * 0.546274215 / 4,
};

struct sums {
    double harmonic[ENVIRONMENT_TERMS][3], level[3], mean, solid_angle;
};

static void add_up(const struct environment_source *source, struct sums *sums)
{
    int up = source->y_up ? 1 : 2;
    *sums = (struct sums){ 0 };
    for (int y = 0; y < source->height; y++) {
        double weight = 2 * M_PI / source->width * (cos(M_PI * y / source->height) - cos(M_PI * (y + 1) / source->height));
        for (int x = 0; x < source->width; x++) {
            double towards[3], terms[ENVIRONMENT_TERMS], color[3];
            pixel_direction(source, x, y, towards);
            clipped(source, source->pixels[y * source->width + x], color);
            terms_of(towards, terms);
            sums->solid_angle += weight;
            sums->mean += weight * fmax(color[0], fmax(color[1], color[2]));
            for (int c = 0; c < 3; c++) {
                sums->level[c] += weight * fmax(towards[up], 0) * color[c] / M_PI;
                for (int t = 0; t < ENVIRONMENT_TERMS; t++)
                    sums->harmonic[t][c] += weight * terms[t] * color[c];
            }
        }
    }
    sums->mean /= sums->solid_angle;
}

/* Clips bright spots of the environment map, then applies exposure and white balance. Returns false if no light comes from above. */
static bool expose(struct environment_source *source, struct environment *environment)
{
    struct sums sums;
    for (int i = 0; i < 3; i++)
        source->factor[i] = 1;
    source->most = INFINITY;
    add_up(source, &sums);
    source->most = MAX_RADIANCE_FACTOR * sums.mean;
    add_up(source, &sums);
    for (int i = 0; i < 3; i++) {
        if (!(sums.level[i] > 1e-9))
            return false;
        source->factor[i] = 1 / sums.level[i];
    }
    for (int t = 0; t < ENVIRONMENT_TERMS; t++)
        for (int c = 0; c < 3; c++)
            environment->irradiance[t][c] = (float)(sums.harmonic[t][c] * term_factors[t] * source->factor[c]);
    return true;
}

static void source_radiance(const struct environment_source *source, const double towards[3], double out[3])
{
    double height = source->y_up ? towards[1] : towards[2], b = source->y_up ? -towards[2] : towards[1], pixels[3];
    double x = (atan2(-b, towards[0]) + M_PI) / (2 * M_PI) * source->width - 0.5;
    double y = acos(fmin(fmax(height, -1), 1)) / M_PI * source->height - 0.5;
    bilinear(source->pixels, source->width, source->height, x, y, true, pixels);
    clipped(source, (float[4]){ (float)pixels[0], (float)pixels[1], (float)pixels[2], 1 }, out);
}

/* --- mirrored light ------------------------------------------------------------------------------------------------------------- */

struct environment_job {
    struct environment_source *source;
    float (*out)[4];
    int side_px, layer;
    const struct lobe *lobe; /* sample rays of the roughness layer; NULL for layer 0, a perfect mirror */
};

/* Returns the index of the texel from which texel `i` copies its light; `i` itself if it must be computed. In a sky whose light
   depends on elevation only, the octahedral map consists of eight equal triangles or, with y up, of two equal halves, of which
   one is computed. */
static size_t twin_of(const struct environment_source *source, int side_px, size_t i)
{
    int x = (int)(i % (size_t)side_px), y = (int)(i / (size_t)side_px);
    if (!source->even)
        return i;
    x = x < side_px - 1 - x ? x : side_px - 1 - x;
    if (!source->y_up) {
        y = y < side_px - 1 - y ? y : side_px - 1 - y;
        return (size_t)(x < y ? x * side_px + y : y * side_px + x);
    }
    return (size_t)(y * side_px + x);
}

static void copy_to_twins(const struct environment_source *source, int side_px, float (*texels)[4])
{
    for (size_t i = 0; source->even && i < (size_t)side_px * (size_t)side_px; i++)
        memcpy(texels[i], texels[twin_of(source, side_px, i)], sizeof(*texels));
}

/* Fills rows of the finest level of source->pyramid: each texel is the mean of 4 x 4 points of the environment map. */
static void base_rows(void *arg, size_t begin, size_t end)
{
    struct environment_job *job = arg;
    for (size_t i = begin * BASE_PX; i < end * BASE_PX; i++) {
        double sum[3] = { 0 };
        if (twin_of(job->source, BASE_PX, i) != i)
            continue;
        for (int k = 0; k < 16; k++) {
            double towards[3], color[3];
            texel_direction((int)(i % BASE_PX) * 4 + k % 4, (int)(i / BASE_PX) * 4 + k / 4, BASE_PX * 4, towards);
            source_radiance(job->source, towards, color);
            for (int c = 0; c < 3; c++)
                sum[c] += color[c] / 16;
        }
        for (int c = 0; c < 3; c++)
            job->out[i][c] = (float)sum[c];
        job->out[i][3] = 1;
    }
}

static void make_pyramid(struct environment_source *source, struct workers *workers)
{
    struct environment_job job = { .source = source };
    for (int level = 0, side = BASE_PX; level < PYRAMID; level++, side /= 2) {
        float(*to)[4] = source->pyramid[level] = mem_array((size_t)side * (size_t)side, sizeof(*to));
        if (level == 0) {
            job.out = to;
            workers_for(workers, BASE_PX, 8, base_rows, &job);
            copy_to_twins(source, BASE_PX, to);
            continue;
        }
        const float(*from)[4] = (const float(*)[4])source->pyramid[level - 1];
        for (int i = 0; i < side * side; i++)
            for (int c = 0; c < 4; c++) {
                int at = (i / side) * 4 * side + (i % side) * 2;
                to[i][c] = 0.25f * (from[at][c] + from[at + 1][c] + from[at + 2 * side][c] + from[at + 2 * side + 1][c]);
            }
    }
}

static void frame_of(const double n[3], double t[3], double b[3])
{
    const double other[3] = { fabs(n[2]) < 0.7 ? 0 : 1, 0, fabs(n[2]) < 0.7 ? 1 : 0 };
    vec_cross(other, n, t);
    vec_normalize(t);
    vec_cross(n, t, b);
}

/* Returns the level of source->pyramid whose texels cover about the solid angle that one sample ray represents. alpha: roughness squared;
   n_h: cosine between normal and half vector. */
static int level_of(double alpha, double n_h)
{
    double d = n_h * n_h * (alpha * alpha - 1) + 1, density = alpha * alpha / (M_PI * d * d) / 4;
    double texel = 4 * M_PI / (BASE_PX * BASE_PX), sample = 1 / (SAMPLES * density);
    int level = (int)lround(0.5 * log2(fmax(sample / texel, 1)));
    return level < PYRAMID - 1 ? level : PYRAMID - 1;
}

struct lobe { /* sample rays relative to the surface normal; the same for all texels of one roughness layer */
    int count, level[SAMPLES];
    double n_l[SAMPLES], flat[SAMPLES], cosine[SAMPLES], sine[SAMPLES];
};

static void make_lobe(double alpha, struct lobe *lobe)
{
    lobe->count = 0;
    for (unsigned i = 0; i < SAMPLES; i++) {
        double n_h = ggx_cosine(alpha, (i + 0.5) / SAMPLES), angle = 2 * M_PI * ggx_turn(i), n_l = 2 * n_h * n_h - 1;
        int k = lobe->count;
        if (n_l <= 0)
            continue;
        lobe->n_l[k] = n_l;
        lobe->flat[k] = 2 * n_h * sqrt(1 - n_h * n_h);
        lobe->cosine[k] = cos(angle);
        lobe->sine[k] = sin(angle);
        lobe->level[k] = level_of(alpha, n_h);
        lobe->count++;
    }
}

static void mirror(const struct environment_source *source, const struct lobe *lobe, const double n[3], double out[3])
{
    double t[3], b[3], sum[3] = { 0 }, all = 0;
    frame_of(n, t, b);
    for (int i = 0; i < lobe->count; i++) {
        double n_l = lobe->n_l[i], towards[3], x, y, color[3];
        for (int c = 0; c < 3; c++)
            towards[c] = n_l * n[c] + lobe->flat[i] * (lobe->cosine[i] * t[c] + lobe->sine[i] * b[c]);
        int level = lobe->level[i], side = BASE_PX >> level;
        texel_of(towards, side, &x, &y);
        bilinear((const float(*)[4])source->pyramid[level], side, side, x, y, false, color);
        for (int c = 0; c < 3; c++)
            sum[c] += n_l * color[c];
        all += n_l;
    }
    for (int c = 0; c < 3; c++)
        out[c] = sum[c] / all;
}

static void layer_rows(void *arg, size_t begin, size_t end)
{
    struct environment_job *job = arg;
    for (size_t i = begin * (size_t)job->side_px; i < end * (size_t)job->side_px; i++) {
        double towards[3], color[3], x, y;
        if (twin_of(job->source, job->side_px, i) != i)
            continue;
        texel_direction((int)(i % (size_t)job->side_px), (int)(i / (size_t)job->side_px), job->side_px, towards);
        if (job->layer == 0) {
            texel_of(towards, BASE_PX / 2, &x, &y);
            bilinear((const float(*)[4])job->source->pyramid[1], BASE_PX / 2, BASE_PX / 2, x, y, false, color);
        } else {
            mirror(job->source, job->lobe, towards, color);
        }
        for (int c = 0; c < 3; c++)
            job->out[i][c] = (float)color[c];
        job->out[i][3] = 1;
    }
}

static void make_layer(struct environment_source *source, struct workers *workers, int layer, float (*out)[4])
{
    int side = layer_px[layer];
    bool small = side < ENVIRONMENT_PX;
    double roughness = (double)layer / (ENVIRONMENT_LAYERS - 1);
    struct lobe lobe;
    make_lobe(roughness * roughness, &lobe);
    struct environment_job job = { .source = source, .side_px = side, .layer = layer, .lobe = &lobe };
    job.out = small ? mem_array((size_t)side * (size_t)side, sizeof(*job.out)) : out;
    workers_for(workers, (size_t)side, 4, layer_rows, &job);
    copy_to_twins(source, side, job.out);
    for (int i = 0; small && i < ENVIRONMENT_PX * ENVIRONMENT_PX; i++) {
        double scale = (side - 1.0) / (ENVIRONMENT_PX - 1), color[3];
        bilinear((const float(*)[4])job.out, side, side, i % ENVIRONMENT_PX * scale, i / ENVIRONMENT_PX * scale, false, color);
        for (int c = 0; c < 3; c++)
            out[i][c] = (float)color[c];
        out[i][3] = 1;
    }
    if (small)
        mem_free(job.out);
}

bool environment_init(struct environment *environment, const struct image_float *image, bool y_up, struct workers *workers)
{
    float(*sky)[4] = image ? NULL : make_sky();
    struct environment_source source = { .pixels = image ? (const float(*)[4])image->rgba : (const float(*)[4])sky,
                                         .width = image ? (int)image->width_px : SKY_WIDTH,
                                         .height = image ? (int)image->height_px : SKY_HEIGHT,
                                         .y_up = y_up,
                                         .even = !image };
    *environment = (struct environment){ 0 };
    bool good = expose(&source, environment);
    if (good) {
        environment->mirrored = mem_array(ENVIRONMENT_LAYERS * ENVIRONMENT_PX * ENVIRONMENT_PX, sizeof(*environment->mirrored));
        make_pyramid(&source, workers);
        for (int layer = 0; layer < ENVIRONMENT_LAYERS; layer++)
            make_layer(&source, workers, layer, environment->mirrored + (size_t)layer * ENVIRONMENT_PX * ENVIRONMENT_PX);
    }
    for (int i = 0; i < PYRAMID; i++)
        mem_free(source.pyramid[i]);
    mem_free(sky);
    return good;
}

void environment_finish(struct environment *environment)
{
    mem_free(environment->mirrored);
    *environment = (struct environment){ 0 };
}
