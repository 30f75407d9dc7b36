/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens two connections to an OPC UA server. On the first one, without security, the server lists its endpoints. This code chooses an
   endpoint and checks its certificate before any of our data is sent over the second connection. */
#include "value/opcua/opcua_client.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netdb.h>
#include <stdarg.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "value/lookup.h"
#include "value/opcua/opcua_impl.h"

enum { TIMEOUT_MS = 5000, CLOSING_MS = 300, CHANNEL_MS = 3600000, SESSION_MS = 60000 };
/* limits on one message from the server: MESSAGE_BYTES: its size; CHUNKS: number of its chunks; BUFFER_BYTES: size of the
   connection's receive and send buffers, and so of a chunk */
enum { MESSAGE_BYTES = 2 << 20, CHUNKS = 512, BUFFER_BYTES = 65536 };
/* maximum number of attempts to list the server's endpoints; each attempt after the first follows a request that the server refused */
enum { DISCOVERIES = 3 };

/* --- library callbacks ------------------------------------------------------------------------------------------------------ */

/* Log callback of open62541. If the sequence numbers of notifications have a gap, the values in between are lost, but the
   library only logs this. That log line sets client->missed. */
static void on_log(void *arg, UA_LogLevel level, UA_LogCategory category, const char *format, va_list args)
{
    struct opcua_client *client = arg;
    (void)category;
    client->missed |= strstr(format, "subscription sequence number") != NULL;
    if (level >= UA_LOGLEVEL_ERROR)
        vsnprintf(client->said, sizeof(client->said), format, args);
}

static void on_silence(UA_Client *library)
{
    struct opcua_client *client = UA_Client_getContext(library);
    client->lost = true;
    snprintf(client->said, sizeof(client->said), "nothing received from the OPC UA server");
}

static void on_subscription_silence(UA_Client *library, UA_UInt32 subscription, void *context)
{
    (void)subscription, (void)context;
    on_silence(library);
}

/* Creates an open62541 client for one secure channel. Returns NULL with the reason in `why` on failure. */
static UA_Client *make_library(struct opcua_client *client, const UA_EndpointDescription *endpoint, bool with_session, char why[200])
{
    UA_ClientConfig config = { .clientContext = client, .logging = &client->logger, .timeout = TIMEOUT_MS,
                               .secureChannelLifeTime = CHANNEL_MS, .requestedSessionTimeout = SESSION_MS,
                               .outStandingPublishRequests = 4, .noSession = !with_session, .noNewSession = true,
                               .subscriptionInactivityCallback = on_subscription_silence,
                               .inactivityCallback = on_silence, .securityMode = endpoint->securityMode };
    config.localConnectionConfig = (UA_ConnectionConfig){ .recvBufferSize = BUFFER_BYTES, .sendBufferSize = BUFFER_BYTES,
                                                          .localMaxMessageSize = MESSAGE_BYTES, .localMaxChunkCount = CHUNKS };
    config.eventLoop = UA_EventLoop_new_POSIX(&client->logger);
    UA_ConnectionManager *tcp = UA_ConnectionManager_new_POSIX_TCP(UA_STRING("tcp"));
    config.eventLoop->registerEventSource(config.eventLoop, &tcp->eventSource);
    config.endpointUrl = UA_STRING_ALLOC(client->numeric_url);
    config.sessionName = UA_STRING_ALLOC("plantcast");
    config.clientDescription.applicationName = UA_LOCALIZEDTEXT_ALLOC("en", "Plantcast");
    config.clientDescription.productUri = UA_STRING_ALLOC("urn:plantcast");
    UA_EndpointDescription_copy(endpoint, &config.endpoint);
    bool good = opcua_security_apply(&client->security, with_session ? client->source->login : NULL, &config, why);
    UA_Client *made = good ? UA_Client_newWithConfig(&config) : NULL;
    if (!made)
        UA_ClientConfig_clear(&config);
    return made;
}

static void close_library(struct opcua_client *client)
{
    if (!client->library)
        return;
    client->call.response = NULL;
    UA_Client_getConfig(client->library)->timeout = CLOSING_MS;
    UA_Client_delete(client->library);
    client->library = NULL;
}

