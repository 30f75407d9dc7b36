/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of a session share: input (session.c), pictures (session_wishes.c), words (session_texts.c). Private to them. */
#ifndef NET_SESSION_IMPL_H
#define NET_SESSION_IMPL_H
#include "net/session.h"

void session_reply(struct session *session, char *text); /* takes it */
void session_drop_ready(struct session *session); /* what was not sent yet */
/* Takes the list, and the first of it that there is. False: there is none. */
bool session_choose_codec(struct session *session, const struct codec_list *codecs, struct message_error *error);
void session_reply_error(struct session *session, const struct message_error *error);

void session_pause(struct session *session);    /* nothing moves: keep no picture for it */
void session_on_shown(struct session *session); /* session->pacer.acked is on the client's screen */

#endif
