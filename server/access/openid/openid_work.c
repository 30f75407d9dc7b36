/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends the requests to the identity provider. One thread starts the tasks that are due, and each request runs in a thread of
   its own. Neither a slow answer nor many log-ins can therefore delay the check that ends expired rights. */
#include <string.h>

#include "access/openid/openid_impl.h"
#include "base/clock.h"
#include "base/files/secret.h"
#include "base/mem.h"
#include "message/names.h"

/* interval between two requests for the provider's metadata and keys. RETRY_DELAY_NS: while they are unknown;
   CHECK_INTERVAL_NS: once they are known */
static const int64_t RETRY_DELAY_NS = 5 * NS_PER_S, CHECK_INTERVAL_NS = 3600 * NS_PER_S;
static const int at_once[OPENID_TASKS] = {
    [OPENID_TASK_CODE] = 4, [OPENID_TASK_CHECK] = 16, [OPENID_TASK_REVOKE] = 1, [OPENID_TASK_DISCOVER] = 1
};

struct task {
    struct openid *openid;
    enum openid_task kind;
    struct openid_job *job; /* queued job of a task that exchanges an authorization code or revokes a token; NULL for other tasks */
    struct person person;   /* for a rights check: a copy of the user's record that owns its texts */
    int64_t began_ns;
};

/* --- audit and log ------------------------------------------------------------------------------------------------------------ */

