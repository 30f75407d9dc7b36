/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Other programs: what they print, how they end, and what they may not do. */
#include "tests/support/test.h"
#include <fcntl.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>


#include "base/mem.h"
#include "preprocess/child/child.h"
#include "preprocess/child/work_folder.h"

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

/* Also what it started in the background, which holds its pipes. */
TEST(test_a_hang_ends)
{
    assert_false(run("sleep 1000 & sleep 1000", 1, room));
    assert_string_equal(why, "the script was ended after 1 s (--timeout)");
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
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
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

static int use_up(void *arg)
{
    size_t bytes = (size_t)1 << 20;
    for (void **last = arg; bytes > 0; bytes += bytes / 2)
        memset(*last = mem_new(bytes), 1, bytes);
    return 0;
}

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
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
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
