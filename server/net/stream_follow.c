/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps track of which session follows which. Following is one level deep: a session that asks to follow a follower follows the
   follower's leader instead. */
#include "base/clock.h"
#include "base/mem.h"
#include "net/stream.h"

static const int64_t MIN_LIST_INTERVAL_NS =
    500 * NS_PER_MS; /* minimum time between two lists of followers, because hundreds of followers may connect at once */

/* After a session was resumed over a new connection: makes its former followers follow the new session. */
static void take_back(struct server_context *server, struct session *session)
{
    for (struct stream *stream = server->streams.first; stream; stream = stream->next) {
        struct session *other = stream->session;
        bool was = other->following.leader && other->following.leader != session &&
                   other->following.leader->identity.number == session->identity.number;
        if (other != session && (was || other->following.left == session->identity.number))
            session_follow(other, session, clock_mono_ns());
    }
}

/* Makes the followers of one session follow another session. If `to` is NULL, they follow nobody. */
static void hand_over(struct server_context *server, const struct session *from, struct session *to)
{
    for (struct stream *stream = server->streams.first; stream; stream = stream->next)
        if (stream->session->following.leader == from)
            session_follow(stream->session, to, clock_mono_ns());
}

/* Hands the lead to one of the followers (the heir). All sessions keep showing the same view, but from now on the heir's user moves it. */
static void resolve_lead(struct server_context *server, struct session *session, uint64_t number)
{
    const struct stream *other = stream_called(server, number);
    struct session *heir = other ? other->session : NULL;
    if (!heir || heir->following.leader != session) {
        session_lead_nobody(session);
        return;
    }
    session_inherit(heir, session);
    session_follow(heir, NULL, clock_mono_ns());
    hand_over(server, session, heir);
    session_follow(session, heir, clock_mono_ns());
}

static void resolve_follow(struct server_context *server, struct session *session, uint64_t number)
{
    const struct stream *other = number ? stream_called(server, number) : NULL;
    struct session *leader = other ? other->session->following.leader ? other->session->following.leader : other->session : NULL;
    if (number && (!leader || leader == session || !leader->hello)) {
        session_follow_nobody(session);
        return;
    }
    if (leader)
        hand_over(server, session, leader);
    session_follow(session, leader, clock_mono_ns());
}

void follow_resolve(struct server_context *server, struct stream *stream)
{
    struct follow_request request = session_take_follow_request(stream->session);
    if (request.returned)
        take_back(server, stream->session);
    if (request.heir)
        resolve_lead(server, stream->session, request.heir);
    if (request.asked)
        resolve_follow(server, stream->session, request.wanted);
}

bool follow_spread(struct server_context *server, const struct stream *leader)
{
    bool any = false;
    for (struct stream *stream = server->streams.first; stream; stream = stream->next) {
        if (stream->session->following.leader != leader->session)
            continue;
        session_on_leader(stream->session, leader->session->demand.input_ns);
        any = true;
    }
    return any;
}

void follow_forget(struct server_context *server, const struct stream *leader)
{
    const struct stream *newer = stream_called(server, leader->session->identity.number);
    /* newer session to which the leading client reconnected while its old connection was not closed yet; NULL: none */
    struct session *again = newer ? newer->session : NULL;
    for (struct stream *stream = server->streams.first; stream; stream = stream->next)
        if (stream->session->following.leader == leader->session && again && again != stream->session)
            session_follow(stream->session, again, clock_mono_ns());
        else if (stream->session->following.leader == leader->session)
            session_leader_gone(stream->session, clock_mono_ns());
}

void follow_tell(struct server_context *server, int64_t now_ns)
{
    for (struct stream *stream = server->streams.first; stream; stream = stream->next) {
        struct session *session = stream->session;
        const struct session **followers = NULL;
        size_t count = 0, capacity = 0;
        if (!session->following.followers_changed || now_ns - session->following.followers_ns < MIN_LIST_INTERVAL_NS)
            continue;
        for (const struct stream *other = server->streams.first; other; other = other->next) {
            if (other->session->following.leader != session)
                continue;
            mem_grow(&followers, &capacity, count + 1, sizeof(*followers));
            followers[count++] = other->session;
        }
        session_say_followers(session, followers, count, now_ns);
        mem_free(followers);
    }
}

void follow_share_steps(struct server_context *server)
{
    void (*const steps[])(struct session *) = { session_clear_steps, session_count_step, session_choose_step };
    for (int i = 0; i < 3; i++)
        for (struct stream *stream = server->streams.first; stream; stream = stream->next)
            steps[i](stream->session);
}
