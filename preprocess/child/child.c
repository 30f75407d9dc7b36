/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forks the child, sets its limits and connects pipes. The parent reads the child's output until the child ends, a signal
 * arrives or the time runs out. */
#include "preprocess/child/child.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/mem.h"

enum { MAX_OUTPUT = 8 << 20, PIPE_BYTES = 1 << 20 /* capacity requested for a pipe */, MAX_FILES = 512, EXIT_NOT_STARTED = 127 };
enum watched { OUTPUT, ERRORS, END, SIGNALS, WATCHED };

struct child {
    pid_t pid;
    /* file descriptors to wait for, by enum watched: the child's output pipes, its pidfd (readable when the child ends), and a
       signalfd; -1: closed */
    int fds[WATCHED];
    struct text errors;
    bool interrupted, timed_out;
};

static int64_t now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

static void limit(int resource, rlim_t most)
{
    struct rlimit old;
    if (getrlimit((__rlimit_resource_t)resource, &old) == 0 && old.rlim_max < most)
        most = old.rlim_max;
    setrlimit((__rlimit_resource_t)resource, &(struct rlimit){ most, most });
}

static void close_all_but(int kept)
{
    unsigned first = STDERR_FILENO + 1;
    if (kept > STDERR_FILENO) {
        if ((unsigned)kept > first)
            syscall(SYS_close_range, first, (unsigned)kept - 1, 0U);
        first = (unsigned)kept + 1;
    }
    syscall(SYS_close_range, first, ~0U, 0U);
}

static void limit_all(const struct child_params *params)
{
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_NOFILE, MAX_FILES);
    limit(RLIMIT_FSIZE, (rlim_t)8 << 30);
/* no memory limit in sanitizer builds: the sanitizer's shadow memory would count as data */
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    /* limit data memory, not address space: WebAssembly reserves far more address space than it uses */
    limit(RLIMIT_DATA, params->memory_bytes);
#else
    (void)params;
#endif
}

/* Turns the forked process into the child: sets its process group, limits, descriptors and confinement, then executes the
 * program. Does not return. */
static void become(const struct child_params *params, int out, int errors, const sigset_t *signals, char **environment)
{
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    sigprocmask(SIG_UNBLOCK, signals, NULL);
    int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    dup2(errors, STDERR_FILENO);
    close_all_but(params->result);
    limit_all(params);
    const struct confine_params confined = { .role = params->role, .paths = params->paths, .path_count = params->path_count };
    int status = confine(&confined);
    if (status != 0 || chdir(params->folder) != 0) {
        dprintf(STDERR_FILENO, "cannot restrict the file access of this process to %s: %s\n", params->folder,
                strerror(status != 0 ? -status : errno));
        _exit(EXIT_NOT_STARTED);
    }
    environ = environment;
    if (params->call) {
        status = params->call(params->arg);
        fflush(NULL);
        _exit(status);
    }
    execvp(params->argv[0], (char *const *)params->argv);
    dprintf(STDERR_FILENO, "%s: %s\n", params->argv[0], strerror(errno));
    _exit(EXIT_NOT_STARTED);
}

static bool start(struct child *child, const struct child_params *params)
{
    int out[2] = { -1, -1 }, errors[2] = { -1, -1 };
    sigset_t ours;
    sigemptyset(&ours);
    sigaddset(&ours, SIGINT);
    sigaddset(&ours, SIGTERM);
    if (pipe2(out, O_CLOEXEC) != 0 || pipe2(errors, O_CLOEXEC) != 0)
        goto error;
    sigprocmask(SIG_BLOCK, &ours, NULL);
    child->fds[SIGNALS] = signalfd(-1, &ours, SFD_CLOEXEC | SFD_NONBLOCK);
    fflush(NULL);
    char **environment = confine_environment(params->folder, false);
    child->pid = fork();
    if (child->pid == 0)
        become(params, out[1], errors[1], &ours, environment);
    mem_free(environment);
    if (child->pid > 0)
        child->fds[END] = (int)syscall(SYS_pidfd_open, child->pid, 0);
    if (child->pid < 0 || child->fds[END] < 0)
        goto error;
    close(out[1]);
    close(errors[1]);
    child->fds[OUTPUT] = out[0];
    child->fds[ERRORS] = errors[0];
    return true;
error:
    for (int i = 0; i < 2; i++) {
        close(out[i]);
        close(errors[i]);
    }
    return false;
}

static bool take(int fd, struct text *text)
{
    char bytes[65536];
    ssize_t count = read(fd, bytes, sizeof(bytes));
    if (count > 0 && text->length < MAX_OUTPUT)
        text_add_bytes(text, bytes, (size_t)count);
    return count > 0 || (count < 0 && (errno == EINTR || errno == EAGAIN));
}

/* Reads the output left in the pipe after the child's end. Never blocks, because a surviving process of the child may hold the
 * pipe open or write without end. */
static void drain(int fd, struct text *text)
{
    char bytes[4096];
    fcntl(fd, F_SETFL, O_NONBLOCK);
    for (size_t left = PIPE_BYTES; left > 0 && text->length < MAX_OUTPUT;) {
        ssize_t count = read(fd, bytes, left < sizeof(bytes) ? left : sizeof(bytes));
        if (count <= 0)
            break;
        text_add_bytes(text, bytes, (size_t)count);
        left -= (size_t)count;
    }
}

