/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines of the audit trail. Each is a JSON object with a sequence number, the hash of the previous line, and its own hash: the
   SHA-256 of the line's text before that hash. No input or output. Use each chain in one thread only. */
#ifndef AUDIT_AUDIT_CHAIN_H
#define AUDIT_AUDIT_CHAIN_H
#include <stdbool.h>
#include <stdint.h>

#include "base/text/text.h"

enum { AUDIT_HASH_CHARS = 64, AUDIT_LINE_BYTES = 32768 };

struct audit_chain {                 /* the last line of an audit trail, which the next line refers to */
    uint64_t seq;                    /* sequence number of the trail's last line; 0: the trail is empty */
    char hash[AUDIT_HASH_CHARS + 1]; /* hash of the trail's last line; 64 zeros: the trail is empty */
};

/* One event of the audit trail. Texts may be NULL (unknown) and are truncated if too long. */
struct audit_entry {
    const char *event;  /* kind of event: login, logout, access, alarm and so on; AUDIT.md has the list */
    const char *result; /* result of the action: done, refused or failed */
    const char *who, *role;
    const char *from; /* address of the client */
    const char *how;  /* channel through which the client acted, such as HTTP or OpenID Connect */
    /* name, from its token, of the renderer (a daemon that draws pictures) that forwarded the client's action; NULL: none */
    const char *through;
    const char *what; /* object, such as an alarm or a view, that the client changed or requested */
    const char *why;  /* why the action was refused or failed */
};

/* Initialises the chain for an audit trail without lines. */
void audit_chain_init(struct audit_chain *chain);
/* Appends the audit line for an entry, including the newline, to `out`, and advances the chain to that line. */
void audit_chain_add(struct audit_chain *chain, const struct audit_entry *entry, int64_t utc_us, struct text *out);
/* Checks an audit line (without its newline) against the chain. first: the line is the oldest that still exists, so the hash of
   its predecessor is not checked. Returns true and advances the chain, or false with the reason in *why (static text). */
bool audit_chain_check(struct audit_chain *chain, const char *line, size_t count, bool first, const char **why);

#endif
