/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests programs that are run as child processes. A crash, a hang or endless output must be reported, a signal must end them,
   and their confinement must forbid network access and limit memory. */
#include "tests/support/test.h"
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <time.h>
#include <unistd.h>

#include "base/system/cgroup.h"
#include "preprocess/child/child.h"
#include "preprocess/child/work_folder.h"

/* Set with sanitizers, which need more memory than the limits of some tests: these tests are left out. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED
#endif

static struct text output;
static char why[CHILD_WHY_BYTES];
static double seconds;

static bool run(const char *script, int timeout_s, size_t memory_bytes)
{
    struct timespec from, to;
    const char *const argv[] = { "sh", "-c", script, NULL };
    const struct confine_path paths[] = { { "/usr", CONFINE_EXECUTE }, { "/bin", CONFINE_EXECUTE }, { "/tmp", CONFINE_WRITE } };
    const struct child_params params = { .argv = argv,
                                         .name = "the script",
                                         .folder = "/tmp",
                                         .timeout_s = timeout_s,
                                         .memory_bytes = memory_bytes,
                                         .timeout_option = "--timeout",
                                         .memory_option = "--memory",
                                         .role = CONFINE_COMMAND,
                                         .paths = paths,
                                         .path_count = sizeof(paths) / sizeof(paths[0]) };
    text_finish(&output);
    clock_gettime(CLOCK_MONOTONIC, &from);
    bool good = child_run(&params, &output, why);
    clock_gettime(CLOCK_MONOTONIC, &to);
    seconds = (double)(to.tv_sec - from.tv_sec) + (double)(to.tv_nsec - from.tv_nsec) * 1e-9;
    return good;
}

static const size_t room = (size_t)1 << 30;

TEST(test_output_and_the_last_line_of_errors)
{
    assert_true(run("echo one; echo two; echo no matter >&2", 10, room));
    assert_string_equal(output.at, "one\ntwo\n");
    assert_false(run("echo first >&2; printf 'the\\treason\\n\\n' >&2; exit 3", 10, room));
    assert_string_equal(why, "the reason");
    assert_false(run("exit 3", 10, room));
    assert_string_equal(why, "the script ended with status 3");
    assert_true(run("pwd; echo $TMPDIR", 10, room));
    assert_string_equal(output.at, "/tmp\n/tmp\n");
}

TEST(test_a_program_that_is_not_there)
{
    const char *const argv[] = { "/nowhere/reader", NULL };
    assert_false(child_run(&(struct child_params){ .argv = argv, .folder = "/tmp", .timeout_s = 10, .memory_bytes = room }, &output, why));
    assert_string_equal(why, "/nowhere/reader: No such file or directory");
}

TEST(test_a_crash_is_told)
{
    assert_false(run("kill -SEGV $$", 10, room));
    assert_string_equal(why, "the script crashed (SIGSEGV)");
}

/* The timeout also ends background processes that the script started and that keep its pipes open. */
TEST(test_a_hang_ends)
{
    assert_false(run("sleep 1000 & sleep 1000", 1, room));
    assert_string_equal(why, "the script was stopped: it ran longer than 1 s (--timeout)");
    assert_true(seconds < 5);
    assert_false(run("exec >/dev/null 2>&1; sleep 1000", 1, room));
    assert_true(seconds < 5);
    assert_true(run("sleep 1000 & echo done", 10, room));
    assert_string_equal(output.at, "done\n");
    assert_true(seconds < 5);
}

TEST(test_endless_output_is_cut)
{
    assert_false(run("yes", 1, room));
    assert_true(output.length <= (9 << 20));
}

TEST(test_memory_is_limited)
{
#ifndef SANITIZED
    assert_false(run("dd if=/dev/zero of=/dev/null bs=512M count=1", 20, (size_t)64 << 20));
    assert_string_equal(why, "the script needs more than 64 MB of memory (--memory)");
#endif
}

TEST(test_there_is_no_network)
{
    assert_false(run("python3 -c 'import socket; socket.socket()'", 20, room));
    assert_non_null(strstr(why, "not permitted"));
    assert_true(run("python3 -c 'import socket; socket.socketpair()'", 20, room));
}

#ifndef SANITIZED
static int use_up(void *arg)
{
    size_t bytes = (size_t)1 << 20;
    for (void **last = arg; bytes > 0; bytes += bytes / 2)
        memset(*last = mem_new(bytes), 1, bytes);
    return 0;
}
#endif

static int give_up(void *arg)
{
    (void)arg;
    abort();
}

