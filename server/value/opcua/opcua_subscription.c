/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The subscription of an OPC UA session: finds the index of each namespace URI on the server, and creates one monitored item per node. */
#include <errno.h>
#include <string.h>

#include "base/mem.h"
#include "plant/sources/opcua_address.h"
#include "value/opcua/opcua_client.h"
#include "value/opcua/opcua_impl.h"

/* node ids in OPC UA's own namespace, which are the same on every server */
enum { NAMESPACE_ARRAY = 2255, MAX_READS_PER_CALL = 11705, MAX_ITEMS_PER_CALL = 11714 };
enum { ITEMS_PER_CALL = 500, KEPT_ALIVE_MS = 5000, LIFETIMES = 12 };
enum { NO_NAMESPACE = 0xffff };
static const UA_StatusCode NO_SUCH_NODE = 0x80340000; /* Bad_NodeIdUnknown */

/* --- namespaces ------------------------------------------------------------------------------------------------------------- */

void opcua_forget_namespaces(struct opcua_client *client)
{
    for (size_t i = 0; i < client->namespace_count; i++)
        mem_free(client->namespaces[i]);
    mem_free(client->namespaces);
    client->namespaces = NULL;
    client->namespace_count = 0;
}

static void keep_namespaces(struct opcua_client *client, const UA_Variant *value)
{
    const UA_String *uris = value->data;
    if (!UA_Variant_hasArrayType(value, &UA_TYPES[UA_TYPES_STRING]))
        return;
    opcua_forget_namespaces(client);
    client->namespaces = mem_array(value->arrayLength, sizeof(*client->namespaces));
    for (size_t i = 0; i < value->arrayLength && i < NO_NAMESPACE; i++)
        client->namespaces[client->namespace_count++] = mem_printf("%.*s", (int)uris[i].length, (const char *)uris[i].data);
}

static UA_UInt16 number_of(const struct opcua_client *client, const char *uri)
{
    if (!strcmp(uri, OPCUA_STANDARD_NAMESPACE))
        return 0;
    for (size_t i = 0; i < client->namespace_count; i++)
        if (!strcmp(client->namespaces[i], uri))
            return (UA_UInt16)i;
    return NO_NAMESPACE;
}

/* Returns the maximum number of nodes in one request. stated: the server's limit; no number, or 0: the server has no limit. */
static uint32_t batch_limit(const UA_Variant *stated)
{
    uint32_t limit = UA_Variant_hasScalarType(stated, &UA_TYPES[UA_TYPES_UINT32]) ? *(const UA_UInt32 *)stated->data : 0;
    return limit == 0 || limit > ITEMS_PER_CALL ? ITEMS_PER_CALL : limit;
}

int opcua_read_namespaces(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200])
{
    UA_ReadValueId values[3] = { { .nodeId = UA_NODEID_NUMERIC(0, NAMESPACE_ARRAY), .attributeId = UA_ATTRIBUTEID_VALUE },
                                 { .nodeId = UA_NODEID_NUMERIC(0, MAX_READS_PER_CALL), .attributeId = UA_ATTRIBUTEID_VALUE },
                                 { .nodeId = UA_NODEID_NUMERIC(0, MAX_ITEMS_PER_CALL), .attributeId = UA_ATTRIBUTEID_VALUE } };
    UA_ReadRequest request = { .nodesToRead = values, .nodesToReadSize = 3, .timestampsToReturn = UA_TIMESTAMPSTORETURN_NEITHER };
    UA_ReadResponse response;
    int status =
        opcua_call(client,
                   &(struct opcua_exchange){ &request, &UA_TYPES[UA_TYPES_READREQUEST], &response, &UA_TYPES[UA_TYPES_READRESPONSE] },
                   stop_fd, deadline_mono_ns, why);
    client->max_reads = client->max_items = ITEMS_PER_CALL;
    if (status == 0 && response.resultsSize == 3) {
        keep_namespaces(client, &response.results[0].value);
        client->max_reads = batch_limit(&response.results[1].value);
        client->max_items = batch_limit(&response.results[2].value);
    }
    /* the index of an accepted node's namespace cannot change during a session */
    for (size_t i = 0; i < client->nodes->count; i++)
        if (client->refused[i])
            client->numbers[i] = number_of(client, client->nodes->at[i].name_space);
    UA_ReadResponse_clear(&response);
    return status;
}

