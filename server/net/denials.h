/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The nodes whose connections to /core this core refused last, with the reasons. Pure; the caller passes now_ns. Call from one
   thread only. */
#ifndef NET_DENIALS_H
#define NET_DENIALS_H
#include <stdbool.h>
#include <stdint.h>

#include "base/log/log_pace.h"

enum { DENIED_NODES = 8 };

struct denials { /* set all members to zero */
    struct denial {
        char who[64];         /* name or address of the refused node; "": this element of the array is not used */
        char why[300];        /* first line of the reason */
        int64_t at_ns;        /* monotonic time of the node's last refusal */
        struct log_pace pace; /* rate limit of log lines about this node */
    } nodes[DENIED_NODES];
    const struct denial *last; /* the last refused node that may be the standby; NULL: none since a standby was accepted */
};

/* Notes a refusal. unchecked: true: the node's token was not checked, because its address sent too many wrong ones; an earlier reason
   for the same node, if it is recent, is then kept. Returns the node. */
struct denial *denials_note(struct denials *denials, const char *who, const char *why, bool unchecked, int64_t now_ns);
/* Returns whether a log line about the node is due, at most one a minute; `more` then receives the text to append. */
bool denials_log(struct denial *node, int64_t now_ns, char more[LOG_PACE_BYTES]);
/* Returns the node refused last, if that was in the last 15 s, in which a standby would have tried again; otherwise NULL. */
const struct denial *denials_recent(const struct denials *denials, int64_t now_ns);
/* Call this when a standby is accepted: earlier refusals are then history. */
void denials_forget(struct denials *denials);

#endif
