/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The subcommands of `plantcast`. argv[0] is the subcommand's name. Each returns the exit code: 0 success, 2 wrong usage, 1 any
   other failure. */
#ifndef CLI_COMMANDS_H
#define CLI_COMMANDS_H
#include <stdbool.h>

struct daemon_access; /* clients/link/daemon.h */

/* Draws one picture offline from a plant file, or fetches it from a daemon. */
int cmd_snapshot(const struct daemon_access *access, int argc, char **argv);
/* Connects many viewers to a daemon and prints a table of latencies. */
int cmd_probe(const struct daemon_access *access, int argc, char **argv);
/* Prints the tags of a daemon with their values, qualities and ages. */
int cmd_tags(const struct daemon_access *access, int argc, char **argv);
/* Reads one address of a field device and prints its value in every type and byte order. address_base: number of the first register, 0
   or 1; -1: not given. Returns the exit code. */
int tags_probe(const char *device, const char *address, int address_base);
/* Prints the variables of an OPC UA server as a tag list. argv[0] is --browse. Returns the exit code. */
int tags_browse(int argc, char **argv);
/* Imports recorded series into a plant's history, or exports them as CSV. */
int cmd_history(int argc, char **argv);
/* Reports whether a daemon is ready. */
int cmd_ready(const struct daemon_access *access, int argc, char **argv);
/* Makes a daemon on this machine close its sessions, so that they reconnect to other daemons. */
int cmd_drain(int argc, char **argv);
/* Begins or ends maintenance of a standby core, the daemon that takes over if the one that polls the field devices fails. */
int cmd_standby(int argc, char **argv);
/* Makes a daemon on this machine reload its plant, and prints the result. */
int cmd_reload(int argc, char **argv);
/* Copies history, journal and configuration of a plant into a folder. */
int cmd_backup(int argc, char **argv);
/* Restores a folder that cmd_backup() wrote. */
int cmd_restore(int argc, char **argv);
/* Watches the servers of many plants, and serves a page that lists them. */
int cmd_fleet(int argc, char **argv);
/* Verifies that a daemon's audit trail is complete. */
int cmd_audit(int argc, char **argv);
/* Proposes locations for more sensors, lists drifting sensors, and accepts assumed positions (positions that `plantcast match`
   chose for sensors on their equipment). */
int cmd_sensors(int argc, char **argv);
int cmd_sensors_accept(int argc, char **argv);
int cmd_sensors_drift(int argc, char **argv);
int cmd_verify(int argc, char **argv);
int cmd_read(int argc, char **argv);
/* Makes, lists and revokes access tokens of a daemon. */
int cmd_token(int argc, char **argv);

/* Replaces this process with a helper program in the same folder, named like this program plus `ending`; the helper runs the
   command argv[0]. Helpers keep large dependencies and parsers of untrusted input out of this program. package: Debian package
   that contains the helper. Returns only if the helper cannot be run, with the reason printed. */
void run_beside(const char *ending, const char *package, char **argv);
/* Replaces this process with plantcast-film, passing on the options common to all commands (access NULL: none). Returns only if
   plantcast-film cannot be run, with the reason printed. */
void run_film(const struct daemon_access *access, int argc, char **argv);

/* Fetches `path` (with its query, such as "/snapshot.png?width=640&group=temperature") from the daemon at url (http://HOST:PORT/).
   Writes the response to the file `out`, or prints it if `out` is NULL. Returns 0, or 1 with the reason printed. */
int daemon_download(const struct daemon_access *access, const char *url, const char *path, const char *out);

#endif
