/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How long the GPU worked on a run of commands. Thread: the one of the GL context. */
#ifndef GPU_TIMER_H
#define GPU_TIMER_H
#include <stdint.h>

#include <glad/gl.h>

struct timer {
    GLuint queries[2];
};

void timer_init(struct timer *timer);
void timer_finish(struct timer *timer);
void timer_start(struct timer *timer);
void timer_stop(struct timer *timer);
int64_t timer_elapsed_ns(const struct timer *timer); /* waits for the commands between start and stop */

#endif
