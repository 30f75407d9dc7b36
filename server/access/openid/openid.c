/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signing in by OpenID Connect: what the loop asks for, and the thread that asks the provider. */
#include "access/openid/openid.h"

#include <curl/curl.h>
#include <string.h>

#include "access/openid/openid_http.h"
#include "access/openid/openid_impl.h"
#include "base/clock.h"
#include "base/mem.h"
#include "base/text.h"

static const int64_t AGAIN_NS = 5 * NS_PER_S; /* until an unknown provider is asked again */

/* --- the loop's side ------------------------------------------------------------------------------------------------------ */

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
    *why = endpoint ? "this machine gives no random numbers" : "the identity provider does not answer; a token still lets you in";
    if (sign_in) {
        strcpy(binding, sign_in->binding);
        url = authorization_url(openid->config, endpoint, sign_in);
    }
    pthread_mutex_unlock(&openid->lock);
    return url;
}

static void add_job(struct openid *openid, const struct openid_job *job)
{
    struct openid_job *copy = mem_new(sizeof(*copy));
    *copy = *job;
    *openid->last_job = copy;
    openid->last_job = &copy->next;
    pthread_cond_signal(&openid->wake);
}

/* Under the lock. Takes why. */
static void add_answer(struct openid *openid, uint64_t request, const char *cookie, const char *path, char *why)
{
    struct openid_answer *answer = mem_new(sizeof(*answer));
    *answer = (struct openid_answer){ .request = request, .good = !why, .why = why, .next = openid->answers };
    strcpy(answer->cookie, cookie);
    strcpy(answer->path, path);
    openid->answers = answer;
}

static void record(struct openid *openid, const char *event, const char *result, const struct token_holder *holder, const char *from,
                   const char *what, const char *why)
{
    audit_say(openid->params.audit, &(struct audit_entry){ .event = event,
                                                           .result = result,
                                                           .who = holder ? holder->name : NULL,
                                                           .role = holder ? name_of(names_role, (int)holder->role) : NULL,
                                                           .from = from,
                                                           .how = "OpenID Connect",
                                                           .what = what,
                                                           .why = why });
}

static void say_refused(struct openid *openid, const char *from, const char *why)
{
    counter_inc(openid->refused, 1);
    log_event(openid->params.log, LOG_WARN, EVENT_LOGIN_REFUSED, "login from %s by OpenID Connect: refused: %s", from, why);
    record(openid, "login", "refused", NULL, from, NULL, why);
}

/* An answer of another provider (RFC 9207). */
static bool is_other_issuer(const struct openid *openid, const char *iss)
{
    if (iss)
        return strcmp(iss, openid->config->issuer) != 0;
    return json_is_true(json_object_get(openid->metadata, "authorization_response_iss_parameter_supported"));
}

