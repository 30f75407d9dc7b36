/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replays the seeds of the fuzzer of RVM files and their attributes, and what random changes make of them. PLANTCAST_FUZZ_ROUNDS: how many
 * of each seed. */
#include "tests/fuzz/rvm_fuzz.c"

#include <setjmp.h>
#include <stdarg.h>
#include <cmocka.h>

#include "tests/support/replay.h"

static void seeds_and_their_changes_keep_the_promises(void **state)
{
    const char *rounds = getenv("PLANTCAST_FUZZ_ROUNDS");
    (void)state;
    assert_true(replay_folder("tests/fuzz/rvm", rounds ? atoi(rounds) : 2000, LLVMFuzzerTestOneInput) >= 2);
}

int main(void)
{
    cmocka_set_message_output(CM_OUTPUT_TAP);
    const struct CMUnitTest tests[] = { cmocka_unit_test(seeds_and_their_changes_keep_the_promises) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
