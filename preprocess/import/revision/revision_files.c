/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replaces files of a plant folder, and undoes a replacement. Each begins by renaming a prepared folder, which is atomic. From
 * then on, plant_folder.c completes the transaction, even after a crash. */
#include "preprocess/import/revision/revision_files.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "plant/plant_folder.h"
#include "plant/recipe.h"
#include "preprocess/import/import_fail.h"

static const size_t max_text_bytes = (size_t)64 << 20;

static int move(const char *from, const char *to)
{
    return rename(from, to) == 0 ? 0 : -errno;
}

/* --- beginning ------------------------------------------------------------------------------------------------------------------ */

/* Saves the current version of a file for undo. Copies text files, because an editor may overwrite them in place. Hard-links
 * models, because they are large and only ever replaced as a whole; copies them if the file system has no hard links. */
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

/* Gives a new file the mode and owner of the file it replaces. */
static void take_rights(const char *from, const char *to)
{
    struct stat st;
    if (stat(from, &st) == 0 && (chmod(to, st.st_mode & 07777) != 0 || chown(to, st.st_uid, st.st_gid) != 0))
        fprintf(stderr, "plantcast import: %s: the new file cannot get the owner and permissions of the old file: %s\n", from,
                strerror(errno));
}

static int add_file(const char *folder, const char *next, const struct revision_file *file, struct text *list)
{
    uint64_t hash = 0;
    char *now = plant_folder_file(folder, file->name), *old = revision_version_of(next, "old", file->name),
         *new = revision_version_of(next, "new", file->name);
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

/* Returns whether the file's text is still the one that was read (file->before). Called immediately before the transaction, so
 * that a user's edit in between is unlikely. */
static bool is_as_read(const char *folder, const struct revision_file *file)
{
    size_t bytes;
    char *path = plant_folder_file(folder, file->name), *text = file->before ? text_read_file(path, max_text_bytes, &bytes) : NULL;
    bool is = !file->before || (text && !strcmp(text, file->before));
    mem_free(text);
    mem_free(path);
    return is;
}

int revision_files_apply(const char *folder, const char *work, const struct revision_file *files, size_t count, const char **changed)
{
    char *next = plant_folder_file(work, "revision"), *old = plant_folder_file(next, "old"), *new = plant_folder_file(next, "new"),
         *path = plant_folder_file(next, "files"), *begun = plant_folder_file(folder, REVISION_PENDING);
    struct text list = { 0 };
    int status = mkdir(next, 0777) == 0 && mkdir(old, 0777) == 0 && mkdir(new, 0777) == 0 ? 0 : -errno;
    for (size_t i = 0; i < count && status == 0; i++)
        status = add_file(folder, next, &files[i], &list);
    if (status == 0)
        status = atomic_file_put(path, list.at, list.length);
    if (status == 0)
        status = plant_folder_sync(new);
    if (status == 0)
        status = plant_folder_sync(next);
    for (size_t i = 0; i < count && status == 0; i++)
        if (!is_as_read(folder, &files[i])) {
            *changed = files[i].name;
            status = -ESTALE;
        }
    if (status == 0)
        status = move(next, begun);
    if (status == 0)
        status = plant_folder_sync(folder);
    if (status == 0)
        status = revision_go_on_applying(folder);
    text_finish(&list);
    mem_free(next);
    mem_free(old);
    mem_free(new);
    mem_free(path);
    mem_free(begun);
    return status;
}

int revision_files_replace(const char *folder, const char *work, const struct revision_file *files, size_t count)
{
    const char *changed;
    int status = revision_files_apply(folder, work, files, count, &changed);
    if (status == -ESTALE)
        return import_fail(changed,
                           "this file was changed by another program during the import, so nothing was written: run the command again");
    return status == 0 ? 0 : import_fail(folder, strerror(-status));
}

/* --- undoing -------------------------------------------------------------------------------------------------------------------- */

static bool has_changed(const char *folder, const struct revision_entry *entry)
{
    uint64_t hash;
    char *path = plant_folder_file(folder, entry->name);
    bool changed = !plant_model_hash(path, &hash) || hash != entry->hash;
    mem_free(path);
    return changed;
}

static int put_beside(const char *folder, const struct revision_entry *entry)
{
    char *path = plant_folder_file(folder, entry->name), *beside = mem_printf("%s.undone", path);
    unlink(beside);
    int status = keep(path, beside);
    mem_free(path);
    mem_free(beside);
    return status == -ENOENT ? 0 : status;
}

int revision_files_undo(const char *folder, bool forced, struct text *changed, struct text *done)
{
    struct revision_record record;
    char *begun = plant_folder_file(folder, REVISION_UNDOING);
    int status = revision_record_read(&record, folder, REVISION_MADE);
    for (size_t i = 0; i < record.count && status == 0; i++) {
        const struct revision_entry *entry = &record.entries[i];
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
        status = revision_go_on_undoing(folder);
    revision_record_finish(&record);
    mem_free(begun);
    return status;
}
