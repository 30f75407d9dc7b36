/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Load generator: runs viewers that do not decode frames, all in the calling thread. They need so little processor time that hundreds fit
   on the same machine as the daemon under test. */
#ifndef CLI_VIEWER_LOAD_GENERATOR_H
#define CLI_VIEWER_LOAD_GENERATOR_H
#include "viewer.h"

/* Runs all viewers until they finish, over plain TCP. Returns false if it could not start, with the reason printed. */
bool load_generator_run(struct viewer **viewers, int count);

#endif
