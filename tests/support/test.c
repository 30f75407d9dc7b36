/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/support/test.h"

#include <errno.h>

enum { MOST = 128 };

static struct {
    struct CMUnitTest tests[MOST];
    int lines[MOST]; /* source lines of the tests registered so far, in ascending order */
    size_t count;
    CMFixtureFunction set_up, tear_down;
    size_t owned_by_group;
} program;

void test_add(const struct CMUnitTest *test, int line)
{
    if (program.count == MOST)
        abort();
    size_t at = program.count++;
    for (; at > 0 && program.lines[at - 1] > line; at--) {
        program.tests[at] = program.tests[at - 1];
        program.lines[at] = program.lines[at - 1];
    }
    program.tests[at] = *test;
    program.lines[at] = line;
}

void test_group(CMFixtureFunction set_up, CMFixtureFunction tear_down)
{
    program.set_up = set_up;
    program.tear_down = tear_down;
}

int test_end(CMFixtureFunction tear_down, void **state)
{
    int status = tear_down ? tear_down(state) : 0;
    owned_release(program.owned_by_group);
    return status;
}

static int group_begin(void **state)
{
    int status = program.set_up ? program.set_up(state) : 0;
    program.owned_by_group = owned_count();
    return status;
}

int tests_run(const char *name)
{
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return _cmocka_run_group_tests(name ? name : program_invocation_short_name, program.tests, program.count, group_begin,
                                   program.tear_down);
}