void openid_record(struct openid *openid, const char *event, const char *result, const struct token_holder *holder, const char *from,
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

void openid_say_refused(struct openid *openid, const char *from, const char *why)
{
    counter_inc(openid->refused, 1);
    log_event(openid->params.log, LOG_WARN, EVENT_LOGIN_REFUSED, "login from %s by OpenID Connect: refused: %s", from, why);
    openid_record(openid, "login", "refused", NULL, from, NULL, why);
}

void openid_add_answer(struct openid *openid, const struct openid_job *job, enum openid_result result, const char *cookie, char *why)
{
    struct openid_answer *answer = mem_new(sizeof(*answer));
    *answer = (struct openid_answer){ .request = job->request, .result = result, .why = why, .next = openid->answers };
    memcpy(answer->address, job->sign_in.address, sizeof(answer->address));
    strcpy(answer->cookie, cookie);
    strcpy(answer->path, job->sign_in.path);
    openid->answers = answer;
}

static void tell_loop(struct openid *openid)
{
    atomic_store(&openid->changed, true);
    openid->params.wake(openid->params.wake_arg);
}

/* --- log-ins ------------------------------------------------------------------------------------------------------------- */

static void let_in(struct openid *openid, const struct openid_job *job, struct person *person, int64_t began_ns)
{
    char cookie[SIGN_IN_SECRET_CHARS + 1] = "", *sub = mem_printf("sub %s", person->sub), *left;
    struct token_holder holder = person->holder;
    person->check_ns = began_ns + (int64_t)(openid->config->check_s * 1e9);
    person->active_ns = clock_mono_ns();
    pthread_mutex_lock(&openid->lock);
    bool good = sign_ins_add_person(openid->table, person, cookie, &left);
    char *why = good ? NULL : mem_strdup("this machine's random number generator failed");
    openid_add_answer(openid, job, good ? OPENID_LET_IN : OPENID_AWAY, cookie, why);
    openid_revoke_later(openid, left);
    counter_set(openid->people, (int64_t)sign_ins_count(openid->table));
    pthread_cond_broadcast(&openid->wake);
    pthread_mutex_unlock(&openid->lock);
    explicit_bzero(cookie, sizeof(cookie));
    secret_forget(left);
    mem_free(person);
    openid_say(openid, NULL);
    if (good) {
        log_info(openid->params.log, "login from %s by OpenID Connect: %s, role %s: accepted", job->from, holder.name,
                 name_of(names_role, (int)holder.role));
        openid_record(openid, "login", "done", &holder, job->from, sub, NULL);
    }
    mem_free(sub);
}

static void do_code(struct task *task)
{
    struct openid *openid = task->openid;
    char *why = NULL;
    enum openid_result result = OPENID_AWAY;
    bool known = openid_knows(openid) || openid_discover(openid);
    struct person *person = known ? openid_redeem(openid, task->job, &result, &why) : NULL;
    if (person) {
        let_in(openid, task->job, person, task->began_ns);
    } else {
        if (!why)
            why = mem_strdup("the identity provider does not answer");
        if (result == OPENID_AWAY)
            openid_say(openid, why);
        else
            openid_say_refused(openid, task->job->from, why);
        pthread_mutex_lock(&openid->lock);
        openid_add_answer(openid, task->job, result, "", why);
        pthread_mutex_unlock(&openid->lock);
    }
    openid->params.wake(openid->params.wake_arg);
    openid_free_job(task->job);
}

static void do_revoke(struct task *task)
{
    openid_revoke(task->openid, task->job->revoke);
    openid_free_job(task->job);
}

/* --- rights --------------------------------------------------------------------------------------------------------------- */

/* Copies a signed-in user's record and its texts, so that the copy can be used without the lock. */
static void copy_person(struct person *out, const struct person *person)
{
    *out = *person;
    out->sub = mem_strdup(person->sub);
    out->refresh_token = person->refresh_token ? mem_strdup(person->refresh_token) : NULL;
    out->access_token = person->access_token ? mem_strdup(person->access_token) : NULL;
    out->id_token = NULL;
}

static void swap_texts(char **a, char **b)
{
    char *kept = *a;
    *a = *b;
    *b = kept;
}

static void end_person(struct openid *openid, struct person *person, const char *why)
{
    log_info(openid->params.log, "openid: %s is signed out: %s", person->holder.name, why);
    openid_record(openid, "leave", "done", &person->holder, NULL, "signed out", why);
    sign_ins_remove(openid->table, person);
    counter_set(openid->people, (int64_t)sign_ins_count(openid->table));
    tell_loop(openid);
}

/* Applies the result of a rights check to the table of signed-in users. A newly received refresh token is revoked if the rights
   ended or the user signed out during the check. The caller holds the lock. */
static void settle(struct openid *openid, struct task *task, enum openid_rights rights, const char *why)
{
    struct person *person = sign_ins_numbered(openid->table, task->person.number), *copy = &task->person;
    if (!person || rights == RIGHTS_GONE)
        openid_revoke_later(openid, copy->refresh_token);
    if (person && rights == RIGHTS_GONE)
        end_person(openid, person, why);
    if (!person || rights == RIGHTS_GONE)
        return;
    bool other_role = rights == RIGHTS_SAME && copy->holder.role != person->holder.role;
    if (other_role)
        openid_record(openid, "role", "done", &copy->holder, NULL, name_of(names_role, (int)person->holder.role), NULL);
    if (rights == RIGHTS_SAME)
        person->holder.role = copy->holder.role;
    swap_texts(&person->refresh_token, &copy->refresh_token);
    swap_texts(&person->access_token, &copy->access_token);
    if (copy->id_token && rights == RIGHTS_SAME)
        swap_texts(&person->id_token, &copy->id_token);
    person->access_until_s = copy->access_until_s;
    person->check_ns = task->began_ns + (int64_t)(openid->config->check_s * 1e9);
    person->checking = false;
    if (other_role)
        tell_loop(openid);
}

static enum openid_rights ask_rights(struct openid *openid, struct person *copy, bool left_alone, const char **why)
{
    if (left_alone) {
        *why = "the user was inactive for the time of --lock-after";
        return RIGHTS_GONE;
    }
    return openid_knows(openid) || clock_utc_ns() >= copy->holder.until_utc_ns ? openid_check(openid, copy, why) : RIGHTS_UNKNOWN;
}

static void do_check(struct task *task)
{
    struct openid *openid = task->openid;
    struct person *copy = &task->person;
    const char *why = NULL;
    bool left_alone = openid->params.lock_ns && task->began_ns - copy->active_ns > openid->params.lock_ns;
    enum openid_rights rights = ask_rights(openid, copy, left_alone, &why);
    if (rights != RIGHTS_UNKNOWN && !left_alone)
        openid_say(openid, NULL);
    else if (rights == RIGHTS_UNKNOWN && !atomic_load(&openid->stopping) && why)
        openid_say(openid, why);
    pthread_mutex_lock(&openid->lock);
    settle(openid, task, rights, why);
    pthread_mutex_unlock(&openid->lock);
    mem_free(copy->sub);
    secret_forget(copy->refresh_token);
    secret_forget(copy->access_token);
    secret_forget(copy->id_token);
}

static void do_discover(struct task *task)
{
    bool known = openid_discover(task->openid);
    pthread_mutex_lock(&task->openid->lock);
    task->openid->discover_ns = clock_mono_ns() + (known ? CHECK_INTERVAL_NS : RETRY_DELAY_NS);
    pthread_mutex_unlock(&task->openid->lock);
}

/* --- starting tasks ----------------------------------------------------------------------------------------------------------- */

static void *run_task(void *arg)
{
    static void (*const run[OPENID_TASKS])(struct task *) = {
        [OPENID_TASK_CODE] = do_code, [OPENID_TASK_CHECK] = do_check, [OPENID_TASK_REVOKE] = do_revoke, [OPENID_TASK_DISCOVER] = do_discover
    };
    struct task *task = arg;
    struct openid *openid = task->openid;
    run[task->kind](task);
    pthread_mutex_lock(&openid->lock);
    openid->running[task->kind]--;
    mem_free(task);
    pthread_cond_broadcast(&openid->wake);
    pthread_mutex_unlock(&openid->lock);
    return NULL;
}

static bool may_start(const struct openid *openid, enum openid_task kind)
{
    return openid->running[kind] < at_once[kind];
}

/* Returns the next request to the provider that is due, or NULL; *next_ns receives the monotonic time when the next one will be
   due. The caller holds the lock. */
static struct task *take_task(struct openid *openid, int64_t *next_ns)
{
    struct person *person = may_start(openid, OPENID_TASK_CHECK) ? sign_ins_next_check(openid->table) : NULL;
    int64_t now_ns = clock_mono_ns();
    struct task task = { .openid = openid, .began_ns = now_ns };
    bool looks = may_start(openid, OPENID_TASK_DISCOVER);
    *next_ns = INT64_MAX;
    if (looks && openid->discover_ns <= now_ns) {
        task.kind = OPENID_TASK_DISCOVER;
    } else if (person && person->check_ns <= now_ns) {
        task.kind = OPENID_TASK_CHECK;
        person->checking = true;
        copy_person(&task.person, person);
    } else if (openid->codes.first && may_start(openid, OPENID_TASK_CODE)) {
        task.kind = OPENID_TASK_CODE;
        task.job = openid_take_job(&openid->codes);
    } else if (openid->revocations.first && may_start(openid, OPENID_TASK_REVOKE)) {
        task.kind = OPENID_TASK_REVOKE;
        task.job = openid_take_job(&openid->revocations);
    } else {
        *next_ns = person ? person->check_ns : INT64_MAX;
        if (looks && openid->discover_ns < *next_ns)
            *next_ns = openid->discover_ns;
        return NULL;
    }
    struct task *copy = mem_new(sizeof(*copy));
    *copy = task;
    openid->running[task.kind]++;
    return copy;
}

/* Runs a task in a new thread, or in this one if none can be created. The caller holds the lock, which is released during the call. */
static void start_task(struct openid *openid, struct task *task)
{
    pthread_t thread;
    pthread_mutex_unlock(&openid->lock);
    if (pthread_create(&thread, NULL, run_task, task) == 0)
        pthread_detach(thread);
    else
        run_task(task);
    pthread_mutex_lock(&openid->lock);
}

static bool is_busy(const struct openid *openid)
{
    int running = 0;
    for (int i = 0; i < OPENID_TASKS; i++)
        running += openid->running[i];
    return running > 0;
}

void *openid_run(void *arg)
{
    struct openid *openid = arg;
    pthread_mutex_lock(&openid->lock);
    while (!atomic_load(&openid->stopping)) {
        int64_t next_ns;
        struct task *task = take_task(openid, &next_ns);
        if (task)
            start_task(openid, task);
        else
            clock_cond_wait(&openid->wake, &openid->lock, next_ns);
    }
    while (is_busy(openid))
        pthread_cond_wait(&openid->wake, &openid->lock);
    pthread_mutex_unlock(&openid->lock);
    return NULL;
}
