/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast`: the command-line client. */
#include <stdio.h>
#include <string.h>

#include "base/system/standard_output.h"
#include "clients/link/daemon.h"
#include "commands.h"

static int cmd_import(int argc, char **argv)
{
    (void)argc;
    run_beside("-import", "plantcast-import", argv);
    return 1;
}

static int cmd_match(int argc, char **argv)
{
    (void)argc;
    run_beside("-match", "plantcast-tools", argv);
    return 1;
}

static int cmd_init(int argc, char **argv)
{
    (void)argc;
    run_beside("-init", "plantcast-server", argv);
    return 1;
}

static int cmd_clip(const struct daemon_access *access, int argc, char **argv)
{
    run_film(access, argc, argv);
    return 1;
}

static const struct cli_command {
    const char *name, *help;
    int (*run)(int argc, char **argv); /* function of a command that needs no daemon; NULL: the command connects to a daemon */
    int (*connect)(const struct daemon_access *access, int argc, char **argv);
} commands[] = {
    { "snapshot", "draw one picture of a plant as PNG, from a plant file or through a running daemon", NULL, cmd_snapshot },
    { "clip", "render recorded readings as a video clip (MP4)", NULL, cmd_clip },
    { "import", "convert CAD exports into a plant's folder: models, names, attributes and plant file", cmd_import, NULL },
    { "nodes", "list the nodes (parts) of a CAD model with their sizes and properties", cmd_import, NULL },
    { "match", "match a control system's tag list to the equipment of an imported plant", cmd_match, NULL },
    { "probe", "open many sessions on a daemon and print frame rates and latencies", NULL, cmd_probe },
    { "tags", "print the tags that a daemon serves, with their present values", NULL, cmd_tags },
    { "init", "set up the systemd service plantcastd@NAME with a certificate and first tokens", cmd_init, NULL },
    { "ready", "check whether a daemon serves pictures (exit status 0: yes)", NULL, cmd_ready },
    { "drain", "move all user sessions of a daemon on this machine to other daemons", cmd_drain, NULL },
    { "standby", "begin or end maintenance, during which one core leads alone and no standby takes over", cmd_standby, NULL },
    { "reload", "make a daemon on this machine reload its plant file and tag list", cmd_reload, NULL },
    { "history", "import readings into the recorded history of a plant, or export recorded readings as CSV", cmd_history, NULL },
    { "backup", "back up a plant, or all files of a service plantcastd@NAME, also while the daemon runs", cmd_backup, NULL },
    { "restore", "restore a backup that `plantcast backup` made", cmd_restore, NULL },
    { "fleet", "serve one overview page and one /metrics page for the daemons of many plants", cmd_fleet, NULL },
    { "token", "create, list and revoke the tokens with which users and programs sign in", cmd_token, NULL },
    { "sensors", "suggest positions for more sensors, detect sensors that drift, accept assumed positions", cmd_sensors, NULL },
    { "verify", "check the signature of a picture or clip; redraw the picture and compare", cmd_verify, NULL },
    { "read", "print the value at a pixel of a picture or screenshot that has a legend strip", cmd_read, NULL },
    { "audit", "check whether an audit trail was altered", cmd_audit, NULL },
};
enum { COMMANDS = sizeof(commands) / sizeof(commands[0]) };

static void print_usage(FILE *out)
{
    fputs("usage: plantcast COMMAND [ARGUMENT ...]\n       plantcast COMMAND --help\n\n", out);
    for (int i = 0; i < COMMANDS; i++)
        fprintf(out, "  %-10s %s\n", commands[i].name, commands[i].help);
    fputs("\nOptions of every command that connects to a daemon (http:// or https://):\n"
          "  --token-file FILE   file whose first line is the token with which to sign in (see `plantcast token`)\n"
          "  --ca FILE           file of certificates (PEM) to trust in addition to those of the system\n",
          out);
}

static int run_command(int argc, char **argv)
{
    struct daemon_access access;
    if (argc < 2) {
        print_usage(stderr);
        return 2;
    }
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "help")) {
        print_usage(stdout);
        return 0;
    }
    if (!daemon_take_options(&argc, argv, &access))
        return 2;
    for (int i = 0; i < COMMANDS; i++)
        if (!strcmp(argv[1], commands[i].name))
            return commands[i].run ? commands[i].run(argc - 1, argv + 1) : commands[i].connect(&access, argc - 1, argv + 1);
    fprintf(stderr, "plantcast: '%s' is not a command\n", argv[1]);
    print_usage(stderr);
    return 2;
}

int main(int argc, char **argv)
{
    return standard_output_end("plantcast", run_command(argc, argv));
}
