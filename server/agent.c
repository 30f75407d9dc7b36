/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tells a load balancer (HAProxy agent check) whether to send users to this daemon, and how busy it is: answers each connection
   with one line such as "up 80%". Reads nothing from clients, so their input cannot harm it. */
#include "agent.h"

#include <errno.h>
#include <netdb.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/thread.h"

struct agent {
    struct log *log;
    int fd, stop_fd;
    struct thread thread;
    /* --- below: protected by thread.lock */
    struct agent_state state;
    int64_t told_ns; /* monotonic time of the last call of agent_tell() */
};

enum { PAUSE_MS = 100 };
static const int64_t STATE_TIMEOUT_NS = 5 * NS_PER_S;

/* Formats the line for the load balancer. A daemon without readings reports "down", so that HAProxy sends no users here. If all
   nodes have lost the core, the shipped HAProxy configuration still sends users to any running node, whose page says that the
   core is lost. */
static int print_line(const struct agent_state *state, char *line, size_t size)
{
    int free_percent = state->busy_percent < 99 ? 100 - state->busy_percent : 1;
    if (state->drains)
        return snprintf(line, size, "down #draining\n");
    return state->has_core ? snprintf(line, size, "up %d%%\n", free_percent) : snprintf(line, size, "down #no core\n");
}

static void answer(struct agent *agent)
{
    char line[64];
    int fd = accept4(agent->fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
    /* accept() failed, for example because no descriptors are left: waits PAUSE_MS before the next try, which would fail
       immediately */
    if (fd < 0) {
        poll(&(struct pollfd){ .fd = agent->stop_fd, .events = POLLIN }, 1, PAUSE_MS);
        return;
    }
    pthread_mutex_lock(&agent->thread.lock);
    struct agent_state state = agent->state;
    /* the event loop has not called agent_tell() for STATE_TIMEOUT_NS: it is stuck, so the state that it reported is stale */
    if (clock_mono_ns() - agent->told_ns > STATE_TIMEOUT_NS)
        state.has_core = false;
    pthread_mutex_unlock(&agent->thread.lock);
    int count = print_line(&state, line, sizeof(line));
    (void)!send(fd, line, (size_t)count, MSG_NOSIGNAL); /* ignores the result: a new socket has enough buffer space for the whole line */
    close(fd);
}

static void *agent_main(void *arg)
{
    struct agent *agent = arg;
    while (!thread_is_stopping(&agent->thread)) {
        struct pollfd fds[2] = { { .fd = agent->fd, .events = POLLIN }, { .fd = agent->stop_fd, .events = POLLIN } };
        if (poll(fds, 2, -1) > 0 && fds[0].revents)
            answer(agent);
    }
    return NULL;
}

static int open_port(const char *address, int port)
{
    struct addrinfo hints = { .ai_socktype = SOCK_STREAM, .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE }, *at;
    char service[12];
    snprintf(service, sizeof(service), "%d", port);
    if (getaddrinfo(address, service, &hints, &at) != 0)
        return -EINVAL;
    int fd = socket(at->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0), on = 1;
    bool good = fd >= 0 && setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on)) == 0 && bind(fd, at->ai_addr, at->ai_addrlen) == 0 &&
                listen(fd, 16) == 0;
    int error = good ? 0 : errno;
    freeaddrinfo(at);
    if (!good && fd >= 0)
        close(fd);
    return good ? fd : -error;
}

struct agent *agent_start(struct log *log, const char *address, int port)
{
    struct agent *agent = mem_new(sizeof(*agent));
    agent->log = log;
    thread_init(&agent->thread);
    agent->stop_fd = eventfd(0, EFD_CLOEXEC);
    agent->fd = open_port(address, port);
    if (agent->fd < 0)
        log_err(log, "--agent-port: cannot listen on port %d for HAProxy's agent check: %s", port, strerror(-agent->fd));
    if (agent->fd < 0 || agent->stop_fd < 0 || !thread_start(&agent->thread, log, "agent", agent_main, agent))
        agent_stop(&agent);
    return agent;
}

void agent_stop(struct agent **pointer)
{
    struct agent *agent = *pointer;
    if (!agent)
        return;
    pthread_mutex_lock(&agent->thread.lock);
    agent->thread.stopping = true;
    pthread_mutex_unlock(&agent->thread.lock);
    if (agent->stop_fd >= 0)
        eventfd_write(agent->stop_fd, 1);
    thread_stop(&agent->thread);
    thread_finish(&agent->thread);
    if (agent->fd >= 0)
        close(agent->fd);
    if (agent->stop_fd >= 0)
        close(agent->stop_fd);
    mem_free(agent);
    *pointer = NULL;
}

void agent_tell(struct agent *agent, const struct agent_state *state)
{
    pthread_mutex_lock(&agent->thread.lock);
    agent->state = *state;
    agent->told_ns = clock_mono_ns();
    pthread_mutex_unlock(&agent->thread.lock);
}
