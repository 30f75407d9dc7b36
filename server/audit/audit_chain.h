/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines of the audit trail: each is a JSON object with a sequence number, the hash of the previous line, and its own hash, the SHA-256 of
   the line's text before it. Pure. Thread: one per chain. */
#ifndef AUDIT_AUDIT_CHAIN_H
#define AUDIT_AUDIT_CHAIN_H
#include <stdbool.h>
#include <stdint.h>

#include "base/text/text.h"

enum { AUDIT_HASH_CHARS = 64, AUDIT_LINE_BYTES = 32768 };

struct audit_chain {                 /* the end of a trail */
    uint64_t seq;                    /* sequence number of the trail's last line; 0: the trail is empty */
    char hash[AUDIT_HASH_CHARS + 1]; /* hash of the trail's last line; 64 zeros: the trail is empty */
};

/* One event. Texts may be NULL (not known) and are shortened if too long. */
struct audit_entry {
    const char *event;  /* login, logout, access, alarm and so on: AUDIT.md has the list */
    const char *result; /* done, refused or failed */
    const char *who, *role;
    const char *from;    /* the client's address */
    const char *how;     /* means of the action, such as HTTP or OpenID Connect */
    const char *through; /* name of the renderer (a daemon that draws for clients) that forwarded the action, as its token names it;
                            NULL: none */
    const char *what;    /* what was changed or requested */
    const char *why;     /* reason of a refusal */
};

/* Initialises the chain of an empty trail. */
void audit_chain_init(struct audit_chain *chain);
/* Appends the next line of the trail for an entry to `out`, with its newline, and advances the chain. */
void audit_chain_add(struct audit_chain *chain, const struct audit_entry *entry, int64_t utc_us, struct text *out);
/* Checks a line (without its newline) against the chain. first: the line is the oldest one kept, so the hash of its predecessor is not
   checked. Returns true and advances the chain; or false with the reason in *why (static text). */
bool audit_chain_check(struct audit_chain *chain, const char *line, size_t count, bool first, const char **why);

#endif
