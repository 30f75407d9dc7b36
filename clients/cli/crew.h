/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viewers at work: a few threads, each with some of them. */
#ifndef CLI_CREW_H
#define CLI_CREW_H
#include "viewer.h"

/* Runs them all to their ends. False: not all could be started; said. */
bool crew_run(struct viewer **viewers, int count);
void crew_raise_file_limit(void); /* as many connections as the system lets this process have */

#endif
