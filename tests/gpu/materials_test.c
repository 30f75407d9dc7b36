/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares materials with glTF's reflectance model, integrated in double precision. The scene is a grid of spheres from rough
   to smooth and from dielectric to metal, lit by surroundings from a file or by the sun. Also tests white spheres in white
   surroundings (white furnace test), which must be indistinguishable from the background. */
#include "tests/support/test.h"

#include "tests/support/cielab.h"
#include "tests/support/no_textures.h"
#include "tests/support/rig.h"

enum { STEPS = 5, SPHERES = STEPS * STEPS, SIDE_PX = 64, /* STEPS: largest value of `steps` */
        WIDTH = 256, HEIGHT = 128, SAMPLES = 400 };
/* SKY_LIGHT, SUN_LIGHT: brightness factors, the same as in shaders/environment.glsl; SPACE_M: distance in metres between the
   centres of the spheres */
static const double SKY_LIGHT = 0.55, SUN_LIGHT = 0.78, SPACE_M = 8;
static struct rig rig;
static int steps, spheres; /* steps: number of different roughness values, and of metallic values; spheres: steps * steps */

struct scene_of {
    struct stand stand;
    struct asset_material materials[SPHERES];
    char *folder, *path;
    double (*radiance)(const double towards[3], int channel);
    double level[3]; /* light from the whole surroundings on a horizontal white surface (irradiance / pi), per colour channel */
};

/* --- surroundings ---------------------------------------------------------------------------------------------------------------- */

static double white(const double towards[3], int channel)
{
    (void)towards;
    (void)channel;
    return 3;
}

/* Returns the radiance of test surroundings in a direction: blue above, brown below, and a wide warm lamp on one side. */
static double room(const double towards[3], int channel)
{
    static const double above[3] = { 0.7, 0.9, 1.2 }, below[3] = { 0.35, 0.30, 0.25 }, lamp[3] = { 3.0, 2.6, 1.8 };
    double up = 0.5 + 0.5 * towards[2], at = 0.8 * towards[0] - 0.48 * towards[1] + 0.36 * towards[2];
    return below[channel] + (above[channel] - below[channel]) * up + lamp[channel] * exp(12 * (at - 1));
}

/* Writes surroundings as a Radiance HDR file, whose pixels are three mantissas with a common exponent. The middle column shows
   the direction +x. */
static void write_hdr(const char *path, double (*radiance)(const double[3], int))
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fprintf(file, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n", HEIGHT, WIDTH);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        double down = M_PI * (i / WIDTH + 0.5) / HEIGHT, turn = 2 * M_PI * (i % WIDTH + 0.5) / WIDTH - M_PI;
        double towards[3] = { sin(down) * cos(turn), -sin(down) * sin(turn), cos(down) }, most = 0, c[3];
        for (int k = 0; k < 3; k++)
            most = fmax(most, c[k] = radiance(towards, k));
        int exponent = (int)ceil(log2(most + 1e-9));
        for (int k = 0; k < 3; k++)
            fputc((int)fmin(c[k] / ldexp(1, exponent) * 256, 255), file);
        fputc(exponent + 128, file);
    }
    fclose(file);
}

/* Returns the centre of sphere i; spheres are staggered so that none shadows another from any of the few light directions. */
static const double *place_of(int i)
{
    static double place[3];
    place[0] = SPACE_M * (i % steps);
    place[1] = 2 * (i * 7 % steps);
    place[2] = SPACE_M * (i / steps) + 0.9 * (i % steps);
    return place;
}

