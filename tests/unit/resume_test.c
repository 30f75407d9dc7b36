/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plantcast-prep is killed or interrupted by a signal while it prepares a large facility, and is run again: it must keep the
   assets that were finished and prepare only the others. */
#include "tests/support/test.h"
#include <dirent.h>
#include <fcntl.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "tests/support/prep_case.h"
#include "tests/support/sleep.h"

#define ASSETS 40
#define PATIENCE_NS (120 * NS_PER_S)

static int set_up(void **state)
{
    const char *out = getenv("PLANTCAST_OUT");
    prep_case_set_up(state);
    struct prep_case *c = *state;
    char *tool = test_printf("%s/tests/scale/facility", out ? out : "build/release");
    char *command = test_printf("'%s' --output '%s' --assets %d --triangles 120000 --sensors 20 >/dev/null", tool, c->folder, ASSETS);
    int status = access(tool, X_OK) == 0 ? system(command) : -1;
    if (status != 0)
        print_message("# %s: %d\n", tool, status);
    c->plant = temp_path(c->folder, "facility.yaml");
    return status;
}

#define CASE(name) TEST_ON(struct prep_case *c, name, set_up, prep_case_tear_down)

/* Returns how many files in facility.prepared have a name that ends in `ending`. */
static size_t count_files(const struct prep_case *c, const char *ending)
{
    char *folder = temp_path(c->folder, "facility.prepared");
    size_t count = 0;
    DIR *dir = opendir(folder);
    for (const struct dirent *entry; dir && (entry = readdir(dir)) != NULL;) {
        size_t length = strlen(entry->d_name), end = strlen(ending);
        count += length >= end && strcmp(entry->d_name + length - end, ending) == 0;
    }
    if (dir)
        closedir(dir);
    return count;
}

/* Starts plantcast-prep with its standard output in FOLDER/out. Returns the process id. */
static pid_t start(const struct prep_case *c, int terminal)
{
    char *program = prep_case_program(), *out = temp_path(c->folder, "out");
    pid_t pid = fork();
    if (pid == 0) {
        int fd = open(out, O_WRONLY | O_CREAT | O_TRUNC, 0666), nothing = open("/dev/null", O_WRONLY);
        dup2(fd, STDOUT_FILENO);
        dup2(terminal >= 0 ? terminal : nothing, STDERR_FILENO);
        execl(program, program, c->plant, "--report", "json", (char *)NULL);
        _exit(127);
    }
    assert_true(pid > 0);
    return pid;
}

static void wait_for_files(const struct prep_case *c, size_t count)
{
    int64_t end_ns = clock_mono_ns() + PATIENCE_NS;
    while (count_files(c, ".asset") < count && clock_mono_ns() < end_ns)
        sleep_ns(2 * NS_PER_MS);
    assert_true(count_files(c, ".asset") >= count);
}

static size_t count_states(const json_t *report, const char *state)
{
    const json_t *assets = json_object_get(report, "assets");
    size_t count = 0;
    for (size_t i = 0; i < json_array_size(assets); i++)
        count += strcmp(json_string_value(json_object_get(json_array_get(assets, i), "state")), state) == 0;
    return count;
}

static void assert_continued(struct prep_case *c, size_t there)
{
    prep_case_expect(c, "$PLANT --report json", 0);
    json_t *report = prep_case_json(&c->out);
    print_message("# %zu assets were there, %zu were built\n", count_states(report, "unchanged"), count_states(report, "built"));
    assert_int_equal(count_states(report, "unchanged"), there);
    assert_int_equal(count_states(report, "built"), ASSETS - there);
    assert_int_equal(count_files(c, ".asset"), ASSETS);
    assert_int_equal(count_files(c, ".new"), 0); /* half-written files are deleted */
    assert_int_equal(count_files(c, "manifest.json"), 1);
}

CASE(killed_at_once_it_goes_on)
{
    int status;
    for (size_t wanted = 5; wanted <= 15; wanted += 10) {
        pid_t pid = start(c, -1);
        wait_for_files(c, wanted);
        assert_int_equal(kill(pid, SIGKILL), 0);
        assert_int_equal(waitpid(pid, &status, 0), pid);
        assert_true(WIFSIGNALED(status));
        assert_int_equal(count_files(c, "manifest.json"), 0);
    }
    size_t there = count_files(c, ".asset");
    assert_true(there >= 15 && there < ASSETS);
    temp_write_text(c->folder, "facility.prepared/0123456789abcdef.asset.1.new", "half");
    assert_continued(c, there);
}

CASE(interrupted_it_finishes_what_it_has_begun)
{
    const int signals[2] = { SIGINT, SIGTERM };
    size_t there = 0;
    for (int i = 0; i < 2; i++) {
        int status;
        pid_t pid = start(c, -1);
        wait_for_files(c, there + 3);
        assert_int_equal(kill(pid, signals[i]), 0);
        assert_int_equal(waitpid(pid, &status, 0), pid);
        assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 1);
        prep_case_read(c, "out", &c->out);
        json_t *report = prep_case_json(&c->out);
        assert_true(json_is_true(json_object_get(report, "interrupted")));
        assert_true(count_states(report, "left") > 0);
        assert_int_equal(count_states(report, "failed"), 0);
        assert_int_equal(count_states(report, "unchanged"), there);
        there += count_states(report, "built");
        assert_int_equal(count_files(c, ".asset"), there);
        assert_int_equal(count_files(c, ".new"), 0);
        assert_int_equal(count_files(c, "manifest.json"), 0);
    }
    assert_continued(c, there);
}

/* On a terminal, progress is one line that is updated and erased at the end. */
CASE(a_terminal_shows_one_line)
{
    struct text *seen = test_text();
    char bytes[4096];
    int master, terminal, status;
    assert_int_equal(openpty(&master, &terminal, NULL, NULL, NULL), 0);
    pid_t pid = start(c, terminal);
    close(terminal);
    for (ssize_t got; (got = read(master, bytes, sizeof(bytes))) > 0;)
        text_add_bytes(seen, bytes, (size_t)got);
    close(master);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    prep_case_says(seen, "preparing 40 of 40 assets");
    prep_case_says(seen, "\r");
    prep_case_says(seen, " of 40 assets prepared, ");
    prep_case_says(seen, " left\033[K");
    assert_string_equal(seen->at + seen->length - 4, "\r\033[K");
}
