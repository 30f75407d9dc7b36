/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Boxes, the commands that they switch on, and the buffers of both. */
#include "render/occlusion.h"

#include <limits.h>
#include <math.h>

#include "base/mem.h"
#include "gpu/mesh.h"
#include "gpu/program.h"
#include "render/matrix.h"
#include "render/solid.h"

enum { BIND_COMMANDS = 1, STRIP_VERTICES = 14 };
enum { FIRST_PART = 8 };              /* of all triangles: drawn before anything is tested; then as many as until then */
static const int BOX_TRIANGLES = 200; /* an asset of fewer costs no more than its box */
static const double RIM_PART = 1e-3;  /* of its size, all round: places are 32-bit floats */
static const double RIM_PX = 1;       /* likewise, where it is farthest: what covers a sample is found to parts of a pixel */

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
    glDeleteBuffers(1, &occlusion->command_buffer);
    mem_free(occlusion->boxes);
    mem_free(occlusion->commands);
    mem_free(occlusion->assets);
    *occlusion = (struct occlusion){ 0 };
}

/* --- boxes ---------------------------------------------------------------------------------------------------------------- */

static double rim_of(const struct shot *shot, const struct scene_asset *asset)
{
    double size = 0, distance = 0;
    for (int c = 0; c < 3; c++) {
        double low = asset->bounds_min_m[c], high = asset->bounds_max_m[c];
        double far = fmax(fabs(low - shot->eye_m[c]), fabs(high - shot->eye_m[c]));
        size += (high - low) * (high - low);
        distance += far * far;
    }
    double pixel_m = shot->pixel_per_metre > 0 ? 1 / shot->pixel_per_metre : sqrt(distance) / shot->pixel_per_radian;
    return RIM_PART * sqrt(size) + RIM_PX * pixel_m;
}

/* False: some of it lies before the near plane, where its faces would be missing. */
static bool make_box(const struct shot *shot, const struct scene_asset *asset, struct occlusion_box *box)
{
    double rim_m = rim_of(shot, asset), clip_from_box[16];
    double plant_from_box[16] = { [15] = 1 };
    for (int c = 0; c < 3; c++) {
        plant_from_box[5 * c] = asset->bounds_max_m[c] - asset->bounds_min_m[c] + 2 * rim_m;
        plant_from_box[12 + c] = asset->bounds_min_m[c] - rim_m;
    }
    matrix_multiply(shot->clip_from_plant, plant_from_box, clip_from_box);
    for (int corner = 0; corner < 8; corner++) {
        double clip[4];
        matrix_point(clip_from_box, (double[3]){ corner & 1, corner >> 1 & 1, corner >> 2 & 1 }, clip);
        if (clip[3] <= 0 || clip[2] >= clip[3])
            return false;
    }
    matrix_to_float(clip_from_box, box->clip_from_box);
    return true;
}

static void add_commands(struct occlusion *occlusion, const struct model_level *level)
{
    for (size_t b = 0; b < level->batch_count; b++) {
        const struct model_batch *batch = &level->batches[b];
        mem_grow(&occlusion->commands, &occlusion->command_capacity, occlusion->command_count + (size_t)batch->draws,
                 sizeof(*occlusion->commands));
        for (GLsizei d = 0; d < batch->draws; d++)
            occlusion->commands[occlusion->command_count++] =
                (struct occlusion_command){ .count = (uint32_t)batch->counts[d],
                                            .first_index = (uint32_t)((uintptr_t)batch->offsets[d] / 4) };
    }
}

/* What is brought forward where faces coincide may come out of its box: that is drawn in any case. */
static struct occlusion_asset add_asset(struct occlusion *occlusion, const struct picture *picture, int index)
{
    const struct scene_asset *asset = &picture->stage->scene->assets[index];
    const struct model_level *level = solid_level(picture, index);
    struct occlusion_asset it = { .boxes_before = occlusion->box_count, .first_command = occlusion->command_count };
    struct occlusion_box box = { .first_command = (uint32_t)occlusion->command_count };
    for (size_t b = 0; b < level->batch_count; b++)
        it.triangles += level->batches[b].triangles;
    it.tested = asset->front == 0 && it.triangles >= BOX_TRIANGLES && make_box(&picture->shot, asset, &box);
    if (!it.tested)
        return it;
    add_commands(occlusion, level);
    box.command_count = (uint32_t)(occlusion->command_count - it.first_command);
    mem_grow(&occlusion->boxes, &occlusion->box_capacity, occlusion->box_count + 1, sizeof(*occlusion->boxes));
    occlusion->boxes[occlusion->box_count++] = box;
    return it;
}

