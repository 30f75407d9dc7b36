/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Serves counters as /metrics to programs on this machine. Call only in the thread of GLib's default main context. */
#ifndef VIDEO_METRICS_H
#define VIDEO_METRICS_H
#include <glib.h>

struct metrics;
/* Listens on 127.0.0.1:port. Returns NULL with the reason printed. The caller destroys the result. */
struct metrics *metrics_create(int port);
void metrics_destroy(struct metrics **metrics); /* &NULL is fine; leaves NULL */
/* Sets the text that is served from now on, in Prometheus text format. Takes ownership of the text. */
void metrics_set(struct metrics *metrics, char *text);

#endif
