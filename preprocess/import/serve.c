/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Links the given files into the plant's folder of exports, prepares the plant, and replaces this process with the daemon. */
#include "preprocess/import/serve.h"

#include <errno.h>
#include <limits.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/mem.h"
#include "plant/plant_folder.h"
#include "importing/export_folder.h"
#include "preprocess/import/import_fail.h"
#include "preprocess/import/plant_draft.h"

static int make_folder(const char *path)
{
    return mkdir(path, 0777) == 0 || errno == EEXIST ? 0 : import_fail(path, strerror(errno));
}

/* Adds a symlink to the file to the folder of exports. The file stays where it is, because it may refer to files in its own folder. */
static int add_link(const char *exports, const char *file)
{
    char target[PATH_MAX];
    const char *slash = strrchr(file, '/'), *name = slash ? slash + 1 : file;
    if (!realpath(file, target))
        return import_fail(file, strerror(errno));
    if (!export_name_good(name))
        return import_fail(file, "import --serve does not allow this file name: rename the file");
    char *link = mem_printf("%s/%s", exports, name);
    int status = 0;
    if (export_kind_of(name) == EXPORT_TAGS)
        export_folder_remove_tag_lists(exports, NULL);
    if (unlink(link) != 0 && errno != ENOENT)
        status = import_fail(link, strerror(errno));
    else if (symlink(target, link) != 0)
        status = import_fail(link, strerror(errno));
    mem_free(link);
    return status;
}

static int beside(char path[PATH_MAX], const char *name)
{
    ssize_t length = readlink("/proc/self/exe", path, PATH_MAX - 32);
    path[length > 0 ? length : 0] = 0;
    char *slash = strrchr(path, '/');
    if (!slash)
        return import_fail(name, "this program cannot be found: the folder of the running program is unknown");
    strcpy(slash + 1, name);
    return 0;
}

static int prepare(const char *plant)
{
    char program[PATH_MAX];
    char *const arguments[] = { program, (char *)(uintptr_t)plant, NULL };
    pid_t child;
    int status;
    if (beside(program, "plantcast-prep") != 0)
        return 1;
    int error = posix_spawn(&child, program, NULL, NULL, arguments, environ);
    if (error)
        return import_fail(program, strerror(error));
    while (waitpid(child, &status, 0) < 0 && errno == EINTR)
        ;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? 0 : import_fail(plant, "the plant cannot be prepared: the errors above say why");
}

static int run_daemon(const struct serve_params *params, const char *plant)
{
    char program[PATH_MAX];
    char *const arguments[] = {
        program, params->count > 0 ? "--import=now" : "--import", "--port", (char *)(uintptr_t)params->port, (char *)(uintptr_t)plant, NULL
    };
    if (beside(program, "plantcastd") != 0)
        return 1;
    fflush(stdout);
    execv(program, arguments);
    return import_fail(program, strerror(errno));
}

int import_serve(const struct serve_params *params)
{
    char *plant = mem_printf("%s/plant.yaml", params->folder), *exports = export_folder_of(params->folder);
    int status = make_folder(params->folder);
    if (status == 0)
        status = make_folder(exports);
    /* lock the plant's folder, so that no other program uses it; keep the lock until this process becomes the daemon */
    if (status == 0) {
        char *why = NULL;
        if (plant_folder_lock(&(struct plant_folder_params){ .folder = params->folder }, &why) < 0)
            status = import_fail(params->folder, why);
        mem_free(why);
    }
    if (status == 0)
        status = plant_draft_begin(params->folder) == 0 ? 0 : 1;
    for (int i = 0; i < params->count && status == 0; i++)
        status = add_link(exports, params->files[i]);
    if (status == 0)
        status = prepare(plant);
    if (status == 0)
        status = run_daemon(params, plant);
    mem_free(exports);
    mem_free(plant);
    return status;
}
