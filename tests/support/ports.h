/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Port numbers for programs that cannot choose their own. */
#ifndef TESTS_PORTS_H
#define TESTS_PORTS_H

/* Returns a port on which nothing listens; the three after it are free too. No other test gets them while this process lives,
   and the system does not use them for outgoing connections. Aborts if there are none. */
int free_port(void);

#endif
