/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of the OPC UA client, shared by the files that send requests to the server. Private to value/opcua/. Call from one thread only. */
#ifndef VALUE_OPCUA_IMPL_H
#define VALUE_OPCUA_IMPL_H
#include <open62541/client_subscriptions.h>

#include "value/opcua/opcua_nodes.h"
#include "value/opcua/opcua_security.h"

struct opcua_events;

struct opcua_client {
    const struct plant_source *source;
    const char *host;
    const struct opcua_nodes *nodes;
    const struct opcua_events *events;
    struct opcua_security security;
    char *url;         /* endpoint URL that contains the host's name */
    char *numeric_url; /* endpoint URL with the host's IP address, to which the connection is made */
    UA_Logger logger;
    char said[160];                  /* text of the last error that open62541 logged */
    UA_Client *library;              /* open62541's client for the open secure channel; NULL: no channel is open */
    UA_EndpointDescription endpoint; /* endpoint of the server that was chosen for the connection, whose certificate has been checked */
    bool lost;                       /* true: the subscription has ended, so a new session is needed */
    bool missed;                     /* true: notifications of changed values were lost since all nodes were last read */
    /* max_items: maximum number of nodes per request to monitor nodes; max_reads: per request to read values; 0: not known yet */
    uint32_t max_items, max_reads;
    UA_UInt32 subscription;
    double publishing_ms; /* the server's publishing interval in milliseconds if it is longer than the requested one; 0: it is not */
    char **namespaces;    /* namespace URIs of the server, by namespace index */
    size_t namespace_count;
    UA_UInt16 *numbers; /* by node: index that the node's namespace has on the server; NO_NAMESPACE: the server has no such namespace */
    /* By node. refused: the server has not accepted the node yet; no_filter: the node is subscribed without a deadband. */
    bool *refused, *no_filter;
    size_t refused_count;
    struct { /* the request in progress */
        bool done;
        void *response; /* receives the response to the request; NULL: the caller has stopped waiting, so the response is dropped */
        const UA_DataType *type;
    } call;
};

/* Receives until *done is true, or until the deadline. Returns 0; -ECANCELED if stop_fd became readable; -ETIMEDOUT, or another negative
   code if the connection has ended, with the reason in `why`. */
int opcua_wait(struct opcua_client *client, const bool *done, int stop_fd, int64_t deadline_mono_ns, char why[200]);
struct opcua_exchange {
    const void *request;
    const UA_DataType *request_type;
    void *response;
    const UA_DataType *response_type;
};
/* Sends a request and waits for its response. Returns the codes of opcua_wait(), or -EPROTO if the server refuses the request. The
   caller must clear the response with UA_clear() in all cases. */
int opcua_call(struct opcua_client *client, const struct opcua_exchange *exchange, int stop_fd, int64_t deadline_mono_ns, char why[200]);
/* Sends a request with a function of open62541 and waits for its response: call opcua_call_begin() before the library's
   function, and opcua_call_end() with its result. Pass opcua_on_answer as the callback, with the client as userdata. */
void opcua_call_begin(struct opcua_client *client, void *response, const UA_DataType *type);
int opcua_call_end(struct opcua_client *client, UA_StatusCode sent, int stop_fd, int64_t deadline_mono_ns, char why[200]);
void opcua_on_answer(UA_Client *library, void *client, UA_UInt32 id, void *response);
/* Reads the namespace URIs of the server, finds the namespaces of the nodes that the server has not accepted yet, and reads the
   server's limit on the number of items per request. Returns the codes of opcua_call(). */
int opcua_read_namespaces(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200]);
void opcua_forget_namespaces(struct opcua_client *client); /* frees the list of namespace URIs */
/* Writes an explanation of a status code into `why`, with the last error that open62541 logged. */
void opcua_explain(const struct opcua_client *client, UA_StatusCode status, char why[200]);

#endif
