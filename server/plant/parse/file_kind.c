/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Table of file signatures. */
#include "plant/parse/file_kind.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const struct {
    const char *begins;
    size_t count;
    const char *kind;
} known[] = {
#define BEGINS(text) text, sizeof(text) - 1
    { BEGINS("glTF"), "a model (GLB)" },
    { BEGINS("Kaydara FBX Binary"), "an FBX model" },
    { BEGINS("; FBX"), "an FBX model" },
    { BEGINS("ply\n"), "a PLY model" },
    { BEGINS("PXR-USDC"), "a USD model" },
    { BEGINS("#usda 1"), "a USD model" },
    { BEGINS("HEAD\n"), "an RVM model" },
    { BEGINS("HEAD\r"), "an RVM model" },
    { BEGINS("\0\0\0H\0\0\0E\0\0\0A\0\0\0D"), "an RVM model" },
    { BEGINS("\xD0\xCF\x11\xE0"), "a document of Office 97 to 2003, or a CAD file in the same container" },
    { BEGINS("PK\x03\x04"), "a ZIP archive, or a document in ZIP format (XLSX, DOCX, 3MF)" },
    { BEGINS("\x1F\x8B"), "a gzip archive" },
    { BEGINS("%PDF"), "a PDF document" },
    { BEGINS("\x89PNG"), "a PNG picture" },
    { BEGINS("\xFF\xD8\xFF"), "a JPEG picture" },
    { BEGINS("SQLite format 3"), "an SQLite database" },
    { BEGINS("\x7F" "ELF"), "a program" },
};

enum { LOOKED_AT_BYTES = 512 };

static bool has(const char *bytes, size_t count, const char *word)
{
    return memmem(bytes, count, word, strlen(word)) != NULL;
}

static const char *kind_of(const char *text, size_t count)
{
    if (count > 12 && !memcmp(text, "ISO-10303-21", 12))
        return has(text, count, "IFC") ? "an IFC model" : "a STEP file";
    for (size_t i = 0; i < sizeof(known) / sizeof(*known); i++)
        if (count >= known[i].count && !memcmp(text, known[i].begins, known[i].count))
            return known[i].kind;
    if (count > 5 && !memcmp(text, "<?xml", 5))
        return has(text, count, "COLLADA") ? "a COLLADA model" : "an XML file";
    if (count > 6 && !memcmp(text, "AC10", 4) && text[6] == 0)
        return "a DWG drawing";
    if (count > 6 && !memcmp(text, "solid ", 6) && has(text, count, "facet"))
        return "an STL model";
    /* recognises the first line of an IGES file: 80 characters, with S in column 73 and 1 in column 80 */
    if (count > 80 && text[72] == 'S' && text[79] == '1' && !memchr(text, '\n', 72))
        return "an IGES model";
    return NULL;
}

const char *file_kind_of(const char *path)
{
    char bytes[LOOKED_AT_BYTES];
    FILE *file = fopen(path, "rb");
    size_t count = file ? fread(bytes, 1, sizeof(bytes), file) : 0;
    if (file)
        fclose(file);
    return kind_of(bytes, count);
}
