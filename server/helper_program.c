/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs another program as a child process with limits, and reads its output from two pipes. */
#include "helper_program.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdint.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "access/quota.h"
#include "base/clock.h"
#include "base/mem.h"
#include "base/system/cgroup.h"
#include "base/system/confine.h"
#include "base/system/memory.h"
#include "base/text/text.h"

enum { STDOUT, STDERR, PIPES, POLL_MS = 50, MAX_STDERR_BYTES = 64 * 1024, MAX_TASKS = 512 };
static const int64_t KILL_AFTER_NS = 30 * NS_PER_S;

struct helper {
    const struct helper_params *params;
    pid_t child;
    int ends[PIPES][2];  /* [pipe]: descriptors of the pipe's two ends; -1: that end is closed */
    struct text written; /* text that the child process has printed on stderr so far */
    char *cgroup;        /* path of the cgroup that limits the child process; NULL: it has no cgroup of its own */
    int64_t until_ns, kill_ns;
    /* told: stop() asked for the program's end; timed_out: the program was told to end because its time limit was over */
    bool told, timed_out;
};

static void close_end(int *fd)
{
    if (*fd >= 0)
        close(*fd);
    *fd = -1;
}

/* Limits the child's priority and memory. Called within a millisecond of the child's start, before it has read any input. */
static void limit(struct helper *helper)
{
    size_t bytes = helper->params->memory_bytes;
    setpriority(PRIO_PROCESS, (id_t)helper->child, 10);
/* no memory limit under sanitizers, whose shadow memory would count as data */
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    if (bytes > 0)
        prlimit(helper->child, RLIMIT_DATA, &(struct rlimit){ bytes, bytes }, NULL);
#endif
    bool divided = cgroup_create("reader", bytes, MAX_TASKS, &helper->cgroup);
    if (!divided || !cgroup_add(helper->cgroup, helper->child))
        log_warn(helper->params->log,
                 "%s: the memory limit applies to each of the program's processes, not to all together: cgroup `reader` cannot be %s: %s",
                 helper->params->arguments[0], divided ? "joined" : "made", strerror(errno));
}

static int start(struct helper *helper)
{
    char program[PATH_MAX];
    posix_spawn_file_actions_t actions;
    ssize_t length = readlink("/proc/self/exe", program, sizeof(program) - NAME_MAX - 1);
    program[length > 0 ? length : 0] = 0;
    char *slash = strrchr(program, '/');
    strncpy(slash ? slash + 1 : program, helper->params->arguments[0], NAME_MAX);
    posix_spawn_file_actions_init(&actions);
    int error = 0;
    for (int i = 0; i < PIPES && helper->params->say && !error; i++) {
        error = pipe2(helper->ends[i], O_CLOEXEC) == 0 ? 0 : errno;
        if (!error)
            error = posix_spawn_file_actions_adddup2(&actions, helper->ends[i][1], i == STDOUT ? STDOUT_FILENO : STDERR_FILENO);
    }
    if (!error)
        error = posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    if (!error && helper->params->lent > 0)
        error = posix_spawn_file_actions_adddup2(&actions, helper->params->lent, HELPER_LENT);
    if (!error)
        error = posix_spawn_file_actions_addclosefrom_np(&actions, helper->params->lent > 0 ? HELPER_LENT + 1 : STDERR_FILENO + 1);
    char **environment = confine_environment(NULL, helper->params->notifies);
    if (!error)
        error = posix_spawn(&helper->child, program, &actions, NULL, (char *const *)(uintptr_t)helper->params->arguments, environment);
    mem_free(environment);
    posix_spawn_file_actions_destroy(&actions);
    for (int i = 0; i < PIPES; i++)
        close_end(&helper->ends[i][1]);
    if (!error)
        limit(helper);
    return error;
}

static void read_end(struct helper *helper, int which)
{
    char piece[4096];
    ssize_t n = read(helper->ends[which][0], piece, sizeof(piece) - 1);
    if (n < 0 && errno == EINTR)
        return;
    if (n <= 0) {
        close_end(&helper->ends[which][0]);
        return;
    }
    piece[n] = 0;
    helper->params->say(helper->params->arg, piece);
    if (which == STDERR && helper->written.length < MAX_STDERR_BYTES)
        text_add(&helper->written, "%s", piece);
}

/* Asks the program to end (SIGTERM) when the caller wants that or the time limit is over, and kills the program if it does not
   end. */
