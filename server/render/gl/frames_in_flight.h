/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A fixed number of slots for frames whose results the GPU has not delivered yet: pixels, visibility of markers and of labels,
   depth. With several slots, the GPU draws one frame while the pixels of another are copied to main memory. Call only in the
   thread that owns the GL context. */
#ifndef RENDER_GL_FRAMES_IN_FLIGHT_H
#define RENDER_GL_FRAMES_IN_FLIGHT_H
#include "gpu/readback.h"
#include "render/gl/depth_query.h"
#include "render/pick/point_visibility.h"

enum { FRAMES_IN_FLIGHT = 8 };

struct frame_in_flight {
    struct readback readback;
    struct point_visibility markers, labels;
    struct depth_query depth;
    bool taken;
};
struct frames_in_flight {
    GLuint program;       /* shaders/point_visibility.comp */
    GLuint depth_program; /* shaders/depth_cells.comp */
    struct frame_in_flight at[FRAMES_IN_FLIGHT];
};

/* Compiles the shader programs. On failure, logs the reason and returns false. */
bool frames_in_flight_init(struct frames_in_flight *frames_in_flight, struct log *log);
void frames_in_flight_finish(struct frames_in_flight *frames_in_flight);
/* Takes a free slot for a frame that is to be submitted to the GPU. Logs and returns NULL if all slots are taken. */
struct frame_in_flight *frames_in_flight_take(struct frames_in_flight *frames_in_flight, struct log *log);
/* Frees a frame's slot once the frame's results have been read or are no longer wanted. Accepts NULL. */
void frames_in_flight_give(struct frame_in_flight *in_flight);

#endif
