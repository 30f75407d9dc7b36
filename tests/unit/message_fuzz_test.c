/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replays the seeds of the fuzzer of clients' messages, and what random changes make of them. */
#include "tests/fuzz/message_fuzz.c"

#include <setjmp.h>
#include <stdarg.h>
#include <cmocka.h>

#include "tests/support/replay.h"

static void seeds_and_their_changes_keep_the_promises(void **state)
{
    (void)state;
    assert_true(replay_folder("tests/fuzz/message", 400, LLVMFuzzerTestOneInput) >= 6);
}

int main(void)
{
    cmocka_set_message_output(CM_OUTPUT_TAP);
    const struct CMUnitTest tests[] = { cmocka_unit_test(seeds_and_their_changes_keep_the_promises) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
