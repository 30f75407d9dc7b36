/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of the web client, served from one folder. Thread: the loop. */
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

/* Reads the file of a path, which is decoded and starts with '/'. Scripts of the page come without comment lines. only_etag: bytes stays
   NULL. Returns false if there is no such file below the folder. */
bool site_read(const char *folder, const char *path, bool only_etag, struct site_file *out);

#endif
