/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Threads that drive viewers. */
#include "viewer_threads.h"

#include <stdio.h>
#include <sys/resource.h>

enum { MAX_THREADS = 64, MAX_FILES = 8192 };

struct worker {
    pthread_t thread;
    struct lws_context *context;
    struct viewer **viewers; /* every `stride`-th, from the first on */
    int count, stride;
};

static bool all_done(const struct worker *worker)
{
    for (int i = 0; i < worker->count; i += worker->stride)
        if (!viewer_done(worker->viewers[i]))
            return false;
    return true;
}

static void *worker_main(void *arg)
{
    struct worker *worker = arg;
    for (int i = 0; i < worker->count; i += worker->stride)
        viewer_connect(worker->viewers[i], worker->context);
    while (!all_done(worker))
        lws_service(worker->context, 0);
    lws_context_destroy(worker->context);
    return NULL;
}

static bool worker_start(struct worker *worker)
{
    struct lws_context_creation_info info = {
        .port = CONTEXT_PORT_NO_LISTEN,
        .protocols = viewer_protocols,
        .gid = -1,
        .uid = -1,
        .pt_serv_buf_size = 64 * 1024,
    };
    viewer_prepare_context(worker->viewers[0], &info);
    worker->context = lws_create_context(&info);
    if (worker->context && pthread_create(&worker->thread, NULL, worker_main, worker) == 0)
        return true;
    if (worker->context)
        lws_context_destroy(worker->context);
    return false;
}

void viewer_threads_raise_file_limit(void)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_NOFILE, &limit) == 0) {
        limit.rlim_cur = limit.rlim_max > MAX_FILES ? MAX_FILES : limit.rlim_max;
        setrlimit(RLIMIT_NOFILE, &limit);
    }
}

bool viewer_threads_run(struct viewer **viewers, int count)
{
    struct worker workers[MAX_THREADS];
    int threads = count < MAX_THREADS ? count : MAX_THREADS, started = 0;
    lws_set_log_level(0, NULL);
    viewer_threads_raise_file_limit();
    for (; started < threads; started++) {
        workers[started] = (struct worker){ .viewers = viewers + started, .count = count - started, .stride = threads };
        if (!worker_start(&workers[started]))
            break;
    }
    for (int i = 0; i < started; i++)
        pthread_join(workers[i].thread, NULL);
    if (started < threads)
        fprintf(stderr, "plantcast: only %d of %d threads could be started\n", started, threads);
    return started == threads;
}
