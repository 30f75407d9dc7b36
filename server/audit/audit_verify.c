/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Verifies an audit trail: the order and hash of every line, and that the trail ends with the line that PATH.head names. */
#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "audit/audit_file.h"
#include "audit/audit_head.h"
#include "base/mem.h"

struct audit_walk {
    struct audit_report *report;
    const struct audit_chain *known;
    struct audit_chain head; /* sequence number and hash in PATH.head, which names the last line; seq 0: the file does not exist */
};

static void set_fault(struct audit_report *report, char *text)
{
    if (report->text)
        mem_free(text);
    else
        report->text = text;
    report->good = false;
}

/* Reports a fault if the audit line read last has the sequence number of `with` but a different hash. whose: source of `with`
   (such as PATH.head), for the message. */
static void compare(struct audit_walk *walk, const struct audit_chain *with, const char *path, const char *whose)
{
    const struct audit_chain *end = &walk->report->end;
    if (with->seq == end->seq && strcmp(with->hash, end->hash) != 0)
        set_fault(walk->report, mem_printf("%s: line %" PRIu64 " differs from the line recorded in %s", path, end->seq, whose));
}

static void verify_file(struct audit_walk *walk, const char *path)
{
    struct audit_report *report = walk->report;
    FILE *file = fopen(path, "re");
    char *line = NULL;
    size_t capacity = 0, number = 0;
    if (!file) {
        set_fault(report, mem_printf("%s: %s", path, strerror(errno)));
        return;
    }
    report->files++;
    for (ssize_t n; report->good && (n = getline(&line, &capacity, file)) > 0;) {
        const char *why = "the line of the audit trail is truncated";
        number++;
        if (line[n - 1] != '\n' || !audit_chain_check(&report->end, line, (size_t)n - 1, report->lines == 0, &why)) {
            set_fault(report, mem_printf("%s:%zu: %s", path, number, why));
            break;
        }
        if (report->lines++ == 0)
            report->first_seq = report->end.seq;
        compare(walk, &walk->head, path, "the file .head");
        compare(walk, walk->known, path, "--known");
    }
    free(line);
    fclose(file);
}

static int is_number(const char *text)
{
    return *text && text[strspn(text, "0123456789")] == 0;
}

static int by_number(const void *a, const void *b)
{
    uint64_t x = strtoull(strrchr(*(char *const *)a, '.') + 1, NULL, 10), y = strtoull(strrchr(*(char *const *)b, '.') + 1, NULL, 10);
    return (x > y) - (x < y);
}

static void verify_full(struct audit_walk *walk, const char *path)
{
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
    char *folder = slash ? mem_printf("%.*s", slash > path ? (int)(slash - path) : 1, path) : mem_strdup("."), **names = NULL;
    size_t count = 0, capacity = 0, length = strlen(base);
    DIR *entries = opendir(folder);
    for (struct dirent *entry; entries && (entry = readdir(entries));)
        if (!strncmp(entry->d_name, base, length) && entry->d_name[length] == '.' && is_number(entry->d_name + length + 1)) {
            mem_grow(&names, &capacity, count + 1, sizeof(*names));
            names[count++] = mem_printf("%s/%s", folder, entry->d_name);
        }
    if (entries)
        closedir(entries);
    if (count)
        qsort(names, count, sizeof(*names), by_number);
    for (size_t i = 0; i < count; i++) {
        if (walk->report->good)
            verify_file(walk, names[i]);
        mem_free(names[i]);
    }
    mem_free(names);
    mem_free(folder);
}

void audit_file_verify(const char *path, const struct audit_chain *known, struct audit_report *report)
{
    struct audit_walk walk = { .report = report, .known = known };
    char *head_path = mem_printf("%s.head", path);
    *report = (struct audit_report){ .good = true };
    audit_chain_init(&report->end);
    audit_chain_init(&walk.head);
    bool has_head = audit_head_read(head_path, &walk.head);
    verify_full(&walk, path);
    if (report->good)
        verify_file(&walk, path);
    if (report->good && report->lines == 0 && walk.head.seq == 0)
        set_fault(report, mem_printf("%s: the file has no lines, although a daemon writes a line at each start: the audit trail was "
                                     "emptied, or this is not an audit trail",
                                     path));
    if (report->good && !has_head)
        set_fault(report,
                  mem_printf("%s: the file is missing: without it, the removal of lines from the end cannot be detected", head_path));
    if (report->good && walk.head.seq > report->end.seq)
        set_fault(report, mem_printf("%s: the audit trail ends at line %" PRIu64 "; the last %" PRIu64 " lines were removed (%s)", path,
                                     report->end.seq, walk.head.seq - report->end.seq, head_path));
    if (report->good && known->seq > report->end.seq)
        set_fault(report, mem_printf("%s: the audit trail ends at line %" PRIu64 ", before line %" PRIu64 " of --known", path,
                                     report->end.seq, known->seq));
    if (report->good && known->seq && known->seq < report->first_seq)
        set_fault(report, mem_printf("%s: the audit trail begins at line %" PRIu64 ", after line %" PRIu64 " of --known", path,
                                     report->first_seq, known->seq));
    mem_free(head_path);
}
