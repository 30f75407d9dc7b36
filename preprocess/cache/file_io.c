/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "preprocess/cache/file_io.h"

#include <errno.h>
#include <unistd.h>

/* Moves the byte range that remains to be read or written forward by the result of a system call. Returns false on an error, or
 * if no bytes were transferred. */
static bool went_on(ssize_t done, size_t *bytes, off_t *at)
{
    if (done < 0)
        return errno == EINTR;
    *at += done;
    *bytes -= (size_t)done;
    if (done == 0)
        errno = EIO;
    return done > 0;
}

bool file_read(int fd, void *to, size_t bytes, off_t at)
{
    for (off_t from = at; bytes;)
        if (!went_on(pread(fd, (char *)to + (at - from), bytes, at), &bytes, &at))
            return false;
    return true;
}

bool file_write(int fd, const void *from, size_t bytes, off_t at)
{
    for (off_t first = at; bytes;)
        if (!went_on(pwrite(fd, (const char *)from + (at - first), bytes, at), &bytes, &at))
            return false;
    return true;
}
