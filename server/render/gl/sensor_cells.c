/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes grids of cells and lists of near sensors with shaders/sensor_cells.comp. */
#include "render/gl/sensor_cells.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "gpu/mesh.h"
#include "gpu/program.h"

/* Must match the shaders sensors.glsl, sensor_cells.glsl and sensor_cells.comp. */
enum { BIND_POSITIONS = 3, BIND_CORNERS = 4, BIND_SENSORS = 5, BIND_GRID = 6, BIND_LISTS = 7 };
enum { UNIT_SENSORS = 14, UNIT_LISTS = 16 };
enum { TRIANGLE_COUNT = 0, MOST_LISTS_UNIFORM = 1, BUDGET = 0 };
enum { MOST_NEAR = 64, LIST_WORDS = 36 + MOST_NEAR / 2, NEAR_COUNT = 11, MARK_GROUPS = 4096, MARK_GROUP = 64 };
/* largest number of work groups that each GL 4.5 driver accepts in a dispatch: there is one for each list */
enum { MOST_LISTS = 65535 };
/* largest number of sensors for each of the programs sensor_grids.make */
static const int SENSORS_OF_SIZE[SENSOR_CELLS_SIZES] = { 512, SENSOR_CELLS_MOST };
/* largest error that polynomials may cause, in colour steps, and the largest share of a sensor in a sum (as in pixel_lists.c) */
static const double MOST_STEPS = 0.5, MOST_SHARE = 0.0625;

struct grid_head { /* as in sensor_cells.glsl */
    float corner_m[3], side_m;
    int32_t cells[3], lists;
};

struct sensor_grid { /* the cells of one asset file that contain surfaces */
    const struct gl_model *model;
    int along; /* number of cells along the longest side of the asset */
    GLuint buffer;
    uint32_t lists; /* number of cells that contain surfaces, so that each has a list */
    struct sensor_grid *next;
};

/* --- grids ------------------------------------------------------------------------------------------------------------------ */

/* Returns the number of cells along the longest side of an asset. The area of surface for each sensor falls with the number of sensors;
   sides of cells fall with its root, so that lists stay short. */
static int cells_along(int sensors)
{
    return sensors <= 32 ? 16 : sensors <= 128 ? 32 : sensors <= 1024 ? 64 : 96;
}

/* Computes the grid around the asset's bounding box. Returns false if the asset has no extent. */
static bool fill_head(struct grid_head *head, const struct gl_model *model, int along)
{
    const struct asset_header *header = model->file->view.header;
    float longest = 0;
    for (int c = 0; c < 3; c++)
        longest = fmaxf(longest, header->bounds_max_m[c] - header->bounds_min_m[c]);
    *head = (struct grid_head){ .side_m = longest * 1.0001f / (float)along };
    if (!(longest > 0))
        return false;
    for (int c = 0; c < 3; c++) {
        float low = header->bounds_min_m[c], high = header->bounds_max_m[c];
        head->cells[c] = (int)ceilf((high - low) / head->side_m + 1e-3f);
        head->corner_m[c] = 0.5f * (low + high - head->side_m * (float)head->cells[c]);
    }
    return true;
}

/* Finds the cells that contain surfaces. Leaves grid->buffer 0 if that fails. */
static void fill_grid(struct sensor_grids *grids, struct sensor_grid *grid)
{
    const struct gpu_mesh *mesh = &grid->model->mesh;
    const GLint triangles = (GLint)(mesh->index_count / 3), groups = (triangles + MARK_GROUP - 1) / MARK_GROUP;
    struct grid_head head;
    if (!fill_head(&head, grid->model, grid->along))
        return;
    if (!grids->mark)
        grids->mark = program_create(grids->log, program_params(.compute = "sensor_cells.comp", .defines = "#define MARK\n"));
    if (!grids->mark)
        return;
    size_t cells = (size_t)head.cells[0] * (size_t)head.cells[1] * (size_t)head.cells[2];
    size_t bytes = sizeof(head) + (cells + (cells < (size_t)MOST_LISTS ? cells : (size_t)MOST_LISTS)) * sizeof(uint32_t);
    grid->buffer = mesh_buffer(grids->log, "cells of an asset", bytes, NULL, GL_DYNAMIC_STORAGE_BIT);
    if (!grid->buffer)
        return;
    glClearNamedBufferData(grid->buffer, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
    glNamedBufferSubData(grid->buffer, 0, sizeof(head), &head);
    glUseProgram(grids->mark);
    glUniform1i(TRIANGLE_COUNT, triangles);
    glUniform1i(MOST_LISTS_UNIFORM, MOST_LISTS);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, BIND_POSITIONS, mesh->positions);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, BIND_CORNERS, mesh->indices);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, BIND_GRID, grid->buffer);
    glDispatchCompute((GLuint)(groups < MARK_GROUPS ? groups : MARK_GROUPS), 1, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(grid->buffer, 0, sizeof(head), &head);
    grid->lists = (uint32_t)(head.lists < MOST_LISTS ? head.lists : MOST_LISTS);
}

