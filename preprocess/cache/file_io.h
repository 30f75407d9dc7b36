/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes whole byte ranges at given file offsets, repeating partial system calls. Call from any thread; concurrent
 * calls are safe for ranges that do not overlap. */
#ifndef PREPROCESS_CACHE_FILE_IO_H
#define PREPROCESS_CACHE_FILE_IO_H
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/* Reads exactly `bytes` bytes from offset `at` of fd into `to`. Returns false with errno set; EIO if the file ends early. */
bool file_read(int fd, void *to, size_t bytes, off_t at);
/* Writes exactly `bytes` bytes from `from` to offset `at` of fd. Returns false with errno set; EIO if the file accepts no more. */
bool file_write(int fd, const void *from, size_t bytes, off_t at);

#endif
