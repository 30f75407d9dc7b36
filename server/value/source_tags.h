/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tags of a source whose addresses are texts: an MQTT topic or an OPC UA node, and a path within it. No side effects. */
#ifndef VALUE_SOURCE_TAGS_H
#define VALUE_SOURCE_TAGS_H
#include "plant/plant.h"

/* Returns the indices in plant->tags of the source's tags, sorted by topic (or node), then by path; *count receives their number. The
 * caller frees the array with mem_free(). */
int *source_tags_by_topic(const struct plant *plant, int source, size_t *count);

#endif
