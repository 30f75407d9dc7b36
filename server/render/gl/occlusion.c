/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Occlusion culling: computes bounding boxes of assets, uploads each with the range of draw commands that its test enables, and
   runs the tests. */
#include "render/gl/occlusion.h"

#include <limits.h>
#include <math.h>

#include "base/mem.h"
#include "gpu/program.h"
#include "render/matrix.h"

enum { BIND_COMMANDS = 1, BIND_PLACES = 2, STRIP_VERTICES = 14 };
/* Occlusion culling draws assets in rounds, nearest first. Before each round, it tests the bounding boxes of the round's assets
   against the depth buffer. The first round draws 1/8 of all triangles untested; each later round draws as many as all rounds
   before. */
enum { FIRST_ROUND_DIVISOR = 8 };
/* the bounding box of an asset is tested only if the asset has at least this many triangles; drawing fewer costs no more than
   the test */
static const int MIN_TESTED_TRIANGLES = 200;
/* margin around an asset's bounding box, as a fraction of the box's size, because positions are 32-bit floats */
static const double MARGIN_PART = 1e-3;
/* additional margin of an asset's bounding box, in pixels at the distance of the box's farthest corner, because GPUs round
   which pixels a triangle covers */
static const double MARGIN_PX = 1;

bool occlusion_init(struct occlusion *occlusion, struct log *log)
{
    occlusion->log = log;
    occlusion->program = program_create(log, program_params(.vertex = "occlusion.vert", .fragment = "occlusion.frag"));
    glCreateVertexArrays(1, &occlusion->vao);
    for (GLuint i = 0; i < 5; i++) {
        glEnableVertexArrayAttrib(occlusion->vao, i);
        glVertexArrayAttribBinding(occlusion->vao, i, 0);
        if (i < 4)
            glVertexArrayAttribFormat(occlusion->vao, i, 4, GL_FLOAT, GL_FALSE, 16 * i);
        else
            glVertexArrayAttribIFormat(occlusion->vao, i, 2, GL_UNSIGNED_INT, 16 * i);
    }
    glVertexArrayBindingDivisor(occlusion->vao, 0, 1);
    return occlusion->program != 0;
}

void occlusion_finish(struct occlusion *occlusion)
{
    program_destroy(&occlusion->program);
    glDeleteVertexArrays(1, &occlusion->vao);
    glDeleteBuffers(1, &occlusion->box_buffer);
    mem_free(occlusion->boxes);
    mem_free(occlusion->assets);
    *occlusion = (struct occlusion){ 0 };
}

/* --- boxes ---------------------------------------------------------------------------------------------------------------- */

static double rim_of(const struct view_constants *constants, const struct scene_asset *asset)
{
    double size = 0, distance = 0;
    for (int c = 0; c < 3; c++) {
        double low = asset->bounds_min_m[c], high = asset->bounds_max_m[c];
        double far = fmax(fabs(low - constants->eye_m[c]), fabs(high - constants->eye_m[c]));
        size += (high - low) * (high - low);
        distance += far * far;
    }
    double pixel_m = constants->pixel_per_metre > 0 ? 1 / constants->pixel_per_metre : sqrt(distance) / constants->pixel_per_radian;
    return MARGIN_PART * sqrt(size) + MARGIN_PX * pixel_m;
}

/* Computes an asset's bounding box with margins, for the occlusion test. Returns false if the box crosses the near plane, which would clip
   the box faces that the test draws. */
static bool make_box(const struct view_constants *constants, const struct scene_asset *asset, struct occlusion_box *box)
{
    double rim_m = rim_of(constants, asset), clip_from_box[16];
    double plant_from_box[16] = { [15] = 1 };
    for (int c = 0; c < 3; c++) {
        plant_from_box[5 * c] = asset->bounds_max_m[c] - asset->bounds_min_m[c] + 2 * rim_m;
        plant_from_box[12 + c] = asset->bounds_min_m[c] - rim_m;
    }
    matrix_multiply(constants->clip_from_plant, plant_from_box, clip_from_box);
    for (int corner = 0; corner < 8; corner++) {
        double clip[4];
        matrix_point(clip_from_box, (double[3]){ corner & 1, corner >> 1 & 1, corner >> 2 & 1 }, clip);
        if (clip[3] <= 0 || clip[2] >= clip[3])
            return false;
    }
    matrix_to_float(clip_from_box, box->clip_from_box);
    return true;
}

