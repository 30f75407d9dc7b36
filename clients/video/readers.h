/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Judges the passwords of readers over HTTP: in constant time, ten wrong ones a minute from an address, each in the log. Thread: that of
   the default main context. */
#ifndef VIDEO_READERS_H
#define VIDEO_READERS_H
#include <libsoup/soup.h>
#include <stdbool.h>

#include "options.h"

/* Returns whether user and password are those of the options. user NULL: a bearer token, the password alone. From an address that gave too
   many wrong ones only one in five seconds is judged, unless a right one came from there before (access/login_throttle.h). */
bool reader_may(const struct options *options, SoupServerMessage *message, const char *user, const char *password);

#endif
