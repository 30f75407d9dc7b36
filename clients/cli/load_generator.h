/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Blind viewers at work, all of them in the thread that calls: so cheap that hundreds fit beside the daemon that they measure. */
#ifndef CLI_LOAD_GENERATOR_H
#define CLI_LOAD_GENERATOR_H
#include "viewer.h"

/* Runs them all to their ends, over plain TCP. False: it could not begin; said. */
bool load_generator_run(struct viewer **viewers, int count);

#endif
