/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs all viewers (simulated clients) that do not decode frames, in one epoll loop. */
#include "load_generator.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/epoll.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "viewer_threads.h"
#include "viewer_impl.h"

enum { EVENTS = 256 };
static const int64_t CONNECT_TIMEOUT_NS = 20 * NS_PER_S; /* time limit for connecting */
/* Poll interval; packets that arrive in between are handled together. Waking for each packet would take processor time from the
   daemon under test, because the kernel wakes this process inside the daemon's send(). */
static const int64_t POLL_INTERVAL_NS = 2 * NS_PER_MS;

struct load_generator {
    int epoll, count;
    struct viewer **viewers;
    int64_t step_ns, next_ns; /* step_ns: interval of the viewers' timers; next_ns: monotonic time at which they fire next */
};

static void leave(struct viewer *viewer)
{
    raw_websocket_destroy(&viewer->raw);
}

static void watch(const struct load_generator *load, struct viewer *viewer, uint32_t events, int how)
{
    struct epoll_event event = { .events = events, .data.ptr = viewer };
    if (epoll_ctl(load->epoll, how, raw_websocket_fd(viewer->raw), &event) != 0)
        viewer_fail(viewer, strerror(errno));
}

static void join(const struct load_generator *load, struct viewer *viewer)
{
    const char *why = NULL;
    viewer->begin_ns = clock_mono_ns();
    viewer->raw = raw_websocket_connect(viewer->params.url, &why);
    if (viewer->raw)
        watch(load, viewer, EPOLLIN | EPOLLOUT, EPOLL_CTL_ADD);
    else
        viewer_fail(viewer, why);
}

static void speak(struct viewer *viewer)
{
    while (viewer->raw && raw_websocket_is_open(viewer->raw) && !viewer->done && viewer_has_output(viewer))
        if (viewer_send(viewer) < 0)
            viewer_fail(viewer, "a message could not be sent to the daemon");
}

static void on_messages(const struct load_generator *load, struct viewer *viewer)
{
    struct raw_websocket_message message;
    const char *why = NULL;
    int status = 0;
    while (!viewer->done && (status = raw_websocket_read(viewer->raw, &message, &why)) > 0) {
        viewer->in.length = 0;
        text_add_bytes(&viewer->in, message.at,
                       message.binary && message.count > RAW_WEBSOCKET_KEPT_BYTES ? RAW_WEBSOCKET_KEPT_BYTES : message.count);
        viewer->in_count = message.count;
        viewer_on_message(viewer, message.binary);
        if (viewer->params.stalls && viewer->result.frames > 0) {
            watch(load, viewer, 0, EPOLL_CTL_MOD);
            return;
        }
    }
    if (status < 0 && viewer->params.stalls)
        viewer->done = true;
    else if (status < 0)
        viewer_fail(viewer, why);
}

static void on_event(const struct load_generator *load, const struct epoll_event *event)
{
    struct viewer *viewer = event->data.ptr;
    if (!viewer->raw)
        return;
    if (event->events & EPOLLOUT) /* the connection is established */
        watch(load, viewer, EPOLLIN, EPOLL_CTL_MOD);
    on_messages(load, viewer);
    speak(viewer);
    if (viewer->done)
        leave(viewer);
}

/* Handles the due timers of all viewers. Returns true if any viewer is still running. */
static bool on_time(struct load_generator *load, int64_t now_ns)
{
    bool any = false;
    for (int i = 0; i < load->count; i++) {
        struct viewer *viewer = load->viewers[i];
        if (!viewer->done)
            viewer_on_time(viewer, now_ns);
        if (viewer->raw && !raw_websocket_is_open(viewer->raw) && now_ns - viewer->begin_ns > CONNECT_TIMEOUT_NS)
            viewer_fail(viewer, "the daemon did not answer for 20 s");
        speak(viewer);
        if (viewer->done)
            leave(viewer);
        any |= !viewer->done;
    }
    load->next_ns += load->step_ns;
    if (load->next_ns < now_ns)
        load->next_ns = now_ns;
    return any;
}

bool load_generator_run(struct viewer **viewers, int count)
{
    struct load_generator load = { .epoll = epoll_create1(EPOLL_CLOEXEC), .count = count, .viewers = viewers, .next_ns = clock_mono_ns() };
    struct epoll_event events[EVENTS];
    bool any = true;
    load.step_ns = (int64_t)(1e9 / viewers[0]->params.hz);
    if (load.epoll < 0) {
        fprintf(stderr, "plantcast: epoll: %s\n", strerror(errno));
        return false;
    }
    viewer_threads_raise_file_limit();
    for (int i = 0; i < count; i++)
        join(&load, viewers[i]);
    while (any) {
        int64_t now_ns = clock_mono_ns();
        if (now_ns >= load.next_ns && !(any = on_time(&load, now_ns)))
            break;
        int64_t wait_ns = load.next_ns - now_ns;
        int found = epoll_wait(load.epoll, events, EVENTS, wait_ns > 0 ? (int)(wait_ns / NS_PER_MS) + 1 : 0);
        for (int i = 0; i < found; i++)
            on_event(&load, &events[i]);
        if (found < EVENTS)
            nanosleep(&(struct timespec){ .tv_nsec = POLL_INTERVAL_NS }, NULL);
    }
    close(load.epoll);
    return true;
}
