/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viewers at work: a few threads, each with some of them. */
#ifndef CLI_VIEWER_THREADS_H
#define CLI_VIEWER_THREADS_H
#include "viewer.h"

/* Runs them all to their ends. False: not all could be started; said. */
bool viewer_threads_run(struct viewer **viewers, int count);
void viewer_threads_raise_file_limit(void); /* as many connections as the system lets this process have */

#endif
