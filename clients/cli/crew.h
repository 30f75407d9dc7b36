/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viewers at work: a few threads, each with some of them. */
#ifndef CLI_CREW_H
#define CLI_CREW_H
#include "viewer.h"

/* Runs them all to their ends. False: not all could be started; said. */
bool crew_run(struct viewer **viewers, int count);

#endif
