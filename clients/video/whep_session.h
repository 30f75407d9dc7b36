/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One reader by WebRTC: its connection, which carries on what the encoder made. Thread: that of the default main context, where nothing
   else is said. */
#ifndef VIDEO_WHEP_SESSION_H
#define VIDEO_WHEP_SESSION_H
#include "options.h"
#include "outputs.h"

struct whep_session;
enum whep_fault { WHEP_BAD_OFFER, WHEP_BUSY, WHEP_UNABLE }; /* why there is no answer: by the reader's fault in the first case only */
/* Begins to answer an offer (SDP). answered is called once, later: with the answer and all ways to get here, or NULL and the fault.
   Returns NULL with *fault, and *why set to a text that stays, if none can be begun. The caller leaves and destroys it. */
struct whep_session *whep_session_create(const struct options *options, struct outputs *outputs, const char *offer,
                                         void (*answered)(struct whep_session *session, const char *sdp, enum whep_fault fault, void *data),
                                         void *data, enum whep_fault *fault, const char **why);
/* From now on it gets nothing more, and answered is not called. Does not wait. */
void whep_session_leave(struct whep_session *session);
/* Waits for what its threads are about, which on a busy machine may take as long as an answer. After whep_session_leave(), on any thread.
   &NULL is fine; leaves NULL. */
void whep_session_destroy(struct whep_session **session);
/* Returns whether its reader is there, or may still come. Call it once a second. */
bool whep_session_is_alive(struct whep_session *session);

#endif
