/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Locks a plant's folder with a kernel lock on the folder itself, and replaces the folder's files at the end of a revision (an
   import or its undoing). */
#include "plant_folder.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/text.h"

enum { LOOK_MS = 50 };
/* name that the folder with a revision's record gets once the revision is undone completely; the next program that locks the
   plant's folder removes it */
static const char undone[] = ".import-undone";
static const size_t max_text_bytes = (size_t)64 << 20;

char *plant_folder_file(const char *folder, const char *name)
{
    return *name == '/' ? mem_strdup(name) : mem_printf("%s/%s", folder, name);
}

char *revision_version_of(const char *record, const char *version, const char *name)
{
    return *name == '/' ? mem_printf("%s/%s/elsewhere-%s", record, version, strrchr(name, '/') + 1)
                        : mem_printf("%s/%s/%s", record, version, name);
}

int plant_folder_sync(const char *folder)
{
    int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC), status = fd < 0 ? -errno : 0;
    if (fd >= 0 && fsync(fd) != 0 && errno != EINVAL) /* ignores EINVAL, because some file systems cannot sync a folder */
        status = -errno;
    if (fd >= 0)
        close(fd);
    return status;
}

static int move(const char *from, const char *to)
{
    return rename(from, to) == 0 ? 0 : -errno;
}

static int remove_one(const char *path, const struct stat *st, int kind, struct FTW *at)
{
    (void)st;
    (void)kind;
    (void)at;
    return remove(path) == 0 || errno == ENOENT ? 0 : -1;
}

int plant_folder_remove(const char *path)
{
    return nftw(path, remove_one, 16, FTW_DEPTH | FTW_PHYS) == 0 ? 0 : -errno;
}

/* --- reads and writes the record of a revision ---------------------------------------------------------------------------------- */

int revision_record_read(struct revision_record *record, const char *folder, const char *name)
{
    size_t bytes;
    *record = (struct revision_record){ .path = plant_folder_file(folder, name) };
    char *list = plant_folder_file(record->path, "files"), *text = text_read_file(list, 1 << 20, &bytes), *next = text;
    int status = text ? 0 : -errno;
    for (char *line = text ? strsep(&next, "\n") : NULL; line; line = strsep(&next, "\n")) {
        unsigned long long hash;
        int was, at = 0;
        if (sscanf(line, "%llx %d %n", &hash, &was, &at) < 2 || at == 0 || !line[at] || (line[at] != '/' && strchr(line + at, '/')))
            continue;
        mem_grow(&record->entries, &record->room, record->count + 1, sizeof(*record->entries));
        record->entries[record->count++] = (struct revision_entry){ mem_strdup(line + at), hash, was == 1 };
    }
    mem_free(text);
    mem_free(list);
    return status;
}

void revision_record_finish(struct revision_record *record)
{
    for (size_t i = 0; i < record->count; i++)
        mem_free(record->entries[i].name);
    mem_free(record->entries);
    mem_free(record->path);
}

/* --- continuing a revision ------------------------------------------------------------------------------------------------------ */

/* Replaces `to`, a file in another folder and perhaps on another file system, by a copy of `from`; the copy gets the owner and
   permissions of the old file. Returns 0 or -errno. */
static int put_elsewhere(const char *from, const char *to)
{
    struct atomic_file file = { .fd = -1 };
    struct stat st;
    size_t count;
    char *bytes = text_read_file(from, max_text_bytes, &count);
    int status = bytes && stat(from, &st) == 0 ? atomic_file_begin(&file, to, 0600) : -errno;
    if (status == 0) {
        if (fchown(file.fd, st.st_uid, st.st_gid) != 0 && errno != EPERM)
            status = -errno;
        else if (fchmod(file.fd, st.st_mode & 07777) != 0)
            status = -errno;
        if (status == 0)
            status = atomic_file_write(&file, bytes, count);
        if (status == 0)
            status = atomic_file_commit(&file, true);
        atomic_file_abandon(&file);
    }
    mem_free(bytes);
    if (status == 0)
        status = unlink(from) == 0 ? 0 : -errno;
    return status;
}

