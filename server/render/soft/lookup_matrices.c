/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the matrices that convert a pixel's position and depth to coordinates in the sun's shadow map, the ground texture and the
   sky. */
#include <math.h>
#include <string.h>

#include "render/soft/soft_impl.h"
#include "render/light/sky.h"
#include "render/matrix.h"

void raster_copy_columns(const double from[16], float to[4][4])
{
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++)
            to[c][r] = (float)from[4 * c + r];
}

/* Computes the matrix from (x in pixels, y in pixels, depth, 1) in the frame to clip space with w = 1. */
static void clip_from_pixel(const struct raster *raster, double out[16])
{
    matrix_identity(out);
    out[0] = 2.0 / raster->width_px;
    out[5] = -2.0 / raster->height_px;
    out[12] = -1;
    out[13] = 1;
}

static void aim_sun(struct raster *raster, const double clip[16])
{
    const struct frame_context *context = raster->context;
    double plant_from_clip[16], out[16];
    matrix_invert(context->constants.clip_from_plant, plant_from_clip);
    matrix_multiply(context->light->texture_from_plant, plant_from_clip, out);
    matrix_multiply(out, clip, out);
    for (int c = 0; c < 4; c++)
        out[4 * c + 2] += frame_sun_slack(context) * out[4 * c + 3];
    raster_copy_columns(out, raster->sun_from_pixel);
}

/* Computes raster->ray_from_pixel: a matrix from pixels to directions of view rays, like near.xyz / near.w in shaders/sky.vert.
   near.w is the same for all pixels. */
static void aim_rays(struct raster *raster, const double clip[16])
{
    double eye_from_clip[16], out[16];
    matrix_invert(raster->context->constants.clip_from_eye, eye_from_clip);
    matrix_multiply(eye_from_clip, clip, out);
    double w = out[11] + out[15]; /* clip w at depth 1 */
    if (raster->context->constants.pixel_per_metre > 0) {
        memset(raster->ray_from_pixel, 0, sizeof(raster->ray_from_pixel));
        for (int r = 0; r < 3; r++)
            raster->ray_from_pixel[2][r] = (float)-raster->context->constants.back[r];
        return;
    }
    for (int r = 0; r < 3; r++) {
        raster->ray_from_pixel[0][r] = (float)(out[r] / w);
        raster->ray_from_pixel[1][r] = (float)(out[4 + r] / w);
        raster->ray_from_pixel[2][r] = (float)((out[8 + r] + out[12 + r]) / w);
    }
}

/* Chooses raster->stretch_px: the number n of pixels over which the sky's elevation is interpolated linearly. f is the distance of eye and
   image plane in pixels. A ray's direction turns by at most 1 / f per pixel, and its second difference is at most 1.2 / f^2. So the
   interpolation deviates from the sine of a ray's elevation by at most 0.15 n^2 / f^2. */
static void choose_stretch(struct raster *raster)
{
    /* maximum error of the sky's interpolated elevation, in columns of the table of backdrop colours: half a grey level at the
       horizon, where colours change most */
    static const double most = 1;
    const float(*m)[3] = raster->ray_from_pixel;
    double step2 = 0, area2 = 0, volume = 0;
    for (int r = 0; r < 3; r++) {
        int a = (r + 1) % 3, b = (r + 2) % 3;
        double normal = (double)m[0][a] * (double)m[1][b] - (double)m[0][b] * (double)m[1][a];
        step2 += (double)m[0][r] * (double)m[0][r];
        area2 += normal * normal;
        volume += normal * (double)m[2][r];
    }
    /* 1 / f^2, where f is the distance in pixels between eye and image plane; 0: the view is orthographic, so all rays are
       parallel */
    double turn2 = step2 > 0 ? step2 * area2 / (volume * volume) : 0;
    int n = SOFT_STRETCH_MOST;
    while (n >= SOFT_STRETCH_LEAST && !(0.15 * n * n * turn2 * SKY_BACKDROPS / 2 <= most))
        n /= 2;
    raster->stretch_px = n >= SOFT_STRETCH_LEAST ? n : 1;
}

