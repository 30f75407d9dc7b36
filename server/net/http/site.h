/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of the web client, below one folder and nowhere else. */
#ifndef NET_SITE_H
#define NET_SITE_H
#include <stdbool.h>
#include <stddef.h>

struct site_file {
    char *bytes; /* mem_free */
    size_t count;
    const char *type; /* MIME, static */
    char etag[48];    /* with its quotes */
};

/* path: decoded, starts with '/'. False: there is no such file that may be served. bytes stay NULL if only_etag. The page's own scripts
   come without lines that only comment. */
bool site_read(const char *folder, const char *path, bool only_etag, struct site_file *out);

#endif
