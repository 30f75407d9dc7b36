/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Versions of a tag list beside each other. */
#include "placing/tag_file.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/text.h"

enum { MOST_BYTES = 64 << 20, MOST_VERSIONS = 100000 };

void tag_save_free(struct tag_save *save)
{
    if (!save)
        return;
    mem_free(save->path);
    mem_free(save->before);
    mem_free(save->after);
    mem_free(save->who);
    mem_free(save);
}

char *tag_file_read(const char *path, char **why)
{
    size_t bytes;
    char *text = text_read_file(path, MOST_BYTES, &bytes);
    *why = text ? NULL : mem_printf("%s cannot be read: %s", text_base_name(path), strerror(errno));
    return text;
}

void tag_file_hash(const char *text, char out[17])
{
    snprintf(out, 17, "%016" PRIx64, (uint64_t)XXH3_64bits(text, strlen(text)));
}

/* Owner and rights stay with it. */
char *tag_file_keep(const char *path, char **why)
{
    for (int n = 1; n < MOST_VERSIONS; n++) {
        char *name = mem_printf("%s.%d", path, n);
        if (link(path, name) == 0)
            return name;
        int error = errno;
        mem_free(name);
        if (error == EEXIST)
            continue;
        *why = mem_printf("the list as it is cannot be kept as %s.%d: %s", text_base_name(path), n, strerror(error));
        return NULL;
    }
    *why = mem_printf("there are %d versions beside %s", MOST_VERSIONS, text_base_name(path));
    return NULL;
}

/* With the rights that the list has. */
static int replace(const struct tag_save *save)
{
    struct stat was;
    struct atomic_file file;
    int error = stat(save->path, &was) == 0 ? 0 : -errno;
    if (!error)
        error = atomic_file_begin(&file, save->path, 0600);
    if (error)
        return error;
    if (fchmod(file.fd, was.st_mode & 07777) != 0)
        error = -errno;
    if (!error)
        error = atomic_file_write(&file, save->after, strlen(save->after));
    if (!error)
        error = atomic_file_commit(&file, true);
    atomic_file_abandon(&file);
    return error;
}

bool tag_file_put(const struct tag_save *save, char **kept, char **why)
{
    char *now = tag_file_read(save->path, why);
    bool same = now && !strcmp(now, save->before);
    if (now && !same)
        *why = mem_printf("%s was changed by somebody else meanwhile", text_base_name(save->path));
    mem_free(now);
    char *name = same ? tag_file_keep(save->path, why) : NULL;
    if (!name)
        return false;
    int error = replace(save);
    if (error) {
        *why = mem_printf("%s cannot be written: %s", text_base_name(save->path), strerror(-error));
        unlink(name);
        mem_free(name);
        return false;
    }
    *kept = name;
    return true;
}

bool tag_file_put_back(const struct tag_save *save, const char *kept, char **why)
{
    if (rename(kept, save->path) == 0)
        return true;
    *why = mem_printf("%s cannot be put back from %s: %s", text_base_name(save->path), text_base_name(kept), strerror(errno));
    return false;
}
