/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One session with an OPC UA server through open62541's client, which only this folder includes. Each session needs a new
   client, because the library neither creates lost subscriptions again nor notices that they are gone. opcua_client.c,
   opcua_subscription.c and opcua_browse.c contain all requests that can be sent: none writes to a node or calls a method. Call
   from one thread only. */
#ifndef VALUE_OPCUA_CLIENT_H
#define VALUE_OPCUA_CLIENT_H
#include "value/opcua/opcua_nodes.h"
#include "value/opcua/opcua_value.h"

struct opcua_client;

/* callbacks invoked during a session, by any function that takes a deadline */
struct opcua_events {
    void *arg;
    void (*value)(void *arg, size_t node, const UA_DataValue *value); /* `node`: index in opcua_nodes */
    void (*refused)(void *arg, size_t node, uint32_t status, const char *why);
    /* the server refuses the node's deadband, so the node is subscribed without one */
    void (*deadband_refused)(void *arg, size_t node, const char *why);
};

/* Creates a client and reads the certificate and login files that the source names; sends nothing yet. host: index in the source's
   hosts. Returns NULL with the reason in `why` if a file cannot be used. All arguments must outlive the client. */
struct opcua_client *opcua_client_create(const struct plant_source *source, int host, const struct opcua_nodes *nodes,
                                         const struct opcua_events *events, char why[200]);
/* Ends the session, waiting at most 0.3 s for the server, frees the client and sets *client to NULL. *client may be NULL. */
void opcua_client_destroy(struct opcua_client **client);
/* Connects: finds an endpoint, checks its certificate, opens a session, all by the deadline. Returns 0; -ECANCELED if stop_fd became
 * readable; another negative code with the reason in `why`. */
int opcua_client_connect(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200]);
/* Subscribes to all nodes. A repeated call only requests the nodes that the server refused; it also finds namespaces that the
   server has added meanwhile. Returns 0; -ECANCELED if stop_fd became readable; another negative code with the reason in `why`. */
int opcua_client_subscribe(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200]);
/* Receives new values until the deadline. Returns 0; -ECANCELED if stop_fd became readable; another negative code with the reason in
   `why` when the session or the subscription has ended. */
int opcua_client_serve(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200]);
/* Returns true if notifications of the subscription were lost, so that nodes may have newer values than the session has received. */
bool opcua_client_missed(const struct opcua_client *client);
/* Reads all subscribed nodes, after notifications were lost. Returns 0; -ECANCELED if stop_fd became readable; another negative code with
   the reason in `why`. */
int opcua_client_read(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200]);
/* Returns the server's publishing interval in milliseconds if it is longer than the requested one; 0: it is not. */
double opcua_client_publishing_ms(const struct opcua_client *client);
/* Returns the number of nodes to which the server has refused a subscription. */
size_t opcua_client_refused(const struct opcua_client *client);

#endif
