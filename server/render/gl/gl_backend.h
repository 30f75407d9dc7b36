/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is drawn with GL, and what it is drawn with: whole on a GPU, tile by tile on a processor. Thread: the one of the GL context. */
#ifndef RENDER_GL_BACKEND_H
#define RENDER_GL_BACKEND_H
#include "render/gl/frames_in_flight.h"
#include "render/gl/ghosts.h"
#include "render/gl/lines.h"
#include "render/gl/section_caps.h"
#include "render/gl/surface_pass.h"
#include "render/gl/targets.h"
#include "render/render_backend.h"

enum gl_pass { GL_SURFACES, GL_EDGES, GL_PASSES }; /* of what is drawn tile by tile */

struct gl_backend {
    struct surface_pass surface_pass;
    struct gl_lines lines;
    struct ghosts ghosts;
    struct section_caps section_caps;
    struct frames_in_flight frames_in_flight;
    GLuint frame_buffer; /* struct frame_uniforms */
    struct targets targets;
    double pixel_ns[GL_PASSES]; /* as measured lately */
    int64_t refined_ns;         /* what a GPU took for the last refined frame; 0: not known */
};

/* Light, colour map and uniforms of a frame, others having drawn meanwhile. Returns false when out of GPU memory, logged. */
bool gl_backend_take_up(struct renderer *renderer, struct frame_context *context);

#endif
