/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fills the GPU buffers that shaders/reference.glsl reads: positions, readings and distances of an asset's sensors. */
#include "render/reference/reference.h"

#include <float.h>
#include <string.h>

#include "base/mem.h"
#include "gpu/mesh.h"
#include "protocol/asset_distance.h"

enum { BIND_SENSORS = 5, BIND_CORNERS = 6, BIND_POSITIONS = 7, UNIT_DISTANCES = 14, FIRST_TRIANGLE = 8 };
enum { SENSORS_PER_TEXEL = 4 };

struct sensors_head { /* header of the GPU buffer of sensors, in the layout std430; must match shaders/reference.glsl */
    float power, radius_m, reach_m, empty;
    float range, vertices_or_usable, hot_spot_m, seen;
    int32_t paper, geodesic, fill, show;
    float low, high, unused[2];
};
struct sensor_block {
    float place_m[3], strength;
    float decay, value;
    uint32_t column, state;
};

void reference_init(struct reference *reference, const struct gpu_scene *gpu_scene, struct field *field)
{
    *reference = (struct reference){ .gpu_scene = gpu_scene, .field = field };
    reference->models = mem_array(gpu_scene->model_count, sizeof(*reference->models));
}

static void model_finish_reference(struct reference_model *model)
{
    GLuint buffers[] = { model->corners, model->positions, model->distances };
    glDeleteTextures(1, &model->distance_texture);
    glDeleteBuffers(sizeof(buffers) / sizeof(buffers[0]), buffers);
    *model = (struct reference_model){ 0 };
}

void reference_finish(struct reference *reference)
{
    for (size_t i = 0; reference->models && i < reference->gpu_scene->model_count; i++)
        model_finish_reference(&reference->models[i]);
    mem_free(reference->models);
    *reference = (struct reference){ 0 };
}

/* --- sensors --------------------------------------------------------------------------------------------------------------- */

static struct sensors_head head_of(const struct reference *reference, int asset, const struct field_params *params, float radius_m)
{
    const struct plant_group *group = &reference->gpu_scene->scene->plant->groups[params->group];
    bool places = params->show == SHOW_OPERATOR, around_0 = places || params->show == SHOW_DIFFERENCE;
    return (struct sensors_head){
        .power = (float)params->power,
        .radius_m = radius_m,
        .reach_m = (float)params->reach_m,
        .empty = around_0 ? 0 : (float)group->min,
        .range = places ? 1 : (float)(group->max - group->min),
        .vertices_or_usable = (float)reference->gpu_scene->of_asset[asset]->file->view.header->vertex_count,
        .paper = params->interpolation == INTERPOLATION_PAPER,
        /* uses the geodesic distances of the asset file even if the view uses heat distances, which the file does not contain */
        .geodesic = params->distance != DISTANCE_EUCLIDEAN,
        .fill = params->fill == FILL_NEIGHBOURS,
        .show = (int32_t)params->show,
        .low = -FLT_MAX,
        .high = FLT_MAX,
    };
}

GLuint reference_sensors(const struct reference *reference, int asset, const struct field_params *params)
{
    struct field_sensor *sensors = NULL;
    float radius_m = 1;
    size_t count = field_sensors(reference->field, asset, params, &sensors, &radius_m);
    size_t bytes = sizeof(struct sensors_head) + count * sizeof(struct sensor_block);
    struct sensors_head *head = mem_array(1, bytes);
    struct sensor_block *blocks = (struct sensor_block *)(head + 1);
    *head = head_of(reference, asset, params, radius_m);
    for (size_t i = 0; i < count; i++) {
        const struct field_sensor *from = &sensors[i];
        blocks[i] = (struct sensor_block){ .strength = from->strength, .decay = from->decay, .value = from->value, .column = from->column };
        memcpy(blocks[i].place_m, from->surface_m, sizeof(from->surface_m));
        /* ignores sensors that a user's trial moved to this asset, because the asset file has no distances from them */
        bool has_column = from->column < reference->gpu_scene->scene->assets[asset].file->view.header->sensor_count;
        blocks[i].state = (from->configured ? PIXEL_CONFIGURED : 0) | (from->usable ? PIXEL_USABLE : 0);
        blocks[i].state = has_column ? blocks[i].state | (from->uncertain ? PIXEL_UNCERTAIN : 0) : 0;
    }
    GLuint buffer = count ? mesh_buffer(reference->gpu_scene->gl->log, "sensors", bytes, head, 0) : 0;
    mem_free(head);
    mem_free(sensors);
    return buffer;
}

