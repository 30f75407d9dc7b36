/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Determines the identity of the client at the other end of a connection. */
#include "net/connection.h"

#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "message/names.h"
#include "net/tls.h"

static const char LOCAL[] = "local";            /* name that journals show for a user on this machine who needs no token */
static const char SIGNED_IN[] = " (signed in)"; /* suffix of the name of a user who signed in with OpenID Connect, if a token has
                                                   the same name */

static const struct http_refusal NO_HOST = { 400, "HTTP/1.1 requires the header Host\n", REFUSAL_NONE };
static const struct http_refusal WRONG_HOST = { 403, "this server does not accept the name in the Host header; --host NAME allows it\n",
                                                REFUSAL_NONE };
static const struct http_refusal LOCAL_ONLY = { 403, "this server accepts only localhost, 127.0.0.1 and [::1] as host\n", REFUSAL_NONE };
static const struct http_refusal PROXY = { 403, "the request came through a proxy; start the server with --behind-proxy to allow this\n",
                                           REFUSAL_NONE };
static const struct http_refusal IN_QUERY = { 400,
                                              "do not put a token into a URL, where logs and histories keep it: send it as "
                                              "Authorization: Bearer, in the subprotocol list, or in hello\n",
                                              REFUSAL_NONE };
static const struct http_refusal BAD_TOKEN = { 401, .code = REFUSAL_TOKEN_UNKNOWN };
static const struct http_refusal HELD = { 429, .code = REFUSAL_TOKEN_GUESSES };
static const struct http_refusal TOO_LONG = { 431,
                                              "the header Authorization, Sec-WebSocket-Protocol or X-Forwarded-For has more "
                                              "than 511 bytes\n",
                                              REFUSAL_NONE };
static const struct http_refusal TOO_MANY = { 503, .code = REFUSAL_CONNECTIONS };

/* --- connections ------------------------------------------------------------------------------------------------------ */

static bool count_refusal(struct server_context *server, bool good)
{
    if (!good)
        counter_inc(server->counters.refused, 1);
    return good;
}

bool connection_may_open(struct server_context *server, int fd)
{
    char address[64] = "";
    if (server->room.connections >= server->room.quotas->at[QUOTA_CONNECTIONS])
        return count_refusal(server, false);
    lws_get_peer_simple_fd(fd, address, sizeof(address));
    /* a proxy may open any number of connections, since all come from its address; sessions are limited later, by the address that the
       proxy forwards */
    if (access_is_proxy(&server->params.access, address))
        return true;
    struct address_usage *usage = address_limits_ref(server->room.addresses, address);
    bool good = address_limits_may_connect(server->room.addresses, usage);
    address_limits_unref(server->room.addresses, &usage);
    return count_refusal(server, good);
}

void connection_open(struct server_context *server, struct lws *wsi)
{
    char address[64] = "";
    struct connection *connection = mem_new(sizeof(*connection));
    lws_get_peer_simple(wsi, address, sizeof(address));
    connection->usage = address_limits_ref(server->room.addresses, address);
    connection->usage->connections++;
    server->room.connections++;
    server->room.unanswered++;
    lws_set_opaque_user_data(wsi, connection);
}

static void leave_client(struct server_context *server, struct connection *connection)
{
    if (connection->client)
        connection->client->named--;
    address_limits_unref(server->room.addresses, &connection->client);
}

void connection_close(struct server_context *server, struct lws *wsi)
{
    struct connection *connection = connection_of(wsi);
    if (!connection)
        return;
    connection->usage->connections--;
    server->room.connections--;
    server->room.unanswered -= !connection->answered;
    leave_client(server, connection);
    address_limits_unref(server->room.addresses, &connection->usage);
    mem_free(connection);
    lws_set_opaque_user_data(wsi, NULL);
}

void connection_set_answered(struct server_context *server, struct lws *wsi, bool answered)
{
    struct connection *connection = connection_of(wsi);
    server->room.unanswered += connection->answered - answered;
    connection->answered = answered;
}

struct connection *connection_of(struct lws *wsi)
{
    return lws_get_opaque_user_data(wsi);
}

/* --- requests --------------------------------------------------------------------------------------------------------- */

bool connection_header(struct lws *wsi, enum lws_token_indexes token, char *out, int size)
{
    out[0] = 0;
    return lws_hdr_total_length(wsi, token) == 0 || lws_hdr_copy(wsi, out, size, token) >= 0;
}