/* --- items ------------------------------------------------------------------------------------------------------------------ */

static void on_value(UA_Client *library, UA_UInt32 subscription, void *arg, UA_UInt32 item, void *node, UA_DataValue *value)
{
    struct opcua_client *client = arg;
    (void)library, (void)subscription, (void)item;
    client->events->value(client->events->arg, (size_t)node, value);
}

static void on_status(UA_Client *library, UA_UInt32 subscription, void *arg, UA_StatusChangeNotification *changed)
{
    struct opcua_client *client = arg;
    (void)library, (void)subscription;
    client->lost = true;
    snprintf(client->said, sizeof(client->said), "%s", UA_StatusCode_name(changed->status));
}

static void on_deleted(UA_Client *library, UA_UInt32 subscription, void *arg)
{
    struct opcua_client *client = arg;
    (void)library, (void)subscription;
    client->lost = true;
}

static int begin_subscription(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200])
{
    /* Creates the subscription. Its keep-alive interval is short, so that a server that stopped answering is detected soon. */
    int poll_ms = client->source->poll_ms < KEPT_ALIVE_MS ? client->source->poll_ms : KEPT_ALIVE_MS;
    UA_CreateSubscriptionRequest request = { .requestedPublishingInterval = poll_ms, .publishingEnabled = true };
    UA_CreateSubscriptionResponse response;
    request.requestedMaxKeepAliveCount = (UA_UInt32)(KEPT_ALIVE_MS / poll_ms) + 1;
    request.requestedLifetimeCount = LIFETIMES * request.requestedMaxKeepAliveCount;
    /* limits the number of items in a notification: a notification with more would exceed the maximum message size */
    request.maxNotificationsPerPublish = 2000;
    opcua_call_begin(client, &response, &UA_TYPES[UA_TYPES_CREATESUBSCRIPTIONRESPONSE]);
    UA_StatusCode sent =
        UA_Client_Subscriptions_create_async(client->library, request, client, on_status, on_deleted, opcua_on_answer, client, NULL);
    int status = opcua_call_end(client, sent, stop_fd, deadline_mono_ns, why);
    client->subscription = response.subscriptionId;
    client->publishing_ms = response.revisedPublishingInterval > client->source->poll_ms ? response.revisedPublishingInterval : 0;
    UA_CreateSubscriptionResponse_clear(&response);
    return status;
}

/* Makes the NodeId of a node, which the caller frees with UA_NodeId_clear(). Returns false if the server does not have its namespace, or
 * the identifier is invalid. */
static bool node_id(const struct opcua_client *client, size_t node, UA_NodeId *out)
{
    UA_UInt16 number = client->numbers[node];
    if (number == NO_NAMESPACE)
        return false;
    char *text = mem_printf("ns=%u;%s", number, client->nodes->at[node].id);
    bool good = UA_NodeId_parse(out, UA_STRING(text)) == UA_STATUSCODE_GOOD;
    mem_free(text);
    return good;
}

static bool has_deadband(const struct opcua_client *client, size_t node)
{
    return client->nodes->at[node].deadband.value > 0 && !client->no_filter[node];
}

/* Fills the request to monitor a node. *filter receives the node's deadband, and must outlive the request. */
static void fill_item(const struct opcua_client *client, size_t node, UA_DataChangeFilter *filter, UA_MonitoredItemCreateRequest *out)
{
    out->itemToMonitor.attributeId = UA_ATTRIBUTEID_VALUE;
    out->monitoringMode = UA_MONITORINGMODE_REPORTING;
    out->requestedParameters.samplingInterval = client->nodes->at[node].sampling_ms;
    out->requestedParameters.queueSize = (UA_UInt32)client->source->opcua.queue;
    out->requestedParameters.discardOldest = true;
    if (!has_deadband(client, node))
        return;
    const struct opcua_deadband *deadband = &client->nodes->at[node].deadband;
    *filter = (UA_DataChangeFilter){ .trigger = UA_DATACHANGETRIGGER_STATUSVALUE,
                                     .deadbandType = deadband->percent ? UA_DEADBANDTYPE_PERCENT : UA_DEADBANDTYPE_ABSOLUTE,
                                     .deadbandValue = deadband->value };
    UA_ExtensionObject_setValueNoDelete(&out->requestedParameters.filter, filter, &UA_TYPES[UA_TYPES_DATACHANGEFILTER]);
}