GLuint reference_pixel_sensors(struct log *log, const struct pixel_field *field)
{
    static const int32_t shows[] = { [PIXEL_SUM] = SHOW_VALUE, [PIXEL_DISTANCE] = SHOW_DISTANCE, [PIXEL_BLIND] = SHOW_BLIND };
    const size_t bytes = sizeof(struct sensors_head) + (size_t)field->count * sizeof(struct sensor_block);
    struct sensors_head *head = mem_array(1, bytes);
    struct sensor_block *blocks = (struct sensor_block *)(head + 1);
    *head = (struct sensors_head){ .power = field->power,
                                   .radius_m = field->radius_m,
                                   .reach_m = field->reach_m,
                                   .empty = field->show == PIXEL_BLIND ? field->most
                                            : field->paper             ? field->offset
                                                                       : field->empty,
                                   .range = field->scale,
                                   .hot_spot_m = field->hot_spot_m,
                                   .seen = field->seen,
                                   .paper = field->paper,
                                   .fill = field->fill,
                                   .show = shows[field->show],
                                   .low = field->low,
                                   .high = field->high };
    int usable = 0, lost = field->count; /* usable sensors are stored from the first block on, others from the last one on */
    for (int i = 0; i < field->count; i++) {
        const struct pixel_sensor *from = &field->sensors[i];
        struct sensor_block *to = &blocks[from->state & PIXEL_USABLE ? usable++ : --lost];
        *to = (struct sensor_block){ .strength = from->strength, .decay = from->decay, .value = from->value, .state = from->state };
        memcpy(to->place_m, from->place_m, sizeof(from->place_m));
    }
    head->vertices_or_usable = (float)usable;
    GLuint buffer = mesh_buffer(log, "sensors for the per-fragment field", bytes, head, 0);
    mem_free(head);
    return buffer;
}

/* --- distances ------------------------------------------------------------------------------------------------------------- */

/* Packs the distances of four sensors into one texel, so that a plant with thousands of sensors fits one texture. */
static GLuint upload_distances(struct log *log, const struct asset_view *view)
{
    size_t vertices = view->header->vertex_count, sensors = view->header->sensor_count;
    size_t groups = (sensors + SENSORS_PER_TEXEL - 1) / SENSORS_PER_TEXEL;
    GLint limit = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &limit);
    if (groups * vertices > (size_t)limit) {
        log_err(log,
                "--field per-fragment: %zu sensors at %zu vertices do not fit into one buffer texture of this GPU: use --field vertices",
                sensors, vertices);
        return 0;
    }
    float(*texels)[SENSORS_PER_TEXEL] = mem_try_array(groups * vertices, sizeof(*texels));
    if (!texels) {
        log_err(log, "--field per-fragment: cannot store %zu sensors at %zu vertices: out of memory", sensors, vertices);
        return 0;
    }
    for (size_t i = 0; i < sensors; i++)
        for (size_t j = 0; j < vertices; j++)
            texels[i / SENSORS_PER_TEXEL * vertices + j][i % SENSORS_PER_TEXEL] = asset_distance_m(view, i, j);
    GLuint buffer = mesh_buffer(log, "distances", groups * vertices * sizeof(*texels), texels, 0);
    mem_free(texels);
    return buffer;
}

static bool model_init_reference(struct reference_model *model, struct log *log, const struct asset_view *view)
{
    model->corners = mesh_buffer(log, "corners", view->header->index_count * sizeof(*view->indices), view->indices, 0);
    model->positions = mesh_buffer(log, "places", view->header->vertex_count * sizeof(*view->positions_m), view->positions_m, 0);
    model->distances = upload_distances(log, view);
    if (!model->corners || !model->positions || !model->distances)
        return false;
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &model->distance_texture);
    glTextureBuffer(model->distance_texture, GL_RGBA32F, model->distances);
    return true;
}

bool reference_bind(struct reference *reference, int asset, GLuint sensors)
{
    const struct gl_model *of = reference->gpu_scene->of_asset[asset];
    struct reference_model *model = &reference->models[of - reference->gpu_scene->models];
    if (!model->distance_texture && !model_init_reference(model, reference->gpu_scene->gl->log, &of->file->view)) {
        model_finish_reference(model);
        return false;
    }
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, BIND_SENSORS, sensors);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, BIND_CORNERS, model->corners);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, BIND_POSITIONS, model->positions);
    glBindTextureUnit(UNIT_DISTANCES, model->distance_texture);
    return true;
}

void reference_draw(const struct draw_command *commands, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        glUniform1i(FIRST_TRIANGLE, (GLint)(commands[i].first_index / 3));
        glDrawElementsInstancedBaseInstance(GL_TRIANGLES, (GLsizei)commands[i].count, GL_UNSIGNED_INT,
                                            (const void *)((uintptr_t)commands[i].first_index * 4), 1, commands[i].base_instance);
    }
}
