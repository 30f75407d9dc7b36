/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs viewers (simulated clients) on a few threads, several viewers on each. */
#ifndef CLI_VIEWER_VIEWER_THREADS_H
#define CLI_VIEWER_VIEWER_THREADS_H
#include "viewer.h"

/* Runs all viewers until they finish. Returns false, with the reason printed, if not all could be started. */
bool viewer_threads_run(struct viewer **viewers, int count);
/* Raises this process's open-file limit to the system's maximum, for many connections. */
void viewer_threads_raise_file_limit(void);

#endif
