/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exchanges authorization codes and refresh tokens at the provider, and derives a user's rights from the answers. */
#include <stdio.h>
#include <string.h>

#include "access/openid/openid_http.h"
#include "access/openid/openid_impl.h"
#include "base/clock.h"
#include "base/mem.h"
#include "base/text/json_text.h"
#include "base/text/text.h"

static void replace(char **text, const char *by)
{
    if (!by)
        return;
    if (*text)
        explicit_bzero(*text, strlen(*text));
    mem_free(*text);
    *text = mem_strdup(by);
}

/* Returns true if the client secret must be sent as a form field, because the provider's authentication methods do not include
   HTTP Basic. */
static bool secret_in_form(struct openid *openid)
{
    pthread_mutex_lock(&openid->lock);
    const json_t *ways = json_object_get(openid->metadata, "token_endpoint_auth_methods_supported");
    bool basic = !json_is_array(ways);
    for (size_t i = 0; i < json_array_size(ways); i++) {
        const char *way = json_string_value(json_array_get(ways, i));
        basic |= way && !strcmp(way, "client_secret_basic");
    }
    pthread_mutex_unlock(&openid->lock);
    return !basic;
}

static bool post(struct openid *openid, const char *endpoint, const struct text *form, struct openid_reply *reply)
{
    char *url = openid_endpoint(openid, endpoint);
    *reply = (struct openid_reply){ .why = "the identity provider's configuration lacks the address for this request" };
    bool answered = url && openid_post(openid->config, url, form->at, secret_in_form(openid), &openid->stopping, reply);
    mem_free(url);
    return answered;
}

static void keep_tokens(struct person *person, const json_t *json)
{
    json_int_t seconds = json_integer_value(json_object_get(json, "expires_in"));
    replace(&person->refresh_token, json_member_text(json, "refresh_token"));
    replace(&person->access_token, json_member_text(json, "access_token"));
    replace(&person->id_token, json_member_text(json, "id_token"));
    person->access_until_s = seconds > 0 ? clock_utc_ns() / NS_PER_S + seconds : 0;
}

/* --- redeeming a code --------------------------------------------------------------------------------------------------------- */

/* Creates the record of a signed-in user from valid claims. Returns NULL with *why (mem_free) if the claims grant no role or
   contain no usable name. */
static struct person *make_person(struct openid *openid, json_t *claims, const json_t *tokens, char **why)
{
    struct token_holder holder = { .signed_in = true, .until_utc_ns = clock_utc_ns() + (int64_t)(openid->config->hours * 3600e9) };
    bool told;
    openid_complete(openid, claims, json_member_text(tokens, "access_token"), &told);
    if (!id_token_name(openid->config, claims, holder.name, sizeof(holder.name))) {
        *why = mem_strdup("the ID token has no user name that can be displayed; check name_claim in the --openid file");
        return NULL;
    }
    holder.role = id_token_role(openid->config, claims);
    if (holder.role == ROLE_NOBODY) {
        char *groups = id_token_groups_text(openid->config, claims);
        *why =
            mem_printf("user %s: none of the user's groups has a role (groups: %s); check roles in the --openid file", holder.name, groups);
        mem_free(groups);
        return NULL;
    }
    struct person *person = mem_new(sizeof(*person));
    person->holder = holder;
    person->sub = mem_strdup(json_member_text(claims, "sub"));
    keep_tokens(person, tokens);
    return person;
}

static struct person *take_tokens(struct openid *openid, const struct openid_job *job, const json_t *tokens, char **why)
{
    const char *id_token = json_member_text(tokens, "id_token"), *fault = "the identity provider sent no ID token";
    bool unsure;
    json_t *claims = id_token ? openid_verify(openid, id_token, job->sign_in.nonce, NULL, &unsure, &fault) : NULL;
    struct person *person = claims ? make_person(openid, claims, tokens, why) : NULL;
    if (!claims)
        *why = mem_printf("the ID token is not accepted: %s", fault);
    json_decref(claims);
    return person;
}

/* Classifies a failed exchange of an authorization code. Only invalid_grant means that the code is wrong (RFC 6749, 5.2):
   OPENID_GUESSED. Every other error is between the provider and this server, not the user's fault: the client secret has
   expired, or the provider is busy. */
static enum openid_result judge_code(const struct openid_reply *reply, const char *error)
{
    if (reply->status == 200)
        return OPENID_REFUSED;
    return reply->status < 500 && error && !strcmp(error, "invalid_grant") ? OPENID_GUESSED : OPENID_AWAY;
}

