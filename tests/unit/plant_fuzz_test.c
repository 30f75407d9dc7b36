/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replays the seeds of the plant file fuzzer and a few thousand random mutations of them. */
#include "tests/fuzz/plant_fuzz.c"

#include "tests/support/test.h"
#include <dirent.h>

#include "base/text/text.h"

#define SEEDS "tests/fuzz/plant"
enum { CHANGED = 200, MAX_BYTES = 1 << 16 };

/* Changes the text at a random place as a careless editor might: replaces a byte, by a random one or by one with a meaning in
   YAML or CSV, or removes or repeats up to 12 bytes. Returns the new length. */
static size_t change(uint8_t *bytes, size_t count, size_t room)
{
    size_t at = (size_t)rand() % (count + 1), piece = (size_t)rand() % 12 + 1;
    if (at + piece > count)
        return count;
    switch (rand() % 4) {
    case 0:
        bytes[at] = (uint8_t)rand();
        return count;
    case 1:
        memmove(bytes + at, bytes + at + piece, count - at - piece);
        return count - piece;
    case 2:
        if (count + piece > room)
            return count;
        memmove(bytes + at + piece, bytes + at, count - at);
        return count + piece;
    default:
        bytes[at] = (uint8_t)"\t\r\n\",;:[]{}-#&*!?.0e\xC3"[rand() % 22];
        return count;
    }
}

static void replay(const char *path, unsigned seed)
{
    static uint8_t bytes[MAX_BYTES];
    size_t count;
    char *text = test_memory(text_read_file(path, MAX_BYTES / 2, &count));
    assert_non_null(text);
    LLVMFuzzerTestOneInput((const uint8_t *)text, count);
    for (int round = 0; round < CHANGED; round++) {
        size_t length = count;
        memcpy(bytes, text, count);
        srand(seed + (unsigned)round); /* each round has its own seed, so that it can be repeated alone */
        for (int changes = rand() % 4; changes >= 0; changes--)
            length = change(bytes, length, MAX_BYTES);
        LLVMFuzzerTestOneInput(bytes, length);
    }
}

TEST(seeds_and_their_changes_keep_the_promises)
{
    DIR *seed_folder = opendir(SEEDS);
    int seeds = 0;
    assert_non_null(seed_folder);
    for (struct dirent *entry; (entry = readdir(seed_folder));) {
        if (entry->d_name[0] == '.')
            continue;
        char *path = temp_path(SEEDS, entry->d_name);
        print_message("# %s\n", path);
        replay(path, 1);
        seeds++;
    }
    closedir(seed_folder);
    assert_true(seeds >= 7);
}
