/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Serves the files of HLS, WHEP, and counters. Thread: that of the default main context. */
#ifndef VIDEO_HTTP_H
#define VIDEO_HTTP_H
#include "options.h"
#include "whep.h"

struct http;
/* Listens. whep may be NULL. metrics writes what /metrics says. Returns NULL with the reason printed. The caller destroys it. */
struct http *http_create(const struct options *options, struct whep *whep, void (*metrics)(GString *out, void *data), void *data);
void http_destroy(struct http **http); /* &NULL is fine; leaves NULL */

#endif