bool connection_origin_allowed(const struct server_context *server, struct lws *wsi)
{
    char origin[256], host[256];
    return connection_header(wsi, WSI_TOKEN_ORIGIN, origin, sizeof(origin)) && connection_header(wsi, WSI_TOKEN_HOST, host, sizeof(host)) &&
           access_origin(&server->params.access, origin, host, server->tls != NULL);
}

void connection_learn_host_name(struct server_context *server)
{
    char name[sizeof(server->machine)] = "";
    if (gethostname(name, sizeof(name) - 1) != 0 || !access_host_name(name, server->machine, sizeof(server->machine)))
        server->machine[0] = 0;
}

static bool is_named(const struct access_params *params, const char *name)
{
    for (int i = 0; i < params->host_count; i++)
        if (!strcasecmp(params->hosts[i], name))
            return true;
    return false;
}

/* Returns whether the Host header names this server. Refuses a web page of another domain whose DNS name was made to point here
   (DNS rebinding). Numeric addresses are accepted, because they cannot be rebound. */
static bool is_ours(const struct server_context *server, const char *name)
{
    const struct access_params *params = &server->params.access;
    if (access_name_is_local(name) || is_named(params, name))
        return true;
    if (server->local_only || params->behind_proxy)
        return false;
    return access_name_is_address(name) || (server->machine[0] && !strcmp(name, server->machine)) ||
           (server->tls && tls_is_called(server->tls, name));
}

/* Returns whether the request has headers that proxies add. Looks for `known` headers with the function for headers that
   libwebsockets parses itself, and for `custom` ones with the function for all other headers, which does not find the parsed
   ones. */
static bool has_forwarding(struct lws *wsi)
{
    static const enum lws_token_indexes known[] = { WSI_TOKEN_X_FORWARDED_FOR, WSI_TOKEN_HTTP_X_REAL_IP, WSI_TOKEN_HTTP_VIA };
    static const char *const custom[] = { "forwarded:", "x-forwarded-host:", "x-forwarded-proto:" };
    for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++)
        if (lws_hdr_total_length(wsi, known[i]) > 0)
            return true;
    for (size_t i = 0; i < sizeof(custom) / sizeof(custom[0]); i++)
        if (lws_hdr_custom_length(wsi, custom[i], (int)strlen(custom[i])) >= 0)
            return true;
    return false;
}

/* Finds the address of the client. Behind a trusted proxy, that is the address that the proxy forwards in a header. Returns false with
   *refusal set. */
static bool find_client(struct server_context *server, struct lws *wsi, struct connection *connection, struct http_refusal *refusal)
{
    char list[512] = "", *address = connection->address;
    lws_get_peer_simple(wsi, address, sizeof(connection->address));
    bool proxied = access_is_proxy(&server->params.access, address);
    leave_client(server, connection);
    if (proxied && !connection_header(wsi, WSI_TOKEN_X_FORWARDED_FOR, list, sizeof(list)))
        *refusal = TOO_LONG;
    connection->from_proxy = proxied;
    connection->forwarded = proxied && lws_hdr_total_length(wsi, WSI_TOKEN_X_FORWARDED_FOR) > 0;
    if (list[0] && !access_forwarded(&server->params.access, list, address, sizeof(connection->address)))
        lws_get_peer_simple(wsi, address, sizeof(connection->address));
    connection->client = address_limits_ref(server->room.addresses, address);
    if (proxied && !refusal->status && !address_limits_may_be_named(server->room.addresses, connection->client))
        *refusal = TOO_MANY;
    connection->client->named++;
    return !refusal->status;
}

static bool has_token_in_query(struct lws *wsi)
{
    char argument[4096]; /* room for one header: larger than all headers together that libwebsockets keeps of a request */
    for (int i = 0; lws_hdr_copy_fragment(wsi, argument, sizeof(argument), WSI_TOKEN_HTTP_URI_ARGS, i) >= 0; i++)
        if (access_argument_is_token(argument))
            return true;
    return false;
}

