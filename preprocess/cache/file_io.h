/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bytes at a place of a file, all of them, however few the system takes at once. Several threads may, in places of their own. */
#ifndef PREPROCESS_CACHE_FILE_IO_H
#define PREPROCESS_CACHE_FILE_IO_H
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/* False: errno says why; EIO where the file ends, or takes no more. */
bool file_read(int fd, void *to, size_t bytes, off_t at);
bool file_write(int fd, const void *from, size_t bytes, off_t at);

#endif
