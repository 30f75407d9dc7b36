/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the GPU still owes of pictures that were given to it: pixels, markers, labels. Several may be under way, so that one is drawn
   while another one's pixels come. Thread: the one of the GL context. */
#ifndef RENDER_GL_FRAMES_IN_FLIGHT_H
#define RENDER_GL_FRAMES_IN_FLIGHT_H
#include "gpu/readback.h"
#include "render/pick/point_visibility.h"

enum { FRAMES_IN_FLIGHT = 8 };

struct frame_in_flight {
    struct readback readback;
    struct point_visibility markers, labels;
    bool taken;
};
struct frames_in_flight {
    GLuint program; /* of the queries */
    struct frame_in_flight at[FRAMES_IN_FLIGHT];
};

bool frames_in_flight_init(struct frames_in_flight *frames_in_flight, struct log *log); /* false: logged */
void frames_in_flight_finish(struct frames_in_flight *frames_in_flight);
struct frame_in_flight *frames_in_flight_take(struct frames_in_flight *frames_in_flight, struct log *log); /* NULL: all are taken, logged */
void frames_in_flight_give(struct frame_in_flight *in_flight); /* its picture came, or is not waited for; NULL is fine */

#endif