struct person *openid_redeem(struct openid *openid, const struct openid_job *job, enum openid_result *result, char **why)
{
    struct text form = { 0 };
    struct openid_reply reply;
    struct person *person = NULL;
    openid_add_argument(&form, "grant_type", "authorization_code");
    openid_add_argument(&form, "code", job->code);
    openid_add_argument(&form, "redirect_uri", openid->config->redirect_uri);
    openid_add_argument(&form, "code_verifier", job->sign_in.verifier);
    bool answered = post(openid, "token_endpoint", &form, &reply);
    const char *error = json_member_text(reply.json, "error");
    *result = answered ? judge_code(&reply, error) : OPENID_AWAY;
    if (!answered)
        *why = mem_printf("the identity provider does not answer: %s", reply.why);
    else if (reply.status != 200)
        *why = mem_printf("the identity provider refuses %s: %.80s (HTTP status %d)",
                          *result == OPENID_GUESSED ? "the code" : "the request", error ? error : "no reason given", reply.status);
    else
        person = take_tokens(openid, job, reply.json, why);
    if (!person && reply.status == 200) { /* the log-in failed, so its refresh token, which the provider has already issued, is revoked */
        pthread_mutex_lock(&openid->lock);
        openid_revoke_later(openid, json_member_text(reply.json, "refresh_token"));
        pthread_mutex_unlock(&openid->lock);
    }
    openid_reply_finish(&reply);
    text_finish(&form);
    return person;
}

/* --- checking rights again ---------------------------------------------------------------------------------------------------- */

static enum openid_rights take_claims(struct openid *openid, struct person *person, json_t *claims, const char **why)
{
    bool told;
    if (!openid_complete(openid, claims, person->access_token, &told)) {
        *why = "the identity provider no longer knows this user";
        return RIGHTS_GONE;
    }
    if (!told && !id_token_has_groups(openid->config, claims)) {
        *why = "the identity provider did not send the user's groups";
        return RIGHTS_UNKNOWN;
    }
    person->holder.role = id_token_role(openid->config, claims);
    *why = "none of the user's groups has a role any more";
    return person->holder.role == ROLE_NOBODY ? RIGHTS_GONE : RIGHTS_SAME;
}

static bool is_refusal(int status)
{
    return status == 400 || status == 401 || status == 403;
}

static enum openid_rights refresh(struct openid *openid, struct person *person, const char **why)
{
    struct text form = { 0 };
    struct openid_reply reply;
    enum openid_rights rights = RIGHTS_UNKNOWN;
    openid_add_argument(&form, "grant_type", "refresh_token");
    openid_add_argument(&form, "refresh_token", person->refresh_token);
    bool answered = post(openid, "token_endpoint", &form, &reply);
    const char *error = json_member_text(reply.json, "error");
    *why = "the identity provider does not answer";
    if (answered && is_refusal(reply.status) && error && strcmp(error, "invalid_grant") != 0) {
        /* the provider rejects this server, not the user: the client secret may have expired */
        *why = "the identity provider refused to renew the sign-in";
    } else if (answered && is_refusal(reply.status)) {
        rights = RIGHTS_GONE;
        *why = "the identity provider ended the user's sign-in";
    } else if (answered && reply.status == 200) {
        const char *id_token = json_member_text(reply.json, "id_token");
        bool unsure = false;
        keep_tokens(person, reply.json);
        json_t *claims =
            id_token ? openid_verify(openid, id_token, NULL, person->sub, &unsure, why) : json_pack("{s:s}", "sub", person->sub);
        rights = claims ? take_claims(openid, person, claims, why) : unsure ? RIGHTS_UNKNOWN : RIGHTS_GONE;
        json_decref(claims);
    }
    openid_reply_finish(&reply);
    text_finish(&form);
    return rights;
}

/* Checks the rights of a user without a refresh token with the user's access token, until that token expires. */
static enum openid_rights ask_again(struct openid *openid, struct person *person, const char **why)
{
    char *url = openid_endpoint(openid, "userinfo_endpoint");
    struct openid_reply reply = { .status = 0 };
    bool over = !person->access_token || (person->access_until_s && clock_utc_ns() / NS_PER_S >= person->access_until_s);
    enum openid_rights rights = RIGHTS_UNKNOWN;
    *why = "the identity provider does not answer";
    if (over || !url) {
        rights = RIGHTS_GONE;
        *why = "the identity provider sent no refresh token, and the access token has expired";
    } else if (openid_get(openid->config, url, person->access_token, &openid->stopping, &reply) && is_refusal(reply.status)) {
        rights = RIGHTS_GONE;
        *why = "the identity provider ended the user's sign-in";
    } else if (reply.status == 200 && json_is_object(reply.json)) {
        const char *sub = json_member_text(reply.json, "sub");
        rights = sub && !strcmp(sub, person->sub) ? take_claims(openid, person, reply.json, why) : RIGHTS_GONE;
    }
    openid_reply_finish(&reply);
    mem_free(url);
    return rights;
}

enum openid_rights openid_check(struct openid *openid, struct person *person, const char **why)
{
    if (clock_utc_ns() >= person->holder.until_utc_ns) {
        *why = "the session has reached its maximum duration";
        return RIGHTS_GONE;
    }
    return person->refresh_token ? refresh(openid, person, why) : ask_again(openid, person, why);
}

void openid_revoke(struct openid *openid, const char *token)
{
    struct text form = { 0 };
    struct openid_reply reply;
    openid_add_argument(&form, "token", token);
    openid_add_argument(&form, "token_type_hint", "refresh_token");
    post(openid, "revocation_endpoint", &form, &reply);
    openid_reply_finish(&reply);
    explicit_bzero(form.at, form.length);
    text_finish(&form);
}
