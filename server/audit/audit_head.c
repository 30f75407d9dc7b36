/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes PATH.head, the file that names the last line of the audit trail. */
#include "audit/audit_head.h"

#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"

bool audit_head_parse(const char *text, struct audit_chain *head)
{
    char *end;
    head->seq = strtoull(text, &end, 10);
    if (end == text || (*end != ' ' && *end != ':') || head->seq == 0 || strspn(end + 1, "0123456789abcdef") != AUDIT_HASH_CHARS)
        return false;
    memcpy(head->hash, end + 1, AUDIT_HASH_CHARS);
    head->hash[AUDIT_HASH_CHARS] = 0;
    return end[1 + AUDIT_HASH_CHARS] == 0 || end[1 + AUDIT_HASH_CHARS] == '\n';
}

bool audit_head_read(const char *path, struct audit_chain *head)
{
    size_t count;
    char *text = text_read_file(path, 256, &count);
    bool good = text && audit_head_parse(text, head);
    mem_free(text);
    return good;
}

bool audit_head_write(const char *path, const struct audit_chain *head)
{
    char text[32 + AUDIT_HASH_CHARS];
    int count = snprintf(text, sizeof(text), "%020" PRIu64 " %s\n", head->seq, head->hash);
    int fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0640);
    bool good = fd >= 0 && pwrite(fd, text, (size_t)count, 0) == count;
    if (fd >= 0)
        close(fd);
    return good;
}