/* Opens a secure channel and, if with_session is true, a session in it. Returns 0 or a negative code with the reason in `why`. */
static int open_library(struct opcua_client *client, const UA_EndpointDescription *endpoint, bool with_session, int stop_fd,
                        int64_t deadline_mono_ns, char why[200])
{
    static const bool never;
    *client->said = 0;
    client->library = make_library(client, endpoint, with_session, why);
    if (!client->library)
        return -EINVAL;
    UA_StatusCode status = __UA_Client_connect(client->library, true);
    for (;;) {
        UA_SecureChannelState channel;
        UA_SessionState session;
        if (status != UA_STATUSCODE_GOOD) {
            opcua_explain(client, status, why);
            return -ECONNREFUSED;
        }
        UA_Client_getState(client->library, &channel, &session, &status);
        if (status == UA_STATUSCODE_GOOD && channel == UA_SECURECHANNELSTATE_OPEN &&
            (!with_session || session == UA_SESSIONSTATE_ACTIVATED))
            return 0;
        int64_t now_ns = clock_mono_ns(), slice_ns = now_ns + 20 * NS_PER_MS;
        int waited = opcua_wait(client, &never, stop_fd, slice_ns < deadline_mono_ns ? slice_ns : deadline_mono_ns, why);
        if (waited != -ETIMEDOUT || now_ns > deadline_mono_ns)
            return waited;
    }
}

/* --- choosing an endpoint --------------------------------------------------------------------------------------------------- */

static bool is_text(UA_String string, const char *text)
{
    return string.length == strlen(text) && memcmp(string.data, text, string.length) == 0;
}

static enum opcua_policy policy_of(const UA_EndpointDescription *endpoint)
{
    UA_MessageSecurityMode mode = endpoint->securityMode;
    for (enum opcua_policy policy = OPCUA_AES256; policy <= OPCUA_NONE; policy++)
        if (is_text(endpoint->securityPolicyUri, opcua_policy_uri(policy)) &&
            mode == (policy == OPCUA_NONE ? UA_MESSAGESECURITYMODE_NONE : UA_MESSAGESECURITYMODE_SIGNANDENCRYPT))
            return policy;
    return OPCUA_BEST; /* OPCUA_BEST: no policy that we support, or the endpoint does not both sign and encrypt */
}

static bool takes_us(const struct opcua_client *client, const UA_EndpointDescription *endpoint)
{
    const UA_UserTokenType wanted = client->source->login                             ? UA_USERTOKENTYPE_USERNAME
                                    : client->security.user_certificate.length > 0 ? UA_USERTOKENTYPE_CERTIFICATE
                                                                                    : UA_USERTOKENTYPE_ANONYMOUS;
    for (size_t i = 0; i < endpoint->userIdentityTokensSize; i++)
        if (endpoint->userIdentityTokens[i].tokenType == wanted)
            return true;
    return false;
}

/* Returns the endpoint with the best security that the configuration permits; NULL with the reason in `why` if there is none. */
static UA_EndpointDescription *choose(const struct opcua_client *client, UA_EndpointDescription *endpoints, size_t count, char why[200])
{
    static const char TCP[] = "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";
    enum opcua_policy wanted = client->source->opcua.policy;
    UA_EndpointDescription *best = NULL;
    bool any = false;
    for (size_t i = 0; i < count; i++) {
        enum opcua_policy policy = policy_of(&endpoints[i]);
        bool is_tcp = endpoints[i].transportProfileUri.length == 0 || is_text(endpoints[i].transportProfileUri, TCP);
        if (!is_tcp || policy == OPCUA_BEST || (wanted == OPCUA_BEST ? policy == OPCUA_NONE : policy != wanted))
            continue;
        any = true;
        if (takes_us(client, &endpoints[i]) && (!best || policy < policy_of(best)))
            best = &endpoints[i];
    }
    if (!best && any)
        snprintf(why, 200, "the OPC UA server does not accept %s",
                 client->source->login                          ? "user and password"
                 : client->security.user_certificate.length > 0 ? "user by certificate"
                                                                : "anonymous users");
    else if (!best)
        snprintf(why, 200, "none of the OPC UA server's %zu endpoints has %s", count,
                 wanted == OPCUA_NONE ? "security: none" : "an allowed security policy with SignAndEncrypt");
    return best;
}

