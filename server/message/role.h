/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The roles of clients, and which messages each may send. PROTOCOL.md holds the table for readers. Pure; any thread. */
#ifndef MESSAGE_ROLE_H
#define MESSAGE_ROLE_H
#include "message/message.h"
#include "message/names.h"

enum role {
    ROLE_NOBODY, /* has yet to say who it is */
    ROLE_RENDERER, /* no person: another daemon, which may open /core and ask for history, and nothing else */
    ROLE_STANDBY,  /* the same for the core that takes over from this one */
    ROLE_OPEN,   /* anyone, under --open-viewers */
    ROLE_VIEWER,
    ROLE_OPERATOR,
    ROLE_ENGINEER, /* also whoever is on the daemon's own machine */
};

/* Returns whether tokens of that role are for daemons, not for people. */
static inline bool role_is_node(enum role role)
{
    return role == ROLE_RENDERER || role == ROLE_STANDBY;
}

extern const struct name names_role[]; /* ends with a NULL text */

/* Returns whether a client of that role may send the message. If not, fills *error with the refusal to answer. */
bool role_may_send(enum role role, const struct message *message, struct message_error *error);

/* Returns the plant for looking up names in a message of that role. Below viewer it is *copy, the same plant without tags, so that
   refusals do not tell which tags exist. *copy shares everything else with `plant`. */
const struct plant *role_plant(enum role role, const struct plant *plant, struct plant *copy);

/* Returns whether a renderer hands on messages of that type to its core: those that change what all share. */
bool message_is_handed_on(const struct message *message);

#endif
