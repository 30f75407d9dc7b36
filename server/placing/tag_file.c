/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Saves a plant's tag list, and keeps its earlier versions in the same folder. */
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

enum { MAX_BYTES = 64 << 20, MAX_VERSIONS = 100000 };

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

char *tag_file_read(const char *path, struct refusal *why)
{
    size_t bytes;
    char *text = text_read_file(path, MAX_BYTES, &bytes);
    if (!text)
        refusal_set(why, REFUSAL_UNREAD_FILE, "file=%s\nerror=%s", text_base_name(path), strerror(errno));
    return text;
}

void tag_file_hash(const char *text, char out[17])
{
    snprintf(out, 17, "%016" PRIx64, (uint64_t)XXH3_64bits(text, strlen(text)));
}

static void cannot_write(struct refusal *why, const char *file, int error)
{
    if (error == ENOSPC || error == EDQUOT)
        refusal_set(why, REFUSAL_DISK_FULL, "file=%s", file);
    else if (error == EACCES || error == EPERM)
        refusal_set(why, REFUSAL_FOLDER_LOCKED, "file=%s", file);
    else
        refusal_set(why, REFUSAL_UNWRITTEN, "file=%s\nerror=%s", file, strerror(error));
}

/* Keeps the present tag list as an earlier version, under a second name. The name is a hard link, so owner and mode stay.
   Returns that name. */
char *tag_file_keep(const char *path, struct refusal *why)
{
    for (int n = 1; n < MAX_VERSIONS; n++) {
        char *name = mem_printf("%s.%d", path, n);
        if (link(path, name) == 0)
            return name;
        int error = errno;
        if (error == EEXIST) {
            mem_free(name);
            continue;
        }
        cannot_write(why, text_base_name(name), error);
        mem_free(name);
        return NULL;
    }
    cannot_write(why, text_base_name(path), ENFILE);
    return NULL;
}

/* Writes the new tag list with the mode of the present one. Returns 0 or -errno. */
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

bool tag_file_put(const struct tag_save *save, char **kept, struct refusal *why)
{
    char *now = tag_file_read(save->path, why);
    bool same = now && !strcmp(now, save->before);
    if (now && !same)
        refusal_set(why, REFUSAL_CHANGED, "file=%s", text_base_name(save->path));
    mem_free(now);
    char *name = same ? tag_file_keep(save->path, why) : NULL;
    if (!name)
        return false;
    int error = replace(save);
    if (error) {
        cannot_write(why, text_base_name(save->path), -error);
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
    *why = mem_printf("%s cannot be restored from %s: %s", text_base_name(save->path), text_base_name(kept), strerror(errno));
    return false;
}
