/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starts, stops and times threads. */
#include "base/thread.h"

#include <string.h>

#include "base/clock.h"

void thread_init(struct thread *thread)
{
    *thread = (struct thread){ 0 };
    pthread_mutex_init(&thread->lock, NULL);
    clock_cond_init(&thread->wake);
}

bool thread_start(struct thread *thread, struct log *log, const char *name, void *(*run)(void *arg), void *arg)
{
    int error = pthread_create(&thread->id, NULL, run, arg);
    thread->started = !error;
    if (error)
        log_err(log, "%s: cannot start a thread: %s", name, strerror(error));
    return !error;
}

void thread_stop(struct thread *thread)
{
    pthread_mutex_lock(&thread->lock);
    thread->stopping = true;
    pthread_cond_signal(&thread->wake);
    pthread_mutex_unlock(&thread->lock);
    if (thread->started)
        pthread_join(thread->id, NULL);
    thread->started = false;
}

void thread_finish(struct thread *thread)
{
    pthread_cond_destroy(&thread->wake);
    pthread_mutex_destroy(&thread->lock);
}

bool thread_is_stopping(struct thread *thread)
{
    pthread_mutex_lock(&thread->lock);
    bool stopping = thread->stopping;
    pthread_mutex_unlock(&thread->lock);
    return stopping;
}

bool thread_wait_for_tick(struct thread *thread, int64_t period_ns, int64_t *next_ns)
{
    int64_t now_ns = clock_mono_ns();
    *next_ns = *next_ns + period_ns < now_ns ? now_ns : *next_ns + period_ns;
    pthread_mutex_lock(&thread->lock);
    while (!thread->stopping && clock_cond_wait(&thread->wake, &thread->lock, *next_ns))
        continue;
    bool stopping = thread->stopping;
    pthread_mutex_unlock(&thread->lock);
    return !stopping;
}
