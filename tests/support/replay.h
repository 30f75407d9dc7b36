/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Feeds a fuzzer's seeds, and random mutations of them, to its function. */
#ifndef TESTS_REPLAY_H
#define TESTS_REPLAY_H
#include <stddef.h>
#include <stdint.h>

/* Feeds every file of the folder unchanged and in `rounds` mutations, which are the same in each run. Returns the number of
   files; -1: the folder does not exist. */
int replay_folder(const char *folder, int rounds, int (*feed)(const uint8_t *bytes, size_t count));

#endif