static void refuse(struct opcua_client *client, size_t node, UA_StatusCode status)
{
    client->events->refused(client->events->arg, node, status, UA_StatusCode_name(status));
}

/* Handles the server's result for one node. A node whose deadband the server refuses is requested again without a deadband; the only
   effect is more notifications. */
static void take_result(struct opcua_client *client, size_t node, UA_StatusCode status)
{
    bool of_filter = status == UA_STATUSCODE_BADFILTERNOTALLOWED || status == UA_STATUSCODE_BADMONITOREDITEMFILTERUNSUPPORTED ||
                     status == UA_STATUSCODE_BADMONITOREDITEMFILTERINVALID || status == UA_STATUSCODE_BADDEADBANDFILTERINVALID;
    if (status >> 30 < 2) {
        client->refused[node] = false;
        client->refused_count--;
    } else if (of_filter && has_deadband(client, node)) {
        client->no_filter[node] = true;
        client->events->deadband_refused(client->events->arg, node, UA_StatusCode_name(status));
    } else {
        refuse(client, node, status);
    }
}

/* Creates monitored items for a batch of nodes, whose NodeIds are set in `items`. Returns the codes of opcua_call(). */
static int create_items(struct opcua_client *client, const size_t *batch, UA_MonitoredItemCreateRequest *items, size_t count, int stop_fd,
                        int64_t deadline_mono_ns, char why[200])
{
    UA_CreateMonitoredItemsRequest request = { .subscriptionId = client->subscription,
                                               .timestampsToReturn = UA_TIMESTAMPSTORETURN_BOTH,
                                               .itemsToCreate = items,
                                               .itemsToCreateSize = count };
    UA_CreateMonitoredItemsResponse response;
    void **contexts = mem_array(count, sizeof(*contexts));
    UA_Client_DataChangeNotificationCallback *on_values = mem_array(count, sizeof(*on_values));
    UA_Client_DeleteMonitoredItemCallback *on_ends = mem_array(count, sizeof(*on_ends));
    for (size_t i = 0; i < count; i++) {
        contexts[i] = (void *)batch[i];
        on_values[i] = on_value;
    }
    opcua_call_begin(client, &response, &UA_TYPES[UA_TYPES_CREATEMONITOREDITEMSRESPONSE]);
    UA_StatusCode sent = UA_Client_MonitoredItems_createDataChanges_async(client->library, request, contexts, on_values, on_ends,
                                                                          opcua_on_answer, client, NULL);
    int status = opcua_call_end(client, sent, stop_fd, deadline_mono_ns, why);
    if (status == 0 && response.resultsSize != count) {
        snprintf(why, 200, "the OPC UA server answered for only %zu of %zu nodes", response.resultsSize, count);
        status = -EPROTO;
    }
    for (size_t i = 0; status == 0 && i < count; i++)
        take_result(client, batch[i], response.results[i].statusCode);
    UA_CreateMonitoredItemsResponse_clear(&response);
    mem_free(contexts);
    mem_free(on_values);
    mem_free(on_ends);
    return status;
}

/* Collects the next nodes that are not subscribed yet, from index *at on. Nodes that cannot be requested are marked as refused. Returns the
 * number of nodes collected. */
static size_t gather(struct opcua_client *client, size_t *at, UA_DataChangeFilter *filters, size_t *batch,
                     UA_MonitoredItemCreateRequest *items)
{
    size_t count = 0;
    for (; *at < client->nodes->count && count < client->max_items; ++*at) {
        if (!client->refused[*at])
            continue;
        UA_MonitoredItemCreateRequest_init(&items[count]);
        if (!node_id(client, *at, &items[count].itemToMonitor.nodeId)) {
            refuse(client, *at, NO_SUCH_NODE);
            continue;
        }
        fill_item(client, *at, &filters[count], &items[count]);
        batch[count++] = *at;
    }
    return count;
}

