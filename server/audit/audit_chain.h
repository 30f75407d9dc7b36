/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The audit trail's lines: each is a JSON object with a number, the hash of the line before, and its own hash, a SHA-256 of all that stands
   before it. Pure. Thread: one per chain. */
#ifndef AUDIT_AUDIT_CHAIN_H
#define AUDIT_AUDIT_CHAIN_H
#include <stdbool.h>
#include <stdint.h>

#include "base/text/text.h"

enum { AUDIT_HASH_CHARS = 64, AUDIT_LINE_BYTES = 32768 };

struct audit_chain {                 /* where a trail ends */
    uint64_t seq;                    /* of its last line; 0: it has none */
    char hash[AUDIT_HASH_CHARS + 1]; /* of that line; 64 zeros: it has none */
};

/* What happened. Texts may be NULL (not known) and are cut where they are too long. */
struct audit_entry {
    const char *event;  /* login, logout, access, alarm, ...: AUDIT.md has the list */
    const char *result; /* done, refused, failed */
    const char *who, *role;
    const char *from; /* the client's address */
    const char *how;  /* by which way or means */
    const char *through; /* renderer that forwarded the action, and its token; NULL: none */
    const char *what; /* what was changed, or asked for */
    const char *why;  /* of a refusal */
};

/* Begins a trail. */
void audit_chain_init(struct audit_chain *chain);
/* Appends the next line of the trail, with its newline, and moves the chain's end there. */
void audit_chain_add(struct audit_chain *chain, const struct audit_entry *entry, int64_t utc_us, struct text *out);
/* Checks a line (without its newline). first: it is the first of what is kept of its trail, and any predecessor will do. Returns true and
   moves the chain's end there; false with *why (static) saying what is wrong. */
bool audit_chain_check(struct audit_chain *chain, const char *line, size_t count, bool first, const char **why);

#endif