static int move_into_place(const struct revision_record *record, const char *folder, const char *from, const char *name)
{
    char *source = revision_version_of(record->path, from, name), *target = plant_folder_file(folder, name);
    /* the record has no version of this file to be moved: the file was moved already, or the revision does not change it; both
       count as success */
    int status = access(source, F_OK) != 0 ? 0 : *name == '/' ? put_elsewhere(source, target) : move(source, target);
    mem_free(source);
    mem_free(target);
    return status;
}

int revision_go_on_applying(const char *folder)
{
    struct revision_record record;
    char *last = plant_folder_file(folder, REVISION_MADE);
    int status = revision_record_read(&record, folder, REVISION_PENDING);
    for (size_t i = 0; i < record.count && status == 0; i++)
        status = move_into_place(&record, folder, "new", record.entries[i].name);
    status = status == 0 ? plant_folder_sync(folder) : status;
    if (status == 0) {
        plant_folder_remove(last);
        status = move(record.path, last);
    }
    revision_record_finish(&record);
    mem_free(last);
    return status;
}

int revision_go_on_undoing(const char *folder)
{
    struct revision_record record;
    char *last = plant_folder_file(folder, undone);
    int status = revision_record_read(&record, folder, REVISION_UNDOING);
    /* The record's list of files is missing, which means that all files are back in place: an earlier run was killed while it
       removed the record's folder. */
    if (status == -ENOENT)
        status = 0;
    for (size_t i = record.count; i-- > 0 && status == 0;) {
        char *path = plant_folder_file(folder, record.entries[i].name);
        if (record.entries[i].was)
            status = move_into_place(&record, folder, "old", record.entries[i].name);
        else
            status = unlink(path) == 0 || errno == ENOENT ? 0 : -errno;
        mem_free(path);
    }
    status = status == 0 ? plant_folder_sync(folder) : status;
    if (status == 0) {
        plant_folder_remove(last);
        status = move(record.path, last);
    }
    if (status == 0)
        plant_folder_remove(last);
    revision_record_finish(&record);
    mem_free(last);
    return status;
}

/* Returns whether programs that were killed left work folders (temporary folders of imports) in the plant's folder. now: true:
   also removes these folders. own: path of a work folder of this program, which is kept. */
static bool remove_left(const char *folder, const char *own, bool now)
{
    DIR *dir = opendir(folder);
    const char *slash = own ? strrchr(own, '/') : NULL;
    bool any = false;
    for (struct dirent *entry; dir && (entry = readdir(dir)) != NULL;)
        if (!strncmp(entry->d_name, ".import-", 8) && (!slash || strcmp(entry->d_name, slash + 1) != 0)) {
            char *path = plant_folder_file(folder, entry->d_name);
            any = true;
            if (now)
                plant_folder_remove(path);
            mem_free(path);
        }
    if (dir)
        closedir(dir);
    return any;
}

/* --- locking -------------------------------------------------------------------------------------------------------------------- */

/* Returns the id of the process that holds the folder's lock; 0: unknown to the kernel (in a container, on a network file system). */
static int holder_of(int fd)
{
    struct stat st;
    char line[256];
    int found = 0;
    FILE *locks = fstat(fd, &st) == 0 ? fopen("/proc/locks", "re") : NULL;
    while (locks && !found && fgets(line, sizeof(line), locks)) {
        int pid;
        unsigned big, small;
        unsigned long long inode;
        if (sscanf(line, "%*d: FLOCK %*s %*s %d %x:%x:%llu", &pid, &big, &small, &inode) == 4 && inode == st.st_ino &&
            big == major(st.st_dev) && small == minor(st.st_dev))
            found = pid > 0 ? pid : 0;
    }
    if (locks)
        fclose(locks);
    return found;
}

static char *say_holder(int fd)
{
    int pid = holder_of(fd);
    char name[32] = "", *path = mem_printf("/proc/%d/comm", pid);
    FILE *comm = pid > 0 ? fopen(path, "re") : NULL;
    if (comm && fgets(name, sizeof(name), comm))
        name[strcspn(name, "\n")] = 0;
    if (comm)
        fclose(comm);
    mem_free(path);
    return pid > 0 ? mem_printf("%s (process %d) is using the plant's folder", *name ? name : "another program", pid)
                   : mem_strdup("another program is using the plant's folder");
}

