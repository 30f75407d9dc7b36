/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The measured memory of this process, and returning freed memory to the system. */
#include "tests/support/test.h"

#include "base/system/memory.h"

enum { PIECES = 4096, PIECE_BYTES = 16 * 1024 };

TEST(the_default_suits_the_machine)
{
    size_t bytes = memory_default_bytes();
    assert_true(bytes > 0 && bytes <= (size_t)2 << 30);
}

/* Frees many small blocks, but not all: free() alone would keep the free memory between the remaining ones, and trimming must
   return it to the system. */
TEST(what_is_freed_goes_back)
{
    static void *pieces[PIECES];
    struct memory_use before, full, after;
    size_t all = (size_t)PIECES * PIECE_BYTES;
    memory_measure(&before);
    assert_true(before.resident >= before.anonymous && before.anonymous > 0);
    for (int i = 0; i < PIECES; i++) {
        pieces[i] = mem_array(PIECE_BYTES, 1);
        memset(pieces[i], 1, PIECE_BYTES);
    }
    void *last = mem_array(PIECE_BYTES, 1);
    memory_measure(&full);
    assert_true(full.anonymous >= before.anonymous + all * 9 / 10);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) /* sanitizers have their own malloc */
    assert_true(full.allocated >= before.allocated + all);
#endif
    for (int i = 0; i < PIECES; i++)
        mem_free(pieces[i]);
    memory_trim();
    memory_measure(&after);
    mem_free(last);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    assert_true(after.anonymous <= before.anonymous + all / 10);
#endif
}
