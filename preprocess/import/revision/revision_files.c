/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Both ways begin with the renaming of a folder that has all that is needed; whoever finds that folder goes on from there.
 *   .revision          made: nothing of what it lists is under way. files: "HASH WAS NAME" a line; WAS: 1, old/NAME is the one of before.
 *                      A file elsewhere is listed by its path; what is kept of it is elsewhere-NAME
 *   .revision.pending  new/NAME are being put in their places
 *   .revision.undoing  old/NAME are being put back */
#include "preprocess/import/revision/revision_files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "base/mem.h"
#include "plant/recipe.h"

struct entry {
    char *name;
    unsigned long long hash; /* of the new file */
    bool was;                /* there was one before */
};

struct record {
    char *path;
    struct entry *entries;
    size_t count, room;
};

static const char made[] = ".revision", pending[] = ".revision.pending", undoing[] = ".revision.undoing",
                  undone[] = ".import-undone"; /* whoever takes the folder next removes what is left of it */
static const size_t max_text_bytes = (size_t)64 << 20;

/* name may be an absolute path. */
static char *in(const char *folder, const char *name)
{
    return *name == '/' ? mem_strdup(name) : mem_printf("%s/%s", folder, name);
}

/* Where a record has one version (old, new) of a file. */
static char *version_of(const char *record, const char *version, const char *name)
{
    return *name == '/' ? mem_printf("%s/%s/elsewhere-%s", record, version, strrchr(name, '/') + 1)
                        : mem_printf("%s/%s/%s", record, version, name);
}

static int sync_folder(const char *folder)
{
    int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC), status = fd < 0 ? -errno : 0;
    if (fd >= 0 && fsync(fd) != 0 && errno != EINVAL) /* some file systems cannot */
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

static void remove_tree(const char *path)
{
    nftw(path, remove_one, 16, FTW_DEPTH | FTW_PHYS);
}

/* --- the record ----------------------------------------------------------------------------------------------------------------- */

static int read_record(struct record *record, const char *folder, const char *name)
{
    size_t bytes;
    *record = (struct record){ .path = in(folder, name) };
    char *list = in(record->path, "files"), *text = text_read_file(list, 1 << 20, &bytes), *next = text;
    int status = text ? 0 : -errno;
    for (char *line = text ? strsep(&next, "\n") : NULL; line; line = strsep(&next, "\n")) {
        unsigned long long hash;
        int was, at = 0;
        if (sscanf(line, "%llx %d %n", &hash, &was, &at) < 2 || at == 0 || !line[at] || (line[at] != '/' && strchr(line + at, '/')))
            continue;
        mem_grow(&record->entries, &record->room, record->count + 1, sizeof(*record->entries));
        record->entries[record->count++] = (struct entry){ mem_strdup(line + at), hash, was == 1 };
    }
    mem_free(text);
    mem_free(list);
    return status;
}

static void finish_record(struct record *record)
{
    for (size_t i = 0; i < record->count; i++)
        mem_free(record->entries[i].name);
    mem_free(record->entries);
    mem_free(record->path);
}

/* --- going on ------------------------------------------------------------------------------------------------------------------- */

/* A file of another folder, perhaps on another file system: a copy with the same owner and rights takes its place. */
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

static int move_into_place(const struct record *record, const char *folder, const char *from, const char *name)
{
    char *source = version_of(record->path, from, name), *target = in(folder, name);
    int status = access(source, F_OK) != 0 ? 0 /* it was moved already, or stays as it is */
                 : *name == '/'            ? put_elsewhere(source, target)
                                           : move(source, target);
    mem_free(source);
    mem_free(target);
    return status;
}

static int go_on_applying(const char *folder)
{
    struct record record;
    char *last = in(folder, made);
    int status = read_record(&record, folder, pending);
    for (size_t i = 0; i < record.count && status == 0; i++)
        status = move_into_place(&record, folder, "new", record.entries[i].name);
    status = status == 0 ? sync_folder(folder) : status;
    if (status == 0) {
        remove_tree(last);
        status = move(record.path, last);
    }
    finish_record(&record);
    mem_free(last);
    return status;
}

static int go_on_undoing(const char *folder)
{
    struct record record;
    char *last = in(folder, undone);
    int status = read_record(&record, folder, undoing);
    if (status == -ENOENT) /* all was put back: its removal had begun */
        status = 0;
    for (size_t i = record.count; i-- > 0 && status == 0;) {
        char *path = in(folder, record.entries[i].name);
        if (record.entries[i].was)
            status = move_into_place(&record, folder, "old", record.entries[i].name);
        else
            status = unlink(path) == 0 || errno == ENOENT ? 0 : -errno;
        mem_free(path);
    }
    status = status == 0 ? sync_folder(folder) : status;
    if (status == 0) {
        remove_tree(last);
        status = move(record.path, last);
    }
    if (status == 0)
        remove_tree(last);
    finish_record(&record);
    mem_free(last);
    return status;
}

static void remove_left(const char *folder, const char *own)
{
    DIR *dir = opendir(folder);
    const char *slash = own ? strrchr(own, '/') : NULL;
    for (struct dirent *entry; dir && (entry = readdir(dir)) != NULL;)
        if (!strncmp(entry->d_name, ".import-", 8) && (!slash || strcmp(entry->d_name, slash + 1) != 0)) {
            char *path = in(folder, entry->d_name);
            remove_tree(path);
            mem_free(path);
        }
    if (dir)
        closedir(dir);
}

