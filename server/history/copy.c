/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Copies of files that must be whole. */
#include "history/copy.h"

#include <errno.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

enum { BUFFER_BYTES = 1 << 16, BUSY_MS = 10000 };

static bool failed(struct log *log, const char *path, const char *doing, const char *why)
{
    log_err(log, "%s: %s: %s", path, doing, why);
    return false;
}

static bool sync_file(struct log *log, const char *path)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    bool good = fd >= 0 && fsync(fd) == 0;
    int cause = errno;
    if (fd >= 0)
        close(fd);
    return good || failed(log, path, "cannot be brought to the disk", strerror(cause));
}

/* "ok", or the first thing that is wrong. */
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

/* All pages in one step: whoever writes goes on in its log meanwhile. */
static int copy_pages(sqlite3 *from, sqlite3 *to)
{
    sqlite3_backup *backup = sqlite3_backup_init(to, "main", from, "main");
    if (!backup)
        return sqlite3_errcode(to);
    int code = sqlite3_backup_step(backup, -1), end = sqlite3_backup_finish(backup);
    return code == SQLITE_DONE ? end : code;
}

bool copy_database(struct log *log, const char *from_path, const char *to_path)
{
    sqlite3 *from = NULL, *to = NULL;
    int code = sqlite3_open_v2(from_path, &from, SQLITE_OPEN_READONLY, NULL);
    sqlite3_busy_timeout(from, BUSY_MS);
    if (code == SQLITE_OK)
        code = sqlite3_open_v2(to_path, &to, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, NULL);
    if (code == SQLITE_OK)
        code = copy_pages(from, to);
    if (code == SQLITE_OK)
        code = sqlite3_exec(to, "PRAGMA journal_mode = DELETE", NULL, NULL, NULL); /* one file, without its log */
    bool good = code == SQLITE_OK ? is_whole(log, to, to_path) : failed(log, from_path, "cannot be copied", sqlite3_errstr(code));
    sqlite3_close(to);
    sqlite3_close(from);
    good = good && sync_file(log, to_path);
    if (!good)
        unlink(to_path);
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
    FILE *from = fopen(from_path, "rb"), *to = from ? fopen(to_path, "wb") : NULL;
    bool good = from && to && copy_bytes(from, to);
    if (!good)
        failed(log, from ? to_path : from_path, "cannot be copied", strerror(errno));
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
