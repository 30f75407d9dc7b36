/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sign-in with OpenID Connect: the functions that the event loop calls. */
#include "access/openid/openid.h"

#include <curl/curl.h>
#include <string.h>

#include "access/openid/id_token.h"
#include "access/openid/openid_http.h"
#include "access/openid/openid_impl.h"
#include "base/clock.h"
#include "base/mem.h"
#include "base/text/text.h"

static const int64_t ERROR_EVERY_NS = 5 * NS_PER_S;

/* --- functions that the event loop calls -------------------------------------------------------------------------------------- */

const struct openid_config *openid_config_of(const struct openid *openid)
{
    return openid->config;
}

static char *authorization_url(const struct openid_config *config, const char *endpoint, const struct sign_in *sign_in)
{
    char challenge[SIGN_IN_SECRET_CHARS + 1];
    struct text query = { 0 };
    sign_in_challenge(sign_in->verifier, challenge);
    openid_add_argument(&query, "response_type", "code");
    openid_add_argument(&query, "client_id", config->client_id);
    openid_add_argument(&query, "redirect_uri", config->redirect_uri);
    openid_add_argument(&query, "scope", config->scope);
    openid_add_argument(&query, "state", sign_in->state);
    openid_add_argument(&query, "nonce", sign_in->nonce);
    openid_add_argument(&query, "code_challenge", challenge);
    openid_add_argument(&query, "code_challenge_method", "S256");
    if (config->prompt)
        openid_add_argument(&query, "prompt", config->prompt);
    char *url = mem_printf("%s%c%s", endpoint, strchr(endpoint, '?') ? '&' : '?', query.at);
    text_finish(&query);
    return url;
}

char *openid_begin(struct openid *openid, const uint8_t address[16], const char *path, int64_t now_ns,
                   char binding[SIGN_IN_SECRET_CHARS + 1], const char **why)
{
    char *url = NULL;
    pthread_mutex_lock(&openid->lock);
    const char *endpoint = json_string_value(json_object_get(openid->metadata, "authorization_endpoint"));
    const struct sign_in *sign_in = endpoint ? sign_ins_begin(openid->table, address, path, now_ns) : NULL;
    *why = endpoint ? "this machine's random number generator failed"
                    : "the identity provider does not answer; you can still sign in with a token";
    if (sign_in) {
        strcpy(binding, sign_in->binding);
        url = authorization_url(openid->config, endpoint, sign_in);
    }
    pthread_mutex_unlock(&openid->lock);
    return url;
}

/* Returns true if the response to a log-in names an issuer other than the configured identity provider (RFC 9207). */
static bool is_other_issuer(const struct openid *openid, const char *iss)
{
    if (iss)
        return strcmp(iss, openid->config->issuer) != 0;
    return json_is_true(json_object_get(openid->metadata, "authorization_response_iss_parameter_supported"));
}

/* Returns true if another authorization code may be queued for exchange. The queue is limited in total and per address, so that
   one address cannot fill it. The caller holds the lock. */
static bool has_room(const struct openid *openid, const uint8_t address[16])
{
    int of_address = 0;
    for (const struct openid_job *job = openid->codes.first; job; job = job->next)
        of_address += memcmp(job->sign_in.address, address, sizeof(job->sign_in.address)) == 0;
    return openid->codes.count < OPENID_CODES && of_address < OPENID_CODES_OF_ADDRESS;
}

/* Returns the result of a log-in that the provider ended with an error, which is not counted as a wrong token. The first such
   error in each ERROR_EVERY_NS gives OPENID_REFUSED, which the audit trail records; all others give OPENID_AWAY, which it does
   not. So nobody can fill the audit trail by sending such errors. The caller holds the lock. */
static enum openid_result judge_error(struct openid *openid, int64_t now_ns)
{
    if (openid->error_ns && now_ns - openid->error_ns < ERROR_EVERY_NS)
        return OPENID_AWAY;
    openid->error_ns = now_ns;
    return OPENID_REFUSED;
}

