/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signing in and out with OpenID Connect, and the answer of /api/v1/me. */
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/json_text.h"
#include "base/text/timestamp.h"
#include "message/names.h"
#include "net/connection.h"
#include "net/http/http_impl.h"

enum { COOKIE_S = 600 }; /* lifetime in seconds of the cookie for signing in: the identity provider's answer must arrive within this time */

static int answer_redirect(struct http_exchange *request, const char *to)
{
    return request_answer(request, HTTP_STATUS_SEE_OTHER, HTTP_TEXT, NULL, 0, "location:", to);
}

/* Sets a cookie. ending: suffix of the cookie's name: "" for the session's cookie; "-b" for the cookie of a browser that begins a log-in.
   The provider's redirect must send that cookie back, so it is not SameSite=Strict. seconds 0: removes the cookie. */
static void set_cookie(const struct openid_config *config, struct http_exchange *request, const char *ending, const char *value,
                       int seconds)
{
    mem_free(request->set_cookie);
    request->set_cookie = mem_printf("%s%s=%s; Path=/; Max-Age=%d; HttpOnly; SameSite=%s%s", config->cookie, ending, value, seconds,
                                     *ending ? "Lax" : "Strict", config->secure ? "; Secure" : "");
}

static const char NOT_HERE[] = "this server has no sign-in by OpenID Connect (it runs without --openid)\n";

int ask_login(struct server_context *server, struct http_exchange *request)
{
    struct message_error error = { 0 };
    struct args args;
    char binding[SIGN_IN_SECRET_CHARS + 1];
    const char *why;
    if (!server->logins.openid)
        return request_answer_text(request, HTTP_STATUS_NOT_FOUND, NOT_HERE);
    if (!request_args(request->wsi, &args, &error))
        return request_answer_error(request, &error);
    const struct openid_config *config = openid_config_of(server->logins.openid);
    const char *to = arg_of(&args, "to"), *home = strchr(strstr(config->url, "://") + 3, '/');
    char *url = openid_begin(server->logins.openid, connection_of(request->wsi)->client->address, to && sign_in_path_good(to) ? to : home,
                             clock_mono_ns(), binding, &why);
    if (!url)
        return request_answer_later(request, why);
    set_cookie(config, request, "-b", binding, COOKIE_S);
    int result = answer_redirect(request, url);
    mem_free(url);
    return result;
}

/* Refuses an identity provider's answer that belongs to no sign-in in progress. Counts the answer, but does not record it or
   hold it against the client's address. It cannot be a guess at a secret of 256 bits, and another site's page can make a user's
   browser send it. */
static int refuse_unasked(struct server_context *server, struct http_exchange *request, enum openid_finish why)
{
    server->logins.unasked++;
    return why == OPENID_FULL ? request_answer_later(request, "too many users are signing in at once; sign in again from the page\n")
                              : request_answer_text(request, HTTP_STATUS_FORBIDDEN,
                                                    "this browser has no sign-in in progress; sign in again from the page\n");
}

static int refuse_held(struct server_context *server, struct http_exchange *request)
{
    server->logins.held++;
    counter_inc(server->counters.logins_held, 1);
    return request_answer_text(request, 429, "too many failed log-ins from this client address; try again later\n");
}

int ask_login_callback(struct server_context *server, struct http_exchange *request)
{
    struct message_error error = { 0 };
    const struct connection *connection = connection_of(request->wsi);
    struct args args;
    char binding[64] = "", name[64];
    size_t size = sizeof(binding);
    if (!server->logins.openid)
        return request_answer_text(request, HTTP_STATUS_NOT_FOUND, NOT_HERE);
    if (login_throttle_begin(server->logins.throttle, connection->client->address, clock_mono_ns()) == LOGIN_HELD)
        return refuse_held(server, request);
    if (!request_args(request->wsi, &args, &error))
        return request_answer_error(request, &error);
    snprintf(name, sizeof(name), "%s-b", openid_config_of(server->logins.openid)->cookie);
    if (lws_http_cookie_get(request->wsi, name, binding, &size) != 0)
        binding[0] = 0;
    request_await(server, request);
    const struct openid_return brought = { .request = request->client,
                                           .state = arg_of(&args, "state"),
                                           .code = arg_of(&args, "code"),
                                           .iss = arg_of(&args, "iss"),
                                           .error = arg_of(&args, "error"),
                                           .binding = binding,
                                           .from = connection->address };
    enum openid_finish result = openid_finish(server->logins.openid, &brought, clock_mono_ns());
    if (result == OPENID_WAITS)
        return 0;
    request_forget(server, request);
    return refuse_unasked(server, request, result);
}

