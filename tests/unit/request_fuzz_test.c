/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs the fuzzer of HTTP requests on its stored seeds and on random changes of them. */
#include "tests/fuzz/request_fuzz.c"

#include "tests/support/test.h"

#include "tests/support/replay.h"

TEST(seeds_and_their_changes_keep_the_promises)
{
    assert_true(replay_folder("tests/fuzz/request", 1000, LLVMFuzzerTestOneInput) >= 12);
}
