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
    { "snapshot", "draw one picture as PNG, from a plant file or by a daemon", cmd_snapshot },
    { "clip", "make a film of recorded history as MP4", cmd_clip },
    { "import", "convert CAD exports into a plant's folder: models, names, attributes, plant file", cmd_import },
    { "nodes", "list the nodes of a model, with sizes and properties", cmd_import },
    { "match", "match a control system's tag list to the equipment of an imported plant", cmd_match },
    { "probe", "put load on a daemon and print its latencies", cmd_probe },
    { "tags", "print the tags of a daemon with their values", cmd_tags },
    { "init", "create an instance of the service plantcastd@NAME, with a certificate and first tokens", cmd_init },
    { "ready", "check whether a daemon is ready (exit status)", cmd_ready },
    { "drain", "move the sessions of a daemon on this machine to other nodes", cmd_drain },
    { "reload", "reload the plant of a daemon on this machine, and print the result", cmd_reload },
    { "history", "import or export a plant's history", cmd_history },
    { "backup", "back up history, journal and configuration of a plant, while its daemon runs or not", cmd_backup },
    { "restore", "restore a backup", cmd_restore },
    { "fleet", "serve one page and one /metrics for the servers of many plants", cmd_fleet },
    { "token", "create, list and revoke tokens of users and programs", cmd_token },
    { "sensors", "suggest places for more sensors, detect drift, accept assumed places", cmd_sensors },
    { "verify", "verify a signed picture or film, and draw it again", cmd_verify },
    { "read", "read the value at a pixel of a picture with a legend strip (PNG, JPEG, screenshot)", cmd_read },
    { "audit", "verify an audit trail", cmd_audit },
};
enum { COMMANDS = sizeof(commands) / sizeof(commands[0]) };

static void print_usage(FILE *out)
{
    fputs("usage: plantcast COMMAND [ARGUMENT ...]\n       plantcast COMMAND --help\n\n", out);
    for (int i = 0; i < COMMANDS; i++)
        fprintf(out, "  %-10s %s\n", commands[i].name, commands[i].help);
    fputs("\nOptions of every command that connects to a daemon (http:// or https://):\n"
          "  --token-file FILE   file whose first line is the token (see `plantcast token`)\n"
          "  --ca FILE           trusted certificates (PEM), in addition to the system's\n",
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
