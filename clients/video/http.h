/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Serves the files of HLS, and counters. Thread: that of the default main context. */
#ifndef VIDEO_HTTP_H
#define VIDEO_HTTP_H
#include "options.h"

struct http;
/* Listens. metrics writes what /metrics says. Returns NULL with the reason printed. The caller destroys it. */
struct http *http_create(const struct options *options, void (*metrics)(GString *out, void *data), void *data);
void http_destroy(struct http **http); /* &NULL is fine; leaves NULL */

#endif