/* Computes the 3x3 matrix from pixels to texture coordinates on the ground plane. */
static void aim_ground(struct raster *raster, const struct light *light)
{
    double clip[16];
    float(*to)[3] = raster->ground_from_pixel;
    raster->has_ground = sky_sees_ground(raster->context, light);
    matrix_multiply(raster->context->constants.clip_from_plant, light->plant_from_ground, clip);
    double h[3][3]; /* homogeneous matrix from a position (u, v, 1) on the ground to the pixel (x w, y w, w), column by column */
    for (int c = 0; c < 3; c++) {
        const double *column = &clip[c == 2 ? 12 : 4 * c];
        h[0][c] = 0.5 * raster->width_px * (column[3] + column[0]);
        h[1][c] = 0.5 * raster->height_px * (column[3] - column[1]);
        h[2][c] = column[3];
    }
    double determinant = 0;
    for (int c = 0; c < 3; c++) {
        int a = (c + 1) % 3, b = (c + 2) % 3;
        determinant += h[0][c] * (h[1][a] * h[2][b] - h[1][b] * h[2][a]);
        for (int r = 0; r < 3; r++) { /* adjugate matrix */
            int p = (r + 1) % 3, q = (r + 2) % 3;
            to[c][r] = (float)(h[p][a] * h[q][b] - h[p][b] * h[q][a]);
        }
    }
    double sign = determinant < 0 ? -1 : 1, size = 0;
    for (int i = 0; i < 9; i++)
        size = fmax(size, fabs((double)to[i / 3][i % 3]));
    for (int i = 0; i < 9; i++)
        to[i / 3][i % 3] = (float)((double)to[i / 3][i % 3] * sign / size);
}

void raster_aim_cuts(struct raster *raster)
{
    float half[2] = { 0.5f * (float)raster->width_px, 0.5f * (float)raster->height_px };
    int count = raster->context->view->visibility.clip.plane_count;
    raster->cut_count = 0;
    for (int leave = 0; leave < 2; leave++) {
        for (int i = 0; i < count; i++) {
            const float *plane = raster->block.clip[i];
            float *out = raster->cuts[raster->cut_count];
            if ((plane[2] < 0) == leave)
                continue;
            out[0] = plane[0] / half[0];
            out[1] = -plane[1] / half[1];
            out[2] = plane[2];
            out[3] = plane[3] - plane[0] + plane[1] + out[0] * raster->shift_px[0] + out[1] * raster->shift_px[1];
            raster->cut_count++;
        }
        if (!leave)
            raster->entry_count = raster->cut_count;
    }
}

bool raster_is_cut_off(const struct raster *raster, const float at[4], int planes)
{
    for (int i = 0; i < planes; i++) {
        const float *plane = raster->cuts[i];
        if (plane[0] * at[0] + plane[1] * at[1] + plane[2] * at[2] + plane[3] * at[3] < 0)
            return true;
    }
    return false;
}

bool raster_cuts_box(const struct raster *raster, const struct soft_mesh *mesh, int plane, const float low[3], const float high[3],
                     bool *cut)
{
    float most = 0, least = 0;
    for (int c = 0; c < 4; c++) {
        float by = 0;
        for (int r = 0; r < 4; r++)
            by += raster->cuts[plane][r] * mesh->place[c][r];
        most += by * (c == 3 ? 1 : by > 0 ? high[c] : low[c]);
        least += by * (c == 3 ? 1 : by > 0 ? low[c] : high[c]);
    }
    *cut |= least < 0;
    return most < 0;
}

void raster_aim(struct raster *raster, const struct light *light)
{
    double clip[16];
    clip_from_pixel(raster, clip);
    aim_sun(raster, clip);
    aim_rays(raster, clip);
    choose_stretch(raster);
    aim_ground(raster, light);
}
