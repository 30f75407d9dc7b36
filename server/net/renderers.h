/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The core's end of /core: renderers come and go, are sent what changed, and what people do at them is done. A renderer that takes nothing
   holds up nobody: it is sent what is newest once it takes something, and let go after 5 s. Thread: the loop. */
#ifndef NET_RENDERERS_H
#define NET_RENDERERS_H
#include "net/server_context.h"

/* Handles the events of a connection to /core, for lws. */
int renderer_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len);
/* Checks who wants to become a renderer. Returns NULL, or why not (static). */
const char *renderers_refusal(const struct server_context *server, struct lws *wsi);
/* Returns whether a core of this version and configuration follows this one. */
bool renderers_have_standby(const struct server_context *server);
/* Makes the key by which its renderers sign views. */
void renderers_make_key(struct server_context *server);
/* Have all renderers sent what changed. */
void renderers_on_change(struct server_context *server);
/* Sends answers to actions that renderers handed on, once these are on disk. */
void renderers_settle(struct server_context *server);
/* Ends all of them: the plant is another one from now on, or the daemon ends. why: static. */
void renderers_close(struct server_context *server, const char *why);

#endif
