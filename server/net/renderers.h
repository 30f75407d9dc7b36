/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The core's side of connections to /core: accepts renderers and standbys, sends them what changed, and carries out actions of
   renderers' users. A peer that reads too slowly delays no other peer: it gets only the newest state, and is disconnected after
   5 s without reading. Call only in the event loop. */
#ifndef NET_RENDERERS_H
#define NET_RENDERERS_H
#include "net/server_context.h"

/* Handles the events of a connection to /core, for libwebsockets. */
int renderer_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len);
/* Checks the client of a new connection to /core. Returns NULL, or why it is refused (static text). */
const char *renderers_refusal(const struct server_context *server, struct lws *wsi);
/* Returns whether a standby core of this version and configuration is connected to this core. */
bool renderers_have_standby(const struct server_context *server);
/* Texts about the standby of this leading core; static. */
struct standby_texts {
    const char *ready, *status; /* ready: first part of the body of /readyz; status: for the service manager */
};
const struct standby_texts *renderers_standby_texts(const struct server_context *server);
/* Notes and logs that this core refused the handshake of a node at /core with this HTTP status. The node may be the standby: if none is
   connected, engineers' pages, /readyz and the service manager learn about the refusal. Does nothing on a core that does not lead a
   pair. */
void renderers_deny(struct server_context *server, const char *who, int status, const char *why);
/* Updates what engineers' pages learn about the standby (session_context.standby). Call it whenever this core may have begun to
   lead or to follow. */
void renderers_describe_standby(struct server_context *server);
/* Returns the lease name of the standby that has confirmed to have all state; NULL: none has. A standby can confirm this only
   once nothing changes any more (life.lead_ended_ns) and all actions are answered. Valid until the event loop runs again. */
const char *renderers_complete_standby(const struct server_context *server);
/* Tells all renderers that this core begins to load the plant, so that they load their files at the same time. configuration: hash of
   the plant file and tag list that this core loads. A standby ignores the message and stays responsive: a leader that cannot reach
   the database needs the standby's promises not to take the lead. */
void renderers_announce_reload(struct server_context *server, const char *configuration);
/* Makes the key that this core's renderers sign view tokens with; all get the same key. */
void renderers_make_key(struct server_context *server);
/* Sends all renderers what changed. */
void renderers_on_change(struct server_context *server);
/* Sends answers to actions that renderers forwarded for their users, once the actions are on disk. */
void renderers_settle(struct server_context *server);
/* Returns whether an action that a renderer forwarded is not answered yet. */
bool renderers_owe_answers(const struct server_context *server);
/* Closes the connections to all renderers, because the plant changes or the daemon ends. why: static text. */
void renderers_close(struct server_context *server, const char *why);

#endif
