/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Takes the network from the calling process, for good. */
#ifndef PREPROCESS_CHILD_CHILD_CONFINE_H
#define PREPROCESS_CHILD_CHILD_CONFINE_H

/* Moves the process into a network namespace without interfaces where it may, and forbids it, and what it starts, to open sockets and to
 * look into other processes. Between fork and exec: it allocates nothing. */
void child_confine(void);

#endif
