/* SPDX-License-Identifier: GPL-3.0-or-later */
/* PATH.head: sequence number and hash of the audit trail's last line. It has a fixed length and is overwritten in place, so
   that writing it works even on a full disk. Call from one thread only. */
#ifndef AUDIT_AUDIT_HEAD_H
#define AUDIT_AUDIT_HEAD_H
#include "audit/audit_chain.h"

/* Parses a line's sequence number and hash, `NUMBER HASH` or `NUMBER:HASH`. Returns false if the text has neither form. */
bool audit_head_parse(const char *text, struct audit_chain *head);
/* Reads sequence number and hash of the audit trail's last line from PATH.head. Returns false if the file does not exist or
   cannot be parsed. */
bool audit_head_read(const char *path, struct audit_chain *head);
/* Writes sequence number and hash of the audit trail's last line to PATH.head. Returns false if the file cannot be written. */
bool audit_head_write(const char *path, const struct audit_chain *head);

#endif
