/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The source kind "replay": plays recorded series from a CSV file (series.h) at a speed that the plant file sets. */
#ifndef VALUE_REPLAY_H
#define VALUE_REPLAY_H
#include "value/source.h"

extern const struct source_impl replay_impl;

#endif
