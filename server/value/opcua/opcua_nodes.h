/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The nodes of a source and the tags of each: one is subscribed once, however many of its elements are tags. Immutable once made.
   Thread: any. */
#ifndef VALUE_OPCUA_NODES_H
#define VALUE_OPCUA_NODES_H
#include <stddef.h>

#include "plant/plant.h"

struct opcua_node {
    const char *name_space, *id; /* the plant's: URI, and s=NAME */
    const int *tags;             /* indices in plant->tags */
    size_t tag_count;
    int sampling_ms;             /* of the tag that wants it most often */
};

struct opcua_nodes {
    struct opcua_node *at;
    size_t count;
    int *tags; /* of the source, by node */
    size_t tag_count;
};

void opcua_nodes_init(struct opcua_nodes *nodes, const struct plant *plant, int source); /* plant must outlive it */
void opcua_nodes_finish(struct opcua_nodes *nodes);

#endif
