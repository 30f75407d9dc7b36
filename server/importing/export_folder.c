/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists, adds and removes the files of the exports folder. An upload in progress is a hidden file until it is complete. */
#include "importing/export_folder.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/utf8.h"

enum { MAX_NAME_BYTES = 200 };

struct export_upload {
    char *path, *hidden;
    int fd;
};

char *export_folder_of(const char *plant_folder)
{
    return mem_printf("%s/exports", plant_folder);
}

bool export_name_good(const char *name)
{
    size_t length = strlen(name);
    bool good = length > 0 && length <= MAX_NAME_BYTES && name[0] != '.';
    for (size_t i = 0, bytes; i < length && good; i += bytes) {
        bytes = utf8_length(name + i, length - i);
        good = bytes > 0 && (unsigned char)name[i] >= ' ' && name[i] != 0x7f && name[i] != '/' && name[i] != '\\';
    }
    return good;
}

static bool has_ending(const char *name, const char *const *endings)
{
    const char *dot = strrchr(name, '.');
    for (; dot && *endings; endings++)
        if (!strcasecmp(dot, *endings))
            return true;
    return false;
}

enum export_kind export_kind_of(const char *name)
{
    static const char *const tags[] = { ".csv", ".tsv", ".xlsx", ".json", NULL };
    static const char *const beside[] = { ".att", ".txt", ".bin", ".mtl", ".png", ".jpg", ".jpeg", ".webp", ".ktx2", NULL };
    return has_ending(name, tags) ? EXPORT_TAGS : has_ending(name, beside) ? EXPORT_BESIDE : EXPORT_MODEL;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(((const struct export_file *)a)->name, ((const struct export_file *)b)->name);
}

void export_folder_list(const char *folder, struct export_list *list)
{
    DIR *dir = opendir(folder);
    struct stat st;
    for (const struct dirent *entry; dir && (entry = readdir(dir));) {
        if (!export_name_good(entry->d_name) || fstatat(dirfd(dir), entry->d_name, &st, 0) != 0 || !S_ISREG(st.st_mode))
            continue;
        mem_grow(&list->at, &list->capacity, list->count + 1, sizeof(*list->at));
        list->at[list->count++] =
            (struct export_file){ .name = mem_strdup(entry->d_name), .kind = export_kind_of(entry->d_name), .bytes = st.st_size };
    }
    if (dir)
        closedir(dir);
    if (list->count > 1)
        qsort(list->at, list->count, sizeof(*list->at), by_name);
}

void export_list_finish(struct export_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        mem_free(list->at[i].name);
    mem_free(list->at);
    *list = (struct export_list){ 0 };
}

const char *export_folder_choice(void)
{
    return ".choice";
}

const char *export_folder_report(void)
{
    return ".report.json";
}

void export_folder_sweep(const char *folder)
{
    DIR *dir = opendir(folder);
    for (const struct dirent *entry; dir && (entry = readdir(dir));)
        if (entry->d_name[0] == '.' && strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0 &&
            strcmp(entry->d_name, export_folder_choice()) != 0 && strcmp(entry->d_name, export_folder_report()) != 0)
            unlinkat(dirfd(dir), entry->d_name, 0);
    if (dir)
        closedir(dir);
}

void export_folder_remove_tag_lists(const char *folder, const char *except)
{
    struct export_list list = { 0 };
    export_folder_list(folder, &list);
    for (size_t i = 0; i < list.count; i++)
        if (list.at[i].kind == EXPORT_TAGS && (!except || strcmp(list.at[i].name, except) != 0))
            export_folder_remove(folder, list.at[i].name);
    export_list_finish(&list);
}

int export_folder_remove(const char *folder, const char *name)
{
    char *path = mem_printf("%s/%s", folder, name);
    int error = unlink(path) == 0 ? 0 : -errno;
    mem_free(path);
    return error;
}

/* --- uploads ----------------------------------------------------------------------------------------------------------- */

struct export_upload *export_upload_begin(const char *folder, const char *name, int *error)
{
    struct export_upload *upload = mem_new(sizeof(*upload));
    upload->path = mem_printf("%s/%s", folder, name);
    upload->hidden = mem_printf("%s/.upload.XXXXXX", folder);
    upload->fd = mkostemp(upload->hidden, O_CLOEXEC);
    *error = upload->fd < 0 ? -errno : 0;
    if (upload->fd < 0) {
        mem_free(upload->hidden); /* forgets the hidden file's name: the file could not be created, so it must not be removed */
        upload->hidden = NULL;
        export_upload_abandon(&upload);
    }
    return upload;
}

int export_upload_write(struct export_upload *upload, const void *bytes, size_t count)
{
    return atomic_file_write(&(struct atomic_file){ .fd = upload->fd }, bytes, count);
}

int export_upload_end(struct export_upload **upload)
{
    int error = rename((*upload)->hidden, (*upload)->path) == 0 ? 0 : -errno;
    if (!error) {
        mem_free((*upload)->hidden);
        (*upload)->hidden = NULL;
    }
    export_upload_abandon(upload);
    return error;
}

void export_upload_abandon(struct export_upload **pointer)
{
    struct export_upload *upload = *pointer;
    if (!upload)
        return;
    if (upload->fd >= 0)
        close(upload->fd);
    if (upload->hidden)
        unlink(upload->hidden);
    mem_free(upload->hidden);
    mem_free(upload->path);
    mem_free(upload);
    *pointer = NULL;
}
