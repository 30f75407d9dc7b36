/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Threads that run viewers. */
#include "viewer_threads.h"

#include <poll.h>
#include <stdio.h>
#include <sys/resource.h>

#include "base/clock.h"

enum { MAX_THREADS = 64, MAX_FILES = 8192, MAX_WAITING = 64 };

struct viewer_thread {
    pthread_t thread;
    struct lws_context *context;
    struct viewer **viewers; /* this thread's first viewer in the array of all viewers; every stride-th viewer from there on belongs
                                to this thread */
    int count, stride;
};

static bool all_done(const struct viewer_thread *worker)
{
    for (int i = 0; i < worker->count; i += worker->stride)
        if (!viewer_done(worker->viewers[i]))
            return false;
    return true;
}

/* Waits in poll() until the next timer of a viewer is due. libwebsockets waits in whole milliseconds and would spin for the rest, which
   takes processor time from a daemon on the same machine. */
static void wait_for_timer(const struct viewer_thread *worker)
{
    struct pollfd sockets[MAX_WAITING];
    int64_t until_ns = INT64_MAX, now_ns = clock_mono_ns();
    nfds_t count = 0;
    for (int i = 0; i < worker->count; i += worker->stride) {
        if (viewer_done(worker->viewers[i]))
            continue;
        if (count == MAX_WAITING)
            return;
        int64_t rests_ns = viewer_rests_until_ns(worker->viewers[i], &sockets[count].fd);
        sockets[count++].events = POLLIN;
        until_ns = rests_ns < until_ns ? rests_ns : until_ns;
    }
    if (until_ns > now_ns && until_ns - now_ns < NS_PER_MS)
        ppoll(sockets, count, &(struct timespec){ .tv_nsec = until_ns - now_ns }, NULL);
}

static void *worker_main(void *arg)
{
    struct viewer_thread *worker = arg;
    for (int i = 0; i < worker->count; i += worker->stride)
        viewer_connect(worker->viewers[i], worker->context);
    while (!all_done(worker)) {
        wait_for_timer(worker);
        lws_service(worker->context, 0);
    }
    lws_context_destroy(worker->context);
    return NULL;
}

/* Creates the thread's libwebsockets context. All contexts must exist before the first thread connects: libwebsockets has one global index
   from TLS connections to contexts, and each new context changes the index. */
static bool worker_prepare(struct viewer_thread *worker)
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
    return worker->context != NULL;
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
    struct viewer_thread workers[MAX_THREADS];
    int threads = count < MAX_THREADS ? count : MAX_THREADS, prepared = 0, started = 0;
    lws_set_log_level(0, NULL);
    viewer_threads_raise_file_limit();
    for (; prepared < threads; prepared++) {
        workers[prepared] = (struct viewer_thread){ .viewers = viewers + prepared, .count = count - prepared, .stride = threads };
        if (!worker_prepare(&workers[prepared]))
            break;
    }
    while (started < prepared && pthread_create(&workers[started].thread, NULL, worker_main, &workers[started]) == 0)
        started++;
    for (int i = started; i < prepared; i++)
        lws_context_destroy(workers[i].context);
    for (int i = 0; i < started; i++)
        pthread_join(workers[i].thread, NULL);
    if (started < threads)
        fprintf(stderr, "plantcast: only %d of %d threads for sessions could be started\n", started, threads);
    return started == threads;
}