int revision_files_lock(const char *folder, const char *own)
{
    int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC), status = 0;
    if (fd < 0)
        return -errno;
    char *apply = in(folder, pending), *undo = in(folder, undoing);
    if (flock(fd, LOCK_EX | LOCK_NB) != 0)
        status = -errno;
    else
        remove_left(folder, own);
    if (status == 0 && access(apply, F_OK) == 0)
        status = go_on_applying(folder);
    if (status == 0 && access(undo, F_OK) == 0)
        status = go_on_undoing(folder);
    mem_free(apply);
    mem_free(undo);
    if (status != 0)
        close(fd);
    return status == 0 ? fd : status;
}

/* --- beginning ------------------------------------------------------------------------------------------------------------------ */

/* Texts are copied: an editor may write into the file that is there. Models are large, and only ever replaced: the same file once more,
 * unless the file system has no links. */
static int keep(const char *from, const char *to)
{
    char *bytes;
    size_t count;
    const char *ending = strrchr(to, '.');
    if (access(from, F_OK) != 0)
        return -errno;
    if (ending && !strcmp(ending, ".glb") && link(from, to) == 0)
        return 0;
    bytes = text_read_file(from, (size_t)8 << 30, &count);
    int status = bytes ? atomic_file_put(to, bytes, count) : -errno;
    mem_free(bytes);
    return status;
}

static int sync_file(const char *path)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC), status = fd < 0 || fsync(fd) != 0 ? -errno : 0;
    if (fd >= 0)
        close(fd);
    return status;
}

/* Whoever may read and write the file that is there may do so with the new one. */
static void take_rights(const char *from, const char *to)
{
    struct stat st;
    if (stat(from, &st) == 0 && (chmod(to, st.st_mode & 07777) != 0 || chown(to, st.st_uid, st.st_gid) != 0))
        fprintf(stderr, "plantcast import: %s: its owner and rights cannot be kept: %s\n", from, strerror(errno));
}

static int add_file(const char *folder, const char *next, const struct revision_file *file, struct text *list)
{
    uint64_t hash = 0;
    char *now = in(folder, file->name), *old = version_of(next, "old", file->name), *new = version_of(next, "new", file->name);
    int status = strchr(file->name, '\n') ? -EINVAL : 0;
    if (status == 0 && file->made && (status = sync_file(file->made)) == 0)
        status = move(file->made, new);
    int kept = status == 0 ? keep(now, old) : 0;
    if (status == 0 && kept == 0) {
        take_rights(now, old);
        if (file->made)
            take_rights(now, new);
    }
    if (status == 0 && (file->made || kept == 0)) {
        status = plant_model_hash(file->made ? new : old, &hash) ? 0 : -errno;
        text_add(list, "%016llx %d %s\n", (unsigned long long)hash, kept == 0, file->name);
    }
    mem_free(now);
    mem_free(old);
    mem_free(new);
    return status == 0 && kept != -ENOENT ? kept : status;
}

/* Looked at last: from here on it takes some renamings. */
static bool is_as_read(const char *folder, const struct revision_file *file)
{
    size_t bytes;
    char *path = in(folder, file->name), *text = file->before ? text_read_file(path, max_text_bytes, &bytes) : NULL;
    bool is = !file->before || (text && !strcmp(text, file->before));
    mem_free(text);
    mem_free(path);
    return is;
}

int revision_files_apply(const char *folder, const char *work, const struct revision_file *files, size_t count, const char **changed)
{
    char *next = in(work, "revision"), *old = in(next, "old"), *new = in(next, "new"), *path = in(next, "files"),
         *begun = in(folder, pending);
    struct text list = { 0 };
    int status = mkdir(next, 0777) == 0 && mkdir(old, 0777) == 0 && mkdir(new, 0777) == 0 ? 0 : -errno;
    for (size_t i = 0; i < count && status == 0; i++)
        status = add_file(folder, next, &files[i], &list);
    if (status == 0)
        status = atomic_file_put(path, list.at, list.length);
    if (status == 0)
        status = sync_folder(new);
    if (status == 0)
        status = sync_folder(next);
    for (size_t i = 0; i < count && status == 0; i++)
        if (!is_as_read(folder, &files[i])) {
            *changed = files[i].name;
            status = -ESTALE;
        }
    if (status == 0)
        status = move(next, begun);
    if (status == 0)
        status = sync_folder(folder);
    if (status == 0)
        status = go_on_applying(folder);
    text_finish(&list);
    mem_free(next);
    mem_free(old);
    mem_free(new);
    mem_free(path);
    mem_free(begun);
    return status;
}

/* --- undoing -------------------------------------------------------------------------------------------------------------------- */

static bool has_changed(const char *folder, const struct entry *entry)
{
    uint64_t hash;
    char *path = in(folder, entry->name);
    bool changed = !plant_model_hash(path, &hash) || hash != entry->hash;
    mem_free(path);
    return changed;
}

static int put_beside(const char *folder, const struct entry *entry)
{
    char *path = in(folder, entry->name), *beside = mem_printf("%s.undone", path);
    unlink(beside);
    int status = keep(path, beside);
    mem_free(path);
    mem_free(beside);
    return status == -ENOENT ? 0 : status;
}

int revision_files_undo(const char *folder, bool forced, struct text *changed, struct text *done)
{
    struct record record;
    char *begun = in(folder, undoing);
    int status = read_record(&record, folder, made);
    for (size_t i = 0; i < record.count && status == 0; i++) {
        const struct entry *entry = &record.entries[i];
        if (has_changed(folder, entry)) {
            text_add(changed, "%s%s", changed->length > 0 ? ", " : "", entry->name);
            status = forced ? put_beside(folder, entry) : 0;
        }
        text_add(done, "%s%s", done->length > 0 ? ", " : "", entry->name);
    }
    if (status == 0 && changed->length > 0 && !forced)
        status = -EBUSY;
    if (status == 0)
        status = move(record.path, begun);
    if (status == 0)
        status = go_on_undoing(folder);
    finish_record(&record);
    mem_free(begun);
    return status;
}