static void wait_for(struct child *child, int timeout_s, struct text *out)
{
    int64_t until_ms = now_ms() + (int64_t)timeout_s * 1000;
    for (bool ended = false; !ended;) {
        struct pollfd polls[WATCHED];
        for (int i = 0; i < WATCHED; i++)
            polls[i] = (struct pollfd){ .fd = child->fds[i], .events = POLLIN };
        int64_t left_ms = until_ms - now_ms();
        int ready = left_ms > 0 ? poll(polls, WATCHED, left_ms < 60000 ? (int)left_ms : 60000) : 0;
        child->timed_out = left_ms <= 0;
        struct signalfd_siginfo signal;
        child->interrupted = ready > 0 && polls[SIGNALS].revents && read(child->fds[SIGNALS], &signal, sizeof(signal)) > 0;
        for (int i = OUTPUT; ready > 0 && i <= ERRORS; i++)
            if (polls[i].revents && !take(polls[i].fd, i == OUTPUT ? out : &child->errors)) {
                close(child->fds[i]);
                child->fds[i] = -1;
            }
        ended = child->timed_out || child->interrupted || (ready > 0 && polls[END].revents);
    }
}

/* Writes the last non-empty line of the child's error output to `why`. */
static void last_line(const struct text *errors, char why[CHILD_WHY_BYTES])
{
    size_t end = errors->length;
    while (end > 0 && strchr(" \t\r\n", errors->at[end - 1]))
        end--;
    size_t from = end;
    while (from > 0 && errors->at[from - 1] != '\n')
        from--;
    snprintf(why, CHILD_WHY_BYTES, "%.*s", (int)(end - from), errors->at ? errors->at + from : "");
    for (char *c = why; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127)
            *c = ' ';
}

/* Returns whether the child probably ran out of memory: it used nearly all of its memory limit, or its error output says so. */
static bool ran_out(const struct child *child, const struct child_params *params, const struct rusage *usage)
{
    static const char *const words[] = { "out of memory", "bad_alloc", "Cannot allocate memory", "allocation failed", "memory exhausted" };
    if ((size_t)usage->ru_maxrss << 10 >= params->memory_bytes / 8 * 7)
        return true;
    for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
        if (child->errors.at && strcasestr(child->errors.at, words[i]))
            return true;
    return false;
}

static bool judge(const struct child *child, const struct child_params *params, int status, const struct rusage *usage,
                  char why[CHILD_WHY_BYTES])
{
    const char *name = params->name;
    bool stopped = child->interrupted || child->timed_out;
    if (!stopped && WIFEXITED(status) && WEXITSTATUS(status) == 0)
        return true;
    if (child->interrupted)
        snprintf(why, CHILD_WHY_BYTES, "interrupted");
    else if (child->timed_out)
        snprintf(why, CHILD_WHY_BYTES, "%s was stopped: it ran longer than %d s (%s)", name, params->timeout_s, params->timeout_option);
    else if (ran_out(child, params, usage))
        snprintf(why, CHILD_WHY_BYTES, "%s needs more than %zu MB of memory%s%s%s", name, params->memory_bytes >> 20,
                 params->memory_option ? " (" : "", params->memory_option ? params->memory_option : "", params->memory_option ? ")" : "");
    else if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
        snprintf(why, CHILD_WHY_BYTES, "%s was killed (SIGKILL), probably because this machine or service ran out of memory", name);
    else if (WIFSIGNALED(status))
        snprintf(why, CHILD_WHY_BYTES, "%s crashed (SIG%s)", name, sigabbrev_np(WTERMSIG(status)));
    else if (params->errors)
        return false;
    else
        last_line(&child->errors, why);
    if (!why[0])
        snprintf(why, CHILD_WHY_BYTES, "%s ended with status %d", name, WEXITSTATUS(status));
    return false;
}

bool child_run(const struct child_params *params, struct text *out, char why[CHILD_WHY_BYTES])
{
    struct child child = { .fds = { -1, -1, -1, -1 } };
    sigset_t before;
    struct rusage usage = { 0 };
    int status = 0;
    why[0] = 0;
    sigprocmask(SIG_BLOCK, NULL, &before);
    bool good = start(&child, params);
    if (good)
        wait_for(&child, params->timeout_s, out);
    else
        snprintf(why, CHILD_WHY_BYTES, "%s", strerror(errno));
    if (child.pid > 0) {
        kill(-child.pid, SIGKILL);
        kill(child.pid, SIGKILL); /* kills the child itself, too, because its process group may not exist yet */
        wait4(child.pid, &status, 0, &usage);
        kill(-child.pid, SIGKILL); /* again kills the child's process group, to which processes that it started meanwhile belong */
    }
    if (child.fds[OUTPUT] >= 0)
        drain(child.fds[OUTPUT], out);
    if (child.fds[ERRORS] >= 0)
        drain(child.fds[ERRORS], &child.errors);
    good = good && judge(&child, params, status, &usage, why);
    for (int i = 0; i < WATCHED; i++)
        if (child.fds[i] >= 0)
            close(child.fds[i]);
    if (params->errors && child.errors.at)
        text_add_bytes(params->errors, child.errors.at, child.errors.length);
    text_finish(&child.errors);
    sigprocmask(SIG_SETMASK, &before, NULL);
    return good;
}