static void scene_init(struct scene_of *scene, double (*radiance)(const double[3], int), const double base[3])
{
    struct toy *toy = toy_create();
    struct test_shape shape = { .materials = scene->materials, .material_count = (size_t)spheres };
    *scene = (struct scene_of){ .radiance = radiance };
    for (int i = 0; i < spheres; i++) {
        scene->materials[i] = (struct asset_material){ .base_color = { (float)base[0], (float)base[1], (float)base[2], 1 },
                                                       .metallic = (float)(i / steps) / (float)(steps - 1),
                                                       .roughness = 0.1f + 0.9f * (float)(i % steps) / (float)(steps - 1),
                                                       .normal_scale = 1,
                                                       .occlusion_strength = 1,
                                                       NO_TEXTURES };
        shape_sphere(&shape, (uint32_t)i, place_of(i), 0.5, 64);
    }
    toy_add(toy, "spheres", &shape, (double[3]){ 0, 0, 0 }, NULL, 0);
    char *path = temp_path(temp_folder(), "room.hdr");
    write_hdr(path, radiance);
    toy->plant.display.environments[0] = (struct plant_environment){ .name = (char *)"room", .path = path };
    toy->plant.display.environment_count = 1;
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            double down = M_PI * (i / WIDTH + 0.5) / HEIGHT, turn = 2 * M_PI * (i % WIDTH + 0.5) / WIDTH;
            double towards[3] = { sin(down) * cos(turn), sin(down) * sin(turn), cos(down) };
            scene->level[c] += fmax(towards[2], 0) * radiance(towards, c) * sin(down) * 2 * M_PI / WIDTH / HEIGHT;
        }
    stand_init(&scene->stand, &rig, toy);
}

static void scene_finish(struct scene_of *scene)
{
    stand_finish(&scene->stand);
}

/* Draws sphere i with an orthographic camera that looks from -y, so that a pixel's column and row give x and z of the point on
   the sphere. */
static struct frame *draw_sphere(struct scene_of *scene, int i, const double sun[3])
{
    struct view view;
    const double *at = place_of(i);
    view_default(&scene->stand.toy->scene, SIDE_PX, SIDE_PX, &view);
    assert_int_equal(view.environment, 1);
    view.look = LOOK_MATERIALS;
    view.camera = (struct camera){
        .eye_m = { at[0], -5, at[2] }, .target_m = { at[0], 0, at[2] }, .up = { 0, 0, 1 }, .fov_deg = 45, .height_m = 1.1 };
    memcpy(view.light_dir, sun, sizeof(view.light_dir));
    return stand_draw(&scene->stand, &view);
}

/* --- reference: the expected colour of a sphere ---------------------------------------------------------------------------------- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double radical_inverse(int i)
{
    double part = 0.5, sum = 0;
    for (; i; i >>= 1, part *= 0.5)
        sum += (i & 1) * part;
    return sum;
}

static void around(const double n[3], double cosine, double turn, double out[3])
{
    double t[3] = { -n[1], n[0], 0 }, size = hypot(n[0], n[1]), flat = sqrt(fmax(1 - cosine * cosine, 0));
    if (size < 1e-6)
        t[0] = size = 1;
    t[0] /= size, t[1] /= size;
    const double b[3] = { n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0] };
    for (int c = 0; c < 3; c++)
        out[c] = n[c] * cosine + flat * (cos(turn) * t[c] + sin(turn) * b[c]);
}

static double smith(double n_l, double n_v, double a2)
{
    return 0.5 / (n_l * sqrt(n_v * n_v * (1 - a2) + a2) + n_v * sqrt(n_l * n_l * (1 - a2) + a2));
}

/* Computes the expected reflection of the surroundings by the glTF 2.0 specification, appendix B: single reflection, plus light
   that enters a dielectric and leaves it again. The result is scaled to compensate for multiple reflection between rough facets
   (Turquin, "Practical multiple scattering compensation for microfacet models"). */
static void reflected_sky(const struct scene_of *scene, const struct asset_material *m, const double n[3], const double v[3], double out[3])
{
    double alpha = m->roughness * m->roughness, a2 = alpha * alpha, n_v = dot(n, v), all = 0, once = 0;
    double clear[3] = { 0 }, metal[3] = { 0 }, soft[3] = { 0 };
    for (int i = 0; i < SAMPLES; i++) {
        double part = (i + 0.5) / SAMPLES, h[3], l[3], turn = 2 * M_PI * radical_inverse(i);
        around(n, sqrt((1 - part) / (1 + (a2 - 1) * part)), turn, h);
        double v_h = dot(v, h), n_h = dot(n, h);
        for (int c = 0; c < 3; c++)
            l[c] = 2 * v_h * h[c] - v[c];
        double n_l = dot(n, l);
        if (n_l > 0 && v_h > 0) {
            double weight = 4 * smith(n_l, n_v, a2) * n_l * v_h / n_h / SAMPLES, x = pow(1 - v_h, 5);
            all += weight;
            once += weight * (0.04 + 0.96 * x);
            for (int c = 0; c < 3; c++) {
                double light = weight * scene->radiance(l, c) / scene->level[c];
                clear[c] += light * (0.04 + 0.96 * x);
                metal[c] += light * (m->base_color[c] + (1 - m->base_color[c]) * x);
            }
        }
        around(n, sqrt(1 - part), turn, l);
        for (int c = 0; c < 3; c++)
            soft[c] += scene->radiance(l, c) / scene->level[c] / SAMPLES;
    }
    double more = (1 - all) / all, let_in = 1 - once * (1 + 0.04 * more);
    for (int c = 0; c < 3; c++) {
        double base = m->base_color[c];
        out[c] = SKY_LIGHT * ((1 - m->metallic) * (clear[c] * (1 + 0.04 * more) + base * let_in * soft[c]) +
                              m->metallic * metal[c] * (1 + base * more));
    }
}

