/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creates sessions, and frees them and what they hold. */
#include "session/session_impl.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "render/depth_grid.h"

struct session *session_create(const struct session_context *context, uint64_t id, int64_t now_ns)
{
    struct session *session = mem_new(sizeof(*session));
    *session = (struct session){ .id = id, .context = context, .identity = { .number = id, .role = ROLE_ENGINEER }, .opened_ns = now_ns };
    session->rate.begin_ns = now_ns;
    pacer_init(&session->delivery.pacer);
    session->delivery.common_step = -1;
    session->owed.tag_changes = mem_array(context->plant->tag_count, sizeof(*session->owed.tag_changes));
    return session;
}

void session_keep_token(struct session *session, const char *token)
{
    if (session->context->core.hand_on)
        snprintf(session->identity.token, sizeof(session->identity.token), "%s", token ? token : "");
}

void session_introduce(struct session *session, const struct session_client *client)
{
    session->identity.number = client->number;
    memcpy(session->identity.address, client->address, sizeof(session->identity.address));
    if (client->from)
        snprintf(session->identity.from, sizeof(session->identity.from), "%s", client->from);
    session->identity.role = client->role;
    session->identity.holder = *client->holder;
    session_keep_token(session, client->token);
    session->room.share = client->share;
    session->demand.starting = true;
}

void session_forget_depth(struct session *session)
{
    depth_grid_unref(&session->delivery.depth[0]);
    depth_grid_unref(&session->delivery.depth[1]);
}

void session_let_go(struct session *session)
{
    session_drop_ready(session);
    session_forget_depth(session);
    session_time_end(session);
    session_place_leave(session);
    session_scope_end(session);
}

void session_destroy(struct session **session_ptr)
{
    struct session *session = *session_ptr;
    if (!session)
        return;
    session_let_go(session);
    session_kept_drop(session);
    for (int i = 0; i < session->owed.reply_count; i++)
        mem_free(session->owed.replies[i]);
    mem_free(session->owed.tag_changes);
    mem_free(session->following.followers_text);
    mem_free(session->tile.told);
    mem_free(session);
    *session_ptr = NULL;
}

void session_retire(struct session **session_ptr)
{
    struct session *session = *session_ptr;
    struct kept_answers *answers = session->context->records.kept_answers;
    session_settle(session);
    if (!answers || !session_kept_waits(session)) {
        session_destroy(session_ptr);
        return;
    }
    session_let_go(session);
    session->next_gone = answers->gone;
    answers->gone = session;
    *session_ptr = NULL;
}

void session_settle_gone(struct kept_answers *answers)
{
    for (struct session **at = &answers->gone, *session; (session = *at);) {
        session_settle(session);
        if (session_kept_waits(session)) {
            at = &session->next_gone;
            continue;
        }
        *at = session->next_gone;
        session_destroy(&session);
    }
}