/* Adds failed log-ins to the metrics, including those whose browser no longer waits for the answer. */
static void count_refused(struct server_context *server, const struct openid_answer *answer)
{
    if (answer->result == OPENID_AWAY)
        server->logins.unasked++;
    if (answer->result != OPENID_GUESSED)
        return;
    counter_inc(server->counters.logins_wrong, 1);
    if (login_throttle_fail(server->logins.throttle, answer->address, clock_mono_ns()) == LOGIN_WRONG_SLOWS)
        log_warn(server->params.log,
                 "login by OpenID Connect: an address had too many failed sign-ins; it may try once every %d s until a minute passes "
                 "without a failure",
                 LOGIN_WAIT_S);
}

static void answer_sign_in(struct server_context *server, struct http_exchange *request, const struct openid_answer *answer)
{
    const struct openid_config *config = openid_config_of(server->logins.openid);
    request_forget(server, request);
    if (answer->result == OPENID_LET_IN) {
        set_cookie(config, request, "", answer->cookie, (int)(config->hours * 3600));
        request_answered(request, answer_redirect(request, answer->path));
        return;
    }
    char *text = mem_printf("you are not signed in: %s\n", answer->why);
    request_answered(request, request_answer_text(request, HTTP_STATUS_FORBIDDEN, text));
    mem_free(text);
}

void http_on_sign_ins(struct server_context *server)
{
    struct openid_answer *answer = server->logins.openid ? openid_collect(server->logins.openid) : NULL;
    if (server->logins.openid && openid_take_changed(server->logins.openid))
        streams_check_tokens(server, clock_utc_ns());
    for (struct openid_answer *next; answer; answer = next) {
        struct http_exchange *request = request_find(server, answer->request);
        next = answer->next;
        count_refused(server, answer);
        if (request)
            answer_sign_in(server, request, answer);
        openid_answer_free(answer);
    }
}

int ask_logout(struct server_context *server, struct http_exchange *request)
{
    char cookie[64];
    size_t size = sizeof(cookie);
    if (!connection_origin_allowed(server, request->wsi))
        return request_refuse_foreign(server, request, LOGOUT_PATH);
    if (!server->logins.openid)
        return request_answer_text(request, HTTP_STATUS_NOT_FOUND, NOT_HERE);
    const struct openid_config *config = openid_config_of(server->logins.openid);
    bool has_cookie = lws_http_cookie_get(request->wsi, config->cookie, cookie, &size) == 0;
    char *url = has_cookie ? openid_end(server->logins.openid, cookie, connection_of(request->wsi)->address) : NULL;
    streams_check_tokens(server, clock_utc_ns());
    set_cookie(config, request, "", "", 0);
    int result = request_answer_json(request, json_text(json_pack("{s:s?}", "provider", url), 0));
    mem_free(url);
    return result;
}

int api_me(struct server_context *server, struct http_exchange *request)
{
    const struct connection *connection = connection_of(request->wsi);
    const struct token_holder *holder = &connection->holder;
    char until[TIMESTAMP_BYTES] = "";
    bool has_end = holder->role != ROLE_NOBODY && holder->until_utc_ns < INT64_MAX;
    if (has_end)
        timestamp_print(holder->until_utc_ns / 1000, until);
    json_t *said =
        json_pack("{s:s?,s:s,s:b,s:s?,s:s?,s:s?}", "name", holder->name[0] ? holder->name : NULL, "role",
                  name_of(names_role, (int)connection->role), "signed_in", holder->signed_in, "until", has_end ? until : NULL, "sign_in",
                  server->logins.openid ? openid_config_of(server->logins.openid)->label : NULL, "notice", server->logins.notice);
    return request_answer_json(request, json_text(said, 0));
}
