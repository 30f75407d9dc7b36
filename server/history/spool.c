/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes spool files, which hold rows that could not be written to history. They are text with one line per row: kind
   (recorded or held), time, value, quality and tag name. A line of kind `u` precedes the first row of each tag: length of the
   tag's unit, unit and name. Earlier versions of the program ignore such lines. */
#include "history/spool.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>
#include <xxhash.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/text.h"

static const char HEAD[] = "plantcast spool 1\n";
enum {
    PLACES = 3,
    RESERVE_BYTES = 8 << 20,
    /* multiple of the reserve file's size (disk space kept for a spool file): the reserve file is created only if this much
       disk space is free */
    PLENTY = 10
};

char **spool_places(const char *folder)
{
    char **places = mem_array(PLACES + 1, sizeof(*places)), *real = realpath(folder, NULL);
    const char *runtime = getenv("RUNTIME_DIRECTORY"), *whole = real ? real : folder;
    size_t count = 0;
    places[count++] = mem_printf("%s/unwritten.spool", folder);
    if (runtime && *runtime)
        places[count++] = mem_printf("%.*s/history.spool", (int)strcspn(runtime, ":"), runtime);
    places[count++] = mem_printf("/var/tmp/plantcast-%016" PRIx64 ".spool", (uint64_t)XXH64(whole, strlen(whole), 0));
    places[count] = NULL;
    free(real);
    return places;
}

void spool_places_free(char **places)
{
    for (char **place = places; *place; place++)
        mem_free(*place);
    mem_free(places);
}

static char *reserve_of(const char *folder, int length)
{
    return mem_printf("%.*s/spool.reserve", length, folder);
}

/* Creates the reserve file, which keeps disk space for a spool file. It gets its final name once all its blocks are allocated,
   so that a program killed in between leaves no partial reserve. */