static bool call(int (*function)(void *arg), void *arg)
{
    const struct child_params params = { .call = function,
                                         .arg = arg,
                                         .name = "the STEP reader",
                                         .folder = "/",
                                         .timeout_s = 10,
                                         .memory_bytes = (size_t)64 << 20,
                                         .timeout_option = "--timeout",
                                         .memory_option = "--memory" };
    text_finish(&output);
    return child_run(&params, &output, why);
}

static int print_number(void *arg)
{
    return printf("%d\n", *(int *)arg) > 0 && close(open("/etc/passwd", O_RDONLY)) != 0 ? 0 : 1;
}

TEST(test_a_function_of_this_program)
{
    int number = 7;
    char lacks[CONFINE_LACKS_BYTES];
    if (!confine_lacks(lacks)) {
        assert_true(call(print_number, &number));
        assert_string_equal(output.at, "7\n");
    }
#ifndef SANITIZED
    assert_false(call(use_up, &(void *){ NULL }));
    assert_string_equal(why, "the STEP reader needs more than 64 MB of memory (--memory)");
#endif
    assert_false(call(give_up, NULL));
    assert_string_equal(why, "the STEP reader crashed (SIGABRT)");
}

TEST(test_a_signal_ends_it)
{
    sigset_t term, before;
    char script[64], lacks[CONFINE_LACKS_BYTES];
    sigemptyset(&term);
    sigaddset(&term, SIGTERM);
    sigprocmask(SIG_BLOCK, &term, &before);
    raise(SIGTERM);
    assert_false(run("sleep 1000", 20, room));
    sigprocmask(SIG_SETMASK, &before, NULL);
    assert_string_equal(why, "interrupted");
    assert_true(seconds < 5);
    snprintf(script, sizeof(script), "kill -TERM %d", (int)getpid());
    if (!confine_lacks(lacks)) {
        assert_false(run(script, 20, room));
        assert_non_null(strstr(why, "not permitted"));
    }
}

/* The access rights that each ABI of Landlock can restrict, as in linux/landlock.h of Linux 6.12, and the warning about those
   that it cannot. */
TEST(test_each_abi_of_landlock_restricts_what_it_knows)
{
    static const struct {
        uint64_t files, tcp, scoped;
        const char *lacks;
    } abis[] = {
        { 0, 0, 0, "no Landlock: programs that read uploaded files can read and write all files of this user (" },
        { 0x1fff, 0, 0,
          "only ABI 1 of Landlock: commands under `convert` can read and write all files of this user, truncate all files that this user "
          "may write, signal other processes of this user (" },
        { 0x3fff, 0, 0,
          "only ABI 2 of Landlock: commands under `convert` can truncate all files that this user may write, signal other processes of "
          "this user (" },
        { 0x7fff, 0, 0, "only ABI 3 of Landlock: commands under `convert` can signal other processes of this user (" },
        { 0x7fff, 3, 0, "only ABI 4 of Landlock: commands under `convert` can signal other processes of this user (" },
        { 0xffff, 3, 0, "only ABI 5 of Landlock: commands under `convert` can signal other processes of this user (" },
        { 0xffff, 3, 3, "" },
        { 0xffff, 3, 3, "" },
    };
    static const char needs[] = "needs Linux 6.12 with landlock in its list of LSMs)";
    for (int abi = 0; abi < (int)(sizeof(abis) / sizeof(abis[0])); abi++) {
        char lacks[CONFINE_LACKS_BYTES], expected[CONFINE_LACKS_BYTES];
        struct confine_ruleset rules = confine_ruleset_of(abi);
        assert_int_equal(rules.files, abis[abi].files);
        assert_int_equal(rules.tcp, abis[abi].tcp);
        assert_int_equal(rules.scoped, abis[abi].scoped);
        snprintf(expected, sizeof(expected), "%s%s", abis[abi].lacks, abi < 6 ? needs : "");
        assert_int_equal(confine_lacks_with(abi, true, lacks), abi < 6);
        assert_string_equal(lacks, expected);
        assert_true(confine_lacks_with(abi, false, lacks));
        assert_non_null(
            strstr(lacks, "no seccomp: programs that read uploaded files can make any system call (needs CONFIG_SECCOMP_FILTER)"));
    }
    assert_int_equal(confine_ruleset_of(-1).files, 0); /* the kernel returns -1 where Landlock is absent or disabled */
}

/* --- older kernels: what a confined process can do with each Landlock ABI ----------------------------------------------------- */

/* Paths of: secret: a file that the confined process must not touch; in: a file that it may read; own: a folder in which it may
   write; away: a folder that it must not touch. */
static char secret[128], in[128], own[128], away[128];

static char *in_folder(const char *folder, const char *name)
{
    static char path[256];
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    return path;
}

