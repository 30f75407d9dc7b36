/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Other programs: what they print, how they end, and what they may not do. */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "preprocess/child/child.h"
#include "preprocess/child/work_folder.h"

static struct text output;
static char why[CHILD_WHY_BYTES];
static double seconds;

static bool run(const char *script, int timeout_s, size_t memory_bytes)
{
    struct timespec from, to;
    const char *const argv[] = { "sh", "-c", script, NULL };
    const struct child_params params = { .argv = argv, .folder = "/tmp", .timeout_s = timeout_s, .memory_bytes = memory_bytes };
    text_finish(&output);
    clock_gettime(CLOCK_MONOTONIC, &from);
    bool good = child_run(&params, &output, why);
    clock_gettime(CLOCK_MONOTONIC, &to);
    seconds = (double)(to.tv_sec - from.tv_sec) + (double)(to.tv_nsec - from.tv_nsec) * 1e-9;
    return good;
}

static const size_t room = (size_t)1 << 30;

static void test_output_and_the_last_line_of_errors(void **state)
{
    (void)state;
    assert_true(run("echo one; echo two; echo no matter >&2", 10, room));
    assert_string_equal(output.at, "one\ntwo\n");
    assert_false(run("echo first >&2; printf 'the\\treason\\n\\n' >&2; exit 3", 10, room));
    assert_string_equal(why, "the reason");
    assert_false(run("exit 3", 10, room));
    assert_string_equal(why, "exit status 3");
    assert_true(run("pwd; echo $TMPDIR", 10, room));
    assert_string_equal(output.at, "/tmp\n/tmp\n");
}

static void test_a_program_that_is_not_there(void **state)
{
    (void)state;
    const char *const argv[] = { "/nowhere/reader", NULL };
    assert_false(child_run(&(struct child_params){ argv, "/tmp", 10, room }, &output, why));
    assert_string_equal(why, "/nowhere/reader: No such file or directory");
}

static void test_a_crash_is_told(void **state)
{
    (void)state;
    assert_false(run("kill -SEGV $$", 10, room));
    assert_non_null(strstr(why, "crashed (Segmentation fault)"));
}

/* Also what it started in the background, which holds its pipes. */
static void test_a_hang_ends(void **state)
{
    (void)state;
    assert_false(run("sleep 1000 & sleep 1000", 1, room));
    assert_string_equal(why, "took longer than 1 s");
    assert_true(seconds < 5);
    assert_false(run("exec >/dev/null 2>&1; sleep 1000", 1, room));
    assert_true(seconds < 5);
    assert_true(run("sleep 1000 & echo done", 10, room));
    assert_string_equal(output.at, "done\n");
    assert_true(seconds < 5);
}

static void test_endless_output_is_cut(void **state)
{
    (void)state;
    assert_false(run("yes", 1, room));
    assert_true(output.length <= (2 << 20));
}

static void test_memory_is_limited(void **state)
{
    (void)state;
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    assert_false(run("dd if=/dev/zero of=/dev/null bs=512M count=1", 20, (size_t)64 << 20));
    assert_non_null(strstr(why, "memory"));
#endif
}

static void test_there_is_no_network(void **state)
{
    (void)state;
    assert_false(run("python3 -c 'import socket; socket.socket()'", 20, room));
    assert_non_null(strstr(why, "Permission"));
    assert_true(run("python3 -c 'import socket; socket.socketpair()'", 20, room));
}

static void test_a_signal_ends_it(void **state)
{
    (void)state;
    char script[64];
    snprintf(script, sizeof(script), "kill -TERM %d; sleep 1000", (int)getpid());
    assert_false(run(script, 20, room));
    assert_string_equal(why, "interrupted");
    assert_true(seconds < 5);
}

static bool gone_when_signalled;
static char path_of_work[256];

static void on_signal(int signal)
{
    (void)signal;
    gone_when_signalled = access(path_of_work, F_OK) != 0;
}

static void test_a_signal_waits_for_the_work_folder(void **state)
{
    (void)state;
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
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_output_and_the_last_line_of_errors),
        cmocka_unit_test(test_a_program_that_is_not_there),
        cmocka_unit_test(test_a_crash_is_told),
        cmocka_unit_test(test_a_hang_ends),
        cmocka_unit_test(test_endless_output_is_cut),
        cmocka_unit_test(test_memory_is_limited),
        cmocka_unit_test(test_there_is_no_network),
        cmocka_unit_test(test_a_signal_ends_it),
        cmocka_unit_test(test_a_signal_waits_for_the_work_folder),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    int failed = cmocka_run_group_tests_name("child", tests, NULL, NULL);
    text_finish(&output);
    return failed;
}
