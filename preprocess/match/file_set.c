/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the new content of all files in a set to temporary files, then renames each to its final name. */
#include "preprocess/match/file_set.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* seconds after which a temporary file is removed as a leftover; its writer may be a process of another container or machine,
 * which cannot be seen from here, but would have finished by then */
enum { LEFT_S = 60 };

static bool is_old(int folder, const char *name)
{
    struct stat st;
    return fstatat(folder, name, &st, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(st.st_mode) && st.st_mtime + LEFT_S < time(NULL);
}

/* Returns whether a file is a temporary file (NAME.PID.new or .trial.PID.yaml) whose process no longer exists. */
static bool is_left(int folder, const char *name)
{
    static const char *const begins[] = { "plant.yaml.", "tags.csv.", "matches.csv.", ".trial." };
    int pid, end = 0;
    for (size_t i = 0; i < sizeof(begins) / sizeof(begins[0]); i++) {
        size_t length = strlen(begins[i]);
        if (strncmp(name, begins[i], length) != 0 || sscanf(name + length, "%d.%n", &pid, &end) != 1 || end == 0 || pid <= 0)
            continue;
        const char *ending = strrchr(name + length, '.');
        bool ours = !strcmp(ending, ".new") || (*name == '.' && (!strcmp(ending, ".yaml") || !strcmp(ending, ".csv")));
        return ours && kill(pid, 0) != 0 && errno == ESRCH && is_old(folder, name);
    }
    return false;
}

int file_set_lock(const struct plant_folder_params *params, char **why)
{
    int fd = plant_folder_lock(params, why);
    if (fd < 0)
        return fd;
    DIR *dir = opendir(params->folder);
    for (struct dirent *entry; dir && (entry = readdir(dir)) != NULL;)
        if (is_left(fd, entry->d_name))
            unlinkat(fd, entry->d_name, 0);
    if (dir)
        closedir(dir);
    return fd;
}

/* Gives a new file the mode and owner of the file it replaces. */
static int take_rights(int fd, const char *path)
{
    struct stat st;
    if (stat(path, &st) != 0)
        return errno == ENOENT ? 0 : -errno;
    if (fchown(fd, st.st_uid, st.st_gid) != 0 && errno != EPERM)
        return -errno;
    return fchmod(fd, st.st_mode & 07777) == 0 ? 0 : -errno;
}

int file_set_add(struct file_set *set, const char *path, const char *text)
{
    char *target = realpath(path, NULL);
    struct atomic_file *file = &set->files[set->count];
    int status = set->count < FILE_SET_ROOM ? atomic_file_begin(file, target ? target : path, 0666) : -ENOSPC;
    if (status == 0) {
        set->count++;
        status = take_rights(file->fd, path);
    }
    if (status == 0)
        status = atomic_file_write(file, text, strlen(text));
    if (status == 0 && fsync(file->fd) != 0)
        status = -errno;
    free(target);
    return status;
}

int file_set_commit(struct file_set *set)
{
    int status = 0;
    for (int i = 0; i < set->count && status == 0; i++)
        status = atomic_file_commit(&set->files[i], true);
    file_set_abandon(set);
    return status;
}

void file_set_abandon(struct file_set *set)
{
    for (int i = 0; i < set->count; i++)
        atomic_file_abandon(&set->files[i]);
    set->count = 0;
}
