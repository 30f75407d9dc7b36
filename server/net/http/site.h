/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The web client's files, as found when the daemon started. They are read into memory from one folder, so that a running daemon
   never serves files of a newer version. Call from the thread that creates it, afterwards only in the event loop. */
#ifndef NET_SITE_H
#define NET_SITE_H
#include <stdbool.h>
#include <stddef.h>

#include "base/log/log.h"

struct site_form { /* a file's content in one encoding (plain or gzip), as it is sent to clients */
    char *bytes;
    size_t count;
    char etag[24]; /* value of the HTTP header ETag, with its quotes */
};

struct site_file {
    char *path;       /* path in the URL, decoded, with its leading '/' */
    const char *type; /* MIME type, static text */
    struct site_form plain;
    /* the file compressed (RFC 1952), made at the first request that accepts gzip; bytes NULL: not made yet, or it saves too little */
    struct site_form gzip;
    bool compresses; /* true: the file has not been compressed yet, because no request has accepted gzip */
};

struct web_site;
/* Reads all files of known types below the folder; strips comment lines from the page's scripts. folder NULL: a site without files. */
struct web_site *site_create(struct log *log, const char *folder);
void site_destroy(struct web_site **site); /* destroys the site and sets *site to NULL; accepts a pointer to NULL */
/* Returns the file of a decoded path that starts with '/', or NULL. A path that ends with '/' means its index.html.
   The file lives as long as the site. */
struct site_file *site_find(const struct web_site *site, const char *path);
/* Returns the smallest form that a value of the HTTP header Accept-Encoding allows (RFC 9110, 12.5.3); "" allows only `plain`. */
const struct site_form *site_form_for(struct site_file *file, const char *accept_encoding);

#endif