static int take_endpoint(struct opcua_client *client, UA_GetEndpointsResponse *response, char why[200])
{
    UA_EndpointDescription *best = choose(client, response->endpoints, response->endpointsSize, why);
    if (!best)
        return -ENOENT;
    if (client->source->opcua.policy != OPCUA_NONE) {
        size_t length = best->serverCertificate.length;
        UA_StatusCode status = opcua_security_check(&client->security, &best->serverCertificate, why);
        if (status != UA_STATUSCODE_GOOD) {
            char text[200];
            snprintf(text, sizeof(text), "%s: %.140s", UA_StatusCode_name(status), why);
            memcpy(why, text, sizeof(text));
            best->serverCertificate.length = length;
            return -EACCES;
        }
    }
    UA_EndpointDescription_clear(&client->endpoint);
    UA_EndpointDescription_copy(best, &client->endpoint);
    return 0;
}

static int discover(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200])
{
    UA_GetEndpointsRequest request = { .endpointUrl = UA_STRING(client->url) };
    UA_GetEndpointsResponse response;
    UA_EndpointDescription open = { .endpointUrl = UA_STRING(client->url), .securityMode = UA_MESSAGESECURITYMODE_NONE,
                                    .securityPolicyUri = UA_STRING((char *)(uintptr_t)opcua_policy_uri(OPCUA_NONE)) };
    int status = -EAGAIN;
    for (int i = 0; i < DISCOVERIES && (status == -EAGAIN || status == -EPROTO); i++) {
        if (i == 0)
            status = open_library(client, &open, false, stop_fd, deadline_mono_ns, why);
        if (i > 0 || status == 0)
            status = opcua_call(client,
                                &(struct opcua_exchange){ &request, &UA_TYPES[UA_TYPES_GETENDPOINTSREQUEST], &response,
                                                          &UA_TYPES[UA_TYPES_GETENDPOINTSRESPONSE] },
                                stop_fd, deadline_mono_ns, why);
        else
            break;
        if (status == 0)
            status = take_endpoint(client, &response, why);
        UA_GetEndpointsResponse_clear(&response);
    }
    close_library(client);
    return status;
}

/* --- connecting ------------------------------------------------------------------------------------------------------------- */

/* Requests the list of endpoints at one IP address of the host. Returns 0 or a negative code. */
static int discover_at(struct opcua_client *client, const struct addrinfo *at, int stop_fd, int64_t deadline_mono_ns, char why[200])
{
    char address[INET6_ADDRSTRLEN + 20];
    bool is_6 = at->ai_family == AF_INET6;
    const char *path = client->source->opcua.path ? client->source->opcua.path : "";
    int status = getnameinfo(at->ai_addr, at->ai_addrlen, address, sizeof(address), NULL, 0, NI_NUMERICHOST);
    if (status != 0) {
        snprintf(why, 200, "an IP address of the host %.100s cannot be used: %.50s", client->host, gai_strerror(status));
        return -EHOSTUNREACH;
    }
    mem_free(client->numeric_url);
    client->numeric_url = mem_printf("opc.tcp://%s%s%s:%d%s%s", is_6 ? "[" : "", address, is_6 ? "]" : "", client->source->port,
                                     *path && *path != '/' ? "/" : "", path);
    return discover(client, stop_fd, deadline_mono_ns, why);
}

/* Requests the list of endpoints at each IP address of the host in turn; each gets an equal share of the remaining time. Resolves the
   host name itself, because open62541's call of the resolver cannot be interrupted. */