/* --- a picture ------------------------------------------------------------------------------------------------------------ */

static bool upload(struct occlusion *occlusion, GLuint *buffer, size_t *room, size_t bytes, const void *data)
{
    if (*room < bytes) {
        glDeleteBuffers(1, buffer);
        *room = bytes + bytes / 2;
        *buffer = mesh_buffer(occlusion->log, "boxes of assets", *room, NULL, GL_DYNAMIC_STORAGE_BIT);
        if (!*buffer)
            *room = 0;
    }
    if (*buffer)
        glNamedBufferSubData(*buffer, 0, (GLsizeiptr)bytes, data);
    return *buffer != 0;
}

bool occlusion_begin(struct occlusion *occlusion, const struct picture *picture, int least_triangles)
{
    size_t count = picture->visible_count;
    int64_t triangles = 0;
    occlusion->box_count = occlusion->command_count = occlusion->asset_count = 0;
    if (least_triangles == INT_MAX)
        return false;
    mem_grow(&occlusion->assets, &occlusion->asset_capacity, count + 1, sizeof(*occlusion->assets));
    for (size_t i = 0; i < count; i++) {
        occlusion->assets[i] = add_asset(occlusion, picture, picture->visible[i]);
        triangles += occlusion->assets[i].triangles;
    }
    occlusion->assets[count] = (struct occlusion_asset){ .boxes_before = occlusion->box_count };
    occlusion->asset_count = count;
    if (triangles < least_triangles || occlusion->box_count == 0 ||
        !upload(occlusion, &occlusion->box_buffer, &occlusion->box_room, occlusion->box_count * sizeof(*occlusion->boxes),
                occlusion->boxes) ||
        !upload(occlusion, &occlusion->command_buffer, &occlusion->command_room, occlusion->command_count * sizeof(*occlusion->commands),
                occlusion->commands)) {
        occlusion->box_count = occlusion->asset_count = 0;
        return false;
    }
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
    int64_t enough = first > 0 ? before : all / FIRST_PART;
    while (end < occlusion->asset_count && (end == first || here < enough))
        here += occlusion->assets[end++].triangles;
    return end - first;
}

void occlusion_test(const struct occlusion *occlusion, size_t first, size_t end)
{
    size_t first_box = occlusion->assets[first].boxes_before, count = occlusion->assets[end].boxes_before - first_box;
    if (count == 0)
        return;
    glUseProgram(occlusion->program);
    glBindVertexArray(occlusion->vao);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, BIND_COMMANDS, occlusion->command_buffer);
    glDisable(GL_CULL_FACE);
    glPolygonOffset(0, 0);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDepthMask(GL_FALSE);
    glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, STRIP_VERTICES, (GLsizei)count, (GLuint)first_box);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, BIND_COMMANDS, 0);
    glMemoryBarrier(GL_COMMAND_BARRIER_BIT);
}

void occlusion_draw_batch(const struct occlusion *occlusion, size_t command, const struct model_batch *batch)
{
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, occlusion->command_buffer);
    glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, (const void *)(command * sizeof(struct occlusion_command)), batch->draws, 0);
}

size_t occlusion_count(const struct occlusion *occlusion)
{
    size_t count = 0, first_round = occlusion_round(occlusion, 0);
    for (size_t i = first_round; i < occlusion->asset_count; i++) {
        struct occlusion_command command;
        size_t offset = occlusion->assets[i].first_command * sizeof(command);
        if (!occlusion->assets[i].tested)
            continue;
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glGetNamedBufferSubData(occlusion->command_buffer, (GLintptr)offset, sizeof(command), &command);
        count += command.instances == 0;
    }
    return count;
}
