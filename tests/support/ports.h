/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Port numbers for programs that must be told theirs. */
#ifndef TESTS_PORTS_H
#define TESTS_PORTS_H

/* Returns a port at which nothing listens, and the three after it. No other test is given them while this process lives, nor does the
   system take them for an outgoing connection. Aborts if there is none. */
int free_port(void);

#endif
