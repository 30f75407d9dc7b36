/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who follows whom. A leader follows nobody: who follows a follower follows its leader. */
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "net/stream.h"

static const int64_t TELL_NS = 500 * NS_PER_MS; /* between two lists of followers: hundreds may come at once */

/* Who followed the session that this one has resumed follows it. */
static void take_back(struct server_context *hub, struct session *session)
{
    for (struct stream *stream = hub->streams; stream; stream = stream->next) {
        struct session *other = stream->session;
        bool was = other->leader && other->leader != session && other->leader->called == session->called;
        if (other != session && (was || other->left == session->called))
            session_follow(other, session, clock_mono_ns());
    }
}

/* The followers of one become those of another (NULL: of nobody). */
static void hand_over(struct server_context *hub, const struct session *from, struct session *to)
{
    for (struct stream *stream = hub->streams; stream; stream = stream->next)
        if (stream->session->leader == from)
            session_follow(stream->session, to, clock_mono_ns());
}

/* What all of them see does not change, but who moves it does. */
static void resolve_lead(struct server_context *hub, struct session *session)
{
    const struct stream *other = stream_called(hub, session->lead);
    struct session *heir = other ? other->session : NULL;
    if (!heir || heir->leader != session) {
        session_lead_nobody(session);
        return;
    }
    session_inherit(heir, session);
    session_follow(heir, NULL, clock_mono_ns());
    hand_over(hub, session, heir);
    session_follow(session, heir, clock_mono_ns());
}

void follow_resolve(struct server_context *hub, struct stream *stream)
{
    struct session *session = stream->session;
    if (session->returned)
        take_back(hub, session);
    session->returned = false;
    if (session->lead)
        resolve_lead(hub, session);
    session->lead = 0;
    if (!session->follow_asked)
        return;
    session->follow_asked = false;
    struct stream *other = session->follow ? stream_called(hub, session->follow) : NULL;
    struct session *leader = other ? other->session->leader ? other->session->leader : other->session : NULL;
    if (session->follow && (!leader || leader == session || !leader->hello)) {
        session_follow_nobody(session);
        return;
    }
    if (leader)
        hand_over(hub, session, leader);
    session_follow(session, leader, clock_mono_ns());
}

bool follow_spread(struct server_context *hub, const struct stream *leader)
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

void follow_forget(struct server_context *hub, const struct stream *leader)
{
    const struct stream *newer = stream_called(hub, leader->session->called);
    struct session *again = newer ? newer->session : NULL; /* has resumed it while it was still there */
    for (struct stream *stream = hub->streams; stream; stream = stream->next)
        if (stream->session->leader == leader->session && again && again != stream->session)
            session_follow(stream->session, again, clock_mono_ns());
        else if (stream->session->leader == leader->session)
            session_leader_gone(stream->session, clock_mono_ns());
    if (leader->session->leader)
        leader->session->leader->followers_changed = true;
}

void follow_tell(struct server_context *hub, int64_t now_ns)
{
    for (struct stream *stream = hub->streams; stream; stream = stream->next) {
        struct session *session = stream->session;
        uint64_t *followers = NULL;
        size_t count = 0, capacity = 0;
        if (!session->followers_changed || now_ns - session->followers_ns < TELL_NS)
            continue;
        for (const struct stream *other = hub->streams; other; other = other->next) {
            if (other->session->leader != session)
                continue;
            mem_grow(&followers, &capacity, count + 1, sizeof(*followers));
            followers[count++] = other->session->called;
        }
        session_say_followers(session, followers, count, now_ns);
        mem_free(followers);
    }
}

/* Whose view it sees. */
static struct session *seen(struct session *session)
{
    return session->leader ? session->leader : session;
}

void follow_share_steps(struct server_context *hub)
{
    struct stream *stream;
    for (stream = hub->streams; stream; stream = stream->next)
        memset(stream->session->steps, 0, sizeof(stream->session->steps));
    for (stream = hub->streams; stream; stream = stream->next)
        if (stream->session->pacer.ladder.known)
            seen(stream->session)->steps[stream->session->pacer.ladder.step]++;
    for (stream = hub->streams; stream; stream = stream->next)
        stream->session->common_step = quality_ladder_common(&seen(stream->session)->pacer.ladder, seen(stream->session)->steps);
}
