/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The commands of plantcast-film. argv starts after the command's name. Each function returns the exit status. */
#ifndef FILM_COMMANDS_H
#define FILM_COMMANDS_H
struct daemon_access; /* clients/link/daemon.h */

/* Makes a film of recorded history, offline from a plant file or through a daemon. */
int command_clip(const struct daemon_access *access, int argc, char **argv);
/* Verifies with the server's public key that each picture of a signed film is as the server drew it. */
int command_verify(int argc, char **argv);

#endif
