/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The subcommands of `plantcast`. argv[0] is the subcommand's own name; what comes back is the exit code: 0 good, 2 usage,
   1 anything else. */
#ifndef CLI_COMMANDS_H
#define CLI_COMMANDS_H
#include <stdbool.h>

int cmd_snapshot(int argc, char **argv); /* one picture: offline from a plant file, or from a daemon */
int cmd_clip(int argc, char **argv);     /* a film of the past, likewise */
int cmd_probe(int argc, char **argv);    /* load generator and latency table */
int cmd_tags(int argc, char **argv);     /* the tags of a daemon with their values */
/* address_base: 0, 1, or -1: not said. rtu: RTU frames in the connection. */
int tags_probe(const char *device, const char *address, int address_base, bool rtu);
int cmd_history(int argc, char **argv);  /* recorded series in and out */
int cmd_backup(int argc, char **argv);   /* history, journal and configuration, out and in again */
int cmd_restore(int argc, char **argv);
int cmd_token(int argc, char **argv);    /* who is let in by a daemon */

/* Fetches PATH (with its query, e.g. "/snapshot.png?width=640&group=temperature") from the daemon at url (http://HOST:PORT/) into
   the file `out`. 0, or 1: the reason is printed. */
int daemon_download(const char *url, const char *path, const char *out); /* out NULL: printed */

#endif