/* Opens the plant's folder, or duplicates the parent process's descriptor, which must refer to the same folder and hold its
   lock. Returns the descriptor; -1 with errno on failure. */
static int open_folder(const struct plant_folder_params *params)
{
    struct stat lent, folder;
    if (params->lent <= 0)
        return open(params->folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fstat(params->lent, &lent) != 0 || stat(params->folder, &folder) != 0)
        return -1;
    if (lent.st_dev != folder.st_dev || lent.st_ino != folder.st_ino) {
        errno = EBADF;
        return -1;
    }
    return fcntl(params->lent, F_DUPFD_CLOEXEC, 0);
}

static bool has(const char *folder, const char *name)
{
    char *path = plant_folder_file(folder, name);
    bool there = access(path, F_OK) == 0;
    mem_free(path);
    return there;
}

static int finish_killed(const struct plant_folder_params *params)
{
    const char *finished = NULL;
    int status = 0;
    if (has(params->folder, REVISION_PENDING)) {
        status = revision_go_on_applying(params->folder);
        finished = "an import";
    }
    if (status == 0 && has(params->folder, REVISION_UNDOING)) {
        status = revision_go_on_undoing(params->folder);
        finished = "the undo of an import";
    }
    if (params->finished && status == 0 && finished)
        *params->finished = finished;
    return status;
}

int plant_folder_lock(const struct plant_folder_params *params, char **why)
{
    int fd = open_folder(params), status = fd < 0 ? -errno : 0;
    int64_t until_ns = clock_mono_ns() + params->wait_ms * INT64_C(1000000);
    while (status == 0 && flock(fd, LOCK_EX | LOCK_NB) != 0)
        if (errno == EWOULDBLOCK && clock_mono_ns() < until_ns)
            usleep(LOOK_MS * 1000);
        /* continues without a lock, because this file system (NFS, for example) has none */
        else if (errno == EBADF || errno == ENOLCK || errno == EOPNOTSUPP)
            return fd; /* does not remove work folders without a lock, because another program may be using them */
        else if (errno != EINTR)
            status = -errno;
    if (status == 0) {
        remove_left(params->folder, params->own, true);
        status = finish_killed(params);
        if (status != 0)
            *why = mem_printf("an import was killed and cannot be completed: %s", strerror(-status));
    } else {
        *why = status == -EWOULDBLOCK ? say_holder(fd) : mem_strdup(strerror(-status));
    }
    if (status != 0 && fd >= 0)
        close(fd);
    return status == 0 ? fd : status;
}

bool plant_folder_unsettled(const char *folder)
{
    return has(folder, REVISION_PENDING) || has(folder, REVISION_UNDOING);
}

bool plant_folder_settle(const struct plant_folder_params *params, char **why)
{
    bool killed = plant_folder_unsettled(params->folder);
    if (!killed && !remove_left(params->folder, params->own, false))
        return true;
    struct plant_folder_params at_once = *params;
    at_once.wait_ms = killed ? params->wait_ms : 0;
    int lock = plant_folder_lock(&at_once, why);
    if (lock >= 0)
        close(lock);
    /* Without an unfinished revision, a failed lock is no error. The lock fails if a running import holds it but has not begun
       to replace files, or if this program lacks the right to remove work folders of killed programs. */
    if (!killed) {
        mem_free(*why);
        *why = NULL;
        return true;
    }
    if (lock >= 0 && plant_folder_unsettled(params->folder)) {
        *why = mem_strdup("an import in this folder was killed or still runs, and the folder cannot be locked: run plantcast import or "
                          "match again when no import runs");
        return false;
    }
    return lock >= 0;
}

char *plant_folder_of(const char *plant_path)
{
    const char *slash = strrchr(plant_path, '/');
    return slash ? mem_printf("%.*s", slash > plant_path ? (int)(slash - plant_path) : 1, plant_path) : mem_strdup(".");
}
