/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replays the inputs in tests/fuzz/outline, and random mutations of them, through the fuzzer for polygon outlines. */
#include "tests/fuzz/outline_fuzz.c"

#include "tests/support/test.h"

#include "tests/support/replay.h"

TEST(seeds_and_their_changes_keep_the_promises)
{
    assert_true(replay_folder("tests/fuzz/outline", 400, LLVMFuzzerTestOneInput) >= 1);
}
