/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Remembers which nodes this core refused last, why, and when it logged that. */
#include "net/denials.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"

static const int64_t RECENT_NS = 15 * NS_PER_S, PAUSE_NS = 60 * NS_PER_S;

static bool is_recent(const struct denial *node, int64_t now_ns)
{
    return node->who[0] && now_ns - node->at_ns < RECENT_NS;
}

/* Returns the node's element. A new node takes the element of the node that was refused least recently, and with it that element's
   pause between log lines: however many nodes are refused, at most DENIED_NODES lines a minute are logged. */
static struct denial *find_or_make(struct denials *denials, const char *who)
{
    struct denial *oldest = denials->nodes;
    for (struct denial *node = denials->nodes; node < denials->nodes + DENIED_NODES; node++) {
        if (!strncmp(node->who, who, sizeof(node->who) - 1))
            return node;
        if (!node->who[0] ? oldest->who[0] : node->at_ns < oldest->at_ns)
            oldest = node;
    }
    snprintf(oldest->who, sizeof(oldest->who), "%s", who);
    oldest->why[0] = 0;
    oldest->at_ns = 0;
    return oldest;
}

struct denial *denials_note(struct denials *denials, const char *who, const char *why, bool unchecked, int64_t now_ns)
{
    struct denial *node = find_or_make(denials, who);
    if (!unchecked || !node->why[0] || !is_recent(node, now_ns))
        snprintf(node->why, sizeof(node->why), "%.*s", (int)strcspn(why, "\r\n"), why);
    node->at_ns = now_ns;
    denials->last = node;
    return node;
}

bool denials_log(struct denial *node, int64_t now_ns, char more[LOG_PACE_BYTES])
{
    node->pace.first_ns = node->pace.longest_ns = PAUSE_NS;
    return log_pace_take(&node->pace, now_ns, more);
}

const struct denial *denials_recent(const struct denials *denials, int64_t now_ns)
{
    return denials->last && is_recent(denials->last, now_ns) ? denials->last : NULL;
}

void denials_forget(struct denials *denials)
{
    denials->last = NULL;
}
