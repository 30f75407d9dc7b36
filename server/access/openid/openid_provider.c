/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests and caches the identity provider's data: its endpoints, its keys, and its claims about a user. */
#include <stdio.h>
#include <string.h>

#include "access/openid/openid_http.h"
#include "access/openid/openid_impl.h"
#include "base/clock.h"
#include "base/mem.h"

static const int64_t MAX_AGE_NS = 3600 * NS_PER_S, RETRY_NS = 5 * NS_PER_S;
/* Minimum time between two requests for the provider's keys. Without this limit, tokens that name unknown keys could trigger
   any number of requests. */
static const int64_t KEYS_INTERVAL_NS = 10 * NS_PER_S;

void openid_say(struct openid *openid, const char *why)
{
    bool was_failing = atomic_exchange(&openid->failing, why != NULL);
    if (why && !was_failing)
        log_event(openid->params.log, LOG_ERROR, EVENT_OPENID_FAILS,
                  "openid: %s: %s; users cannot sign in by OpenID Connect; signed-in users stay signed in", openid->config->issuer, why);
    else if (!why && was_failing)
        log_info(openid->params.log, "openid: %s answers again", openid->config->issuer);
    counter_set(openid->good, !why);
}

char *openid_endpoint(struct openid *openid, const char *name)
{
    pthread_mutex_lock(&openid->lock);
    const char *url = json_string_value(json_object_get(openid->metadata, name));
    char *copy = url ? mem_strdup(url) : NULL;
    pthread_mutex_unlock(&openid->lock);
    return copy;
}

static const char *fault_of(const struct openid_config *config, const struct openid_reply *reply)
{
    const char *issuer = json_string_value(json_object_get(reply->json, "issuer"));
    if (reply->status != 200 || !json_is_object(reply->json))
        return "the provider's configuration (/.well-known/openid-configuration) cannot be read";
    if (!issuer || strcmp(issuer, config->issuer) != 0)
        return "the provider's configuration (/.well-known/openid-configuration) names another issuer";
    for (size_t i = 0; i < 3; i++)
        if (!json_is_string(json_object_get(reply->json, (const char *[]){ "authorization_endpoint", "token_endpoint", "jwks_uri" }[i])))
            return "the provider's configuration (/.well-known/openid-configuration) lacks an endpoint";
    return NULL;
}

static bool ask_metadata(struct openid *openid)
{
    struct openid_reply reply;
    size_t length = strlen(openid->config->issuer);
    bool slash = openid->config->issuer[length - 1] == '/';
    char *url = mem_printf("%.*s/.well-known/openid-configuration", (int)(length - slash), openid->config->issuer);
    openid->discovered_ns = clock_mono_ns();
    bool answered = openid_get(openid->config, url, NULL, &openid->stopping, &reply);
    const char *why = answered ? fault_of(openid->config, &reply) : reply.why;
    if (why)
        openid_say(openid, why);
    pthread_mutex_lock(&openid->lock);
    if (!why) {
        json_decref(openid->metadata);
        openid->metadata = json_incref(reply.json);
    }
    pthread_mutex_unlock(&openid->lock);
    openid_reply_finish(&reply);
    mem_free(url);
    return !why;
}

static bool ask_keys(struct openid *openid)
{
    struct openid_reply reply;
    char *url = openid_endpoint(openid, "jwks_uri");
    openid->jwks_ns = clock_mono_ns();
    bool good = openid_get(openid->config, url, NULL, &openid->stopping, &reply) && reply.status == 200 &&
                json_is_array(json_object_get(reply.json, "keys"));
    pthread_mutex_lock(&openid->lock);
    if (good) {
        json_decref(openid->jwks);
        openid->jwks = json_incref(reply.json);
    }
    pthread_mutex_unlock(&openid->lock);
    openid_say(openid, good ? NULL : reply.why[0] ? reply.why : "its signing keys are missing");
    openid_reply_finish(&reply);
    mem_free(url);
    return good;
}

static bool is_due(int64_t asked_ns, bool known)
{
    return asked_ns == 0 || clock_mono_ns() - asked_ns > (known ? MAX_AGE_NS : RETRY_NS);
}

bool openid_knows(struct openid *openid)
{
    pthread_mutex_lock(&openid->lock);
    bool known = openid->metadata && openid->jwks;
    pthread_mutex_unlock(&openid->lock);
    return known;
}

bool openid_discover(struct openid *openid)
{
    pthread_mutex_lock(&openid->asking);
    if (is_due(openid->discovered_ns, openid->metadata != NULL))
        ask_metadata(openid);
    if (openid->metadata && is_due(openid->jwks_ns, openid->jwks != NULL))
        ask_keys(openid);
    pthread_mutex_unlock(&openid->asking);
    return openid_knows(openid);
}

static json_t *take_keys(struct openid *openid)
{
    pthread_mutex_lock(&openid->lock);
    json_t *keys = json_incref(openid->jwks);
    pthread_mutex_unlock(&openid->lock);
    return keys;
}

/* Requests the provider's keys, unless this was done within the last KEYS_INTERVAL_NS or another thread has already replaced
   `keys`. Returns false if no keys newer than `keys` are available. */
static bool renew_keys(struct openid *openid, const json_t *keys)
{
    pthread_mutex_lock(&openid->asking);
    bool renewed = openid->jwks != keys; /* true: another thread has already fetched new keys, so no request is needed */
    if (!renewed && clock_mono_ns() - openid->jwks_ns > KEYS_INTERVAL_NS)
        renewed = ask_keys(openid);
    pthread_mutex_unlock(&openid->asking);
    return renewed;
}

json_t *openid_verify(struct openid *openid, const char *token, const char *nonce, const char *sub, bool *unsure, const char **why)
{
    json_t *keys = take_keys(openid), *claims;
    struct id_token_expected expected = {
        .config = openid->config, .jwks = keys, .nonce = nonce, .sub = sub, .now_s = clock_utc_ns() / NS_PER_S
    };
    enum id_token_fault fault = id_token_verify(token, &expected, &claims, why);
    *unsure = fault == ID_TOKEN_NO_KEY && !renew_keys(openid, keys);
    if (fault == ID_TOKEN_NO_KEY && !*unsure) {
        json_decref(keys);
        expected.jwks = keys = take_keys(openid);
        id_token_verify(token, &expected, &claims, why);
    }
    json_decref(keys);
    return claims;
}

bool openid_complete(struct openid *openid, json_t *claims, const char *access_token, bool *told)
{
    char *url = openid_endpoint(openid, "userinfo_endpoint"), name[TOKEN_NAME_BYTES];
    struct openid_reply reply = { .status = 200 };
    bool lacks = !id_token_has_groups(openid->config, claims) || !json_object_get(claims, openid->config->name_claim) ||
                 !id_token_name(openid->config, claims, name, sizeof(name));
    bool asks = url && access_token && lacks;
    /* if the provider is not asked, the claims are complete only if they come from an ID token, which always has the claim
       `iss`; the provider may answer a token refresh without an ID token */
    *told = !asks && json_object_get(claims, "iss");
    if (asks && openid_get(openid->config, url, access_token, &openid->stopping, &reply) && reply.status == 200) {
        const char *sub = json_string_value(json_object_get(claims, "sub")), *its = json_string_value(json_object_get(reply.json, "sub"));
        *told = sub && its && !strcmp(sub, its);
        if (*told)
            json_object_update_missing(claims, reply.json);
    }
    bool refused = reply.status == 401 || reply.status == 403;
    openid_reply_finish(&reply);
    mem_free(url);
    return !refused;
}
