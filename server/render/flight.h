/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the GPU still owes of pictures that were given to it: pixels, markers, labels. Several may be under way, so that one is drawn
   while another one's pixels come. Thread: the one of the GL context. */
#ifndef RENDER_FLIGHT_H
#define RENDER_FLIGHT_H
#include "gpu/readback.h"
#include "render/sights.h"

enum { FLIGHTS = 8 };

struct flight {
    struct readback readback;
    struct sights markers, labels;
    bool taken;
};
struct flights {
    GLuint program; /* of the sights */
    struct flight at[FLIGHTS];
};

bool flights_init(struct flights *flights, struct log *log); /* false: logged */
void flights_finish(struct flights *flights);
struct flight *flights_take(struct flights *flights, struct log *log); /* NULL: all are taken, logged */
void flights_give(struct flight *flight); /* its picture came, or is not waited for; NULL is fine */

#endif