enum openid_finish openid_finish(struct openid *openid, const struct openid_return *brought, int64_t now_ns)
{
    struct openid_job job = { .request = brought->request };
    enum openid_finish result = OPENID_WAITS;
    pthread_mutex_lock(&openid->lock);
    if (!brought->state || !brought->binding || !sign_ins_take(openid->table, brought->state, brought->binding, now_ns, &job.sign_in)) {
        pthread_mutex_unlock(&openid->lock);
        counter_inc(openid->foreign, 1);
        return OPENID_FOREIGN;
    }
    bool other = is_other_issuer(openid, brought->iss);
    const char *why = other            ? "the issuer (iss) in the provider's answer differs from the issuer in the --openid file"
                      : brought->error ? "the identity provider refused to sign this user in, with the error"
                      : !brought->code ? "the provider's answer has no authorization code"
                                       : NULL;
    if (why) {
        char *text = brought->error ? mem_printf("%s: %.80s", why, brought->error) : mem_strdup(why);
        enum openid_result verdict = other || !brought->error ? OPENID_GUESSED : judge_error(openid, now_ns);
        if (verdict != OPENID_AWAY)
            openid_say_refused(openid, brought->from, text);
        openid_add_answer(openid, &job, verdict, "", text);
    } else if (has_room(openid, job.sign_in.address)) {
        job.code = mem_strdup(brought->code);
        job.from = mem_strdup(brought->from);
        openid_add_job(openid, &openid->codes, &job);
    } else {
        result = OPENID_FULL;
    }
    pthread_mutex_unlock(&openid->lock);
    if (why)
        openid->params.wake(openid->params.wake_arg);
    return result;
}

struct openid_answer *openid_collect(struct openid *openid)
{
    pthread_mutex_lock(&openid->lock);
    struct openid_answer *answers = openid->answers;
    openid->answers = NULL;
    pthread_mutex_unlock(&openid->lock);
    return answers;
}

bool openid_take_changed(struct openid *openid)
{
    return atomic_exchange(&openid->changed, false);
}

void openid_answer_free(struct openid_answer *answer)
{
    explicit_bzero(answer->cookie, sizeof(answer->cookie));
    mem_free(answer->why);
    mem_free(answer);
}

bool openid_find(struct openid *openid, const char *cookie, struct token_holder *out)
{
    pthread_mutex_lock(&openid->lock);
    const struct person *person = sign_ins_find(openid->table, cookie);
    bool good = person && clock_utc_ns() < person->holder.until_utc_ns;
    if (good)
        *out = person->holder;
    pthread_mutex_unlock(&openid->lock);
    return good;
}

enum role openid_role(struct openid *openid, const struct token_holder *holder)
{
    pthread_mutex_lock(&openid->lock);
    const struct person *person = sign_ins_find_hash(openid->table, holder->hash);
    enum role role = person && clock_utc_ns() < person->holder.until_utc_ns ? person->holder.role : ROLE_NOBODY;
    pthread_mutex_unlock(&openid->lock);
    return role;
}

char *openid_id_token(struct openid *openid, const struct token_holder *holder)
{
    pthread_mutex_lock(&openid->lock);
    const struct person *person = sign_ins_find_hash(openid->table, holder->hash);
    char *token = person && person->id_token ? mem_strdup(person->id_token) : NULL;
    pthread_mutex_unlock(&openid->lock);
    return token;
}

static const char *take_claims(const struct openid_config *config, const json_t *claims, struct token_holder *out)
{
    int64_t made_s = (int64_t)json_number_value(json_object_get(claims, "iat"));
    *out = (struct token_holder){ .signed_in = true, .until_utc_ns = made_s * NS_PER_S + (int64_t)(config->hours * 3600e9) };
    out->role = id_token_role(config, claims);
    if (!id_token_name(config, claims, out->name, sizeof(out->name)))
        return "the ID token has no user name that can be displayed; check name_claim in the core's --openid file";
    if (clock_utc_ns() >= out->until_utc_ns)
        return "the ID token is older than the maximum duration of a session; sign in again";
    return out->role == ROLE_NOBODY ? "none of the groups in the ID token has a role at the core" : NULL;
}

const char *openid_vouch(struct openid *openid, const char *id_token, struct token_holder *out)
{
    const char *why = "the core does not have the identity provider's keys yet; try again later";
    json_t *claims = NULL;
    *out = (struct token_holder){ .role = ROLE_NOBODY };
    pthread_mutex_lock(&openid->lock);
    json_t *keys = json_incref(openid->jwks);
    pthread_mutex_unlock(&openid->lock);
    const struct id_token_expected expected = {
        .config = openid->config, .jwks = keys, .now_s = clock_utc_ns() / NS_PER_S, .patience_s = (int64_t)(openid->config->hours * 3600)
    };
    enum id_token_fault fault = keys ? id_token_verify(id_token, &expected, &claims, &why) : ID_TOKEN_NO_KEY;
    json_decref(keys);
    if (fault == ID_TOKEN_NO_KEY) { /* the provider may have a new signing key: tells the thread to fetch the provider's keys now */
        pthread_mutex_lock(&openid->lock);
        openid->discover_ns = clock_mono_ns();
        pthread_cond_broadcast(&openid->wake);
        pthread_mutex_unlock(&openid->lock);
    }
    why = claims ? take_claims(openid->config, claims, out) : why;
    json_decref(claims);
    if (why)
        out->role = ROLE_NOBODY;
    return why;
}

