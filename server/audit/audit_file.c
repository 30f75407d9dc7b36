/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the audit trail's file, and renames it when it is full. */
#include "audit/audit_file.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "audit/audit_head.h"
#include "base/mem.h"

static bool write_all(int fd, const char *bytes, size_t count)
{
    for (ssize_t n; count > 0; bytes += n, count -= (size_t)n)
        if ((n = write(fd, bytes, count)) <= 0)
            return false;
    return true;
}

/* Finds the last complete line of the audit file, and sets the hash chain's state (line number and hash) to that line. Returns
   the offset after that line. */
static size_t find_end(struct audit_file *file, size_t bytes, char **finding)
{
    size_t window = bytes < 2 * AUDIT_LINE_BYTES ? bytes : 2 * AUDIT_LINE_BYTES;
    char *tail = mem_array(window + 1, 1);
    ssize_t n = pread(file->fd, tail, window, (off_t)(bytes - window));
    size_t end = n > 0 ? (size_t)n : 0;
    while (end > 0 && tail[end - 1] != '\n')
        end--;
    size_t begin = end > 0 ? end - 1 : 0;
    while (begin > 0 && tail[begin - 1] != '\n')
        begin--;
    const char *why = NULL;
    if (end > 0 && !audit_chain_check(&file->chain, tail + begin, end - 1 - begin, true, &why))
        *finding = mem_printf("%s: the last line: %s", file->path, why);
    mem_free(tail);
    return bytes - window + end;
}

/* Sets the hash chain's state (line number and hash) to the last complete line of the audit file; removes an incomplete line
   left by a crash. */
static int find_chain(struct audit_file *file, char **finding)
{
    struct stat st;
    if (fstat(file->fd, &st) != 0)
        return -errno;
    if (!S_ISREG(st.st_mode))
        return -EINVAL;
    file->bytes = find_end(file, (size_t)st.st_size, finding);
    if (file->bytes == (size_t)st.st_size)
        return 0;
    if (!*finding)
        *finding = mem_printf("%s: removed an incomplete last line of %zu bytes from the audit file", file->path,
                              (size_t)st.st_size - file->bytes);
    return ftruncate(file->fd, (off_t)file->bytes) == 0 ? 0 : -errno;
}

/* Returns true if the audit file is empty because the last full file was just renamed. PATH.head then names the last line of
   that full file, so it does not mean that lines are missing. */
static bool is_rotated(const struct audit_file *file, const struct audit_chain *head)
{
    char *full = mem_printf("%s.%012" PRIu64, file->path, head->seq);
    bool rotated = file->bytes == 0 && access(full, F_OK) == 0;
    mem_free(full);
    return rotated;
}

/* Compares the end of the audit file with PATH.head, which names the line written last. If PATH.head names a later line than
   the file contains, lines were removed. Numbering then continues after that line, so that the gap stays visible. */
static void compare_head(struct audit_file *file, char **finding)
{
    struct audit_chain head;
    if (!audit_head_read(file->head_path, &head) || head.seq < file->chain.seq ||
        (head.seq == file->chain.seq && !strcmp(head.hash, file->chain.hash)))
        return;
    if (!*finding && !is_rotated(file, &head))
        *finding = mem_printf("%s: the audit file ends at line %" PRIu64 ", but was written up to line %" PRIu64 ": lines were removed",
                              file->path, file->chain.seq, head.seq);
    file->chain = head;
}

static int open_fd(struct audit_file *file)
{
    file->fd = open(file->path, O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0640);
    return file->fd >= 0 ? 0 : -errno;
}

int audit_file_open(struct audit_file *file, const char *path, size_t most_bytes, char **finding)
{
    *finding = NULL;
    *file = (struct audit_file){ .path = mem_strdup(path), .head_path = mem_printf("%s.head", path), .fd = -1, .most_bytes = most_bytes };
    audit_chain_init(&file->chain);
    int error = open_fd(file);
    if (!error)
        error = find_chain(file, finding);
    if (!error)
        compare_head(file, finding);
    return error;
}

void audit_file_close(struct audit_file *file)
{
    if (file->path && file->fd >= 0)
        close(file->fd);
    mem_free(file->path);
    mem_free(file->head_path);
    *file = (struct audit_file){ .fd = -1 };
}

/* Reopens the audit file if another program has renamed it (which is allowed) or removed it. If another program removed the
   file or changed its content, *finding receives a message about it. Returns 0 or -errno. */
static int look_at_path(struct audit_file *file, char **finding)
{
    struct stat ours, there;
    bool open = file->fd >= 0 && fstat(file->fd, &ours) == 0, found = stat(file->path, &there) == 0;
    if (open && (size_t)ours.st_size != file->bytes) {
        *finding = mem_printf("%s: the audit file has %lld bytes, but %zu were written: another program changed the file", file->path,
                              (long long)ours.st_size, file->bytes);
        file->bytes = (size_t)ours.st_size;
    }
    if (open && found && ours.st_ino == there.st_ino && ours.st_dev == there.st_dev)
        return 0;
    if (open && ours.st_nlink == 0 && !*finding)
        *finding = mem_printf("%s: the audit file was removed by another program; %zu bytes are lost", file->path, file->bytes);
    if (open)
        close(file->fd);
    int error = open_fd(file);
    file->bytes = !error && fstat(file->fd, &there) == 0 ? (size_t)there.st_size : 0;
    return error;
}

/* Renames the full audit file to PATH.NUMBER. Never overwrites an existing file. */
static int rotate(struct audit_file *file)
{
    char *full = mem_printf("%s.%012" PRIu64, file->path, file->chain.seq);
    int error = link(file->path, full) == 0 && unlink(file->path) == 0 ? 0 : -errno;
    mem_free(full);
    if (error)
        return error;
    close(file->fd);
    file->bytes = 0;
    return open_fd(file);
}

int audit_file_append(struct audit_file *file, const struct audit_entry *entry, int64_t utc_us, struct text *line, char **finding)
{
    struct audit_chain chain = file->chain;
    size_t begin = line->length;
    *finding = NULL;
    int error = look_at_path(file, finding);
    if (!error && file->bytes >= file->most_bytes)
        error = rotate(file);
    if (error)
        return error;
    audit_chain_add(&chain, entry, utc_us, line);
    size_t count = line->length - begin;
    errno = EIO;
    if (!write_all(file->fd, line->at + begin, count) || fdatasync(file->fd) != 0) {
        error = -errno;
        if (ftruncate(file->fd, (off_t)file->bytes) != 0)
            error = -errno;
        line->length = begin;
        line->at[begin] = 0;
        return error;
    }
    file->chain = chain;
    file->bytes += count;
    /* ignores an error, because the next append writes PATH.head again; until then PATH.head merely names an earlier line */
    audit_head_write(file->head_path, &chain);
    return 0;
}
