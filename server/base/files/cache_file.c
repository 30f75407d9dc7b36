/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes cache files: a header with magic, key, byte count and checksum precedes the content, which may be compressed. The
   header describes the content as stored in the file. */
#include "base/files/cache_file.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
/* makes xxhash.h define the struct of the hash state, so that the state can be on the stack instead of the heap */
#define XXH_STATIC_LINKING_ONLY
#include <xxhash.h>

#include "base/files/atomic_file.h"
#include "base/files/compress.h"
#include "base/mem.h"

struct cache_head {
    char magic[8];
    uint64_t key, count;
    uint64_t checksum; /* XXH3-64 of the content, seeded with the key */
};

/* FILE_OTHER: the file is intact but has another kind, version or key than the caller asks for */
enum file_state { FILE_GOOD, FILE_MISSING, FILE_OTHER, FILE_DAMAGED };

static enum file_state __attribute__((format(printf, 3, 4))) found(char *why, enum file_state state, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(why, CACHE_FILE_WHY_BYTES, fmt, ap);
    va_end(ap);
    return state;
}

static enum file_state map_file(struct cache_file *file, const char *path, char *why)
{
    struct stat st = { 0 };
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0 && errno == ENOENT)
        return found(why, FILE_MISSING, "missing");
    if (fd >= 0 && fstat(fd, &st) == 0 && S_ISREG(st.st_mode) && st.st_size > 0) {
        file->map_bytes = (size_t)st.st_size;
        file->map = mmap(NULL, file->map_bytes, PROT_READ, MAP_PRIVATE, fd, 0);
        file->map = file->map == MAP_FAILED ? NULL : file->map;
    } else if (fd >= 0) {
        errno = S_ISDIR(st.st_mode) ? EISDIR : ENODATA;
    }
    int cause = errno;
    if (fd >= 0)
        close(fd);
    return file->map ? FILE_GOOD : found(why, FILE_DAMAGED, "cannot be read: %s", strerror(cause));
}

static enum file_state check(const struct cache_file *file, const char *magic, uint64_t key, char *why)
{
    const struct cache_head *head = file->map;
    if (file->map_bytes < sizeof(*head))
        return found(why, FILE_DAMAGED, "the file is truncated: %zu bytes, but the header alone takes %zu", file->map_bytes, sizeof(*head));
    if (memcmp(head->magic, magic, sizeof(head->magic)) != 0)
        return found(why, FILE_OTHER, "the file is of another version or kind: it does not begin with %.8s", magic);
    if (head->key != key)
        return found(why, FILE_OTHER, "the file was made from other input (key %016" PRIx64 ", expected %016" PRIx64 ")", head->key, key);
    if (head->count != file->map_bytes - sizeof(*head))
        return found(why, FILE_DAMAGED, "%s: the file has %zu bytes, but its header says %" PRIu64,
                     head->count > file->map_bytes - sizeof(*head) ? "truncated" : "too long", file->map_bytes,
                     head->count + sizeof(*head));
    uint64_t sum = XXH3_64bits_withSeed(head + 1, head->count, key);
    if (sum != head->checksum)
        return found(why, FILE_DAMAGED, "the file is damaged: its checksum is %016" PRIx64 ", but its header says %016" PRIx64, sum,
                     head->checksum);
    return FILE_GOOD;
}

static enum file_state open_file(struct cache_file *file, const char *path, const char *magic, uint64_t key, char *why)
{
    *file = (struct cache_file){ 0 };
    enum file_state state = map_file(file, path, why);
    if (state == FILE_GOOD)
        state = check(file, magic, key, why);
    if (state != FILE_GOOD) {
        cache_file_close(file);
        return state;
    }
    file->bytes = (const char *)file->map + sizeof(struct cache_head);
    file->count = file->map_bytes - sizeof(struct cache_head);
    return FILE_GOOD;
}

bool cache_file_open(struct cache_file *file, const char *path, const char *magic, uint64_t key, char why[CACHE_FILE_WHY_BYTES])
{
    return open_file(file, path, magic, key, why) == FILE_GOOD;
}

static bool is_good(enum file_state state, struct log *log, const char *path, const char *why)
{
    if (state == FILE_DAMAGED)
        log_warn(log, "cache file %s: %s; its contents are computed again, so there is nothing to do", path, why);
    return state == FILE_GOOD;
}

bool cache_file_open_if_good(struct cache_file *file, struct log *log, const char *path, const char *magic, uint64_t key)
{
    char why[CACHE_FILE_WHY_BYTES];
    return is_good(open_file(file, path, magic, key, why), log, path, why);
}

