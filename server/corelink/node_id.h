/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A core's unique identity, even among cores of the same name: a random number in its history folder. Only one process may use
   it at a time, and a copy of the folder gets a new identity. Call from any thread. */
#ifndef CORELINK_NODE_ID_H
#define CORELINK_NODE_ID_H

struct node_id {
    int fd; /* descriptor of the identity file, which stays locked until the descriptor is closed */
    char id[9];
};

/* Locks the identity in the history folder for this process, and creates it if it is missing. Returns NULL on success, or an
   error message (mem_free). */
char *node_id_take(struct node_id *id, const char *folder);
void node_id_release(struct node_id *id); /* Releases the identity; a zero-initialised struct is fine. */

#endif