/* Finds the access token of the request; `token` becomes "" if the request has none. Returns false if a header is too long. */
static bool find_token(struct lws *wsi, char token[TOKEN_MAX_CHARS + 1])
{
    char text[512];
    token[0] = 0;
    if (!connection_header(wsi, WSI_TOKEN_HTTP_AUTHORIZATION, text, sizeof(text)))
        return false;
    if (!strncasecmp(text, "Bearer ", 7) && strlen(text) - 7 <= TOKEN_MAX_CHARS) {
        strcpy(token, text + 7);
        return true;
    }
    if (!connection_header(wsi, WSI_TOKEN_PROTOCOL, text, sizeof(text)))
        return false;
    access_list_rest(text, "Authorization-Bearer.", token, TOKEN_MAX_CHARS + 1);
    return true;
}

const char *connection_who(const struct connection *connection)
{
    return connection->holder.name[0] ? connection->holder.name : LOCAL;
}

void connection_record(const struct server_context *server, struct lws *wsi, const char *event, const char *result, const char *path,
                       const char *why)
{
    const struct connection *connection = connection_of(wsi);
    if (connection->role <= ROLE_OPEN && !connection->holder.name[0])
        return;
    audit_say(server->params.audit, &(struct audit_entry){ .event = event,
                                                           .result = result,
                                                           .who = connection_who(connection),
                                                           .role = name_of(names_role, (int)connection->role),
                                                           .from = connection->address,
                                                           .how = "HTTP",
                                                           .what = path,
                                                           .why = why });
}

void connection_record_refusal(const struct server_context *server, struct lws *wsi, const char *path, const char *why)
{
    connection_record(server, wsi, "access", "refused", path, why);
}

/* Records a login in the audit trail. Tokens left unchecked because the address is throttled are only counted, so that
   thousands of attempts do not fill the trail. */
static void record_login(struct server_context *server, const struct connection *connection, const char *way,
                         const struct token_holder *holder, enum login login)
{
    bool good = login_is_good(login), known = holder->role != ROLE_NOBODY;
    if (login == LOGIN_HELD)
        server->logins.held++;
    if (login == LOGIN_HELD || login == LOGIN_GOOD)
        return;
    audit_say(server->params.audit,
              &(struct audit_entry){ .event = "login",
                                     .result = good ? "done" : "refused",
                                     .who = holder->name[0] ? holder->name
                                            : good          ? LOCAL
                                                            : NULL,
                                     .role = known ? name_of(names_role, (int)holder->role) : NULL,
                                     .from = connection->address,
                                     .how = way,
                                     .why = good                         ? NULL
                                            : known                      ? "the token has expired"
                                            : login == LOGIN_WRONG_SLOWS ? "unknown token; further tokens from this address are delayed"
                                                                         : "unknown token" });
}

void connection_log_login(struct server_context *server, struct lws *wsi, const char *way, const struct token_holder *holder,
                          enum login login)
{
    const struct connection *connection = connection_of(wsi);
    struct log *log = server->params.log;
    bool known = holder->role != ROLE_NOBODY;
    const char *role = known ? name_of(names_role, (int)holder->role) : "none", *name = holder->name[0] ? holder->name : "(none)";
    int failures = login_throttle_failures(server->logins.throttle, connection->client->address, clock_mono_ns());
    record_login(server, connection, way, holder, login);
    if (login == LOGIN_NONE || login == LOGIN_GOOD_NEW)
        log_info(log, "login from %s by %s: token %s, role %s: accepted", connection->address, way, name, role);
    if (login == LOGIN_HELD)
        counter_inc(server->counters.logins_held, 1);
    if (login != LOGIN_WRONG && login != LOGIN_WRONG_SLOWS)
        return;
    counter_inc(server->counters.logins_wrong, 1);
    log_event(log, LOG_WARN, EVENT_LOGIN_REFUSED, "login from %s by %s: token %s, role %s: refused, %s (%d refused within a minute)",
              connection->address, way, known ? holder->name : "(unknown)", role, known ? "the token has expired" : "the token is unknown",
              failures);
    if (login == LOGIN_WRONG_SLOWS)
        log_warn(log,
                 "login from %s: too many wrong tokens; only one attempt every %d s is accepted until a minute passes without a "
                 "wrong token",
                 connection->address, LOGIN_WAIT_S);
}

