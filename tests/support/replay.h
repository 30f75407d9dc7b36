/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Feeds a fuzzer's seeds, and random mutations of them, to its function. */
#ifndef TESTS_REPLAY_H
#define TESTS_REPLAY_H
#include <stddef.h>
#include <stdint.h>

/* Calls feed() with each file of the folder, then with `rounds` mutations of that file, which are the same in each run. Returns
   the number of files, or -1 if the folder does not exist. */
int replay_folder(const char *folder, int rounds, int (*feed)(const uint8_t *bytes, size_t count));

#endif
