/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads the web client's files into memory and finds them by path. */
#include "net/http/site.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <xxhash.h>
#include <zlib.h>

#include "base/mem.h"
#include "base/text/text.h"

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

/* Returns the MIME type of a path; NULL for unknown types, which are not served. */
static const char *type_of(const char *path)
{
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof(types) / sizeof(types[0]); i++)
        if (!strcmp(types[i].ending, dot))
            return types[i].type;
    return NULL;
}

/* Returns whether a path has only letters, digits, '-', '_' and '.', and no part that starts with a dot: no "..", no hidden file. */
static bool path_harmless(const char *path)
{
    for (const char *at = path; *at; at++)
        if (*at == '/' ? at[1] == '.' || at[1] == '/' : !isalnum((unsigned char)*at) && !strchr("-_.", *at))
            return false;
    return path[0] == '/';
}

/* Returns whether the file is inside the folder after resolving symlinks. */
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

/* Counts the backquotes of a line of JavaScript. Returns whether the line opens a template literal without closing it, or closes one that
   an earlier line opened. */
static bool toggles_template(const char *line, const char *end)
{
    bool toggles = false;
    for (; line < end; line++)
        if (*line == '\\')
            line++;
        else if (*line == '`')
            toggles = !toggles;
    return toggles;
}

/* Removes the indentation of a script's lines, and empties lines that hold only a comment, except the first line, which is the
   licence. This saves the page a fifth of its bytes. Lines of template literals are left unchanged, and no line is removed, so
   that line numbers match the source. Returns how many of the `count` bytes are left. */
static size_t drop_comments(char *bytes, size_t count)
{
    size_t out = 0;
    bool in_template = false;
    for (size_t at = 0, end; at < count; at = end) {
        const char *stop = memchr(bytes + at, '\n', count - at);
        size_t text = at;
        end = stop ? (size_t)(stop - bytes) + 1 : count;
        while (!in_template && text < end && bytes[text] == ' ')
            text++;
        bool comment = !in_template && at > 0 && end - text >= 2 && bytes[text] == '/' && bytes[text + 1] == '/';
        size_t from = comment ? end - (stop != NULL) : text;
        if (!comment && toggles_template(bytes + text, bytes + end))
            in_template = !in_template;
        memmove(bytes + out, bytes + from, end - from);
        out += end - from;
    }
    return out;
}

static void set_etag(struct site_form *form)
{
    snprintf(form->etag, sizeof(form->etag), "\"%016" PRIx64 "\"", (uint64_t)XXH3_64bits(form->bytes, form->count));
}

/* Returns the bytes compressed as gzip; bytes is NULL if compression would save less than a tenth. */
static struct site_form compressed(const struct site_form *plain)
{
    /* GZIP_WINDOW: for zlib, window bits plus 16 select the gzip format; MEMORY_LEVEL: 9, the most memory and best compression */
    enum { GZIP_WINDOW = MAX_WBITS + 16, MEMORY_LEVEL = 9 };
    z_stream stream = { .next_in = (Bytef *)plain->bytes, .avail_in = (uInt)plain->count };
    struct site_form gzip = { .count = plain->count - plain->count / 10 };
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, GZIP_WINDOW, MEMORY_LEVEL, Z_DEFAULT_STRATEGY) != Z_OK)
        return (struct site_form){ 0 };
    gzip.bytes = mem_array(gzip.count + 1, 1);
    stream.next_out = (Bytef *)gzip.bytes;
    stream.avail_out = (uInt)gzip.count;
    bool fits = deflate(&stream, Z_FINISH) == Z_STREAM_END;
    gzip.count = stream.total_out;
    deflateEnd(&stream);
    if (fits)
        set_etag(&gzip);
    else
        mem_free(gzip.bytes);
    return fits ? gzip : (struct site_form){ 0 };
}

struct web_site {
    char *folder;
    struct site_file *files; /* files of the web client, sorted by path within the site */
    size_t count, capacity;
};

