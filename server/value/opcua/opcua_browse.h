/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the variables of a server that hold numbers, for a tag list to begin with. Thread: one. */
#ifndef VALUE_OPCUA_BROWSE_H
#define VALUE_OPCUA_BROWSE_H
#include "value/opcua/opcua_client.h"

struct opcua_variable {
    const char *path;        /* names from the folder Objects on, joined by dots */
    const char *address;     /* nsu=URI;s=NAME, as in a tag list */
    const char *description; /* maybe "" */
    bool is_bit;
    size_t elements;         /* of an array; 0: it is none */
};

/* Calls found for each variable below the folder Objects, but for those that every server has. The client is connected. Returns as
   opcua_client_connect(). */
int opcua_browse(struct opcua_client *client, void (*found)(void *arg, const struct opcua_variable *variable), void *arg, int stop_fd,
                 int64_t deadline_mono_ns, char why[200]);

#endif
