/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The roles of clients, and the messages that each may send. PROTOCOL.md has the same table for authors of clients. Pure; any thread. */
#ifndef MESSAGE_ROLE_H
#define MESSAGE_ROLE_H
#include "message/message.h"
#include "message/names.h"

enum role {
    ROLE_NOBODY,   /* role of a client that has not proved its identity yet */
    ROLE_RENDERER, /* a renderer daemon: may only open /core and request history */
    ROLE_STANDBY,  /* a standby core: has the rights of a renderer */
    ROLE_OPEN,     /* any client without a token, if the daemon runs with --open-viewers */
    ROLE_VIEWER,
    ROLE_OPERATOR,
    ROLE_ENGINEER, /* role of engineers, and of every user on the daemon's own machine */
};

/* Returns true if tokens of a role are for daemons, not for people. */
static inline bool role_is_node(enum role role)
{
    return role == ROLE_RENDERER || role == ROLE_STANDBY;
}

extern const struct name names_role[]; /* names of the roles; terminated by an entry whose text is NULL */

/* Returns true if that role may send the message; if not, *error says why. */
bool role_may_send(enum role role, const struct message *message, struct message_error *error);

/* Returns true if that role may use an argument NAME=VALUE in the HTTP query for a picture; if not, *error says why. */
bool role_may_ask(enum role role, const char *arg, struct message_error *error);

/* Returns true if that role may save a view with this address; if not, *error says why. All users see saved views with an
   engineer's rights, so only engineers may save an address with parameters for engineers. */
bool role_may_save(enum role role, const char *address, struct message_error *error);

/* Returns the plant in which names in a message from that role are looked up. For roles below viewer it is *copy, the same
   plant without tags, so that refusals do not reveal which tags exist. *copy shares everything else with `plant`. */
const struct plant *role_plant(enum role role, const struct plant *plant, struct plant *copy);

/* Returns true if a renderer must forward messages of that type to its core, because only the core can change the state in
   question. */
bool message_is_handed_on(const struct message *message);

#endif
