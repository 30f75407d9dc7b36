/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The subcommands of `plantcast`. argv[0] is the subcommand's own name. Each returns the exit code: 0 good, 2 wrong usage, 1 anything
   else. */
#ifndef CLI_COMMANDS_H
#define CLI_COMMANDS_H
#include <stdbool.h>

/* Takes one picture: offline from a plant file, or from a daemon. */
int cmd_snapshot(int argc, char **argv);
/* Loads a daemon with viewers and prints a table of latencies. */
int cmd_probe(int argc, char **argv);
/* Prints the tags of a daemon with value, quality and age. */
int cmd_tags(int argc, char **argv);
/* Reads one address of a field device and prints it in every type and byte order. address_base: 0, 1, or -1 (not given). rtu: RTU frames
   over the connection. Returns the exit code. */
int tags_probe(const char *device, const char *address, int address_base, bool rtu);
/* Prints the variables of an OPC UA server as a tag list; argv[0] is --browse. */
int tags_browse(int argc, char **argv);
/* Imports recorded series into a plant's history, or exports them as CSV. */
int cmd_history(int argc, char **argv);
/* Says whether a daemon is ready. */
int cmd_ready(int argc, char **argv);
/* Has a daemon of this machine send its sessions to other nodes. */
int cmd_drain(int argc, char **argv);
/* Has a daemon of this machine load its plant anew and says what came of it. */
int cmd_reload(int argc, char **argv);
/* Copies history, journal and configuration of a plant into a folder. */
int cmd_backup(int argc, char **argv);
/* Puts such a backup in place. */
int cmd_restore(int argc, char **argv);
/* Watches the servers of many plants, and serves a page of them. */
int cmd_fleet(int argc, char **argv);
/* Verifies the audit trail of a daemon. */
int cmd_audit(int argc, char **argv);
/* Proposes places for more sensors; names those that drift; accepts assumed places. */
int cmd_sensors(int argc, char **argv);
int cmd_sensors_accept(int argc, char **argv);
int cmd_sensors_drift(int argc, char **argv);
int cmd_verify(int argc, char **argv);
int cmd_read(int argc, char **argv);
/* Makes, lists and revokes access tokens of a daemon. */
int cmd_token(int argc, char **argv);

/* Has another program beside this one do a command, whose name is argv[0]: what it needs, or what it reads of strangers, is kept out of
   this one. ending: of its name. Returns only if it cannot be run, with the reason printed. */
void run_beside(const char *ending, char **argv);
/* Likewise plantcast-film, with the options that all commands share. */
void run_film(int argc, char **argv);

/* Fetches `path` (with its query, e.g. "/snapshot.png?width=640&group=temperature") from the daemon at url (http://HOST:PORT/) into the
   file `out`, or prints it (NULL). Returns 0, or 1 with the reason printed. */
int daemon_download(const char *url, const char *path, const char *out);

#endif