static const struct sensor_grid *get_grid(struct sensor_grids *grids, const struct gl_model *model, int along)
{
    for (struct sensor_grid *grid = grids->newest; grid; grid = grid->next)
        if (grid->model == model && grid->along == along)
            return grid;
    struct sensor_grid *grid = mem_new(sizeof(*grid));
    *grid = (struct sensor_grid){ .model = model, .along = along, .next = grids->newest };
    grids->newest = grid;
    fill_grid(grids, grid);
    return grid;
}

void sensor_grids_finish(struct sensor_grids *grids)
{
    while (grids->newest) {
        struct sensor_grid *grid = grids->newest;
        grids->newest = grid->next;
        glDeleteBuffers(1, &grid->buffer);
        mem_free(grid);
    }
    glDeleteBuffers(1, &grids->none);
    glDeleteTextures(2, (GLuint[2]){ grids->sensor_texture, grids->list_texture });
    program_destroy(&grids->mark);
    for (int i = 0; i < SENSOR_CELLS_SIZES; i++)
        program_destroy(&grids->make[i]);
    *grids = (struct sensor_grids){ .log = grids->log };
}

/* --- lists ------------------------------------------------------------------------------------------------------------------ */

/* Sets the program's uniform `budget`, as find_spread() and fill_root() in pixel_lists.c do. */
static void set_budget(const struct pixel_field *field, double step)
{
    double low = INFINITY, high = -INFINITY, middle = 0, away = 0;
    for (int i = 0; i < field->count; i++)
        if (field->sensors[i].state & PIXEL_USABLE) {
            low = fmin(low, (double)field->sensors[i].value);
            high = fmax(high, (double)field->sensors[i].value);
        }
    if (high > low) {
        middle = 0.5 * (low + high);
        away = 1 / (high - low);
    }
    double spread = (field->paper ? fmax(fabs(low), fabs(high)) : high - low) * fabs((double)field->scale);
    double left = spread > 0 ? fmin(MOST_STEPS * step * (1 - 2 * MOST_SHARE) / spread, MOST_SHARE) : MOST_SHARE;
    glUniform3f(BUDGET, (float)middle, (float)away, (float)left);
}

static GLuint get_program(struct sensor_grids *grids, int sensors)
{
    int size = 0;
    while (sensors > SENSORS_OF_SIZE[size])
        size++;
    if (!grids->make[size]) {
        struct text defines = { 0 };
        text_add(&defines, "#define MOST_SENSORS %d\n", SENSORS_OF_SIZE[size]);
        grids->make[size] = program_create(grids->log, program_params(.compute = "sensor_cells.comp", .defines = defines.at));
        text_finish(&defines);
    }
    return grids->make[size];
}

static struct sensor_cells *create_cells(struct sensor_grids *grids, const struct sensor_grid *grid)
{
    struct sensor_cells *cells = mem_new(sizeof(*cells));
    *cells = (struct sensor_cells){ .grid = grid, .holds = 1 };
    size_t bytes = grid->lists * sizeof(uint32_t) * LIST_WORDS;
    GLint most_texels = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most_texels);
    cells->lists = grid->lists > 0 && bytes / sizeof(float[4]) <= (size_t)most_texels
                       ? mesh_buffer(grids->log, "lists of near sensors", bytes, NULL, 0)
                       : 0;
    cells->bytes = cells->lists ? bytes : 0;
    return cells;
}

static void forget_lists(struct sensor_cells *cells)
{
    glDeleteBuffers(1, &cells->lists);
    cells->lists = 0;
    cells->bytes = 0;
}

