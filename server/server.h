/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The daemon: creates its parts, serves until it is told to end, and destroys them again. */
#ifndef SERVER_SERVER_H
#define SERVER_SERVER_H
#include "server_params.h"

/* Each function returns the exit code: 0 for success, 1 for any error (printed on stderr). */
int server_run(const struct server_params *params);       /* runs the daemon until SIGINT or SIGTERM */
int server_check(const struct server_params *params);     /* checks the plant: reads all files without starting anything */
int server_dump_plan(const struct server_params *params); /* prints the requests that the daemon would send to field devices, and ends */
int server_test_notify(const struct server_params *params); /* sends a test message to all recipients of `notify`, and ends */

#endif
