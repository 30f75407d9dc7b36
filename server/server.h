/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The daemon as a whole: builds the layers in order, serves, takes them down again. */
#ifndef SERVER_SERVER_H
#define SERVER_SERVER_H
#include "server_params.h"

/* They return the exit code: 0 good, 1 anything wrong, said on stderr. */
int server_run(const struct server_params *params);       /* until SIGINT or SIGTERM */
int server_check(const struct server_params *params);     /* reads everything, starts nothing */
int server_dump_plan(const struct server_params *params); /* prints what field devices will be asked */

#endif