static void fill_lists(struct sensor_grids *grids, struct sensor_cells *cells, const struct sensor_cells_params *params)
{
    GLuint program = cells->lists ? get_program(grids, params->field->count) : 0;
    cells->ready = true;
    if (!program) {
        forget_lists(cells);
        return;
    }
    glUseProgram(program);
    set_budget(params->field, params->step);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, BIND_SENSORS, params->sensors);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, BIND_GRID, cells->grid->buffer);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, BIND_LISTS, cells->lists);
    /* fragments of an earlier frame may still fetch the lists */
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    glDispatchCompute(cells->grid->lists, 1, 1);
    /* fragments fetch the lists from a buffer texture */
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

void sensor_cells_update(struct sensor_grids *grids, const struct sensor_cells_params *params, struct sensor_cells **cells)
{
    const int sensors = params->field->count;
    const bool many = params->gl->software && sensors > SENSOR_CELLS_FEW && sensors <= SENSOR_CELLS_MOST;
    if (*cells ? (*cells)->ready : !many)
        return;
    gl_pass_enter("near sensors");
    const struct sensor_grid *grid = many ? get_grid(grids, params->model, cells_along(sensors)) : NULL;
    if (*cells && (*cells)->grid != grid)
        sensor_cells_unref(cells);
    if (grid && !*cells)
        *cells = create_cells(grids, grid);
    if (grid)
        fill_lists(grids, *cells, params);
    if (!gl_pass_leave(params->gl, "near sensors") && *cells)
        forget_lists(*cells);
}

void sensor_cells_bind(struct sensor_grids *grids, GLuint sensors, const struct sensor_cells *cells)
{
    static const struct {
        struct grid_head head;
        float list[LIST_WORDS];
    } nothing = { .head.side_m = 1 };
    if (!grids->none)
        grids->none = mesh_buffer(grids->log, "grid without cells", sizeof(nothing), &nothing, 0);
    if (!grids->sensor_texture) {
        glCreateTextures(GL_TEXTURE_BUFFER, 1, &grids->sensor_texture);
        glCreateTextures(GL_TEXTURE_BUFFER, 1, &grids->list_texture);
    }
    bool some = cells && cells->ready && cells->lists;
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, BIND_SENSORS, sensors);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, BIND_GRID, some ? cells->grid->buffer : grids->none);
    glTextureBuffer(grids->sensor_texture, GL_RGBA32UI, sensors);
    glTextureBuffer(grids->list_texture, GL_RGBA32UI, some ? cells->lists : grids->none);
    glBindTextureUnit(UNIT_SENSORS, grids->sensor_texture);
    glBindTextureUnit(UNIT_LISTS, grids->list_texture);
}

/* --- references ------------------------------------------------------------------------------------------------------------- */

struct sensor_cells *sensor_cells_ref(struct sensor_cells *cells)
{
    if (cells)
        cells->holds++;
    return cells;
}

void sensor_cells_unref(struct sensor_cells **cells_ptr)
{
    struct sensor_cells *cells = *cells_ptr;
    *cells_ptr = NULL;
    if (!cells || --cells->holds > 0)
        return;
    glDeleteBuffers(1, &cells->lists);
    mem_free(cells);
}

void sensor_cells_expire(struct sensor_cells **cells)
{
    if (*cells && (*cells)->holds > 1)
        sensor_cells_unref(cells);
    else if (*cells)
        (*cells)->ready = false;
}

struct sensor_cells_tally sensor_cells_count(const struct sensor_cells *cells)
{
    struct sensor_cells_tally tally = { 0 };
    if (!cells || !cells->lists)
        return tally;
    float(*lists)[LIST_WORDS] = mem_array(cells->grid->lists, sizeof(*lists));
    glGetNamedBufferSubData(cells->lists, 0, (GLsizeiptr)cells->bytes, lists);
    tally.lists = cells->grid->lists;
    for (size_t i = 0; i < tally.lists; i++) {
        tally.near += lists[i][NEAR_COUNT] > 0 ? (size_t)lists[i][NEAR_COUNT] : 0;
        tally.overflowing += lists[i][NEAR_COUNT] < 0;
    }
    mem_free(lists);
    return tally;
}
