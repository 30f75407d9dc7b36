/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/files/secret.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"

enum { SECRET_BYTES = 4096 };

char *secret_read(const char *path, char **why)
{
    size_t bytes;
    char *text = text_read_file(path, SECRET_BYTES, &bytes);
    if (!text) {
        *why = mem_printf("%s cannot be read: %s", path, strerror(errno));
        return NULL;
    }
    text[strcspn(text, "\r\n")] = 0;
    return text;
}

const char *secret_read_bearer(const char *path, char *out, size_t size)
{
    size_t bytes;
    char *text = text_read_file(path, SECRET_BYTES, &bytes);
    if (!text)
        return strerror(errno);
    size_t n = strcspn(text, " \t\r\n");
    bool good = n > 0 && n + sizeof("Bearer ") <= size;
    if (good)
        snprintf(out, size, "Bearer %.*s", (int)n, text);
    secret_forget(text);
    return good ? NULL : "the first line of this file must be a token (see `plantcast token`)";
}

void secret_forget(char *secret)
{
    if (secret)
        explicit_bzero(secret, strlen(secret));
    mem_free(secret);
}
