/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creates and removes temporary work folders. */
#include "preprocess/child/work_folder.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"
#include "plant/plant_folder.h"

static sigset_t waiting_signals(void)
{
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    return set;
}

bool work_folder_interrupted(void)
{
    sigset_t pending;
    return sigpending(&pending) == 0 && (sigismember(&pending, SIGINT) || sigismember(&pending, SIGTERM));
}

int work_folder_begin(struct work_folder *work, const char *target)
{
    const char *temporary = getenv("TMPDIR");
    *work = (struct work_folder){ 0 };
    sigset_t waiting = waiting_signals();
    sigprocmask(SIG_BLOCK, &waiting, &work->before);
    if (target) {
        work->created = mkdir(target, 0777) == 0;
        if (!work->created && errno != EEXIST) {
            int status = -errno;
            work_folder_end(work, false);
            return status;
        }
        work->target = mem_strdup(target);
    }
    char *real = realpath(target ? target : temporary && temporary[0] ? temporary : "/tmp", NULL);
    work->path = real ? mem_printf("%s/.import-XXXXXX", real) : NULL;
    free(real);
    if (work->path && mkdtemp(work->path))
        return 0;
    int status = -errno;
    mem_free(work->path);
    work->path = NULL;
    work_folder_end(work, false);
    return status;
}

void work_folder_end(struct work_folder *work, bool keep)
{
    if (work->path && plant_folder_remove(work->path) != 0)
        fprintf(stderr, "plantcast: %s: %s\n", work->path, strerror(errno));
    if (work->target && work->created && !keep)
        rmdir(work->target);
    mem_free(work->path);
    mem_free(work->target);
    sigset_t before = work->before;
    *work = (struct work_folder){ 0 };
    /* restores the signal mask: a SIGINT or SIGTERM that arrived while both were blocked takes effect now */
    sigprocmask(SIG_SETMASK, &before, NULL);
}