static bool opens(const char *path, int flags)
{
    int file = open(path, flags | O_CLOEXEC, 0600);
    if (file >= 0)
        close(file);
    return file >= 0;
}

static bool moves_away(void)
{
    char from[256];
    snprintf(from, sizeof(from), "%s/f", own);
    return rename(from, in_folder(away, "f")) == 0;
}

static bool finds_memory(void)
{
    char path[64];
    snprintf(path, sizeof(path), "/proc/%d/mem", (int)getppid());
    return opens(path, O_RDONLY);
}

/* bits for what a confined process managed to do: READ_SECRET, EMPTY_SECRET: read or truncate the forbidden file; SIGNAL:
   signal its parent; ALTER: change other forbidden files or folders; ALLOWED: do everything that is allowed */
enum { READ_SECRET = 1, EMPTY_SECRET = 2, SIGNAL = 4, ALTER = 8, ALLOWED = 16 };

static int attempt_all(void)
{
    int done = 0;
    done |=
        opens(in, O_RDONLY) && opens(in_folder(own, "f"), O_RDWR | O_CREAT) && opens(in_folder(own, "g"), O_RDWR | O_CREAT) ? ALLOWED : 0;
    done |= kill(getppid(), 0) == 0 ? SIGNAL : 0;
    done |= truncate(secret, 0) == 0 || opens(secret, O_RDONLY | O_TRUNC) ? EMPTY_SECRET : 0;
    done |= opens(secret, O_RDONLY) || opens(away, O_RDONLY | O_DIRECTORY) ? READ_SECRET : 0;
    done |= opens(secret, O_WRONLY) || opens(in, O_WRONLY) || opens(in_folder(away, "new"), O_WRONLY | O_CREAT) || moves_away() ||
                    mkdir(in_folder(away, "d"), 0700) == 0 || link(secret, in_folder(own, "l")) == 0 || finds_memory() ||
                    unlink(secret) == 0
                ? ALTER
                : 0;
    return done;
}

static int attempts_under(enum confine_role role, int abi)
{
    int status = 0;
    pid_t pid = fork();
    if (pid == 0) {
        const struct confine_path paths[] = { { in, CONFINE_READ }, { own, CONFINE_WRITE } };
        const struct confine_params params = { .role = role, .paths = paths, .path_count = 2, .most_abi = abi };
        _exit(confine(&params) == 0 ? attempt_all() : 255);
    }
    waitpid(pid, &status, 0);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) != 255);
    return WEXITSTATUS(status);
}

static void lay_out(const char *folder)
{
    const char *const names[] = { "secret", "in" };
    char *const paths[] = { secret, in };
    for (int i = 0; i < 2; i++) {
        snprintf(paths[i], sizeof(secret), "%s/%s", folder, names[i]);
        FILE *file = fopen(paths[i], "w");
        assert_true(file && fputs("content", file) >= 0 && fclose(file) == 0);
    }
    snprintf(own, sizeof(own), "%s/own", folder);
    snprintf(away, sizeof(away), "%s/away", folder);
    assert_true((mkdir(own, 0700) == 0 || errno == EEXIST) && (mkdir(away, 0700) == 0 || errno == EEXIST));
}

/* Simulates each ABI of Landlock up to this kernel's. A confined reader can do nothing forbidden with any of them. A confined
   command can do some forbidden things with older ones, and the log names each of these. */
TEST(test_each_abi_of_landlock_holds_or_the_log_names_what_it_leaves_open)
{
    char lacks[CONFINE_LACKS_BYTES], *folder = temp_folder();
    int newest = (int)syscall(444, NULL, 0, 1); /* landlock_create_ruleset: asks for the ABI */
    for (int abi = 1; abi <= newest; abi++) {
        lay_out(folder);
        assert_int_equal(attempts_under(CONFINE_READER, abi), ALLOWED);
        int open = attempts_under(CONFINE_COMMAND, abi);
        confine_lacks_with(abi, true, lacks);
        assert_true(open & ALLOWED);
        assert_true(!(open & (READ_SECRET | ALTER)) == !strstr(lacks, "read and write all files"));
        assert_true(!(open & EMPTY_SECRET) == !strstr(lacks, "truncate all files"));
        assert_true(!(open & SIGNAL) == !strstr(lacks, "signal other processes"));
        print_message("Landlock ABI %d: %s\n", abi, *lacks ? lacks : "nothing is left open");
    }
    if (newest < 1)
        skip();
}

