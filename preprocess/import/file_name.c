/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Splits file names at their last slash and dot. */
#include "preprocess/import/file_name.h"

#include <string.h>

#include "base/mem.h"

char *file_name_with_ending(const char *path, const char *ending)
{
    const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
    size_t stem = dot && (!slash || dot > slash) ? (size_t)(dot - path) : strlen(path);
    return mem_printf("%.*s%s", (int)stem, path, ending);
}

char *file_name_stem(const char *path)
{
    const char *slash = strrchr(path, '/');
    return file_name_with_ending(slash ? slash + 1 : path, "");
}
