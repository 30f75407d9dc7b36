/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends requests to an OPC UA server and waits for their responses while watching stop_fd. */
#include <errno.h>
#include <string.h>

#include "base/clock.h"
#include "value/lookup.h"
#include "value/opcua/opcua_client.h"
#include "value/opcua/opcua_impl.h"

static const int64_t SLICE_NS = 100 * NS_PER_MS; /* interval in nanoseconds at which a call that waits for the server checks stop_fd */

void opcua_explain(const struct opcua_client *client, UA_StatusCode status, char why[200])
{
    const char *said = *client->said && !strstr(client->said, UA_StatusCode_name(status)) ? client->said : "";
    snprintf(why, 200, "%s%s%s%s", UA_StatusCode_name(status), *said ? " (" : "", said, *said ? ")" : "");
}

int opcua_wait(struct opcua_client *client, const bool *done, int stop_fd, int64_t deadline_mono_ns, char why[200])
{
    while (!*done) {
        int64_t left_ns = deadline_mono_ns - clock_mono_ns();
        if (wait_for(-1, 0, stop_fd, 0) == -ECANCELED)
            return -ECANCELED;
        if (left_ns <= 0) {
            snprintf(why, 200, "the OPC UA server does not answer%s%.150s", *client->said ? ": " : "", client->said);
            return -ETIMEDOUT;
        }
        UA_StatusCode status = UA_Client_run_iterate(client->library, (UA_UInt32)((left_ns < SLICE_NS ? left_ns : SLICE_NS) / NS_PER_MS));
        if (status != UA_STATUSCODE_GOOD) {
            opcua_explain(client, status, why);
            return -ECONNRESET;
        }
    }
    return 0;
}

void opcua_on_answer(UA_Client *library, void *arg, UA_UInt32 id, void *response)
{
    struct opcua_client *client = arg;
    (void)library, (void)id;
    client->call.done = true;
    if (!client->call.response)
        return;
    memcpy(client->call.response, response, client->call.type->memSize);
    memset(response, 0, client->call.type->memSize); /* the caller now owns the memory of the response, so open62541's copy is cleared */
    client->call.response = NULL;
}

void opcua_call_begin(struct opcua_client *client, void *response, const UA_DataType *type)
{
    UA_init(response, type);
    client->call.done = false;
    client->call.response = response;
    client->call.type = type;
}

int opcua_call_end(struct opcua_client *client, UA_StatusCode sent, int stop_fd, int64_t deadline_mono_ns, char why[200])
{
    /* the response of any service begins with this header, so the pointer can be converted */
    const UA_ResponseHeader *header = client->call.response;
    if (sent != UA_STATUSCODE_GOOD) {
        client->call.response = NULL;
        opcua_explain(client, sent, why);
        return -ECONNRESET;
    }
    int status = opcua_wait(client, &client->call.done, stop_fd, deadline_mono_ns, why);
    client->call.response = NULL;
    if (status == 0 && header->serviceResult != UA_STATUSCODE_GOOD) {
        opcua_explain(client, header->serviceResult, why);
        return -EPROTO;
    }
    return status;
}

int opcua_call(struct opcua_client *client, const struct opcua_exchange *exchange, int stop_fd, int64_t deadline_mono_ns, char why[200])
{
    opcua_call_begin(client, exchange->response, exchange->response_type);
    UA_StatusCode sent = __UA_Client_AsyncService(client->library, exchange->request, exchange->request_type, opcua_on_answer,
                                                  exchange->response_type, client, NULL);
    return opcua_call_end(client, sent, stop_fd, deadline_mono_ns, why);
}
