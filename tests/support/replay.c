/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a fuzzer's test function on its stored seed files and on random changes of them, without the fuzzing engine. */
#include "tests/support/replay.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "tests/support/temp.h"

#define MAX_BYTES ((size_t)1 << 20)

/* Changes an input randomly: one byte, a run of bytes or a digit, or cuts off the end. Only cutting changes the length;
   otherwise the lengths stated in the input's headers remain true. Returns the new length. */
static size_t change(uint8_t *bytes, size_t count)
{
    if (count == 0)
        return 0;
    size_t at = (size_t)rand() % count, run = (size_t)rand() % 8 + 1;
    if (run > count - at)
        run = count - at;
    switch (rand() % 16) {
    case 0: return at;
    case 1:
    case 2:
    case 3: memmove(bytes + at, bytes + (size_t)rand() % (count - run + 1), run); return count;
    case 4:
    case 5: memset(bytes + at, rand() % 2 ? 0xff : 0x7f, run); return count;
    case 6:
    case 7:
    case 8: bytes[at] = (uint8_t) "0123456789-.eE\",:[]{}"[rand() % 21]; return count;
    default: bytes[at] ^= (uint8_t)(1 << rand() % 8); return count;
    }
}

static void replay(const char *path, int rounds, int (*feed)(const uint8_t *bytes, size_t count))
{
    size_t count;
    char *seed = text_read_file(path, MAX_BYTES, &count);
    if (!seed)
        abort();
    feed((const uint8_t *)seed, count);
    for (int round = 0; round < rounds; round++) {
        uint8_t *bytes = mem_array(count + 1, 1);
        size_t length = count;
        memcpy(bytes, seed, count);
        srand((unsigned)round); /* seeds the random numbers with the round's number, so that a failing round can be repeated alone */
        for (int changes = rand() % 4; changes >= 0; changes--)
            length = change(bytes, length);
        feed(bytes, length);
        mem_free(bytes);
    }
    mem_free(seed);
}

int replay_folder(const char *folder, int rounds, int (*feed)(const uint8_t *bytes, size_t count))
{
    int files = 0;
    DIR *dir = opendir(folder);
    if (!dir)
        return -1;
    for (struct dirent *entry; (entry = readdir(dir));) {
        if (entry->d_name[0] == '.')
            continue;
        char *path = temp_path(folder, entry->d_name);
        printf("# %s\n", path);
        replay(path, rounds, feed);
        files++;
    }
    closedir(dir);
    return files;
}