static int ask_for_refused(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200])
{
    UA_DataChangeFilter *filters = mem_array(client->max_items, sizeof(*filters));
    UA_MonitoredItemCreateRequest *items = mem_array(client->max_items, sizeof(*items));
    size_t *batch = mem_array(client->max_items, sizeof(*batch)), at = 0, count;
    int status = 0;
    while (status == 0 && (count = gather(client, &at, filters, batch, items)) > 0) {
        status = create_items(client, batch, items, count, stop_fd, deadline_mono_ns, why);
        for (size_t i = 0; i < count; i++)
            UA_NodeId_clear(&items[i].itemToMonitor.nodeId);
    }
    mem_free(filters);
    mem_free(items);
    mem_free(batch);
    return status;
}

static bool any_without_filter(const struct opcua_client *client)
{
    for (size_t i = 0; i < client->nodes->count; i++)
        if (client->refused[i] && client->no_filter[i])
            return true;
    return false;
}

/* Returns true if the namespace of a node was not found on the server. */
static bool lacks_namespace(const struct opcua_client *client)
{
    for (size_t i = 0; i < client->nodes->count; i++)
        if (client->refused[i] && client->numbers[i] == NO_NAMESPACE)
            return true;
    return false;
}

int opcua_client_subscribe(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200])
{
    bool is_new = !client->max_items;
    int status = is_new || lacks_namespace(client) ? opcua_read_namespaces(client, stop_fd, deadline_mono_ns, why) : 0;
    if (status == 0 && is_new)
        status = begin_subscription(client, stop_fd, deadline_mono_ns, why);
    if (status == 0)
        status = ask_for_refused(client, stop_fd, deadline_mono_ns, why);
    if (status == 0 && is_new && any_without_filter(client))
        status = ask_for_refused(client, stop_fd, deadline_mono_ns, why);
    return status;
}

/* --- reading ---------------------------------------------------------------------------------------------------------------- */

static int read_batch(struct opcua_client *client, const size_t *batch, UA_ReadValueId *values, size_t count, int stop_fd,
                      int64_t deadline_mono_ns, char why[200])
{
    UA_ReadRequest request = { .nodesToRead = values, .nodesToReadSize = count, .timestampsToReturn = UA_TIMESTAMPSTORETURN_BOTH };
    UA_ReadResponse response;
    int status =
        opcua_call(client,
                   &(struct opcua_exchange){ &request, &UA_TYPES[UA_TYPES_READREQUEST], &response, &UA_TYPES[UA_TYPES_READRESPONSE] },
                   stop_fd, deadline_mono_ns, why);
    if (status == 0 && response.resultsSize != count) {
        snprintf(why, 200, "the OPC UA server answered for only %zu of %zu nodes", response.resultsSize, count);
        status = -EPROTO;
    }
    for (size_t i = 0; status == 0 && i < count; i++)
        client->events->value(client->events->arg, batch[i], &response.results[i]);
    UA_ReadResponse_clear(&response);
    return status;
}

int opcua_client_read(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200])
{
    UA_ReadValueId *values = mem_array(client->max_reads, sizeof(*values));
    size_t *batch = mem_array(client->max_reads, sizeof(*batch));
    int status = 0;
    client->missed = false;
    for (size_t node = 0; node < client->nodes->count && status == 0;) {
        size_t count = 0;
        for (; node < client->nodes->count && count < client->max_reads; node++) {
            UA_ReadValueId_init(&values[count]);
            values[count].attributeId = UA_ATTRIBUTEID_VALUE;
            if (!client->refused[node] && node_id(client, node, &values[count].nodeId))
                batch[count++] = node;
        }
        if (count > 0)
            status = read_batch(client, batch, values, count, stop_fd, deadline_mono_ns, why);
        for (size_t i = 0; i < count; i++)
            UA_NodeId_clear(&values[i].nodeId);
    }
    mem_free(values);
    mem_free(batch);
    return status;
}
