/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Timestamp queries. */
#include "gpu/timer.h"

void timer_init(struct timer *timer)
{
    glCreateQueries(GL_TIMESTAMP, 2, timer->queries);
}

void timer_finish(struct timer *timer)
{
    glDeleteQueries(2, timer->queries);
    *timer = (struct timer){ 0 };
}

void timer_start(struct timer *timer)
{
    glQueryCounter(timer->queries[0], GL_TIMESTAMP);
}

void timer_stop(struct timer *timer)
{
    glQueryCounter(timer->queries[1], GL_TIMESTAMP);
}

int64_t timer_elapsed_ns(const struct timer *timer)
{
    GLuint64 start_ns = 0, stop_ns = 0;
    glGetQueryObjectui64v(timer->queries[0], GL_QUERY_RESULT, &start_ns);
    glGetQueryObjectui64v(timer->queries[1], GL_QUERY_RESULT, &stop_ns);
    return (int64_t)(stop_ns - start_ns);
}
