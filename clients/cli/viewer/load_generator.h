/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Load generator: drives viewers that do not decode, all in the calling thread, so cheaply that hundreds fit beside the daemon that they
   measure. */
#ifndef CLI_VIEWER_LOAD_GENERATOR_H
#define CLI_VIEWER_LOAD_GENERATOR_H
#include "viewer.h"

/* Runs all viewers to their ends, over plain TCP. Returns false if it could not begin, with the reason printed. */
bool load_generator_run(struct viewer **viewers, int count);

#endif
