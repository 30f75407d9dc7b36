/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Unpacks ZIP-compressed models with minizip and gzip-compressed ones with zlib. */
#include "preprocess/import/unpack.h"

#include <errno.h>
#include <minizip/unzip.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <zlib.h>

#include "base/mem.h"
#include "preprocess/import/file_name.h"
#include "preprocess/import/formats.h"

enum {
    BLOCK_BYTES = 1 << 16,
    /* largest accepted ratio of unpacked to packed size; models compress to about a tenth, so a file with a larger ratio is
     * rejected as a decompression bomb */
    MAX_RATIO = 200,
    NAME_BYTES = 512
};
static const size_t free_bytes = (size_t)64 << 20; /* number of bytes that may be unpacked regardless of MAX_RATIO */

static const struct {
    const char *packed, *ending;
} endings[] = { { ".ifczip", ".ifc" }, { ".stpz", ".stp" }, { ".zae", ".dae" } };

static const char *ending_of(const char *path)
{
    const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
    return dot && (!slash || dot > slash) ? dot : "";
}

/* Returns whether a file begins with the magic bytes of a ZIP or gzip file. */
static bool begins_packed(const char *path)
{
    unsigned char head[4] = { 0 };
    FILE *file = fopen(path, "rb");
    bool packed = file && fread(head, 1, sizeof(head), file) == sizeof(head) &&
                  (!memcmp(head, "PK\3\4", 4) || (head[0] == 0x1f && head[1] == 0x8b));
    if (file)
        fclose(file);
    return packed;
}

char *unpack_ending(const char *path)
{
    char *inner = file_name_without_gz(path), *ending = NULL;
    for (size_t i = 0; i < sizeof(endings) / sizeof(endings[0]) && !ending; i++)
        if (!strcasecmp(ending_of(inner), endings[i].packed))
            ending = mem_strdup(endings[i].ending);
    if (!ending && (strcmp(inner, path) != 0 || begins_packed(path)))
        ending = mem_strdup(ending_of(inner));
    mem_free(inner);
    return ending;
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
    char block[BLOCK_BYTES];
    size_t total = 0;
    for (int count; (count = read_block(from, block)) != 0; total += (size_t)count) {
        if (count < 0)
            return "the archive is damaged: create the archive again";
        if (total + (size_t)count > most)
            return "the archive unpacks to more than 200 times its size";
        if (fwrite(block, 1, (size_t)count, to) != (size_t)count)
            return strerror(errno);
    }
    return total > 0 ? NULL : "the archive is empty";
}

/* Closes an archive. Returns whether its data was complete and its checksum correct. */
static bool finish(const struct archive_reading *from)
{
    bool good = true;
    if (from->zip) {
        good = unzCloseCurrentFile(from->zip) == UNZ_OK;
        unzClose(from->zip);
    }
    return (!from->gzip || gzclose(from->gzip) == Z_OK) && good;
}

/* Copies the name of the first document in a COLLADA archive's manifest.xml to `root`, or "" if there is none. */
static void read_root(unzFile zip, char root[NAME_BYTES])
{
    char text[4096];
    int count = unzLocateFile(zip, "manifest.xml", 2) == UNZ_OK && unzOpenCurrentFile(zip) == UNZ_OK
                    ? unzReadCurrentFile(zip, text, sizeof(text) - 1)
                    : 0;
    text[count > 0 ? count : 0] = 0;
    const char *tag = strstr(text, "<dae_root"), *at = tag ? strchr(tag, '>') : NULL;
    size_t length = at ? strcspn(at + 1, "<#\r\n") : 0;
    snprintf(root, NAME_BYTES, "%.*s", (int)length, at ? at + 1 : "");
    unzCloseCurrentFile(zip);
}

static bool is_step(const char *ending)
{
    return !strcasecmp(ending, ".stp") || !strcasecmp(ending, ".step") || !strcasecmp(ending, ".p21");
}

static bool has_ending(const char *name, const char *ending)
{
    return !strcasecmp(ending_of(name), ending) || (is_step(ending) && is_step(ending_of(name)));
}

static bool is_named(const char *name, const char *root)
{
    const char *base = text_base_name(root);
    return *base && !strcmp(text_base_name(name), base);
}

/* Opens a file of a ZIP archive with this ending: the one named in the archive's manifest, else the first. Returns NULL, or the
 * reason if there is none. */
static const char *open_file(unzFile zip, const char *ending, struct text *said)
{
    char name[NAME_BYTES], root[NAME_BYTES], taken[NAME_BYTES] = "";
    size_t count = 0;
    bool locked = false, xml = false;
    read_root(zip, root);
    for (int status = unzGoToFirstFile(zip); status == UNZ_OK; status = unzGoToNextFile(zip)) {
        unz_file_info info;
        if (unzGetCurrentFileInfo(zip, &info, name, sizeof(name), NULL, 0, NULL, 0) != UNZ_OK)
            continue;
        xml |= has_ending(name, ".ifcxml");
        if (!has_ending(name, ending) || !strncmp(name, "__MACOSX/", 9))
            continue;
        if (count++ == 0 || is_named(name, root)) {
            memcpy(taken, name, sizeof(taken));
            locked = info.flag & 1;
        }
    }
    if (count == 0)
        return xml ? FORMAT_IFC_XML : "the archive contains no model";
    if (locked)
        return "the archive is encrypted: create the archive again without a password";
    if (count > 1)
        text_add(said, "left out: %zu other model%s in the archive; only %s was imported\n", count - 1, count == 2 ? "" : "s", taken);
    return unzLocateFile(zip, taken, 1) == UNZ_OK && unzOpenCurrentFile(zip) == UNZ_OK ? NULL
                                                                                       : "the archive is damaged: create the archive again";
}

bool unpack(const char *path, const char *output, struct text *said, char *why, size_t why_bytes)
{
    struct stat st;
    size_t most = free_bytes + (stat(path, &st) == 0 ? (size_t)st.st_size * MAX_RATIO : 0);
    struct archive_reading from = { .zip = unzOpen64(path) };
    const char *reason = NULL;
    if (!from.zip)
        from.gzip = gzopen(path, "rb");
    if (from.zip)
        reason = open_file(from.zip, ending_of(output), said);
    else if (!from.gzip || gzdirect(from.gzip))
        reason = "the file is not a ZIP or gzip archive";
    FILE *to = reason ? NULL : fopen(output, "wb");
    if (!reason)
        reason = to ? copy(&from, to, most) : strerror(errno);
    if (to && fclose(to) != 0 && !reason)
        reason = strerror(errno);
    if (!finish(&from) && !reason)
        reason = "the archive is damaged: truncated, or with a wrong checksum";
    if (reason)
        snprintf(why, why_bytes, "%s", reason);
    return !reason;
}
