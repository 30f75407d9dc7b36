/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Copies SQLite databases and other files for a backup, and checks that each copy is complete. */
#include "history/copy.h"

#include <errno.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/mem.h"

enum { BUFFER_BYTES = 1 << 16, BUSY_MS = 10000 };

static bool failed(struct log *log, const char *path, const char *doing, const char *why)
{
    log_err(log, "%s: %s: %s", path, doing, why);
    return false;
}

static bool sync_file(struct log *log, const char *path)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    bool good = fd >= 0 && fsync(fd) == 0;
    int cause = errno;
    if (fd >= 0)
        close(fd);
    return good || failed(log, path, "the copy cannot be flushed to disk", strerror(cause));
}

/* --- checking and setting the owners of files -------------------------------------------------------------------------------- */

/* Returns the path of the folder that contains a file; free with mem_free(). */
static char *folder_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash == path ? mem_strdup("/") : slash ? mem_printf("%.*s", (int)(slash - path), path) : mem_strdup(".");
}

static bool stat_folder(const char *path, struct stat *st)
{
    char *folder = folder_of(path);
    bool good = stat(folder, st) == 0;
    mem_free(folder);
    return good;
}

/* Returns why a file must not be copied (static text), or NULL if it may be. The owner of the folder could put a hard link
   there to a file that only the caller (root) may read, so files of other users are refused. */
static const char *fault_of(const char *path, const struct stat *st)
{
    struct stat folder;
    if (!S_ISREG(st->st_mode))
        return "it is not a regular file";
    if (!stat_folder(path, &folder))
        return strerror(errno);
    if (st->st_uid != folder.st_uid && st->st_uid != geteuid())
        return "the file's owner differs from the owner of its folder";
    return st->st_nlink > 1 && st->st_uid != folder.st_uid ? "the file has another hard link, which is not allowed for copied files" : NULL;
}

/* Opens a file for copying. Refuses symbolic links, and files that fault_of() finds unsafe: not regular, or possibly planted by
   the folder's owner. Returns its descriptor, or -1 on failure (logged). */
static int open_source(struct log *log, const char *path)
{
    struct stat st;
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    const char *fault = fd < 0 ? errno == ELOOP ? "it is a symbolic link" : strerror(errno) : NULL;
    if (!fault)
        fault = fstat(fd, &st) == 0 ? fault_of(path, &st) : strerror(errno);
    if (!fault)
        return fd;
    failed(log, path, "cannot be copied", fault);
    if (fd >= 0)
        close(fd);
    return -1;
}

/* Creates the file for a copy, readable only by its owner and group. If root creates it, it gets the owner of its folder.
   Returns its descriptor, or -1 on failure (logged). */
static int create_target(struct log *log, const char *path)
{
    struct stat folder;
    int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0640);
    bool good = fd >= 0 && (geteuid() != 0 || (stat_folder(path, &folder) && fchown(fd, folder.st_uid, folder.st_gid) == 0));
    if (good)
        return fd;
    failed(log, path, "cannot be created", strerror(errno));
    if (fd >= 0) {
        unlink(path);
        close(fd);
    }
    return -1;
}

/* Returns true if SQLite's integrity check of a database finds no fault; otherwise logs the first fault. */
static bool is_whole(struct log *log, sqlite3 *db, const char *path)
{
    sqlite3_stmt *check = NULL;
    bool good = sqlite3_prepare_v2(db, "PRAGMA integrity_check(1)", -1, &check, NULL) == SQLITE_OK && sqlite3_step(check) == SQLITE_ROW;
    const char *said = good ? (const char *)sqlite3_column_text(check, 0) : sqlite3_errmsg(db);
    good = good && said && !strcmp(said, "ok");
    if (!good)
        failed(log, path, "is damaged", said ? said : "no answer");
    sqlite3_finalize(check);
    return good;
}

/* Copies all pages of a database in one call. The daemon can keep writing, because it writes to the write-ahead log. Returns an
   SQLite result code. */