/* Checks a token. Returns NULL and sets connection->holder if the token is accepted; otherwise the refusal to send. */
static const struct http_refusal *judge_token(struct server_context *server, struct lws *wsi, const char *token)
{
    struct connection *connection = connection_of(wsi);
    struct token_holder holder;
    bool good = tokens_find(server->logins.tokens, token, clock_utc_ns(), &holder);
    /* true: the request opens a stream; the audit trail records its accepted token later, when the stream sends `hello` */
    bool stream = lws_hdr_total_length(wsi, WSI_TOKEN_UPGRADE) > 0;
    enum login login =
        login_throttle_judge(server->logins.throttle, connection->client->address, good ? holder.hash : NULL, clock_mono_ns());
    if (!stream || !login_is_good(login))
        connection_log_login(server, wsi, stream ? "stream" : "HTTP", &holder, login);
    if (login_is_good(login))
        connection->holder = holder;
    return login_is_good(login) ? NULL : login == LOGIN_HELD ? &HELD : &BAD_TOKEN;
}

/* Appends a suffix to a signed-in user's name. Token names cannot contain the suffix's characters, so journals show whether a
   user signed in or used a token. */
void connection_tell_apart(const struct server_context *server, struct token_holder *person)
{
    size_t length = strlen(person->name), most = sizeof(person->name) - sizeof(SIGNED_IN);
    if (!strcasecmp(person->name, LOCAL) || (server->logins.tokens && tokens_has_name(server->logins.tokens, person->name)))
        memcpy(person->name + (length < most ? length : most), SIGNED_IN, sizeof(SIGNED_IN));
}

/* Sets connection->holder to the signed-in user whose cookie the request has. Ignores cookies of ended sessions. */
static void find_person(struct server_context *server, struct lws *wsi, struct connection *connection)
{
    char cookie[64];
    size_t size = sizeof(cookie);
    if (server->logins.openid && lws_http_cookie_get(wsi, openid_config_of(server->logins.openid)->cookie, cookie, &size) == 0 &&
        openid_find(server->logins.openid, cookie, &connection->holder))
        connection_tell_apart(server, &connection->holder);
}

/* Returns whether the client needs no token: it is on this machine and uses a local host name, and either no tokens are configured or
   --trust-local is set. */
static bool is_trusted(const struct server_context *server, const struct connection *connection, const char *name)
{
    const struct access_params *params = &server->params.access;
    if (!connection->usage->local || params->behind_proxy || (server->logins.tokens && !params->trust_local))
        return false;
    return !name[0] || access_name_is_local(name) || (params->trust_local && is_named(params, name));
}

static bool is_http_1_0(struct lws *wsi)
{
    char version[16];
    return connection_header(wsi, WSI_TOKEN_HTTP, version, sizeof(version)) && !strcmp(version, "HTTP/1.0");
}

bool connection_identify(struct server_context *server, struct lws *wsi, struct http_refusal *refusal)
{
    const struct access_params *params = &server->params.access;
    struct connection *connection = connection_of(wsi);
    char host[256], name[256] = "", *token = connection->token;
    bool has_host = lws_hdr_total_length(wsi, WSI_TOKEN_HOST) > 0;
    const struct http_refusal *bad_token;
    *refusal = (struct http_refusal){ 0 };
    connection->holder = (struct token_holder){ 0 };
    connection->role = ROLE_NOBODY;
    if (!find_client(server, wsi, connection, refusal))
        return false;
    if (!has_host && !is_http_1_0(wsi))
        *refusal = NO_HOST;
    else if (has_host && (!connection_header(wsi, WSI_TOKEN_HOST, host, sizeof(host)) || !access_host_name(host, name, sizeof(name)) ||
                          !is_ours(server, name)))
        *refusal = server->local_only ? LOCAL_ONLY : WRONG_HOST;
    else if (connection->usage->local && !params->behind_proxy && has_forwarding(wsi))
        *refusal = PROXY;
    else if (has_token_in_query(wsi))
        *refusal = IN_QUERY;
    else if (!find_token(wsi, token))
        *refusal = TOO_LONG;
    else if (token[0] && server->logins.tokens && (bad_token = judge_token(server, wsi, token)))
        *refusal = *bad_token;
    if (refusal->status)
        return false;
    if (!token[0])
        find_person(server, wsi, connection);
    if (connection->holder.role != ROLE_NOBODY)
        connection->role = tokens_role_of(&connection->holder);
    else if (is_trusted(server, connection, name))
        connection->role = ROLE_ENGINEER;
    else if (params->open_viewers)
        connection->role = ROLE_OPEN;
    return true;
}