static void add_file(struct web_site *site, struct log *log, const char *full, const char *path)
{
    struct site_file file = { .type = type_of(path), .compresses = true };
    if (!file.type || !path_harmless(path) || !inside(site->folder, full))
        return;
    file.plain.bytes = text_read_file(full, MAX_FILE_BYTES, &file.plain.count);
    if (!file.plain.bytes) {
        log_err(log, "%s: %s", full, strerror(errno));
        return;
    }
    if (is_own_script(path))
        file.plain.count = drop_comments(file.plain.bytes, file.plain.count);
    file.path = mem_strdup(path);
    set_etag(&file.plain);
    mem_grow(&site->files, &site->capacity, site->count + 1, sizeof(*site->files));
    site->files[site->count++] = file;
}

/* Adds the files of a folder and of the folders inside. path: path of the folder within the site, without a trailing slash. */
static void add_folder(struct web_site *site, struct log *log, const char *path)
{
    char *full = mem_printf("%s%s", site->folder, path);
    DIR *folder = opendir(full);
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        struct stat st = { 0 };
        char *one = mem_printf("%s/%s", full, entry->d_name), *below = mem_printf("%s/%s", path, entry->d_name);
        if (entry->d_name[0] != '.' && stat(one, &st) == 0 && S_ISDIR(st.st_mode) && inside(site->folder, one))
            add_folder(site, log, below);
        else if (entry->d_name[0] != '.' && S_ISREG(st.st_mode))
            add_file(site, log, one, below);
        mem_free(one);
        mem_free(below);
    }
    if (folder)
        closedir(folder);
    mem_free(full);
}

static int by_path(const void *a, const void *b)
{
    return strcmp(((const struct site_file *)a)->path, ((const struct site_file *)b)->path);
}

struct web_site *site_create(struct log *log, const char *folder)
{
    struct web_site *site = mem_new(sizeof(*site));
    if (!folder)
        return site;
    site->folder = mem_strdup(folder);
    add_folder(site, log, "");
    if (site->count)
        qsort(site->files, site->count, sizeof(*site->files), by_path);
    return site;
}

void site_destroy(struct web_site **pointer)
{
    struct web_site *site = *pointer;
    if (!site)
        return;
    for (size_t i = 0; i < site->count; i++) {
        mem_free(site->files[i].path);
        mem_free(site->files[i].plain.bytes);
        mem_free(site->files[i].gzip.bytes);
    }
    mem_free(site->files);
    mem_free(site->folder);
    mem_free(site);
    *pointer = NULL;
}

struct site_file *site_find(const struct web_site *site, const char *path)
{
    size_t length = strlen(path);
    char *whole = length && path[length - 1] == '/' ? mem_printf("%sindex.html", path) : NULL;
    const struct site_file wanted = { .path = whole ? whole : (char *)(uintptr_t)path };
    struct site_file *found = site->count ? bsearch(&wanted, site->files, site->count, sizeof(*site->files), by_path) : NULL;
    mem_free(whole);
    return found;
}

/* Returns whether an element of Accept-Encoding, `length` bytes long, allows gzip: its weight (";q=", default 1) is above 0. */
static bool allows_gzip(const char *element, size_t length)
{
    char text[32];
    snprintf(text, sizeof(text), "%.*s", (int)length, element);
    const char *name = text + strspn(text, " \t"), *weight = strstr(name, "q=");
    return strcspn(name, "; \t") == 4 && !strncasecmp(name, "gzip", 4) && (!weight || strtod(weight + 2, NULL) > 0);
}

static bool accepts_gzip(const char *accept_encoding)
{
    bool accepts = false;
    for (const char *at = accept_encoding; *at && !accepts; at += *at == ',') {
        size_t length = strcspn(at, ",");
        accepts = allows_gzip(at, length);
        at += length;
    }
    return accepts;
}

const struct site_form *site_form_for(struct site_file *file, const char *accept_encoding)
{
    if (!accepts_gzip(accept_encoding))
        return &file->plain;
    if (file->compresses)
        file->gzip = compressed(&file->plain);
    file->compresses = false;
    return file->gzip.bytes ? &file->gzip : &file->plain;
}
