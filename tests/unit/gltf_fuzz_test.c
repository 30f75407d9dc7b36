/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs the model fuzzer on its stored seeds and on random changes of them. `gltf_fuzz_test --write FOLDER` writes the seeds. */
#include "tests/fuzz/gltf_fuzz.c"

#include "tests/support/test.h"

#include "tests/support/model_seeds.h"
#include "tests/support/replay.h"

#define SEEDS "tests/fuzz/gltf"
enum { BY_HAND = 3, FOUND = 2 };

TEST(seeds_and_their_changes_keep_the_promises)
{
    assert_true(replay_folder(SEEDS, 150, LLVMFuzzerTestOneInput) >= SEED_COUNT + BY_HAND + FOUND);
}

static int write_seeds(const char *to)
{
    struct wavy_sheet sheet = sheet_create(2, 2);
    for (int i = 0; i < SEED_COUNT; i++) {
        struct seed seed;
        seed_make(&seed, i, &sheet);
        temp_write(to, seed.name, seed.bytes, seed.size);
        mem_free(seed.bytes);
    }
    return 0;
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--write") == 0)
        return write_seeds(argv[2]);
    return tests_run(NULL);
}
