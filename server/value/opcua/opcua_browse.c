/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the variables of an OPC UA server by following all hierarchical references. Visits each node once, because references may form
   cycles. */
#include "value/opcua/opcua_browse.h"

#include <errno.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "value/opcua/opcua_impl.h"

/* node ids in OPC UA's own namespace, which are the same on every server */
enum { OBJECTS_FOLDER = 85, HIERARCHICAL = 33, HAS_PROPERTY = 46 };
enum { MAX_NODES = 200000, MAX_DEPTH = 24, REFERENCES_AT_ONCE = 500 };

struct browse_step {
    UA_NodeId id;
    char *path;
    int depth;
    bool is_variable;
};

struct browse {
    struct opcua_client *client;
    void (*found)(void *arg, const struct opcua_variable *variable);
    void *arg;
    int stop_fd;
    int64_t deadline_mono_ns;
    struct browse_step *steps; /* all nodes found so far, in the order in which they are visited */
    size_t count, capacity;
    size_t *table; /* hash table of the nodes found so far, with open addressing: 1 + index in `steps`; 0: empty slot */
};

static size_t slot_of(const struct browse *browse, const UA_NodeId *id)
{
    size_t slot = UA_NodeId_hash(id) % (2 * MAX_NODES);
    while (browse->table[slot] && !UA_NodeId_equal(&browse->steps[browse->table[slot] - 1].id, id))
        slot = (slot + 1) % (2 * MAX_NODES);
    return slot;
}

static void see(struct browse *browse, const UA_NodeId *id, const char *path, int depth, bool is_variable)
{
    size_t slot = slot_of(browse, id);
    if (browse->table[slot] || browse->count == MAX_NODES || depth > MAX_DEPTH)
        return;
    mem_grow(&browse->steps, &browse->capacity, browse->count + 1, sizeof(*browse->steps));
    struct browse_step *step = &browse->steps[browse->count++];
    *step = (struct browse_step){ .path = mem_strdup(path), .depth = depth, .is_variable = is_variable };
    UA_NodeId_copy(id, &step->id);
    browse->table[slot] = browse->count;
}

static void see_all(struct browse *browse, size_t parent, const UA_BrowseResult *result)
{
    for (size_t i = 0; i < result->referencesSize; i++) {
        const UA_ReferenceDescription *to = &result->references[i];
        const struct browse_step *step = &browse->steps[parent];
        bool is_property = to->referenceTypeId.namespaceIndex == 0 && to->referenceTypeId.identifierType == UA_NODEIDTYPE_NUMERIC &&
                           to->referenceTypeId.identifier.numeric == HAS_PROPERTY;
        if (to->nodeId.serverIndex != 0 || to->nodeId.nodeId.namespaceIndex == 0 || is_property)
            continue;
        char *path = mem_printf("%s%s%.*s", step->path, *step->path ? "." : "", (int)to->browseName.name.length,
                                (const char *)to->browseName.name.data);
        see(browse, &to->nodeId.nodeId, path, step->depth + 1, to->nodeClass == UA_NODECLASS_VARIABLE);
        mem_free(path);
    }
}

/* Requests the remaining references of a node after a partial response; takes ownership of `point`, the continuation point. Returns 0 or
   a negative code. */
static int browse_rest(struct browse *browse, size_t parent, UA_ByteString point, char why[200])
{
    int status = 0;
    while (status == 0 && point.length > 0) {
        UA_BrowseNextRequest request = { .continuationPoints = &point, .continuationPointsSize = 1 };
        UA_BrowseNextResponse response;
        status = opcua_call(browse->client,
                            &(struct opcua_exchange){ &request, &UA_TYPES[UA_TYPES_BROWSENEXTREQUEST], &response,
                                                      &UA_TYPES[UA_TYPES_BROWSENEXTRESPONSE] },
                            browse->stop_fd, browse->deadline_mono_ns, why);
        UA_ByteString_clear(&point);
        if (status == 0 && response.resultsSize == 1) {
            see_all(browse, parent, &response.results[0]);
            point = response.results[0].continuationPoint;
            UA_ByteString_init(&response.results[0].continuationPoint);
        }
        UA_BrowseNextResponse_clear(&response);
    }
    UA_ByteString_clear(&point);
    return status;
}

static int browse_node(struct browse *browse, size_t at, char why[200])
{
    UA_BrowseDescription description = { .nodeId = browse->steps[at].id,
                                         .browseDirection = UA_BROWSEDIRECTION_FORWARD,
                                         .referenceTypeId = UA_NODEID_NUMERIC(0, HIERARCHICAL),
                                         .includeSubtypes = true,
                                         .nodeClassMask = UA_NODECLASS_OBJECT | UA_NODECLASS_VARIABLE,
                                         .resultMask = UA_BROWSERESULTMASK_ALL };
    UA_BrowseRequest request = { .nodesToBrowse = &description,
                                 .nodesToBrowseSize = 1,
                                 .requestedMaxReferencesPerNode = REFERENCES_AT_ONCE };
    UA_BrowseResponse response;
    UA_ByteString point = UA_BYTESTRING_NULL;
    int status =
        opcua_call(browse->client,
                   &(struct opcua_exchange){ &request, &UA_TYPES[UA_TYPES_BROWSEREQUEST], &response, &UA_TYPES[UA_TYPES_BROWSERESPONSE] },
                   browse->stop_fd, browse->deadline_mono_ns, why);
    if (status == 0 && response.resultsSize == 1) {
        see_all(browse, at, &response.results[0]);
        point = response.results[0].continuationPoint;
        UA_ByteString_init(&response.results[0].continuationPoint);
    }
    UA_BrowseResponse_clear(&response);
    return status ? status : browse_rest(browse, at, point, why);
}

