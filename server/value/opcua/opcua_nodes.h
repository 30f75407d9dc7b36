/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The nodes of an OPC UA source, with the tags of each node. A node is subscribed only once, even if several elements of its
   array are tags. Immutable once made. Call from any thread. */
#ifndef VALUE_OPCUA_NODES_H
#define VALUE_OPCUA_NODES_H
#include <stddef.h>

#include "plant/plant.h"

struct opcua_node {
    /* name_space: namespace URI of the node; id: its identifier in the namespace, such as s=NAME; owned by the plant */
    const char *name_space, *id;
    const int *tags;             /* indices in plant->tags of the tags that take their values from the node */
    size_t tag_count;
    int sampling_ms; /* sampling interval in milliseconds: the shortest that any of the node's tags requests */
    /* the smallest deadband of the node's tags, or the source's deadband; none if one tag states percent and another does not */
    struct opcua_deadband deadband;
    bool own_deadband; /* true: the tag list states the deadband; false: the source does */
};

struct opcua_nodes {
    struct opcua_node *at;
    size_t count;
    int *tags; /* indices in plant->tags of the source's tags, grouped by node */
    size_t tag_count;
};

/* Builds the nodes of one source. `plant` must outlive them. */
void opcua_nodes_init(struct opcua_nodes *nodes, const struct plant *plant, int source);
void opcua_nodes_finish(struct opcua_nodes *nodes);

#endif
