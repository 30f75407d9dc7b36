/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast audit`: verifies that a daemon's audit trail is complete and unaltered, by its hash chain. */
#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "audit/audit_file.h"
#include "audit/audit_head.h"
#include "base/mem.h"
#include "clients/cli/commands.h"

static void print_usage(FILE *out)
{
    fputs("usage: plantcast audit verify FILE [--known LINE:HASH]\n"
          "\n"
          "Checks that nobody altered the audit trail written by plantcastd --audit FILE, including its older files.\n"
          "Each line contains a hash of itself and of the previous line, so that changed, removed and added lines\n"
          "are detected.\n"
          "FILE.head contains the hash of the last line, so that lines removed from the end are detected.\n"
          "If an intruder rewrote both FILE and FILE.head, only a hash that is kept elsewhere reveals the change:\n"
          "\n"
          "  --known LINE:HASH   line number and hash of an audit line, as recorded by the journal or the syslog\n"
          "                      server; proves that the audit trail is unchanged up to that line\n",
          out);
}

static int verify(const char *path, const struct audit_chain *known)
{
    struct audit_report report;
    audit_file_verify(path, known, &report);
    if (report.good)
        printf("%s: unaltered: lines %" PRIu64 " to %" PRIu64 " in %zu file%s%s\n"
               "last line and its hash: %" PRIu64 ":%s\n",
               path, report.first_seq, report.end.seq, report.files, report.files == 1 ? "" : "s",
               report.first_seq > 1 ? "; earlier audit lines are not in these files" : "", report.end.seq, report.end.hash);
    else
        fprintf(stderr, "plantcast: %s\n", report.text);
    mem_free(report.text);
    return report.good ? 0 : 1;
}

int cmd_audit(int argc, char **argv)
{
    static const struct option options[] = { { "known", required_argument, NULL, 'k' }, { "help", no_argument, NULL, 'h' }, { 0 } };
    struct audit_chain known;
    audit_chain_init(&known);
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
        if (option == 'h') {
            print_usage(stdout);
            return 0;
        }
        if (option != 'k' || !audit_head_parse(optarg, &known)) {
            if (option == 'k')
                fprintf(stderr, "plantcast: --known: expected LINE:HASH, found '%s'\n", optarg);
            print_usage(stderr);
            return 2;
        }
    }
    if (argc - optind == 2 && !strcmp(argv[optind], "verify"))
        return verify(argv[optind + 1], &known);
    print_usage(stderr);
    return 2;
}
