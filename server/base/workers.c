/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A fixed pool of threads that take jobs from one list. */
#include "base/workers.h"

#include <pthread.h>
#include <stdbool.h>
#include <unistd.h>

#include "base/mem.h"

struct worker_job {
    void (*run)(void *arg);
    void *arg;
    struct worker_job *next;
};

struct workers {
    int count;
    pthread_t *threads;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    /* --- below: under `lock` */
    struct worker_job *first, **last;
    bool stopping;
};

static void *worker_main(void *arg)
{
    struct workers *workers = arg;
    pthread_mutex_lock(&workers->lock);
    for (;;) {
        while (!workers->first && !workers->stopping)
            pthread_cond_wait(&workers->wake, &workers->lock);
        struct worker_job *job = workers->first;
        if (!job)
            break;
        workers->first = job->next;
        if (!workers->first)
            workers->last = &workers->first;
        pthread_mutex_unlock(&workers->lock);
        job->run(job->arg);
        mem_free(job);
        pthread_mutex_lock(&workers->lock);
    }
    pthread_mutex_unlock(&workers->lock);
    return NULL;
}

struct workers *workers_create(int threads)
{
    if (threads <= 0) {
        long cores = sysconf(_SC_NPROCESSORS_ONLN);
        threads = cores > 0 ? (int)cores : 1;
    }
    struct workers *workers = mem_new(sizeof(*workers));
    workers->threads = mem_array((size_t)threads, sizeof(*workers->threads));
    workers->last = &workers->first;
    pthread_mutex_init(&workers->lock, NULL);
    pthread_cond_init(&workers->wake, NULL);
    for (; workers->count < threads; workers->count++)
        if (pthread_create(&workers->threads[workers->count], NULL, worker_main, workers) != 0)
            break;
    return workers;
}

void workers_destroy(struct workers **workers_ptr)
{
    struct workers *workers = *workers_ptr;
    if (!workers)
        return;
    pthread_mutex_lock(&workers->lock);
    workers->stopping = true;
    pthread_cond_broadcast(&workers->wake);
    pthread_mutex_unlock(&workers->lock);
    for (int i = 0; i < workers->count; i++)
        pthread_join(workers->threads[i], NULL);
    pthread_cond_destroy(&workers->wake);
    pthread_mutex_destroy(&workers->lock);
    mem_free(workers->threads);
    mem_free(workers);
    *workers_ptr = NULL;
}

int workers_count(const struct workers *workers)
{
    return workers->count;
}

void workers_submit(struct workers *workers, void (*run)(void *arg), void *arg)
{
    if (workers->count == 0) { /* no thread could be started, so the calling thread runs the job itself */
        run(arg);
        return;
    }
    struct worker_job *job = mem_new(sizeof(*job));
    *job = (struct worker_job){ .run = run, .arg = arg };
    pthread_mutex_lock(&workers->lock);
    *workers->last = job;
    workers->last = &job->next;
    pthread_cond_signal(&workers->wake);
    pthread_mutex_unlock(&workers->lock);
}

/* A call of workers_for() in progress. The caller and its helper jobs share the struct; the last to finish frees it. */
struct loop {
    size_t count, grain;
    void (*body)(void *arg, size_t begin, size_t end);
    void *arg;
    pthread_mutex_t lock;
    pthread_cond_t done;
    /* --- below: under `lock` */
    size_t next, finished;
    int users;
};

static void loop_unref(struct loop *loop)
{
    pthread_mutex_lock(&loop->lock);
    bool last = --loop->users == 0;
    pthread_mutex_unlock(&loop->lock);
    if (last) {
        pthread_cond_destroy(&loop->done);
        pthread_mutex_destroy(&loop->lock);
        mem_free(loop);
    }
}

static void loop_work(struct loop *loop)
{
    pthread_mutex_lock(&loop->lock);
    while (loop->next < loop->count) {
        size_t begin = loop->next;
        size_t end = begin + loop->grain < loop->count ? begin + loop->grain : loop->count;
        loop->next = end;
        pthread_mutex_unlock(&loop->lock);
        loop->body(loop->arg, begin, end);
        pthread_mutex_lock(&loop->lock);
        loop->finished += end - begin;
        if (loop->finished == loop->count)
            pthread_cond_broadcast(&loop->done);
    }
    pthread_mutex_unlock(&loop->lock);
}

static void loop_help(void *arg)
{
    loop_work(arg);
    loop_unref(arg);
}

/* Starts a parallel loop: queues a helper job for each worker thread that is to help the caller. */
static struct loop *loop_begin(struct workers *workers, const struct loop *like)
{
    struct loop *loop = mem_new(sizeof(*loop));
    *loop = *like;
    pthread_mutex_init(&loop->lock, NULL);
    pthread_cond_init(&loop->done, NULL);
    for (int i = 1; i < like->users; i++)
        workers_submit(workers, loop_help, loop);
    return loop;
}

static void loop_end(struct loop *loop)
{
    loop_work(loop);
    pthread_mutex_lock(&loop->lock);
    while (loop->finished < loop->count)
        pthread_cond_wait(&loop->done, &loop->lock);
    pthread_mutex_unlock(&loop->lock);
    loop_unref(loop);
}

void workers_for(struct workers *workers, size_t count, size_t grain, void (*body)(void *arg, size_t begin, size_t end), void *arg)
{
    if (count == 0)
        return;
    if (grain == 0)
        grain = 1;
    if (!workers || count <= grain || workers->count <= 1) {
        body(arg, 0, count);
        return;
    }
    size_t pieces = (count + grain - 1) / grain;
    int helpers = pieces - 1 < (size_t)(workers->count - 1) ? (int)(pieces - 1) : workers->count - 1;
    loop_end(loop_begin(workers, &(struct loop){ .count = count, .grain = grain, .body = body, .arg = arg, .users = helpers + 1 }));
}

struct workers_task {
    struct loop *loop;
    void (*body)(void *arg);
    void *arg;
};

static void run_task(void *arg, size_t begin, size_t end)
{
    const struct workers_task *task = arg;
    (void)begin;
    (void)end;
    task->body(task->arg);
}

struct workers_task *workers_begin(struct workers *workers, void (*body)(void *arg), void *arg)
{
    struct workers_task *task = mem_new(sizeof(*task));
    *task = (struct workers_task){ .body = body, .arg = arg };
    task->loop = loop_begin(workers, &(struct loop){ .count = 1, .grain = 1, .body = run_task, .arg = task, .users = workers ? 2 : 1 });
    return task;
}

void workers_end(struct workers_task **task)
{
    if (!*task)
        return;
    loop_end((*task)->loop);
    mem_free(*task);
    *task = NULL;
}
