/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replaces a file as a whole: writes a temporary file in the same folder, then renames it over the old file, so that readers
   see the old content or the new one, never a part. */
#include "base/files/atomic_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"

/* maximum number of names tried for the temporary file: killed programs with the same process id may have left files behind */
enum { MAX_TRIES = 1000 };

int atomic_file_begin(struct atomic_file *file, const char *path, mode_t mode)
{
    long pid = (long)getpid();
    *file = (struct atomic_file){ .fd = -1 };
    for (int i = 0; i < MAX_TRIES && file->fd < 0; i++) {
        mem_free(file->beside);
        file->beside = i ? mem_printf("%s.%ld.%d.new", path, pid, i) : mem_printf("%s.%ld.new", path, pid);
        file->fd = open(file->beside, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, mode);
        if (file->fd < 0 && errno != EEXIST)
            break;
    }
    if (file->fd < 0) {
        int error = -errno;
        mem_free(file->beside);
        file->beside = NULL;
        return error;
    }
    file->path = mem_strdup(path);
    return 0;
}

int atomic_file_write(struct atomic_file *file, const void *bytes, size_t count)
{
    for (const char *at = bytes; count > 0;) {
        ssize_t n = write(file->fd, at, count);
        if (n < 0 && errno != EINTR)
            return -errno;
        at += n > 0 ? n : 0;
        count -= n > 0 ? (size_t)n : 0;
    }
    return 0;
}

static void end(struct atomic_file *file)
{
    mem_free(file->beside);
    mem_free(file->path);
    *file = (struct atomic_file){ .fd = -1 };
}

/* Syncs the folder, so that the new name is on disk. Ignores errors: some file systems cannot sync a folder, but keep its files
   safe anyway. */
static void sync_folder_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *folder = slash ? mem_printf("%.*s", slash > path ? (int)(slash - path) : 1, path) : mem_strdup(".");
    int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd >= 0) {
        fsync(fd);
        close(fd);
    }
    mem_free(folder);
}

int atomic_file_commit(struct atomic_file *file, bool durable)
{
    int error = fsync(file->fd) != 0 ? -errno : 0;
    if (close(file->fd) != 0 && !error)
        error = -errno;
    if (!error && rename(file->beside, file->path) != 0)
        error = -errno;
    if (error)
        unlink(file->beside);
    else if (durable)
        sync_folder_of(file->path);
    end(file);
    return error;
}

void atomic_file_abandon(struct atomic_file *file)
{
    if (!file->beside)
        return;
    close(file->fd);
    unlink(file->beside);
    end(file);
}

static int put_parts(const char *path, const struct atomic_file_part *parts, size_t part_count, bool durable)
{
    struct atomic_file file;
    int error = atomic_file_begin(&file, path, 0666);
    if (error)
        return error;
    for (size_t i = 0; i < part_count && !error; i++)
        error = atomic_file_write(&file, parts[i].bytes, parts[i].count);
    if (!error)
        return atomic_file_commit(&file, durable);
    atomic_file_abandon(&file);
    return error;
}

int atomic_file_put_parts(const char *path, const struct atomic_file_part *parts, size_t part_count)
{
    return put_parts(path, parts, part_count, false);
}

int atomic_file_put(const char *path, const void *bytes, size_t count)
{
    return put_parts(path, &(struct atomic_file_part){ bytes, count }, 1, false);
}

int atomic_file_keep(const char *path, const void *bytes, size_t count)
{
    return put_parts(path, &(struct atomic_file_part){ bytes, count }, 1, true);
}

enum refusal_code atomic_file_not_kept(int error)
{
    switch (-error) {
    case 0: return REFUSAL_NONE;
    case ENOSPC:
    case EDQUOT:
    case EFBIG: return REFUSAL_DISK_FULL;
    case EROFS: return REFUSAL_DISK_LOCKED;
    case ETIMEDOUT: return REFUSAL_DISK_SLOW;
    default: return REFUSAL_DISK;
    }
}
