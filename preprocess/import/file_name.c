/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Splits file names at their last slash and dot. */
#include "preprocess/import/file_name.h"

#include <string.h>
#include <strings.h>

#include "base/mem.h"

char *file_name_without_gz(const char *path)
{
    static const char gz[] = ".gz";
    size_t length = strlen(path), kept = length >= sizeof(gz) - 1 ? length - (sizeof(gz) - 1) : length;
    return mem_printf("%.*s", (int)(strcasecmp(path + kept, gz) == 0 ? kept : length), path);
}

char *file_name_with_ending(const char *path, const char *ending)
{
    char *plain = file_name_without_gz(path);
    const char *dot = strrchr(plain, '.'), *slash = strrchr(plain, '/');
    size_t stem = dot && (!slash || dot > slash) ? (size_t)(dot - plain) : strlen(plain);
    char *out = mem_printf("%.*s%s", (int)stem, plain, ending);
    mem_free(plain);
    return out;
}

char *file_name_stem(const char *path)
{
    const char *slash = strrchr(path, '/');
    return file_name_with_ending(slash ? slash + 1 : path, "");
}
