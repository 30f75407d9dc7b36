/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A fuzzer's seeds, and what random changes make of them, fed to its function. */
#ifndef TESTS_REPLAY_H
#define TESTS_REPLAY_H
#include <stddef.h>
#include <stdint.h>

/* Every file of the folder, as it is and changed in `rounds` ways, the same at every run. How many files there were; -1: no folder. */
int replay_folder(const char *folder, int rounds, int (*feed)(const uint8_t *bytes, size_t count));

#endif