static void end_in_time(struct helper *helper)
{
    int64_t now_ns = clock_mono_ns();
    if (helper->told || helper->timed_out) {
        if (now_ns >= helper->kill_ns)
            kill(helper->child, SIGKILL);
        return;
    }
    helper->told = helper->params->stop(helper->params->arg);
    helper->timed_out = !helper->told && helper->params->timeout_s > 0 && now_ns >= helper->until_ns;
    if (helper->told || helper->timed_out) {
        helper->kill_ns = now_ns + KILL_AFTER_NS;
        kill(helper->child, SIGTERM);
    }
}

/* Reads the program's output until the program has ended, and ends the program if the caller or the time limit requires it.
   Returns the exit status. Other processes may still hold the program's pipes open. */
static int attend(struct helper *helper)
{
    int status = 0;
    helper->until_ns = clock_mono_ns() + helper->params->timeout_s * NS_PER_S;
    for (bool ended = false; !ended;) {
        struct pollfd polled[PIPES] = { { helper->ends[STDOUT][0], POLLIN, 0 }, { helper->ends[STDERR][0], POLLIN, 0 } };
        ended = waitpid(helper->child, &status, WNOHANG) != 0; /* true once the program has ended; the rest of its output is still
                                                                   read afterwards */
        int ready = poll(polled, PIPES, ended ? 0 : POLL_MS);
        for (int i = 0; i < PIPES && ready > 0; i++)
            if (polled[i].revents)
                read_end(helper, i);
        if (ended && ready > 0)
            ended = false;
        if (!ended)
            end_in_time(helper);
    }
    return status;
}

static char *last_line(const struct text *text)
{
    size_t end = text->length;
    while (end > 0 && (text->at[end - 1] == '\n' || text->at[end - 1] == '\r'))
        end--;
    size_t begin = end;
    while (begin > 0 && text->at[begin - 1] != '\n')
        begin--;
    return end > begin ? mem_printf("%.*s", (int)(end - begin), text->at + begin) : NULL;
}

char *helper_run(const struct helper_params *params)
{
    const char *name = params->arguments[0];
    struct helper helper = { .params = params, .ends = { { -1, -1 }, { -1, -1 } } };
    char *why = NULL;
    int error = start(&helper), status = error ? 0 : attend(&helper);
    if (error)
        why = mem_printf("%s cannot be run: %s%s%s", name, strerror(error), error == ENOENT ? ": install the package " : "",
                         error == ENOENT ? name : "");
    else if (helper.told)
        why = mem_printf("%s was stopped before it finished: the import was cancelled, or the daemon is stopping", name);
    else if (helper.timed_out)
        why = mem_printf("%s was stopped: it ran longer than %d s (%s)", name, params->timeout_s, params->timeout_option);
    else if (params->remark && WIFEXITED(status) && WEXITSTATUS(status) == HELPER_PARTLY)
        *params->remark = last_line(&helper.written);
    else if (WIFSIGNALED(status) && params->memory_bytes > 0)
        why = mem_printf("%s crashed (%s); its memory limit is %zu MB (%s)", name, strsignal(WTERMSIG(status)),
                         params->memory_bytes >> 20, params->memory_option);
    else if (WIFSIGNALED(status))
        why = mem_printf("%s crashed (%s)", name, strsignal(WTERMSIG(status)));
    else if (WEXITSTATUS(status) != 0 && !(why = last_line(&helper.written)))
        why = mem_printf("%s ended with status %d", name, WEXITSTATUS(status));
    for (int i = 0; i < PIPES; i++)
        close_end(&helper.ends[i][0]);
    cgroup_destroy(&helper.cgroup);
    text_finish(&helper.written);
    return why;
}

char *helper_prepare(const struct helper_params *how, const char *folder, const char *plant_path, const struct quotas *quotas)
{
    const char *const arguments[] = { "plantcast-prep", "-o", folder, plant_path, NULL };
    struct helper_params params = *how;
    params.arguments = arguments;
    params.timeout_s = (int)quotas->at[QUOTA_PREPARE_S];
    params.memory_bytes = quotas->at[QUOTA_PREPARE_MB] > 0 ? (size_t)quotas->at[QUOTA_PREPARE_MB] << 20 : memory_machine_bytes() / 4 * 3;
    params.timeout_option = "--limit prepare-seconds";
    params.memory_option = "--limit prepare-megabytes";
    return helper_run(&params);
}
