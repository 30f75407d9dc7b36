/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs the fuzzer of RVM and attribute files on its stored seeds and on random changes of them. PLANTCAST_FUZZ_ROUNDS: number
   of changes per seed. */
#include "tests/fuzz/rvm_fuzz.c"

#include "tests/support/test.h"

#include "tests/support/replay.h"

TEST(seeds_and_their_changes_keep_the_promises)
{
    const char *rounds = getenv("PLANTCAST_FUZZ_ROUNDS");
    assert_true(replay_folder("tests/fuzz/rvm", rounds ? atoi(rounds) : 2000, LLVMFuzzerTestOneInput) >= 2);
}
