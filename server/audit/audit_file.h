/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The audit trail's file. PATH is written; full ones are kept beside it as PATH.NUMBER, after the number of their last line. PATH.head
   says where the trail ends, so that removed last lines are noticed. Functions that return int return 0 or -errno. Thread: one. */
#ifndef AUDIT_AUDIT_FILE_H
#define AUDIT_AUDIT_FILE_H
#include <stddef.h>

#include "audit/audit_chain.h"

struct audit_file {
    char *path, *head_path;
    int fd;                   /* -1: not open */
    size_t bytes;             /* written so far */
    size_t most_bytes;        /* beyond that it is rotated */
    struct audit_chain chain; /* where the trail ends */
};

/* Opens the file, or makes it. *finding: NULL, or what is wrong with the trail that is there, which is continued anyway (mem_free). */
int audit_file_open(struct audit_file *file, const char *path, size_t most_bytes, char **finding);
void audit_file_close(struct audit_file *file); /* one that was never opened, zeroed, is fine */
/* Appends an entry; all of it is on the disk, or none of it and the chain is as it was. line: its text, appended to. *finding: as above:
   somebody changed the file meanwhile. */
int audit_file_append(struct audit_file *file, const struct audit_entry *entry, int64_t utc_us, struct text *line, char **finding);

struct audit_report {
    size_t files, lines;
    uint64_t first_seq;
    struct audit_chain end;
    bool good;
    char *text; /* what is wrong, and where; NULL: nothing. mem_free */
};
/* Verifies the trail: full files, PATH, and PATH.head. known: a line's number and hash that are kept elsewhere (seq 0: none); where the
   trail ends before it, or has another there, that is found. */
void audit_file_verify(const char *path, const struct audit_chain *known, struct audit_report *report);

#endif
