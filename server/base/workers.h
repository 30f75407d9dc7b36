/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Thread pool of fixed size: runs background jobs, and runs loops in parallel on all cores. Call from any thread. */
#ifndef BASE_WORKERS_H
#define BASE_WORKERS_H
#include <stddef.h>

struct workers;

struct workers *workers_create(int threads); /* Creates a pool of that many threads; 0: one thread per core. Never returns NULL. */
/* Waits for the submitted jobs and ends the threads. Accepts a pointer to NULL; sets *workers to NULL. */
void workers_destroy(struct workers **workers);
int workers_count(const struct workers *workers);

/* Queues job(arg) to run on a worker. Jobs start in the order of submission. */
void workers_submit(struct workers *workers, void (*job)(void *arg), void *arg);
/* Runs body(arg, begin, end) over the indices 0 to count - 1 in pieces of about `grain` indices, on the calling thread and idle workers.
   Returns when all pieces are done. May be called from a job. workers NULL: runs all pieces on the calling thread. */
void workers_for(struct workers *workers, size_t count, size_t grain, void (*body)(void *arg, size_t begin, size_t end), void *arg);

/* Starts body(arg) on an idle worker while the caller continues; if no worker is idle, workers_end() runs body(arg) instead.
   `workers` may be NULL. May be called from a job. */
struct workers_task;
struct workers_task *workers_begin(struct workers *workers, void (*body)(void *arg), void *arg);
void workers_end(struct workers_task **task); /* Waits until the task is done. Accepts a pointer to NULL; sets *task to NULL. */

#endif
