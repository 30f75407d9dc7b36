/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes cache files: a header with magic, key, byte count and checksum precedes the content. */
#include "base/files/cache_file.h"

#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#define XXH_STATIC_LINKING_ONLY /* keeps the state of the hash on the stack, not on the heap */
#include <xxhash.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"

struct cache_head {
    char magic[8];
    uint64_t key, count;
    uint64_t checksum; /* XXH3-64 of the content, seeded with the key */
};

static bool is_good(const struct cache_file *file, const char *magic, uint64_t key)
{
    const struct cache_head *head = file->map;
    return file->map_bytes >= sizeof(*head) && memcmp(head->magic, magic, sizeof(head->magic)) == 0 && head->key == key &&
           head->count == file->map_bytes - sizeof(*head) && head->checksum == XXH3_64bits_withSeed(head + 1, head->count, key);
}

bool cache_file_open(struct cache_file *file, const char *path, const char *magic, uint64_t key)
{
    struct stat st;
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    *file = (struct cache_file){ 0 };
    if (fd >= 0 && fstat(fd, &st) == 0 && S_ISREG(st.st_mode) && st.st_size > 0) {
        file->map_bytes = (size_t)st.st_size;
        file->map = mmap(NULL, file->map_bytes, PROT_READ, MAP_PRIVATE, fd, 0);
        file->map = file->map == MAP_FAILED ? NULL : file->map;
    }
    if (fd >= 0)
        close(fd);
    if (!file->map || !is_good(file, magic, key)) {
        cache_file_close(file);
        return false;
    }
    file->bytes = (const char *)file->map + sizeof(struct cache_head);
    file->count = file->map_bytes - sizeof(struct cache_head);
    return true;
}

void cache_file_close(struct cache_file *file)
{
    if (file->map)
        munmap(file->map, file->map_bytes);
    *file = (struct cache_file){ 0 };
}

/* Hashes and writes the parts one by one, because joining them in memory could take tens of megabytes. */
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
