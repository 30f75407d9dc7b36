/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The view that a session shows: its own or its leader's, with readings of the present or of an instant. Call only in the event loop. */
#ifndef SESSION_VIEW_SESSION_VIEW_H
#define SESSION_VIEW_SESSION_VIEW_H
#include "session/session_state.h"

/* Returns the view that the session shows: its own or its leader's. */
const struct view *session_view(const struct session *session);
/* Returns the view to draw: session_view(), without the leader's trial sensor positions. */
struct view session_shown(const struct session *session);
/* Returns the readings that the session's view shows: those of the present, or those of the past instant to which the user
   went. */
const struct snapshot *session_snapshot(const struct session *session);
/* Applies the parameters of a message to a view. If a parameter is wrong, returns false with *error and leaves the view unchanged. */
bool session_apply_params(const struct session *session, const struct message *message, struct view *view, struct message_error *error);

#endif