/* Opens a file of compressed content, and checks that its chunks are complete. */
static enum file_state map_compressed(struct cache_file *file, const char *path, const char *magic, uint64_t key, char *why)
{
    enum file_state state = open_file(file, path, magic, key, why);
    if (state != FILE_GOOD || decompressed_size(file->bytes, file->count) != SIZE_MAX)
        return state;
    cache_file_close(file);
    return found(why, FILE_DAMAGED, "the file is damaged: its compressed parts do not have the sizes that they state");
}

/* Replaces the mapped content of the file by the decompressed content. */
static enum file_state decompress_file(struct cache_file *file, char *why)
{
    const size_t bytes = file->count;
    size_t count;
    void *decompressed = decompress(file->bytes, bytes, &count);
    cache_file_close(file);
    if (!decompressed)
        return found(why, FILE_DAMAGED, "the file's %zu compressed bytes are damaged, or memory ran out", bytes);
    *file = (struct cache_file){ .decompressed = decompressed, .bytes = decompressed, .count = count };
    return FILE_GOOD;
}

bool cache_file_map_compressed(struct cache_file *file, struct log *log, const char *path, const char *magic, uint64_t key)
{
    char why[CACHE_FILE_WHY_BYTES];
    return is_good(map_compressed(file, path, magic, key, why), log, path, why);
}

bool cache_file_open_compressed(struct cache_file *file, struct log *log, const char *path, const char *magic, uint64_t key)
{
    char why[CACHE_FILE_WHY_BYTES];
    enum file_state state = map_compressed(file, path, magic, key, why);
    if (state == FILE_GOOD)
        state = decompress_file(file, why);
    return is_good(state, log, path, why);
}

void cache_file_close(struct cache_file *file)
{
    if (file->map)
        munmap(file->map, file->map_bytes);
    mem_free(file->decompressed);
    *file = (struct cache_file){ 0 };
}

/* Writes a cache file whose content is given in several parts. Hashes and writes the parts one by one, because joining them
   could take tens of megabytes of memory. */
int cache_file_write_parts(const char *path, const char *magic, uint64_t key, const struct atomic_file_part *parts, size_t part_count)
{
    struct cache_head head = { .key = key };
    struct atomic_file_part *all = mem_array(part_count + 1, sizeof(*all));
    XXH3_state_t state;
    XXH3_INITSTATE(&state);
    XXH3_64bits_reset_withSeed(&state, key);
    memcpy(head.magic, magic, sizeof(head.magic));
    for (size_t i = 0; i < part_count; i++) {
        XXH3_64bits_update(&state, parts[i].bytes, parts[i].count);
        head.count += parts[i].count;
        all[i + 1] = parts[i];
    }
    head.checksum = XXH3_64bits_digest(&state);
    all[0] = (struct atomic_file_part){ &head, sizeof(head) };
    int status = atomic_file_put_parts(path, all, part_count + 1);
    mem_free(all);
    return status;
}

struct compressed_writing {
    struct atomic_file file;
    struct cache_head head;
    XXH3_state_t state;
};

static int put_compressed(void *arg, const void *bytes, size_t count)
{
    struct compressed_writing *writing = arg;
    XXH3_64bits_update(&writing->state, bytes, count);
    writing->head.count += count;
    return atomic_file_write(&writing->file, bytes, count);
}

/* Writes the header last, because only then the size and the checksum of the compressed content are known. */
int cache_file_write_compressed(const char *path, const char *magic, uint64_t key, const struct atomic_file_part *parts, size_t part_count)
{
    struct compressed_writing writing = { .head = { .key = key } };
    int status = atomic_file_begin(&writing.file, path, 0666);
    if (status != 0)
        return status;
    memcpy(writing.head.magic, magic, sizeof(writing.head.magic));
    XXH3_INITSTATE(&writing.state);
    XXH3_64bits_reset_withSeed(&writing.state, key);
    status = atomic_file_write(&writing.file, &writing.head, sizeof(writing.head));
    if (status == 0)
        status = compress_parts(parts, part_count, put_compressed, &writing);
    writing.head.checksum = XXH3_64bits_digest(&writing.state);
    if (status == 0) {
        ssize_t written = pwrite(writing.file.fd, &writing.head, sizeof(writing.head), 0);
        status = written == sizeof(writing.head) ? 0 : written < 0 ? -errno : -EIO;
    }
    if (status == 0)
        return atomic_file_commit(&writing.file, false);
    atomic_file_abandon(&writing.file);
    return status;
}
