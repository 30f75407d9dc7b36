/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One session with an OPC UA server, by open62541's client, which only this folder includes. A client is made for each session, and gone
   with it: the library neither creates its subscriptions anew nor notices that they are gone. All it can send are the requests
   in opcua_client.c, opcua_subscription.c and opcua_browse.c: none writes to a node, none calls a method. Thread: one. */
#ifndef VALUE_OPCUA_CLIENT_H
#define VALUE_OPCUA_CLIENT_H
#include "value/opcua/opcua_nodes.h"
#include "value/opcua/opcua_value.h"

struct opcua_client;

/* What is called from all functions that are given a deadline. */
struct opcua_events {
    void *arg;
    void (*value)(void *arg, size_t node, const UA_DataValue *value); /* node: index in the nodes */
    void (*refused)(void *arg, size_t node, uint32_t status, const char *why);
};

/* Reads the files that the source names; nothing is sent yet. Returns NULL if one cannot be used, and says in why what is wrong. All
   that is given must outlive the client. */
struct opcua_client *opcua_client_create(const struct plant_source *source, int host, const struct opcua_nodes *nodes,
                                         const struct opcua_events *events, char why[200]);
/* Ends the session; waits 0.3 s at most for the server. &NULL is fine; leaves NULL. */
void opcua_client_destroy(struct opcua_client **client);
/* Connects: finds an endpoint and checks its certificate, opens a session. The deadline is for all of that. Returns 0; -ECANCELED if
   stop_fd became readable; other < 0, and why. */
int opcua_client_connect(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200]);
/* Subscribes to all nodes, and asks once more for those that were refused if it has done so before. Returns likewise. */
int opcua_client_subscribe(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200]);
/* Receives until the deadline. Returns 0; -ECANCELED likewise; other < 0: the session or the subscription has ended, and why. */
int opcua_client_serve(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200]);
/* Returns how often the server tells what has changed, in milliseconds, where that is more rarely than it was asked to; else 0. */
double opcua_client_publishing_ms(const struct opcua_client *client);
/* Returns how many nodes the server has refused. */
size_t opcua_client_refused(const struct opcua_client *client);

#endif
