/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Addresses of OPC UA nodes: `[ELEMENT]nsu=URI;s=NAME` (SOURCES.md). Call from any thread. */
#ifndef PLANT_SOURCES_OPCUA_ADDRESS_H
#define PLANT_SOURCES_OPCUA_ADDRESS_H
#include <stdbool.h>

#include "plant/plant.h"

#define OPCUA_STANDARD_NAMESPACE "http://opcfoundation.org/UA/"
enum { OPCUA_NODE_BYTES = 4096 }; /* maximum length of a node's identifier, according to the OPC UA standard */

/* Sets tag->topic (the namespace URI), tag->path (the identifier, such as s=NAME) and tag->element from the tag's address and its
   source's namespace. Returns false on errors, with the expected form in `why`. */
bool opcua_address_resolve(const struct plant *plant, struct plant_tag *tag, char why[200]);

#endif
