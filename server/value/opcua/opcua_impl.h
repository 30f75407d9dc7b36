/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A client, as the files that ask its server share it. Private to value/opcua/. Thread: one. */
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
    char *url;                   /* with the host's name */
    char *numeric_url;           /* with an address of it, where the connection goes */
    UA_Logger logger;
    char said[160];              /* the last that the library complained of */
    UA_Client *library;          /* of the channel that is open now */
    UA_EndpointDescription endpoint; /* that was chosen; its certificate is checked */
    bool lost;                   /* the subscription */
    uint32_t max_items;          /* of one request */
    UA_UInt32 subscription;
    double publishing_ms;        /* how often the server tells what has changed; 0: as it was asked to */
    char **namespaces;           /* the server's, by number */
    size_t namespace_count;
    UA_UInt16 *numbers;          /* of each node's namespace; NO_NAMESPACE: the server has none of that URI */
    bool *refused, *no_filter;   /* by node: not subscribed; to be without a deadband */
    size_t refused_count;
    struct {                     /* the request that is under way */
        bool done;
        void *response;          /* NULL: nobody waits for it any more */
        const UA_DataType *type;
    } call;
};

/* Receives until *done, or the deadline. Returns 0, -ECANCELED, -ETIMEDOUT, other < 0: the connection has ended; all but the first two
   say why. */
int opcua_wait(struct opcua_client *client, const bool *done, int stop_fd, int64_t deadline_mono_ns, char why[200]);
/* Sends a request and waits for its answer. Returns as opcua_wait(), and -EPROTO where the server refuses. In all cases clear the response
   with UA_clear(). */
int opcua_call(struct opcua_client *client, const void *request, const UA_DataType *request_type, void *response,
               const UA_DataType *response_type, int stop_fd, int64_t deadline_mono_ns, char why[200]);
/* What opcua_call() does for requests that the library sends in its own way: opcua_call_begin() before, opcua_call_end() with what it
   returned. opcua_on_answer is its callback, with the client as userdata. */
void opcua_call_begin(struct opcua_client *client, void *response, const UA_DataType *type);
int opcua_call_end(struct opcua_client *client, UA_StatusCode sent, int stop_fd, int64_t deadline_mono_ns, char why[200]);
void opcua_on_answer(UA_Client *library, void *client, UA_UInt32 id, void *response);
/* Reads which namespaces the server has, and how much may be asked for at once. Returns as opcua_call(). */
int opcua_read_namespaces(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200]);
/* Says in why what a status means here. */
void opcua_explain(const struct opcua_client *client, UA_StatusCode status, char why[200]);

#endif