static int make_reserve(const char *path)
{
    char *made = mem_printf("%s.new", path);
    unlink(made);
    int fd = open(made, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    int error = fd < 0 ? -errno : -posix_fallocate(fd, 0, RESERVE_BYTES);
    if (!error && rename(made, path) != 0)
        error = -errno;
    if (fd >= 0)
        close(fd);
    if (error && fd >= 0)
        unlink(made);
    mem_free(made);
    return error;
}

int spool_reserve(const char *folder)
{
    struct statvfs disk;
    struct stat st;
    char *path = reserve_of(folder, (int)strlen(folder));
    int error = statvfs(folder, &disk) ? -errno : 0;
    if (!error && (lstat(path, &st) != 0 || st.st_size < RESERVE_BYTES))
        error = disk.f_bavail * disk.f_frsize < (unsigned long)RESERVE_BYTES * PLENTY ? -ENOSPC : make_reserve(path);
    mem_free(path);
    return error;
}

/* Writes the spool's text over the blocks of the reserve file, then renames that file to the spool's name. Used when the disk is full. */
static int write_into_reserve(const char *path, const struct text *text)
{
    const char *slash = strrchr(path, '/');
    char *reserve = reserve_of(path, slash ? (int)(slash - path) : 0);
    struct stat st;
    int fd = open(reserve, O_WRONLY | O_NOFOLLOW | O_CLOEXEC), error = fd < 0 ? -errno : 0;
    if (!error && (fstat(fd, &st) != 0 || !S_ISREG(st.st_mode) || (size_t)st.st_size < text->length))
        error = -ENOSPC;
    for (size_t done = 0; !error && done < text->length;) {
        ssize_t n = pwrite(fd, text->at + done, text->length - done, (off_t)done);
        if (n > 0)
            done += (size_t)n;
        else if (n == 0 || errno != EINTR)
            error = n == 0 ? -EIO : -errno;
    }
    if (!error && (ftruncate(fd, (off_t)text->length) != 0 || fsync(fd) != 0 || rename(reserve, path) != 0))
        error = -errno;
    if (fd >= 0)
        close(fd);
    mem_free(reserve);
    return error;
}

/* Appends a line of text for each row. has_unit: [tag]: true once the text has the line with the tag's unit */
static void add_rows(struct text *text, const struct plant *plant, const struct recorder_rows *rows, char kind, bool *has_unit)
{
    for (size_t i = 0; i < rows->count; i++) {
        const struct history_row *row = &rows->at[i];
        const char *unit = plant_tag_unit(plant, row->tag);
        if (!has_unit[row->tag])
            text_add(text, "u %zu %s%s\n", strlen(unit), unit, plant->tags[row->tag].name);
        has_unit[row->tag] = true;
        text_add(text, "%c %" PRId64 " %.17g %" PRIu32 " %s\n", kind, row->point.t_us, row->point.value, row->point.quality,
                 plant->tags[row->tag].name);
    }
}

int spool_write(const char *path, const struct plant *plant, const struct spool_rows *rows)
{
    struct text text = { 0 };
    struct atomic_file file;
    bool *has_unit = mem_array(plant->tag_count + 1, sizeof(*has_unit));
    text_add(&text, "%s", HEAD);
    add_rows(&text, plant, &rows->kept, 'k', has_unit);
    add_rows(&text, plant, &rows->held, 'h', has_unit);
    mem_free(has_unit);
    int error = atomic_file_begin(&file, path, 0600);
    if (!error) {
        error = atomic_file_write(&file, text.at, text.length);
        if (!error)
            error = atomic_file_commit(&file, true);
        atomic_file_abandon(&file);
    }
    if (error && write_into_reserve(path, &text) == 0)
        error = 0;
    text_finish(&text);
    return error;
}

struct spool_unit { /* units of one tag: the one in which the spool file has its values, and the one that the plant has now */
    bool misfits;              /* true: the unit in the spool file cannot be converted to the tag's current unit */
    struct unit_change change; /* conversion from the unit in the spool file to the tag's current unit */
};

static void take_unit(const char *text, size_t bytes, const struct plant *plant, struct spool_unit *units)
{
    if (bytes > strlen(text))
        return;
    char *unit = mem_printf("%.*s", (int)bytes, text);
    int tag = plant_find_tag(plant, text + bytes);
    if (tag >= 0)
        units[tag].misfits = !history_unit_fits(unit, plant_tag_unit(plant, tag), &units[tag].change);
    mem_free(unit);
}

static void add_line(const char *line, const struct plant *plant, struct spool_unit *units, struct spool_rows *rows, size_t *foreign)
{
    struct history_point point;
    char kind, *end;
    int at = 0;
    if (sscanf(line, "%c %" SCNd64 " %n", &kind, &point.t_us, &at) != 2 || at == 0)
        return;
    if (kind == 'u')
        take_unit(line + at, (size_t)point.t_us, plant, units);
    if (kind != 'k' && kind != 'h')
        return;
    point.value = strtod(line + at, &end);
    point.quality = (uint32_t)strtoul(end, &end, 10);
    int tag = *end == ' ' ? plant_find_tag(plant, end + 1) : -1;
    if (tag < 0 || units[tag].misfits) {
        ++*foreign;
        return;
    }
    point.value = unit_change_value(&units[tag].change, point.value);
    struct recorder_rows *to = kind == 'k' ? &rows->kept : &rows->held;
    mem_grow(&to->at, &to->capacity, to->count + 1, sizeof(*to->at));
    to->at[to->count++] = (struct history_row){ tag, point };
}

/* Reads the spool file if it is a regular file of this user that nobody else can write to. Returns its text (free with
   mem_free()); NULL with errno on failure. */
static char *read_own(const char *path)
{
    struct stat st;
    int fd = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0)
        return NULL;
    bool good = fstat(fd, &st) == 0 && S_ISREG(st.st_mode) && st.st_uid == geteuid() && !(st.st_mode & (S_IWGRP | S_IWOTH));
    char *text = good ? mem_try_array((size_t)st.st_size + 1, 1) : NULL;
    size_t have = 0;
    for (ssize_t n = 1; text && n > 0 && have<(size_t)st.st_size; have += n> 0 ? (size_t)n : 0)
        n = read(fd, text + have, (size_t)st.st_size - have);
    int error = !good ? EPERM : !text ? ENOMEM : have < (size_t)st.st_size ? EIO : 0;
    close(fd);
    if (error) {
        mem_free(text);
        text = NULL;
    }
    errno = error;
    return text;
}

int spool_read(const char *path, const struct plant *plant, struct spool_rows *rows, size_t *foreign)
{
    char *text = read_own(path), *at = text;
    if (!text)
        return -errno;
    bool known = !strncmp(text, HEAD, sizeof(HEAD) - 1);
    struct spool_unit *units = mem_array(plant->tag_count + 1, sizeof(*units));
    for (char *line; known && (line = strsep(&at, "\n"));)
        add_line(line, plant, units, rows, foreign);
    mem_free(units);
    mem_free(text);
    return known ? 0 : -EBADMSG;
}