static int discover_somewhere(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200])
{
    const struct addrinfo *found;
    int left = 0;
    struct lookup *lookup = lookup_start(client->host, client->source->port);
    int status = lookup_wait(lookup, stop_fd, deadline_mono_ns, &found);
    if (status < 0 && status != -ECANCELED)
        snprintf(why, 200, "the host name %.100s cannot be resolved", client->host);
    for (const struct addrinfo *at = found; status == 0 && at; at = at->ai_next)
        left++;
    for (const struct addrinfo *at = found; left > 0; at = at->ai_next, left--) {
        int64_t now_ns = clock_mono_ns();
        status = discover_at(client, at, stop_fd, now_ns + (deadline_mono_ns - now_ns) / left, why);
        if (status == 0 || status == -ECANCELED || status == -EACCES)
            break;
    }
    lookup_destroy(&lookup);
    return status;
}

int opcua_client_connect(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200])
{
    int status = discover_somewhere(client, stop_fd, deadline_mono_ns, why);
    if (status == 0)
        status = open_library(client, &client->endpoint, true, stop_fd, deadline_mono_ns, why);
    if (status == 0) {
        UA_ClientConfig *config = UA_Client_getConfig(client->library);
        config->noReconnect = true; /* open62541 must not reconnect by itself, because a new client replaces a lost session */
        /* interval in milliseconds of the checks that detect a server that stopped answering, even if it rarely has new values */
        config->connectivityCheckInterval = TIMEOUT_MS;
        *client->said = 0;
    }
    return status;
}

int opcua_client_serve(struct opcua_client *client, int stop_fd, int64_t deadline_mono_ns, char why[200])
{
    int status = opcua_wait(client, &client->lost, stop_fd, deadline_mono_ns, why);
    if (status == 0) {
        snprintf(why, 200, "the OPC UA server ended the subscription (%.150s)", client->said);
        return -ECONNRESET;
    }
    UA_SessionState session;
    UA_Client_getState(client->library, NULL, &session, NULL);
    if (status == -ETIMEDOUT && session != UA_SESSIONSTATE_ACTIVATED) {
        snprintf(why, 200, "the session with the OPC UA server has ended%s%.150s", *client->said ? ": " : "", client->said);
        return -ECONNRESET;
    }
    return status == -ETIMEDOUT ? 0 : status;
}

struct opcua_client *opcua_client_create(const struct plant_source *source, int host, const struct opcua_nodes *nodes,
                                         const struct opcua_events *events, char why[200])
{
    struct opcua_client *client = mem_new(sizeof(*client));
    const char *path = source->opcua.path ? source->opcua.path : "";
    bool is_6 = strchr(source->hosts[host], ':');
    *client = (struct opcua_client){ .source = source, .host = source->hosts[host], .nodes = nodes, .events = events };
    client->logger = (UA_Logger){ .log = on_log, .context = client };
    client->url = mem_printf("opc.tcp://%s%s%s:%d%s%s", is_6 ? "[" : "", client->host, is_6 ? "]" : "", source->port,
                             *path && *path != '/' ? "/" : "", path);
    client->numbers = mem_array(nodes->count, sizeof(*client->numbers));
    client->refused = mem_array(nodes->count, sizeof(*client->refused));
    client->no_filter = mem_array(nodes->count, sizeof(*client->no_filter));
    client->refused_count = nodes->count;
    for (size_t i = 0; i < nodes->count; i++)
        client->refused[i] = true;
    if (!opcua_security_init(&client->security, &source->opcua, client->host, why))
        opcua_client_destroy(&client);
    return client;
}

void opcua_client_destroy(struct opcua_client **client_ptr)
{
    struct opcua_client *client = *client_ptr;
    *client_ptr = NULL;
    if (!client)
        return;
    client->lost = true;
    close_library(client);
    UA_EndpointDescription_clear(&client->endpoint);
    opcua_security_finish(&client->security);
    opcua_forget_namespaces(client);
    mem_free(client->numbers);
    mem_free(client->refused);
    mem_free(client->no_filter);
    mem_free(client->url);
    mem_free(client->numeric_url);
    mem_free(client);
}

bool opcua_client_missed(const struct opcua_client *client)
{
    return client->missed;
}

double opcua_client_publishing_ms(const struct opcua_client *client)
{
    return client->publishing_ms;
}

size_t opcua_client_refused(const struct opcua_client *client)
{
    return client->refused_count;
}
