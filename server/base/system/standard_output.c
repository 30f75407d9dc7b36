/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Detects output that was lost, for example on a full disk, so that scripts see an exit code other than 0. */
#include "base/system/standard_output.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

int standard_output_end(const char *program, int code)
{
    errno = 0;
    bool good = fflush(stdout) == 0 && !ferror(stdout);
    if (!good)
        fprintf(stderr, "%s: standard output could not be written%s%s\n", program, errno ? ": " : "", errno ? strerror(errno) : "");
    return good || code ? code : 1;
}
