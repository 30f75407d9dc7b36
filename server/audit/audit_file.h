/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The audit trail's file. New lines go to PATH; full files stay next to it as PATH.NUMBER, where NUMBER is the sequence number
   of their last line. PATH.head names the line written last, so that removing lines at the end is detected. Functions that
   return int return 0 or -errno. Call from one thread only. */
#ifndef AUDIT_AUDIT_FILE_H
#define AUDIT_AUDIT_FILE_H
#include <stddef.h>

#include "audit/audit_chain.h"

struct audit_file {
    char *path, *head_path;
    int fd;                   /* descriptor of the open file PATH; -1: not open */
    size_t bytes;             /* size of the file PATH in bytes */
    size_t most_bytes;        /* size in bytes at which the file PATH is full: it is then renamed to PATH.NUMBER, and a new one begun */
    struct audit_chain chain; /* sequence number and hash of the trail's last line */
};

/* Opens the audit file, or creates it. *finding receives NULL, or a description of what is wrong with the existing trail, which
   is extended anyway; the caller frees the description with mem_free. */
int audit_file_open(struct audit_file *file, const char *path, size_t most_bytes, char **finding);
void audit_file_close(struct audit_file *file); /* closes the file; accepts a zeroed struct that was never opened */
/* Appends an entry. On success the whole entry is on disk; on failure nothing is, and the chain is unchanged. The entry's
   line is also appended to `line`. *finding receives NULL, or a description of changes that another program made to the file.
   */
int audit_file_append(struct audit_file *file, const struct audit_entry *entry, int64_t utc_us, struct text *line, char **finding);

struct audit_report {
    size_t files, lines;
    uint64_t first_seq;
    struct audit_chain end;
    bool good;
    char *text; /* description of the first fault of the audit trail, with file and line; NULL: no fault. Free with mem_free */
};
/* Verifies the audit trail: the full files PATH.NUMBER, PATH, and PATH.head. known: sequence number and hash of a line that was
   noted elsewhere (seq 0: none). It is a fault if the trail ends before that line or has a different line with that number. */
void audit_file_verify(const char *path, const struct audit_chain *known, struct audit_report *report);

#endif
