/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One reader by WebRTC: its connection, which carries on what the encoder made. Thread: that of the default main context. */
#ifndef VIDEO_WHEP_SESSION_H
#define VIDEO_WHEP_SESSION_H
#include "options.h"
#include "outputs.h"

struct whep_session;
enum whep_fault { WHEP_BAD_OFFER, WHEP_BUSY, WHEP_UNABLE }; /* why there is no answer: by the reader's fault in the first case only */
/* Begins to answer an offer (SDP). answered is called once, later: with the answer and all ways to get here, or NULL and the fault.
   Returns NULL with *fault, and *why set to a text that stays, if none can be begun. The caller destroys it; then answered is
   called no more. */
struct whep_session *whep_session_create(const struct options *options, struct outputs *outputs, const char *offer,
                                         void (*answered)(struct whep_session *session, const char *sdp, enum whep_fault fault, void *data),
                                         void *data, enum whep_fault *fault, const char **why);
void whep_session_destroy(struct whep_session **session); /* &NULL is fine; leaves NULL */
/* Returns whether its reader is there, or may still come. Call it once a second. */
bool whep_session_is_alive(struct whep_session *session);

#endif
