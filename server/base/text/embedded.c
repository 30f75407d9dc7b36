/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Looks up built-in files. */
#include "base/text/embedded.h"

#include <stddef.h>
#include <string.h>

const char *embedded_find(const char *name)
{
    for (const struct embedded_file *file = embedded_files; file->name; file++)
        if (!strcmp(file->name, name))
            return file->text;
    return NULL;
}