/* Returns the address nsu=URI;s=NAME of a node, which the caller frees; NULL: its namespace has no URI. */
static char *address_of(const struct browse *browse, const UA_NodeId *id)
{
    UA_NodeId local = *id;
    UA_String printed = UA_STRING_NULL;
    if (id->namespaceIndex >= browse->client->namespace_count)
        return NULL;
    local.namespaceIndex = 0; /* namespace 0 makes UA_NodeId_print() print the identifier without a namespace */
    UA_NodeId_print(&local, &printed);
    struct text text = { 0 };
    text_add(&text, "nsu=");
    for (const char *at = browse->client->namespaces[id->namespaceIndex]; *at; at++)
        text_add(&text, *at == ';' || *at == '%' ? "%%%02X" : "%c", *at);
    text_add(&text, ";%.*s", (int)printed.length, (const char *)printed.data);
    UA_String_clear(&printed);
    char *address = mem_strdup(text.at);
    text_finish(&text);
    return address;
}

static bool is_number(const UA_Variant *value)
{
    UA_DataTypeKind kind = value->type ? (UA_DataTypeKind)value->type->typeKind : UA_DATATYPEKIND_STRING;
    return kind <= UA_DATATYPEKIND_DOUBLE || kind == UA_DATATYPEKIND_ENUM;
}

static int read_variable(struct browse *browse, size_t at, char why[200])
{
    const struct browse_step *step = &browse->steps[at];
    UA_ReadValueId values[2] = { { .nodeId = step->id, .attributeId = UA_ATTRIBUTEID_VALUE },
                                 { .nodeId = step->id, .attributeId = UA_ATTRIBUTEID_DESCRIPTION } };
    UA_ReadRequest request = { .nodesToRead = values, .nodesToReadSize = 2, .timestampsToReturn = UA_TIMESTAMPSTORETURN_NEITHER };
    UA_ReadResponse response;
    int status =
        opcua_call(browse->client,
                   &(struct opcua_exchange){ &request, &UA_TYPES[UA_TYPES_READREQUEST], &response, &UA_TYPES[UA_TYPES_READRESPONSE] },
                   browse->stop_fd, browse->deadline_mono_ns, why);
    bool is_one = status == 0 && response.resultsSize == 2 && is_number(&response.results[0].value);
    char *address = is_one ? address_of(browse, &step->id) : NULL;
    if (address) {
        const UA_Variant *value = &response.results[0].value, *text = &response.results[1].value;
        const UA_LocalizedText *said = UA_Variant_hasScalarType(text, &UA_TYPES[UA_TYPES_LOCALIZEDTEXT]) ? text->data : NULL;
        char *description = said ? mem_printf("%.*s", (int)said->text.length, (const char *)said->text.data) : mem_strdup("");
        const struct opcua_variable variable = { .path = step->path,
                                                 .address = address,
                                                 .description = description,
                                                 .is_bit = value->type->typeKind == UA_DATATYPEKIND_BOOLEAN,
                                                 .elements = UA_Variant_isScalar(value) ? 0 : value->arrayLength };
        if (UA_Variant_isScalar(value) || value->arrayLength > 0)
            browse->found(browse->arg, &variable);
        mem_free(description);
    }
    mem_free(address);
    UA_ReadResponse_clear(&response);
    return status;
}

int opcua_browse(struct opcua_client *client, void (*found)(void *arg, const struct opcua_variable *variable), void *arg, int stop_fd,
                 int64_t deadline_mono_ns, char why[200])
{
    struct browse browse = { .client = client, .found = found, .arg = arg, .stop_fd = stop_fd, .deadline_mono_ns = deadline_mono_ns };
    const UA_NodeId objects = UA_NODEID_NUMERIC(0, OBJECTS_FOLDER);
    browse.table = mem_array(2 * MAX_NODES, sizeof(*browse.table));
    see(&browse, &objects, "", 0, false);
    int status = opcua_read_namespaces(client, stop_fd, deadline_mono_ns, why);
    for (size_t i = 0; status == 0 && i < browse.count; i++) {
        status = browse_node(&browse, i, why);
        if (status == 0 && browse.steps[i].is_variable)
            status = read_variable(&browse, i, why);
    }
    if (status == 0 && browse.count == MAX_NODES) {
        snprintf(why, 200, "the OPC UA server has more than %d nodes; the list is incomplete", MAX_NODES);
        status = -E2BIG;
    }
    for (size_t i = 0; i < browse.count; i++) {
        UA_NodeId_clear(&browse.steps[i].id);
        mem_free(browse.steps[i].path);
    }
    mem_free(browse.steps);
    mem_free(browse.table);
    return status;
}