/* Adds the occlusion test of an asset. Assets whose depth is shifted towards the viewer (scene_asset.front) may be in front of
   their bounding box, so they are drawn without a test. */
static struct occlusion_asset add_asset(struct occlusion *occlusion, const struct frame_context *context, int index)
{
    const struct scene_asset *asset = &context->gpu_scene->scene->assets[index];
    struct occlusion_asset it = { .boxes_before = occlusion->box_count, .triangles = frame_level(context, index)->triangles };
    struct occlusion_box box = { 0 };
    it.tested = asset->front == 0 && it.triangles >= MIN_TESTED_TRIANGLES && make_box(&context->constants, asset, &box);
    if (!it.tested)
        return it;
    mem_grow(&occlusion->boxes, &occlusion->box_capacity, occlusion->box_count + 1, sizeof(*occlusion->boxes));
    occlusion->boxes[occlusion->box_count++] = box;
    return it;
}

/* --- a picture ------------------------------------------------------------------------------------------------------------ */

bool occlusion_begin(struct occlusion *occlusion, const struct frame_context *context, int least_triangles)
{
    size_t count = context->visible_count;
    int64_t triangles = 0;
    occlusion->box_count = occlusion->asset_count = 0;
    if (least_triangles == INT_MAX)
        return false;
    mem_grow(&occlusion->assets, &occlusion->asset_capacity, count + 1, sizeof(*occlusion->assets));
    for (size_t i = 0; i < count; i++) {
        occlusion->assets[i] = add_asset(occlusion, context, context->visible[i]);
        triangles += occlusion->assets[i].triangles;
    }
    occlusion->assets[count] = (struct occlusion_asset){ .boxes_before = occlusion->box_count };
    occlusion->asset_count = count;
    if (triangles < least_triangles)
        occlusion->box_count = occlusion->asset_count = 0;
    return occlusion->box_count > 0;
}

void occlusion_decides(struct occlusion *occlusion, const struct occlusion_asset *asset, size_t first_command, size_t count)
{
    occlusion->boxes[asset->boxes_before].first_place = (uint32_t)first_command;
    occlusion->boxes[asset->boxes_before].place_count = (uint32_t)count;
}

bool occlusion_upload(struct occlusion *occlusion)
{
    if (!draw_batches_refill(occlusion->log, &occlusion->box_buffer, &occlusion->box_room, occlusion->box_count * sizeof(*occlusion->boxes),
                             occlusion->boxes))
        return false;
    glVertexArrayVertexBuffer(occlusion->vao, 0, occlusion->box_buffer, 0, sizeof(struct occlusion_box));
    return true;
}

size_t occlusion_round(const struct occlusion *occlusion, size_t first)
{
    int64_t before = 0, all = 0, here = 0;
    size_t end = first;
    for (size_t i = 0; i < occlusion->asset_count; i++) {
        all += occlusion->assets[i].triangles;
        before += i < first ? occlusion->assets[i].triangles : 0;
    }
    int64_t enough = first > 0 ? before : all / FIRST_ROUND_DIVISOR;
    while (end < occlusion->asset_count && (end == first || here < enough))
        here += occlusion->assets[end++].triangles;
    return end - first;
}

void occlusion_test(const struct occlusion *occlusion, const struct draw_batches *batches, size_t first, size_t end)
{
    size_t first_box = occlusion->assets[first].boxes_before, count = occlusion->assets[end].boxes_before - first_box;
    if (count == 0)
        return;
    glUseProgram(occlusion->program);
    glBindVertexArray(occlusion->vao);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, BIND_COMMANDS, batches->command_buffer);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, BIND_PLACES, batches->place_buffer);
    glDisable(GL_CULL_FACE);
    glPolygonOffset(0, 0);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDepthMask(GL_FALSE);
    glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, STRIP_VERTICES, (GLsizei)count, (GLuint)first_box);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glBindBuffersBase(GL_SHADER_STORAGE_BUFFER, BIND_COMMANDS, 2, NULL);
    glMemoryBarrier(GL_COMMAND_BARRIER_BIT);
}
