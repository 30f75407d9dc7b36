/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes plant.yaml and tags.csv. */
#ifndef GENERATE_PLANT_FILE_H
#define GENERATE_PLANT_FILE_H
#include "tags.h"

/* 0 or -errno. */
int plant_file_write(const char *path);
int tag_list_write(const struct tags *tags, const char *path);

#endif