static void reflected_sun(const struct asset_material *m, const double n[3], const double v[3], const double l[3], double out[3])
{
    double alpha = m->roughness * m->roughness, a2 = alpha * alpha, n_l = dot(n, l), n_v = dot(n, v), h[3], size;
    for (int c = 0; c < 3; c++)
        h[c] = v[c] + l[c];
    size = sqrt(dot(h, h));
    double n_h = dot(n, h) / size, v_h = dot(v, h) / size, d = n_h * n_h * (a2 - 1) + 1;
    for (int c = 0; c < 3 && n_l > 0; c++) {
        double f0 = 0.04 + (m->base_color[c] - 0.04) * m->metallic, grazing = pow(1 - v_h, 5), fresnel = f0 + (1 - f0) * grazing;
        double diffuse = m->base_color[c] * (1 - m->metallic) * (1 - (0.04 + 0.96 * grazing));
        out[c] += SUN_LIGHT * n_l * (diffuse + a2 / (d * d) * smith(n_l, n_v, a2) * fresnel);
    }
}

/* Converts a colour to what is shown: Khronos PBR Neutral tone mapping, then sRGB from 0 to 255. */
static void shown(double c[3])
{
    double least = fmin(c[0], fmin(c[1], c[2])), offset = least < 0.08 ? least - 6.25 * least * least : 0.04, peak;
    for (int i = 0; i < 3; i++)
        c[i] -= offset;
    peak = fmax(c[0], fmax(c[1], c[2]));
    if (peak >= 0.76) {
        double now = 1 - 0.24 * 0.24 / (peak - 0.52), grey = 1 - 1 / (0.15 * (peak - now) + 1);
        for (int i = 0; i < 3; i++)
            c[i] = c[i] * now / peak * (1 - grey) + now * grey;
    }
    for (int i = 0; i < 3; i++)
        c[i] = 255 * (c[i] <= 0.0031308 ? 12.92 * c[i] : 1.055 * pow(c[i], 1 / 2.4) - 0.055);
}

static double difference(const uint8_t *bgrx, const double want[3])
{
    double a[3], b[3];
    lab_of((const uint8_t[3]){ bgrx[2], bgrx[1], bgrx[0] }, false, a);
    lab_of_rgb(want, false, b);
    return lab_distance(a, b);
}

/* Computes the sphere's normal at a pixel. Returns false if the pixel is outside the sphere or near its rim. */
static bool normal_at(int x, int y, double n[3])
{
    n[0] = ((x + 0.5) / SIDE_PX - 0.5) * 1.1 / 0.5;
    n[2] = (0.5 - (y + 0.5) / SIDE_PX) * 1.1 / 0.5;
    double square = n[0] * n[0] + n[2] * n[2];
    n[1] = -sqrt(fmax(1 - square, 0));
    return square < 0.92 * 0.92;
}

/* Draws sphere i and returns the mean CIELAB difference between its pixels and the reference. */
static double compare(struct scene_of *scene, int i, const double sun[3])
{
    const double v[3] = { 0, -1, 0 };
    double sum = 0;
    int count = 0;
    struct frame *frame = draw_sphere(scene, i, sun);
    for (int y = 2; y < SIDE_PX; y += 4)
        for (int x = 2; x < SIDE_PX; x += 4) {
            double n[3], want[3];
            /* skips pixels that the sun grazes (within about 7 degrees of the surface), because its soft shadow begins there */
            if (!normal_at(x, y, n) || fabs(dot(n, sun)) < 0.12)
                continue;
            reflected_sky(scene, &scene->materials[i], n, v, want);
            reflected_sun(&scene->materials[i], n, v, sun, want);
            shown(want);
            sum += difference(frame_pixel(frame, x, y), want);
            count++;
        }
    frame_unref(&frame);
    return sum / count;
}