/* Returns the folder of a new cgroup, delegated as by systemd; NULL if this machine has no cgroup v2 with memory limits. */
static const char *delegated_cgroup(void)
{
    static const char *const mounts[] = { "/sys/fs/cgroup", "/sys/fs/cgroup/unified" };
    static char path[64];
    for (size_t i = 0; i < sizeof(mounts) / sizeof(mounts[0]); i++) {
        char name[64], control[256] = "";
        snprintf(name, sizeof(name), "%s/cgroup.subtree_control", mounts[i]);
        FILE *file = fopen(name, "r");
        bool limits = file && fgets(control, sizeof(control), file) && strstr(control, "memory") && strstr(control, "pids");
        if (file)
            fclose(file);
        snprintf(path, sizeof(path), "%s/plantcast-test-%d", mounts[i], (int)getpid());
        if (limits && mkdir(path, 0755) == 0 && setxattr(path, "user.delegate", "1", 1, 0) == 0)
            return path;
    }
    return NULL;
}

/* Moves this process into the delegated cgroup and tests child cgroups there. Returns the number of the step that failed, or 0.
   */
static int use_cgroup(const char *service)
{
    char name[128], *path;
    int status = 0;
    FILE *procs;
    snprintf(name, sizeof(name), "%s/cgroup.procs", service);
    if (!(procs = fopen(name, "w")) || fprintf(procs, "0") != 1 || fclose(procs) != 0)
        return 1;
    if (!cgroup_create("reader", room, 8, &path) || path)
        return 2; /* while the process itself is in the delegated cgroup, no cgroup for children is made there (path stays NULL) */
    if (!cgroup_divide() || !cgroup_divide() || !cgroup_create("reader", (size_t)64 << 20, 8, &path) || !path)
        return 3;
    if (cgroup_add(path, 1 << 30) || errno != ESRCH)
        return 8; /* joining a cgroup fails for a process that does not exist */
    int go[2];
    if (pipe(go) != 0)
        return 4;
    pid_t pid = fork();
    if (pid == 0) {
        char byte;
        if (read(go[0], &byte, 1) != 1 || cgroup_memory_bytes() != (size_t)64 << 20)
            _exit(1);
        memset(mem_new((size_t)256 << 20), 1, (size_t)256 << 20);
        _exit(0);
    }
    if (!cgroup_add(path, pid) || write(go[1], "x", 1) != 1 || waitpid(pid, &status, 0) != pid)
        return 5;
    if (!WIFSIGNALED(status) || WTERMSIG(status) != SIGKILL)
        return 6;
    pid = fork();
    if (pid == 0)
        for (;;)
            pause();
    cgroup_add(path, pid);
    cgroup_destroy(&path); /* destroying the cgroup must kill the process that is left in it */
    return waitpid(pid, &status, 0) == pid && WIFSIGNALED(status) && !path ? 0 : 7;
}

TEST(test_a_child_has_a_cgroup_with_a_limit_where_one_is_delegated)
{
    const char *service = delegated_cgroup();
    char daemon[128], *path;
    int status = 0;
    assert_false(cgroup_divide()); /* ours is not delegated */
    assert_true(cgroup_create("reader", room, 8, &path));
    assert_null(path);
    if (!service) {
        print_message("no cgroup v2 with limits of memory that this user may divide\n");
        skip();
        return;
    }
    pid_t pid = fork();
    if (pid == 0)
        _exit(use_cgroup(service));
    waitpid(pid, &status, 0);
    snprintf(daemon, sizeof(daemon), "%s/daemon", service);
    rmdir(daemon);
    rmdir(service);
    assert_int_equal(status, 0);
}

static bool gone_when_signalled;
static char path_of_work[256];

static void on_signal(int signal)
{
    (void)signal;
    gone_when_signalled = access(path_of_work, F_OK) != 0;
}

TEST(test_a_signal_waits_for_the_work_folder)
{
    char target[] = "/tmp/plantcast-work-XXXXXX", inside[300];
    struct work_folder work;
    assert_non_null(mkdtemp(target));
    assert_int_equal(rmdir(target), 0);
    signal(SIGTERM, on_signal);
    assert_int_equal(work_folder_begin(&work, target), 0);
    snprintf(path_of_work, sizeof(path_of_work), "%s", work.path);
    snprintf(inside, sizeof(inside), "%s/file", work.path);
    FILE *file = fopen(inside, "w");
    assert_non_null(file);
    fclose(file);
    assert_false(work_folder_interrupted());
    raise(SIGTERM);
    assert_true(work_folder_interrupted());
    assert_int_equal(access(inside, F_OK), 0);
    work_folder_end(&work, false);
    signal(SIGTERM, SIG_DFL);
    assert_true(gone_when_signalled);
    assert_int_not_equal(access(target, F_OK), 0);
}

int main(void)
{
    int failed = tests_run("child");
    text_finish(&output);
    return failed;
}
