/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists of the sensors that matter in each cell of space, for fields of many sensors that shaders evaluate at each pixel
   (field/pixel_field.h). A cell is a cube of a grid around an asset; only cells that contain surfaces have lists. Shaders sum the
   near sensors of a list; polynomials of the position approximate the sums over all others, as in render/soft/pixel_lists.h.
   Compute shaders make the lists when sensors or readings change. Call only in the thread that owns the GL context. */
#ifndef RENDER_GL_SENSOR_CELLS_H
#define RENDER_GL_SENSOR_CELLS_H
#include <stdbool.h>
#include <stddef.h>

#include <glad/gl.h>

#include "field/pixel_field.h"
#include "render/gl/model.h"

/* Fields with at most SENSOR_CELLS_FEW or more than SENSOR_CELLS_MOST sensors have no lists: all sensors are summed at each pixel. So
   are those of contexts on a GPU, because the lists were tested in software only. */
enum { SENSOR_CELLS_FEW = 16, SENSOR_CELLS_MOST = 4096, SENSOR_CELLS_SIZES = 2 };

struct sensor_grid;

struct sensor_cells { /* the lists of one asset's field */
    const struct sensor_grid *grid;
    GLuint lists;
    size_t bytes;
    int holds;  /* number of references */
    bool ready; /* false: the lists are out of date */
};

struct sensor_grids { /* grids of cells by asset file, and the programs that make lists; zero-initialise, then set log */
    struct log *log;
    GLuint mark, make[SENSOR_CELLS_SIZES]; /* programs; make: by number of sensors; 0: not compiled yet */
    GLuint none;                           /* buffer of a grid without cells; 0: not made yet */
    GLuint sensor_texture, list_texture;   /* textures of the buffers that are bound; 0: not made yet */
    struct sensor_grid *newest;
};

void sensor_grids_finish(struct sensor_grids *grids);
struct sensor_cells_params {
    struct gl *gl;
    const struct gl_model *model; /* model of the asset that shows the field */
    const struct pixel_field *field;
    GLuint sensors; /* buffer from reference_pixel_sensors() with the field's sensors */
    double step;    /* smallest difference of values that is visible in the colours (scale_step) */
};
/* Makes a field's lists if they are missing or out of date. *cells receives them, or NULL if the field needs none. If making them fails,
   shaders sum all sensors. */
void sensor_cells_update(struct sensor_grids *grids, const struct sensor_cells_params *params, struct sensor_cells **cells);
/* Binds a field's sensors (reference_pixel_sensors()) and lists for the next draws; their program must be compiled with PIXEL_FIELD.
   cells NULL: the field has no lists. */
void sensor_cells_bind(struct sensor_grids *grids, GLuint sensors, const struct sensor_cells *cells);

struct sensor_cells *sensor_cells_ref(struct sensor_cells *cells); /* NULL is fine */
void sensor_cells_unref(struct sensor_cells **cells); /* drops a reference and sets *cells to NULL; accepts a pointer to NULL */
/* Declares the lists out of date because the field has changed. Lists that a frame in progress still uses stay unchanged: *cells is
   then set to NULL. */
void sensor_cells_expire(struct sensor_cells **cells);

struct sensor_cells_tally {
    size_t lists, near, overflowing; /* near: sum of the lengths of all lists; overflowing: cells with too many near sensors for a list */
};
/* For tests and measurements: reads the lists back from the GPU. */
struct sensor_cells_tally sensor_cells_count(const struct sensor_cells *cells);

#endif
