/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tags of a source whose addresses are texts: a topic or a node, and what of it. Pure. */
#ifndef VALUE_SOURCE_TAGS_H
#define VALUE_SOURCE_TAGS_H
#include "plant/plant.h"

/* Returns the indices of the source's tags in plant->tags, sorted by topic, then by path, and how many there are; the caller frees them
   (mem_free). */
int *source_tags_by_topic(const struct plant *plant, int source, size_t *count);

#endif
