/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Addresses of OPC UA nodes: `[ELEMENT]nsu=URI;s=NAME` (PLANT.md). Thread: any. */
#ifndef PLANT_SOURCES_OPCUA_ADDRESS_H
#define PLANT_SOURCES_OPCUA_ADDRESS_H
#include <stdbool.h>

#include "plant/plant.h"

#define OPCUA_STANDARD_NAMESPACE "http://opcfoundation.org/UA/"
enum { OPCUA_NODE_BYTES = 4096 }; /* no identifier is longer, says the standard */

/* Sets tag->topic (the URI of the namespace), tag->path (the identifier, such as s=NAME) and tag->element from its address and its source's
   namespace. Returns false on errors, with what was expected in why. */
bool opcua_address_resolve(const struct plant *plant, struct plant_tag *tag, char why[200]);

#endif
