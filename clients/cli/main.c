/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast`: the command-line client. */
#include <stdio.h>
#include <string.h>

#include "clients/link/daemon.h"
#include "commands.h"

static int cmd_import(int argc, char **argv)
{
    (void)argc;
    run_beside("-import", argv);
    return 1;
}

static int cmd_match(int argc, char **argv)
{
    (void)argc;
    run_beside("-match", argv);
    return 1;
}

static int cmd_init(int argc, char **argv)
{
    (void)argc;
    run_beside("-init", argv);
    return 1;
}

static int cmd_clip(int argc, char **argv)
{
    run_film(argc, argv);
    return 1;
}

static const struct cli_command {
    const char *name, *help;
    int (*run)(int argc, char **argv);
} commands[] = {
    { "snapshot", "one picture, from a plant file or from a daemon, as PNG", cmd_snapshot },
    { "clip", "a film of what was recorded, as MP4", cmd_clip },
    { "import", "a CAD export into a plant's folder: model, names, attributes, plant file", cmd_import },
    { "nodes", "what is in a model: nodes, sizes, properties", cmd_import },
    { "match", "a control system's tag list to the equipment of an imported plant", cmd_match },
    { "probe", "put load on a daemon and print a table of latencies", cmd_probe },
    { "tags", "print the tags of a daemon and their values", cmd_tags },
    { "init", "make what the service plantcastd@NAME reads, with a certificate and first tokens", cmd_init },
    { "ready", "say by the exit status whether a daemon is ready", cmd_ready },
    { "drain", "have a daemon of this machine send its sessions to other nodes", cmd_drain },
    { "reload", "have a daemon of this machine load its plant anew, and say what came of it", cmd_reload },
    { "history", "take series into a plant's history, or print what was recorded", cmd_history },
    { "backup", "history, journal and configuration of a plant, also while its daemon records", cmd_backup },
    { "restore", "what backup made, put in place", cmd_restore },
    { "fleet", "one page and one /metrics over the servers of many plants", cmd_fleet },
    { "token", "make, list and revoke what lets people and programs in", cmd_token },
    { "sensors", "propose places for more sensors; name those that drift; accept assumed places", cmd_sensors },
    { "verify", "say whether a signed picture is what the server drew, and draw it again", cmd_verify },
    { "read", "the value at a pixel of a picture with a legend strip, also of a JPEG or a screenshot", cmd_read },
    { "audit", "say whether an audit trail is whole, or where it was changed", cmd_audit },
};
enum { COMMANDS = sizeof(commands) / sizeof(commands[0]) };

static void print_usage(FILE *out)
{
    fputs("usage: plantcast COMMAND ...      (plantcast COMMAND --help tells more)\n\n", out);
    for (int i = 0; i < COMMANDS; i++)
        fprintf(out, "  %-10s %s\n", commands[i].name, commands[i].help);
    fputs("\nWherever a daemon's URL is given (http:// or https://):\n"
          "  --token-file FILE   its first line is the token that lets us in (see plantcast token)\n"
          "  --ca FILE           certificates (PEM) that are trusted beside this machine's own\n",
          out);
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        print_usage(stderr);
        return 2;
    }
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "help")) {
        print_usage(stdout);
        return 0;
    }
    if (!daemon_take_options(&argc, argv))
        return 2;
    for (int i = 0; i < COMMANDS; i++)
        if (!strcmp(argv[1], commands[i].name))
            return commands[i].run(argc - 1, argv + 1);
    fprintf(stderr, "plantcast: '%s' is not a command\n", argv[1]);
    print_usage(stderr);
    return 2;
}
