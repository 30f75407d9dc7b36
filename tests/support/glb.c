/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds a GLB file from its JSON and its binary chunk. */
#include "tests/support/glb.h"

#include <stdint.h>
#include <string.h>

#include "base/text/text.h"

static void add_chunk(struct text *file, const char *type, const void *bytes, size_t count, char fill)
{
    uint32_t padded = (uint32_t)(count + 3) / 4 * 4;
    text_add_bytes(file, &padded, 4);
    text_add_bytes(file, type, 4);
    text_add_bytes(file, bytes, count);
    for (size_t i = count; i < padded; i++)
        text_add_bytes(file, &fill, 1);
}

char *glb_build(const char *json, const void *bin, size_t bin_bytes, size_t *size)
{
    struct text file = { 0 };
    text_add_bytes(&file, "glTF\2\0\0\0\0\0\0\0", 12);
    add_chunk(&file, "JSON", json, strlen(json), ' ');
    if (bin)
        add_chunk(&file, "BIN\0", bin, bin_bytes, 0);
    uint32_t total = (uint32_t)file.length;
    memcpy(file.at + 8, &total, 4);
    *size = file.length;
    return file.at;
}