/* --- tests ------------------------------------------------------------------------------------------------------------------------- */

static const double from_behind[3] = { 0, 1, 0 }, from_the_left[3] = { -0.6, -0.64, 0.48 };

TEST(test_grid)
{
    struct scene_of scene;
    double all[2] = { 0 }, worst[2] = { 0 };
    scene_init(&scene, room, (double[3]){ 0.8, 0.45, 0.2 });
    for (int i = 0; i < spheres; i++)
        for (int lit = 0; lit < 2; lit++) {
            double mean = compare(&scene, i, lit ? from_the_left : from_behind);
            if (mean > 2)
                print_message("# metallic %.2f, roughness %.2f, %s: CIELAB difference %.2f\n", (double)scene.materials[i].metallic,
                              (double)scene.materials[i].roughness, lit ? "in the sun" : "in the shade", mean);
            all[lit] += mean / spheres;
            worst[lit] = fmax(worst[lit], mean);
        }
    print_message("# mean CIELAB difference %.2f in the shade, %.2f in the sun; of the worst sphere %.2f, %.2f\n", all[0], all[1], worst[0],
                  worst[1]);
    scene_finish(&scene);
    assert_true(all[0] <= 2 && all[1] <= 2 && worst[0] <= 4 && worst[1] <= 4);
}

/* Under light that is equal from all directions, a white sphere must be as bright as the light everywhere, also at its rim. */
TEST(test_white_furnace)
{
    struct scene_of scene;
    double want[3] = { SKY_LIGHT, SKY_LIGHT, SKY_LIGHT }, worst = 0;
    int off = 0, all = 0;
    scene_init(&scene, white, (double[3]){ 1, 1, 1 });
    shown(want);
    for (int i = 0; i < spheres; i++) {
        struct frame *frame = draw_sphere(&scene, i, from_behind);
        for (int y = 0; y < SIDE_PX; y++)
            for (int x = 0; x < SIDE_PX; x++) {
                double n[3];
                for (int c = 0; c < 3 && normal_at(x, y, n); c++, all++) {
                    double by = fabs(frame_pixel(frame, x, y)[c] - want[c]) / want[c];
                    worst = fmax(worst, by);
                    off += by > 0.03;
                }
            }
        frame_unref(&frame);
    }
    print_message("# white in white: %.1f %% of the pixels off by more than 3 %%, the worst by %.1f %%\n", 100.0 * off / all, 100 * worst);
    scene_finish(&scene);
    /* 4 % of the pixels may be off, because a neighbouring sphere hides one of the few directions in which the sky is sampled
       */
    assert_true(off <= 0.04 * all && worst <= 0.07);
}

/* A dark, smooth dielectric reflects a few percent in its middle and much more at its rim. */
TEST(test_rim_mirrors)
{
    struct scene_of scene;
    scene_init(&scene, white, (double[3]){ 0, 0, 0 });
    struct frame *frame = test_frame(draw_sphere(&scene, 0, from_behind));
    const uint8_t *middle = frame_pixel(frame, SIDE_PX / 2, SIDE_PX / 2), *rim = frame_pixel(frame, SIDE_PX * 94 / 100, SIDE_PX / 2);
    double want[3], n[3];
    const double v[3] = { 0, -1, 0 };
    assert_true(normal_at(SIDE_PX / 2, SIDE_PX / 2, n));
    reflected_sky(&scene, &scene.materials[0], n, v, want);
    shown(want);
    print_message("# middle %d (wanted %.1f), rim %d\n", middle[1], want[1], rim[1]);
    assert_true(fabs(middle[1] - want[1]) <= 3 && rim[1] > 2 * middle[1]);
    scene_finish(&scene);
}

int main(void)
{
    steps = sweep(STEPS, 3);
    spheres = steps * steps;
    return rig_run(&rig);
}
