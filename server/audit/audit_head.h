/* SPDX-License-Identifier: GPL-3.0-or-later */
/* PATH.head: number and hash of the audit trail's last line, of a fixed length and overwritten in place, so that a full disk takes it,
   too. Thread: one. */
#ifndef AUDIT_AUDIT_HEAD_H
#define AUDIT_AUDIT_HEAD_H
#include "audit/audit_chain.h"

/* Parses `NUMBER HASH`, or `NUMBER:HASH`. Returns false if it is not that. */
bool audit_head_parse(const char *text, struct audit_chain *head);
/* Returns false if there is none, or it cannot be understood. */
bool audit_head_read(const char *path, struct audit_chain *head);
/* Returns whether it was written. */
bool audit_head_write(const char *path, const struct audit_chain *head);

#endif
