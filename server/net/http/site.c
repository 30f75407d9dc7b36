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

static bool is_own_script(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && !strcmp(dot, ".js") && strncmp(path, "/vendor/", 8) != 0;
}

/* Empties lines that only comment, a tenth of what a page loads, but for the first, which is the licence. Line numbers stay those of
   the source. Returns what is left of count. */
static size_t drop_comments(char *bytes, size_t count)
{
    size_t out = 0;
    for (size_t at = 0, end; at < count; at = end) {
        const char *stop = memchr(bytes + at, '\n', count - at);
        size_t text = at;
        end = stop ? (size_t)(stop - bytes) + 1 : count;
        while (text < end && bytes[text] == ' ')
            text++;
        bool comment = at > 0 && end - text >= 2 && bytes[text] == '/' && bytes[text + 1] == '/';
        size_t from = comment ? end - (stop != NULL) : at;
        memmove(bytes + out, bytes + from, end - from);
        out += end - from;
    }
    return out;
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
        if (out->bytes && is_own_script(path))
            out->count = drop_comments(out->bytes, out->count);
    }
    mem_free(full);
    return good;
}
