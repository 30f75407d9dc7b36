/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who follows whom. A leader follows nobody: who follows a follower follows its leader. */
#include <string.h>

#include "base/clock.h"
#include "net/stream.h"

/* The followers of one become those of another (NULL: of nobody). */
static void hand_over(struct hub *hub, const struct session *from, struct session *to)
{
    for (struct stream *stream = hub->streams; stream; stream = stream->next)
        if (stream->session->leader == from)
            session_follow(stream->session, to, clock_mono_ns());
}

void follow_resolve(struct hub *hub, struct stream *stream)
{
    struct session *session = stream->session;
    if (!session->follow_asked)
        return;
    session->follow_asked = false;
    struct stream *other = session->follow ? stream_find(hub, session->follow) : NULL;
    struct session *leader = other ? other->session->leader ? other->session->leader : other->session : NULL;
    if (session->follow && (!leader || leader == session || !leader->hello)) {
        session_follow_nobody(session);
        return;
    }
    if (leader)
        hand_over(hub, session, leader);
    session_follow(session, leader, clock_mono_ns());
}

bool follow_spread(struct hub *hub, const struct stream *leader)
{
    bool any = false;
    for (struct stream *stream = hub->streams; stream; stream = stream->next) {
        if (stream->session->leader != leader->session)
            continue;
        session_on_leader(stream->session, leader->session->input_ns);
        any = true;
    }
    return any;
}

void follow_forget(struct hub *hub, const struct stream *leader)
{
    hand_over(hub, leader->session, NULL);
}

/* Whose view it sees. */
static struct session *seen(struct session *session)
{
    return session->leader ? session->leader : session;
}

void follow_share_steps(struct hub *hub)
{
    struct stream *stream;
    for (stream = hub->streams; stream; stream = stream->next)
        memset(stream->session->steps, 0, sizeof(stream->session->steps));
    for (stream = hub->streams; stream; stream = stream->next)
        if (stream->session->pacer.ladder.known)
            seen(stream->session)->steps[stream->session->pacer.ladder.step]++;
    for (stream = hub->streams; stream; stream = stream->next)
        stream->session->common_step = ladder_common(&seen(stream->session)->pacer.ladder, seen(stream->session)->steps);
}
