/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the numeric variables of an OPC UA server, as a starting point for a tag list. Call from one thread only. */
#ifndef VALUE_OPCUA_BROWSE_H
#define VALUE_OPCUA_BROWSE_H
#include "value/opcua/opcua_client.h"

struct opcua_variable {
    const char *path;        /* browse names of the nodes from the folder Objects to the variable, joined by dots */
    const char *address;     /* address of the variable's node, nsu=URI;s=NAME, as written in a tag list */
    const char *description; /* the server's description of the variable; may be "" */
    bool is_bit;
    size_t elements; /* number of elements if the variable is an array; 0: it is not an array */
};

/* Calls `found` for each numeric variable below the folder Objects, except the variables that every server has. The client must be
   connected. Returns 0; -ECANCELED if stop_fd became readable; another negative code with the reason in `why`. */
int opcua_browse(struct opcua_client *client, void (*found)(void *arg, const struct opcua_variable *variable), void *arg, int stop_fd,
                 int64_t deadline_mono_ns, char why[200]);

#endif
