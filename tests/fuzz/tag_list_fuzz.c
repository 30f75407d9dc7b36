/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Feeds tag lists to the reader of exports. The first byte selects a text (CSV or JSON, in a detected encoding) or a
   spreadsheet. For a spreadsheet, the input is the sheet's XML, a zero byte, and the XML of the shared strings; the container
   around them is always valid. */
#include <fcntl.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "base/text/charset.h"
#include "base/text/text.h"
#include "preprocess/match/tag_export.h"
#include "tests/fuzz/promise.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

enum { PARTS = 4 };
struct part {
    const char *name;
    const void *bytes;
    size_t count;
};

static void add16(struct text *out, unsigned value)
{
    text_add_bytes(out, (const char[]){ (char)value, (char)(value >> 8) }, 2);
}

static void add32(struct text *out, size_t value)
{
    add16(out, (unsigned)(value & 0xffff));
    add16(out, (unsigned)(value >> 16));
}

/* Appends the fields that a local header and an entry of the central directory share; parts are stored, not compressed. */
static void add_head(struct text *out, const struct part *part)
{
    for (int i = 0; i < 5; i++)
        add16(out, i == 0 ? 20 : 0);
    add32(out, crc32(0, part->bytes, (uInt)part->count));
    add32(out, part->count);
    add32(out, part->count);
    add16(out, (unsigned)strlen(part->name));
    add16(out, 0);
}

static void write_zip(struct text *out, const struct part parts[PARTS])
{
    struct text central = { 0 };
    for (int i = 0; i < PARTS; i++) {
        size_t at = out->length;
        text_add_bytes(out, "PK\3\4", 4);
        add_head(out, &parts[i]);
        text_add_bytes(out, parts[i].name, strlen(parts[i].name));
        text_add_bytes(out, parts[i].bytes, parts[i].count);
        text_add_bytes(&central, "PK\1\2\24\0", 6);
        add_head(&central, &parts[i]);
        for (int k = 0; k < 3; k++)
            add16(&central, 0);
        add32(&central, 0);
        add32(&central, at);
        text_add_bytes(&central, parts[i].name, strlen(parts[i].name));
    }
    size_t at = out->length;
    text_add_bytes(out, central.at, central.length);
    text_add_bytes(out, "PK\5\6\0\0\0\0", 8);
    add16(out, PARTS);
    add16(out, PARTS);
    add32(out, central.length);
    add32(out, at);
    add16(out, 0);
    text_finish(&central);
}

static void write_workbook(struct text *out, const uint8_t *bytes, size_t count)
{
    static const char book[] = "<workbook xmlns:r=\"r\"><sheets><sheet name=\"s\" sheetId=\"1\" r:id=\"r1\"/></sheets></workbook>";
    static const char relations[] = "<Relationships><Relationship Id=\"r1\" Type=\"worksheet\" Target=\"worksheets/sheet1.xml\"/>"
                                    "</Relationships>";
    const uint8_t *end = memchr(bytes, 0, count), *strings = end ? end + 1 : bytes + count;
    write_zip(out, (const struct part[PARTS]){
                       { "xl/workbook.xml", book, sizeof(book) - 1 },
                       { "xl/_rels/workbook.xml.rels", relations, sizeof(relations) - 1 },
                       { "xl/worksheets/sheet1.xml", bytes, end ? (size_t)(end - bytes) : count },
                       { "xl/sharedStrings.xml", strings, (size_t)(bytes + count - strings) },
                   });
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    struct tag_export list = { 0 };
    struct text file = { 0 };
    char path[64], why[400] = "";
    if (count == 0)
        return 0;
    if (bytes[0] % 2)
        write_workbook(&file, bytes + 1, count - 1);
    else
        text_add_bytes(&file, (const char *)bytes + 1, count - 1);
    snprintf(path, sizeof(path), "/dev/shm/plantcast-fuzz-%d", (int)getpid());
    int out = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    require(out >= 0 && write(out, file.at ? file.at : "", file.length) == (ssize_t)file.length, "the file can be written");
    close(out);
    bool good = tag_export_read(&list, path, NULL, why, sizeof(why));
    require(good || (*why && list.count == 0), "a refusal says why and leaves nothing");
    for (size_t i = 0; i < list.count; i++)
        for (int k = 0; k < EXPORT_FIELDS; k++) {
            const char *field = list.tags[i].fields[k];
            require(!field || charset_fits(field, strlen(field), "UTF-8"), "a field is UTF-8");
        }
    tag_export_finish(&list);
    unlink(path);
    text_finish(&file);
    return 0;
}
