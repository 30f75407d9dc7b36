/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Confines the process by executing the program again from a confined thread. exec makes the kernel end all other threads,
   which are not confined. */
#include "preprocess/child/child_self.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

static const char mark[] = "PLANTCAST_CONFINED";

bool child_self_confined(void)
{
    return getenv(mark) != NULL;
}

static int count_threads(void)
{
    int count = 0;
    DIR *folder = opendir("/proc/self/task");
    for (const struct dirent *entry; folder && (entry = readdir(folder));)
        count += entry->d_name[0] != '.';
    if (folder)
        closedir(folder);
    return count;
}

int child_self_confine(const struct child_paths *paths, bool notifies, char **argv)
{
    int threads = count_threads();
    const struct confine_params params = { .role = CONFINE_READER, .paths = paths->at, .path_count = paths->count, .notifies = notifies };
    int status = confine(&params);
    if (status != 0 || threads == 1)
        return status;
    if (setenv(mark, "1", 1) == 0)
        execv("/proc/self/exe", argv);
    return -errno;
}