bool openid_finish(struct openid *openid, const struct openid_return *brought, int64_t now_ns)
{
    struct openid_job job = { .request = brought->request };
    pthread_mutex_lock(&openid->lock);
    bool ours = brought->state && brought->binding && sign_ins_take(openid->table, brought->state, brought->binding, now_ns, &job.sign_in);
    const char *why = !ours                                   ? "no log-in of this browser waits for this answer"
                      : is_other_issuer(openid, brought->iss) ? "another issuer answers"
                      : brought->error                        ? "the provider refuses it"
                      : !brought->code                        ? "the provider gives no code"
                                                              : NULL;
    if (ours && why) {
        add_answer(openid, brought->request, "", job.sign_in.path,
                   brought->error ? mem_printf("%s: %.80s", why, brought->error) : mem_strdup(why));
    } else if (ours) {
        job.code = mem_strdup(brought->code);
        job.from = mem_strdup(brought->from);
        add_job(openid, &job);
    }
    pthread_mutex_unlock(&openid->lock);
    if (why)
        say_refused(openid, brought->from, why);
    if (ours && why)
        openid->params.wake(openid->params.wake_arg);
    return ours;
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

char *openid_end(struct openid *openid, const char *cookie, const char *from)
{
    char *url = NULL;
    pthread_mutex_lock(&openid->lock);
    struct person *person = sign_ins_find(openid->table, cookie);
    const char *endpoint = json_string_value(json_object_get(openid->metadata, "end_session_endpoint"));
    if (person) {
        record(openid, "leave", "done", &person->holder, from, "signed out", NULL);
        if (person->refresh_token && json_object_get(openid->metadata, "revocation_endpoint"))
            add_job(openid, &(struct openid_job){ .revoke = mem_strdup(person->refresh_token) });
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

/* --- the thread's side ---------------------------------------------------------------------------------------------------- */

static void free_secret(char *text)
{
    if (text)
        explicit_bzero(text, strlen(text));
    mem_free(text);
}

static void free_job(struct openid_job *job)
{
    free_secret(job->code);
    free_secret(job->revoke);
    mem_free(job->from);
    mem_free(job);
}

static void let_in(struct openid *openid, const struct openid_job *job, struct person *person)
{
    char cookie[SIGN_IN_SECRET_CHARS + 1] = "", *sub = mem_printf("sub %s", person->sub);
    struct token_holder holder = person->holder;
    person->check_ns = clock_mono_ns() + (int64_t)(openid->config->check_s * 1e9);
    pthread_mutex_lock(&openid->lock);
    bool good = sign_ins_add_person(openid->table, person, cookie);
    add_answer(openid, job->request, cookie, job->sign_in.path, good ? NULL : mem_strdup("this machine gives no random numbers"));
    counter_set(openid->people, (int64_t)sign_ins_count(openid->table));
    pthread_mutex_unlock(&openid->lock);
    explicit_bzero(cookie, sizeof(cookie));
    mem_free(person);
    if (good) {
        log_info(openid->params.log, "login from %s by OpenID Connect: %s, role %s: let in", job->from, holder.name,
                 name_of(names_role, (int)holder.role));
        record(openid, "login", "done", &holder, job->from, sub, NULL);
    }
    mem_free(sub);
}

static void do_job(struct openid *openid, struct openid_job *job)
{
    char *why = NULL;
    bool known = openid_discover(openid);
    if (job->revoke) {
        if (known)
            openid_revoke(openid, job->revoke);
        return;
    }
    struct person *person = known ? openid_redeem(openid, job, &why) : NULL;
    if (person) {
        let_in(openid, job, person);
    } else {
        if (!why)
            why = mem_strdup("the provider does not answer");
        say_refused(openid, job->from, why);
        pthread_mutex_lock(&openid->lock);
        add_answer(openid, job->request, "", job->sign_in.path, why);
        pthread_mutex_unlock(&openid->lock);
    }
    openid->params.wake(openid->params.wake_arg);
}

/* A copy that owns its texts, to be worked on without the lock. */
static void copy_person(struct person *out, const struct person *person)
{
    *out = *person;
    out->sub = mem_strdup(person->sub);
    out->refresh_token = person->refresh_token ? mem_strdup(person->refresh_token) : NULL;
    out->access_token = person->access_token ? mem_strdup(person->access_token) : NULL;
}

static void swap_texts(char **a, char **b)
{
    char *kept = *a;
    *a = *b;
    *b = kept;
}

static void tell_loop(struct openid *openid)
{
    atomic_store(&openid->changed, true);
    openid->params.wake(openid->params.wake_arg);
}

/* Under the lock. The person may have signed out meanwhile. */
static void settle(struct openid *openid, struct person *copy, enum openid_rights rights, const char *why)
{
    struct person *person = sign_ins_numbered(openid->table, copy->number);
    if (!person)
        return;
    if (rights == RIGHTS_GONE) {
        log_info(openid->params.log, "openid: %s is signed out: %s", person->holder.name, why);
        record(openid, "leave", "done", &person->holder, NULL, "signed out", why);
        sign_ins_remove(openid->table, person);
        counter_set(openid->people, (int64_t)sign_ins_count(openid->table));
        tell_loop(openid);
        return;
    }
    bool other_role = rights == RIGHTS_SAME && copy->holder.role != person->holder.role;
    if (other_role)
        record(openid, "role", "done", &copy->holder, NULL, name_of(names_role, (int)person->holder.role), NULL);
    person->holder.role = copy->holder.role;
    swap_texts(&person->refresh_token, &copy->refresh_token);
    swap_texts(&person->access_token, &copy->access_token);
    person->access_until_s = copy->access_until_s;
    person->check_ns = clock_mono_ns() + (int64_t)(openid->config->check_s * 1e9);
    if (other_role)
        tell_loop(openid);
}

/* Under the lock, which is given up meanwhile. */
static void check(struct openid *openid, const struct person *person)
{
    struct person copy;
    const char *why = NULL;
    copy_person(&copy, person);
    pthread_mutex_unlock(&openid->lock);
    enum openid_rights rights =
        openid_discover(openid) || clock_utc_ns() >= copy.holder.until_utc_ns ? openid_check(openid, &copy, &why) : RIGHTS_UNKNOWN;
    if (!atomic_load(&openid->stopping) && why && rights == RIGHTS_UNKNOWN)
        openid_say(openid, why);
    else if (rights != RIGHTS_UNKNOWN)
        openid_say(openid, NULL);
    pthread_mutex_lock(&openid->lock);
    settle(openid, &copy, rights, why);
    mem_free(copy.sub);
    free_secret(copy.refresh_token);
    free_secret(copy.access_token);
}

/* Under the lock, which is given up meanwhile. Returns when there is something to do next, by the monotonic clock. */
static int64_t do_what_is_due(struct openid *openid)
{
    struct openid_job *job = openid->jobs;
    const struct person *person = sign_ins_next_check(openid->table);
    int64_t now_ns = clock_mono_ns();
    if (job) {
        openid->jobs = job->next;
        if (!openid->jobs)
            openid->last_job = &openid->jobs;
        pthread_mutex_unlock(&openid->lock);
        do_job(openid, job);
        free_job(job);
        pthread_mutex_lock(&openid->lock);
        return 0;
    }
    if (person && person->check_ns <= now_ns) {
        check(openid, person);
        return 0;
    }
    if (!openid->metadata || !openid->jwks) {
        pthread_mutex_unlock(&openid->lock);
        bool known = openid_discover(openid);
        pthread_mutex_lock(&openid->lock);
        return known ? 0 : clock_mono_ns() + AGAIN_NS;
    }
    return person ? person->check_ns : INT64_MAX;
}

static void *run(void *arg)
{
    struct openid *openid = arg;
    pthread_mutex_lock(&openid->lock);
    while (!atomic_load(&openid->stopping)) {
        int64_t next_ns = do_what_is_due(openid);
        if (next_ns > 0 && !openid->jobs && !atomic_load(&openid->stopping))
            clock_cond_wait(&openid->wake, &openid->lock, next_ns);
    }
    pthread_mutex_unlock(&openid->lock);
    return NULL;
}

/* --- life ----------------------------------------------------------------------------------------------------------------- */

struct openid *openid_start(const struct openid_params *params)
{
    struct openid *openid = mem_new(sizeof(*openid));
    *openid = (struct openid){ .params = *params, .last_job = &openid->jobs };
    openid->table = sign_ins_create();
    pthread_mutex_init(&openid->lock, NULL);
    clock_cond_init(&openid->wake);
    openid->good = counters_add(params->counters, "plantcast_openid_good", "gauge", "1 while the identity provider answers.");
    openid->people = counters_add(params->counters, "plantcast_openid_people", "gauge", "People who are signed in.");
    openid->refused = counters_add(params->counters, "plantcast_openid_refused_total", "counter", "Log-ins by OpenID Connect refused.");
    openid->config = openid_config_read(params->log, params->path);
    if (openid->config && curl_global_init(CURL_GLOBAL_DEFAULT) == CURLE_OK)
        openid->started = pthread_create(&openid->thread, NULL, run, openid) == 0;
    if (!openid->started) {
        log_err(params->log, "openid: %s cannot be used", params->path);
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
    pthread_cond_signal(&openid->wake);
    pthread_mutex_unlock(&openid->lock);
    if (openid->started)
        pthread_join(openid->thread, NULL);
    for (struct openid_job *job = openid->jobs, *next; job; job = next) {
        next = job->next;
        free_job(job);
    }
    for (struct openid_answer *answer = openid->answers, *next; answer; answer = next) {
        next = answer->next;
        openid_answer_free(answer);
    }
    json_decref(openid->metadata);
    json_decref(openid->jwks);
    sign_ins_destroy(&openid->table);
    openid_config_free(&openid->config);
    pthread_cond_destroy(&openid->wake);
    pthread_mutex_destroy(&openid->lock);
    mem_free(openid);
    *pointer = NULL;
}
