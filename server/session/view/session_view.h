/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a session is shown: its own view or its leader's, of now or of an instant. Thread: the loop. */
#ifndef SESSION_VIEW_SESSION_VIEW_H
#define SESSION_VIEW_SESSION_VIEW_H
#include "session/session_state.h"

/* Returns the view that it is shown: its own, or its leader's. */
const struct view *session_view(const struct session *session);
/* Returns the view to draw: session_view, without what a leader has moved on trial. */
struct view session_shown(const struct session *session);
/* Returns the readings that it is shown: of now, or of an instant. */
const struct snapshot *session_snapshot(const struct session *session);

#endif
