/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of the web client. */
#include "net/http/site.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "base/text.h"

enum { MAX_FILE_BYTES = 32 * 1024 * 1024 };

static const struct {
    const char *ending, *type;
} types[] = {
    { ".html", "text/html; charset=utf-8" },
    { ".js", "text/javascript; charset=utf-8" },
    { ".mjs", "text/javascript; charset=utf-8" },
    { ".css", "text/css; charset=utf-8" },
    { ".json", "application/json" },
    { ".svg", "image/svg+xml" },
    { ".png", "image/png" },
    { ".jpg", "image/jpeg" },
    { ".ico", "image/x-icon" },
    { ".webmanifest", "application/manifest+json" },
    { ".woff2", "font/woff2" },
    { ".txt", "text/plain; charset=utf-8" },
};

/* Only what we know is served. */
static const char *type_of(const char *path)
{
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof(types) / sizeof(types[0]); i++)
        if (!strcmp(types[i].ending, dot))
            return types[i].type;
    return NULL;
}

/* Letters, digits, '-', '_' and '.', no part that starts with a dot: so no "..", no hidden file. */
static bool path_harmless(const char *path)
{
    for (const char *at = path; *at; at++)
        if (*at == '/' ? at[1] == '.' || at[1] == '/' : !isalnum((unsigned char)*at) && !strchr("-_.", *at))
            return false;
    return path[0] == '/';
}

/* Links may not lead out of the folder either. */
static bool inside(const char *folder, const char *path)
{
    char *real_folder = realpath(folder, NULL), *real_path = realpath(path, NULL);
    size_t n = real_folder ? strlen(real_folder) : 0;
    bool good = real_folder && real_path && !strncmp(real_path, real_folder, n) && real_path[n] == '/';
    free(real_path);
    free(real_folder);
    return good;
}

bool site_read(const char *folder, const char *path, bool only_etag, struct site_file *out)
{
    struct stat st;
    *out = (struct site_file){ 0 };
    if (!folder || !path_harmless(path))
        return false;
    char *full = mem_printf("%s%s%s", folder, path, path[strlen(path) - 1] == '/' ? "index.html" : "");
    bool good = inside(folder, full) && stat(full, &st) == 0 && S_ISREG(st.st_mode) && (out->type = type_of(full)) != NULL;
    if (good) {
        snprintf(out->etag, sizeof(out->etag), "\"%" PRIx64 "-%" PRIx64 "\"", (uint64_t)st.st_size,
                 (uint64_t)st.st_mtim.tv_sec * 1000000000u + (uint64_t)st.st_mtim.tv_nsec);
        if (!only_etag)
            good = (out->bytes = text_read_file(full, MAX_FILE_BYTES, &out->count)) != NULL;
    }
    mem_free(full);
    return good;
}