void openid_touch(struct openid *openid, const struct token_holder *holder, int64_t now_ns)
{
    pthread_mutex_lock(&openid->lock);
    struct person *person = sign_ins_find_hash(openid->table, holder->hash);
    if (person)
        person->active_ns = now_ns;
    pthread_mutex_unlock(&openid->lock);
}

char *openid_end(struct openid *openid, const char *cookie, const char *from)
{
    char *url = NULL;
    pthread_mutex_lock(&openid->lock);
    struct person *person = sign_ins_find(openid->table, cookie);
    const char *endpoint = json_string_value(json_object_get(openid->metadata, "end_session_endpoint"));
    if (person) {
        openid_record(openid, "leave", "done", &person->holder, from, "signed out", NULL);
        openid_revoke_later(openid, person->refresh_token);
        sign_ins_remove(openid->table, person);
        counter_set(openid->people, (int64_t)sign_ins_count(openid->table));
    }
    if (person && endpoint) {
        struct text query = { 0 };
        openid_add_argument(&query, "client_id", openid->config->client_id);
        openid_add_argument(&query, "post_logout_redirect_uri", openid->config->url);
        url = mem_printf("%s%c%s", endpoint, strchr(endpoint, '?') ? '&' : '?', query.at);
        text_finish(&query);
    }
    pthread_mutex_unlock(&openid->lock);
    return url;
}

/* --- life cycle --------------------------------------------------------------------------------------------------------------- */

struct openid *openid_start(const struct openid_params *params)
{
    struct openid *openid = mem_new(sizeof(*openid));
    *openid = (struct openid){ .params = *params, .codes.last = &openid->codes.first, .revocations.last = &openid->revocations.first };
    openid->table = sign_ins_create();
    pthread_mutex_init(&openid->lock, NULL);
    pthread_mutex_init(&openid->asking, NULL);
    clock_cond_init(&openid->wake);
    openid->good = counters_add(params->counters, "plantcast_openid_good", "gauge",
                                "1 while the OpenID Connect identity provider answers, so that users can sign in.");
    openid->people = counters_add(params->counters, "plantcast_openid_people", "gauge", "Users signed in by OpenID Connect.");
    openid->refused =
        counters_add(params->counters, "plantcast_openid_refused_total", "counter", "OpenID Connect sign-ins that the daemon refused.");
    openid->foreign = counters_add(params->counters, "plantcast_openid_foreign_total", "counter",
                                   "Answers of the identity provider that matched no pending sign-in.");
    openid->config = openid_config_read(params->log, params->path);
    if (openid->config && curl_global_init(CURL_GLOBAL_DEFAULT) == CURLE_OK)
        openid->started = pthread_create(&openid->thread, NULL, openid_run, openid) == 0;
    if (!openid->started) {
        log_err(
            params->log,
            "openid: users cannot sign in by OpenID Connect: the settings in %s cannot be used, or libcurl or a thread cannot be started",
            params->path);
        openid_stop(&openid);
    }
    return openid;
}

void openid_stop(struct openid **pointer)
{
    struct openid *openid = *pointer;
    if (!openid)
        return;
    pthread_mutex_lock(&openid->lock);
    atomic_store(&openid->stopping, true);
    pthread_cond_broadcast(&openid->wake);
    pthread_mutex_unlock(&openid->lock);
    if (openid->started)
        pthread_join(openid->thread, NULL);
    openid_free_jobs(&openid->codes);
    openid_free_jobs(&openid->revocations);
    for (struct openid_answer *answer = openid->answers, *next; answer; answer = next) {
        next = answer->next;
        openid_answer_free(answer);
    }
    json_decref(openid->metadata);
    json_decref(openid->jwks);
    sign_ins_destroy(&openid->table);
    openid_config_free(&openid->config);
    pthread_cond_destroy(&openid->wake);
    pthread_mutex_destroy(&openid->asking);
    pthread_mutex_destroy(&openid->lock);
    mem_free(openid);
    *pointer = NULL;
}
