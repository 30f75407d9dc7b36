/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A long-lived thread with its lock, a condition variable to wait for work, and a flag that asks the thread to end. */
#ifndef BASE_THREAD_H
#define BASE_THREAD_H
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/log/log.h"

struct thread {
    pthread_t id;
    bool started;
    pthread_mutex_t lock;
    pthread_cond_t wake; /* timed waits use clock_mono_ns() */
    bool stopping;       /* true: the thread must end; protected by the lock */
};

/* Initialises lock and condition variable. End with thread_finish(). */
void thread_init(struct thread *thread);
/* Starts run(arg). Returns false if the thread cannot be created, after logging `NAME: no thread`. */
bool thread_start(struct thread *thread, struct log *log, const char *name, void *(*run)(void *arg), void *arg);
/* Sets `stopping`, wakes the thread and waits until it has ended. If the thread was never started, it only sets `stopping`. */
void thread_stop(struct thread *thread);
void thread_finish(struct thread *thread);
/* Returns true if the thread must end. Locks the thread's lock. */
bool thread_is_stopping(struct thread *thread);
/* Waits until *next_ns plus the period, or not at all if that time has passed, and stores that time in *next_ns. Returns false
   once the thread must end. Locks the thread's lock. Call only in the thread itself. */
bool thread_wait_for_tick(struct thread *thread, int64_t period_ns, int64_t *next_ns);

#endif
