/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of the web client, as they were when the daemon started: read into memory from one folder, so that an upgrade of
   the files never meets the daemon of before. Thread: one makes it; immutable from then on. */
#ifndef NET_SITE_H
#define NET_SITE_H
#include <stdbool.h>
#include <stddef.h>

#include "base/log/log.h"

struct site_file {
    char *path; /* of the URL, decoded, from '/' on */
    char *bytes;
    size_t count;
    const char *type; /* MIME, static */
    char etag[24];    /* with its quotes */
};

struct web_site;
/* Reads all files of known types below the folder; scripts of the page without their comment lines. folder NULL: a site without files. */
struct web_site *site_create(struct log *log, const char *folder);
void site_destroy(struct web_site **site); /* &NULL is fine; leaves NULL */
/* Returns the file of a path, which is decoded and starts with '/', or NULL. It lives as long as the site. */
const struct site_file *site_find(const struct web_site *site, const char *path);

#endif
