/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Unpacks ZIP with minizip and gzip with zlib. */
#include "preprocess/import/unpack.h"

#include <errno.h>
#include <minizip/unzip.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <zlib.h>

enum {
    BLOCK_BYTES = 1 << 16,
    /* largest accepted ratio of unpacked to packed size; models shrink to about a tenth, so a file with a larger ratio is rejected as a
     * decompression bomb */
    MAX_RATIO = 200
};
static const size_t free_bytes = (size_t)64 << 20; /* bytes that may be unpacked regardless of the ratio */

static const struct {
    const char *packed, *ending;
} endings[] = { { ".ifczip", ".ifc" }, { ".stpz", ".stp" }, { ".zae", ".dae" } };

static const char *ending_of(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot ? dot : "";
}

const char *unpack_ending(const char *path)
{
    for (size_t i = 0; i < sizeof(endings) / sizeof(endings[0]); i++)
        if (!strcasecmp(ending_of(path), endings[i].packed))
            return endings[i].ending;
    return NULL;
}

struct archive_reading {
    unzFile zip; /* archive handle if the file is ZIP; NULL: the file is gzip, and `gzip` is set */
    gzFile gzip;
};

static int read_block(const struct archive_reading *from, char *block)
{
    return from->zip ? unzReadCurrentFile(from->zip, block, BLOCK_BYTES) : gzread(from->gzip, block, BLOCK_BYTES);
}

static const char *copy(const struct archive_reading *from, FILE *to, size_t most)
{
    static char block[BLOCK_BYTES];
    size_t total = 0;
    for (int count; (count = read_block(from, block)) != 0; total += (size_t)count) {
        if (count < 0)
            return "its archive is broken";
        if (total + (size_t)count > most)
            return "its archive grows to more than 200 times its size";
        if (fwrite(block, 1, (size_t)count, to) != (size_t)count)
            return strerror(errno);
    }
    return total > 0 ? NULL : "its archive is empty";
}

/* Closes an archive. Returns whether its data was complete and matched the checksum. */
static bool finish(const struct archive_reading *from)
{
    bool good = true;
    if (from->zip) {
        good = unzCloseCurrentFile(from->zip) == UNZ_OK;
        unzClose(from->zip);
    }
    return (!from->gzip || gzclose(from->gzip) == Z_OK) && good;
}

/* Opens the first file of the archive with this ending. Returns false if there is none. */
static bool find_file(unzFile zip, const char *ending)
{
    char name[512];
    unz_file_info info; /* required by minizip, unused */
    for (int status = unzGoToFirstFile(zip); status == UNZ_OK; status = unzGoToNextFile(zip))
        if (unzGetCurrentFileInfo(zip, &info, name, sizeof(name), NULL, 0, NULL, 0) == UNZ_OK &&
            (!strcasecmp(ending_of(name), ending) || (!strcmp(ending, ".stp") && !strcasecmp(ending_of(name), ".step"))))
            return unzOpenCurrentFile(zip) == UNZ_OK;
    return false;
}

bool unpack(const char *path, const char *output, char *why, size_t why_bytes)
{
    struct stat st;
    size_t most = free_bytes + (stat(path, &st) == 0 ? (size_t)st.st_size * MAX_RATIO : 0);
    struct archive_reading from = { .zip = unzOpen64(path) };
    const char *reason = NULL;
    if (!from.zip)
        from.gzip = gzopen(path, "rb");
    if (from.zip && !find_file(from.zip, unpack_ending(path)))
        reason = "its archive holds no model";
    else if (!from.zip && (!from.gzip || gzdirect(from.gzip)))
        reason = "it is neither a ZIP nor a gzip file";
    FILE *to = reason ? NULL : fopen(output, "wb");
    if (!reason)
        reason = to ? copy(&from, to, most) : strerror(errno);
    if (to && fclose(to) != 0 && !reason)
        reason = strerror(errno);
    if (!finish(&from) && !reason)
        reason = "its archive is broken: it is cut off, or its checksum is wrong";
    if (reason)
        snprintf(why, why_bytes, "%s", reason);
    return !reason;
}