static int copy_pages(sqlite3 *from, sqlite3 *to)
{
    sqlite3_backup *backup = sqlite3_backup_init(to, "main", from, "main");
    if (!backup)
        return sqlite3_errcode(to);
    int code = sqlite3_backup_step(backup, -1), end = sqlite3_backup_finish(backup);
    return code == SQLITE_DONE ? end : code;
}

/* Resolves all symbolic links in a database's path, because SQLITE_OPEN_NOFOLLOW refuses links. Returns the path (free with
   free()), or NULL if the file must not be copied (logged). */
static char *path_of_database(struct log *log, const char *path)
{
    int fd = open_source(log, path);
    char *real = fd >= 0 ? realpath(path, NULL) : NULL;
    if (fd >= 0)
        close(fd);
    return real;
}

static bool copy_state(struct log *log, const char *from_path, const char *to_path)
{
    sqlite3 *from = NULL, *to = NULL;
    int code = sqlite3_open_v2(from_path, &from, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOFOLLOW, NULL);
    sqlite3_busy_timeout(from, BUSY_MS);
    if (code == SQLITE_OK)
        code = sqlite3_open_v2(to_path, &to, SQLITE_OPEN_READWRITE, NULL);
    if (code == SQLITE_OK)
        code = copy_pages(from, to);
    if (code == SQLITE_OK)
        /* disables write-ahead logging in the copy, so that the copy is a single file */
        code = sqlite3_exec(to, "PRAGMA journal_mode = DELETE", NULL, NULL, NULL);
    bool good = code == SQLITE_OK ? is_whole(log, to, to_path) : failed(log, from_path, "cannot be copied", sqlite3_errstr(code));
    sqlite3_close(to);
    sqlite3_close(from);
    return good && sync_file(log, to_path);
}

bool copy_database(struct log *log, const char *from_path, const char *to_path)
{
    char *from = path_of_database(log, from_path);
    int target = from ? create_target(log, to_path) : -1;
    bool good = target >= 0;
    if (good) {
        close(target);
        good = copy_state(log, from, to_path);
        if (!good)
            unlink(to_path);
    }
    free(from);
    return good;
}

static bool copy_bytes(FILE *from, FILE *to)
{
    char buffer[BUFFER_BYTES];
    for (size_t n; (n = fread(buffer, 1, sizeof(buffer), from)) > 0;)
        if (fwrite(buffer, 1, n, to) != n)
            return false;
    return !ferror(from) && fflush(to) == 0;
}

bool copy_file(struct log *log, const char *from_path, const char *to_path)
{
    int source = open_source(log, from_path), target = source >= 0 ? create_target(log, to_path) : -1;
    FILE *from = source >= 0 ? fdopen(source, "rb") : NULL, *to = target >= 0 ? fdopen(target, "wb") : NULL;
    bool good = from && to && copy_bytes(from, to);
    if (from && to && !good)
        failed(log, to_path, "cannot be copied", strerror(errno));
    if (from)
        fclose(from);
    if (to && fclose(to) != 0)
        good = good && failed(log, to_path, "cannot be copied", strerror(errno));
    good = good && sync_file(log, to_path);
    if (!good && to)
        unlink(to_path);
    return good;
}

bool copy_hash(struct log *log, const char *path, char hash[COPY_HASH_BYTES], long long *bytes)
{
    FILE *file = fopen(path, "rb");
    XXH3_state_t state;
    char buffer[BUFFER_BYTES];
    XXH3_INITSTATE(&state);
    XXH3_128bits_reset(&state);
    *bytes = 0;
    for (size_t n; file && (n = fread(buffer, 1, sizeof(buffer), file)) > 0; *bytes += (long long)n)
        XXH3_128bits_update(&state, buffer, n);
    bool good = file && !ferror(file);
    if (!good)
        failed(log, path, "cannot be read", strerror(errno));
    if (file)
        fclose(file);
    XXH128_hash_t sum = XXH3_128bits_digest(&state);
    snprintf(hash, COPY_HASH_BYTES, "%016llx%016llx", (unsigned long long)sum.high64, (unsigned long long)sum.low64);
    return good;
}
