/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds back answers until their action is on disk. Only the answer waits, not the event loop. */
#include <errno.h>
#include <jansson.h>

#include "alarm/alarm_service.h"
#include "audit/audit.h"
#include "base/files/atomic_file.h"
#include "base/text/json_text.h"
#include "base/mem.h"
#include "session/session_impl.h"

struct kept_answer {
    char *text, *what; /* description of an action on alarms, for the audit trail; NULL: no alarm action */
    /* alarm service that carried out the action; NULL: the journal's decision is in `journal`, or there was no alarm action */
    const struct alarm_service *alarms;
    int journal_error; /* 0: the action is in the journal on disk; -errno: writing failed */
    struct settling_ticket journal, audit;
    struct kept_answer *next;
};

/* Returns whether the journal has the action on disk: 0, -EINPROGRESS or an error. A plant reload replaces the journal: the decision of the
   old one stands, and without a decision the action counts as not kept (-ECANCELED). */
static int journal_state(const struct session *session, struct kept_answer *kept)
{
    struct alarm_service *service = session->context->alarm_service;
    if (kept->alarms)
        kept->journal_error = kept->alarms == service ? alarm_service_settled(service, &kept->journal) : -ECANCELED;
    if (kept->journal_error != -EINPROGRESS)
        kept->alarms = NULL;
    return kept->journal_error;
}

static void say_not_kept(json_t *answer, int error)
{
    json_object_set(answer, "not_kept", json_object_get(answer, "done"));
    json_object_set_new(answer, "done", json_integer(0));
    refusal_add(answer, atomic_file_not_kept(error));
}

static void answer_now(struct session *session, struct kept_answer *kept, int journal_error, int audit_error)
{
    json_t *answer = journal_error || audit_error ? json_loads(kept->text, 0, NULL) : NULL;
    if (answer && journal_error && json_integer_value(json_object_get(answer, "done")) > 0) {
        say_not_kept(answer, journal_error);
        session_record_not_kept(session, kept->what, refusal_words(atomic_file_not_kept(journal_error)));
    }
    if (answer && audit_error)
        refusal_add_unaudited(answer, atomic_file_not_kept(audit_error));
    if (answer) {
        mem_free(kept->text);
        kept->text = json_text(answer, 0);
    }
    session_reply(session, kept->text);
    mem_free(kept->what);
    mem_free(kept);
}

/* Queues the answer if it is known whether its action is on disk, or immediately if `now` is true. Returns true if the answer was queued
   and removed from the list; *at is then the next answer. */
static bool try_to_answer(struct session *session, struct kept_answer **at, bool now)
{
    struct kept_answer *kept = *at;
    int journal = journal_state(session, kept), audit = audit_settled(session->context->audit, &kept->audit);
    if (!now && (journal == -EINPROGRESS || audit == -EINPROGRESS))
        return false;
    *at = kept->next;
    session->kept_count--;
    answer_now(session, kept, journal == -EINPROGRESS ? -ETIMEDOUT : journal, audit == -EINPROGRESS ? -ETIMEDOUT : audit);
    return true;
}

struct kept_action session_kept_begin(const struct session *session)
{
    struct kept_action action = { .audit = audit_begin(session->context->audit) };
    if (session->context->alarm_service)
        action.journal = alarm_service_begin(session->context->alarm_service);
    return action;
}

void session_kept_reply(struct session *session, const struct kept_action *action, char *answer, char *alarm_what)
{
    struct kept_answer *kept = mem_new(sizeof(*kept)), **last = &session->kept;
    *kept = (struct kept_answer){ .text = answer, .what = alarm_what, .journal = action->journal, .audit = action->audit };
    if (alarm_what) {
        kept->alarms = session->context->alarm_service;
        alarm_service_end(session->context->alarm_service, &kept->journal);
    }
    audit_end(session->context->audit, &kept->audit);
    while (*last)
        last = &(*last)->next;
    *last = kept;
    session->kept_count++;
    if (session->kept_count == SESSION_MAX_REPLIES)
        try_to_answer(session, &session->kept, true);
    session_settle(session);
}

bool session_settle(struct session *session)
{
    bool answered = false;
    for (struct kept_answer **at = &session->kept; *at;)
        if (try_to_answer(session, at, false))
            answered = true;
        else
            at = &(*at)->next;
    if (session->kept && session->context->kept_answers)
        session->context->kept_answers->waiting = true;
    return answered;
}

static bool waits_for_journal(const struct session *session)
{
    const struct kept_answer *kept = session->kept;
    while (kept && !kept->alarms)
        kept = kept->next;
    return kept != NULL;
}

void session_retire(struct session **session_ptr)
{
    struct session *session = *session_ptr;
    struct kept_answers *answers = session->context->kept_answers;
    session_settle(session);
    if (!answers || !waits_for_journal(session)) {
        session_destroy(session_ptr);
        return;
    }
    session_let_go(session);
    session->next_gone = answers->gone;
    answers->gone = session;
    *session_ptr = NULL;
}

void session_settle_gone(struct kept_answers *answers)
{
    for (struct session **at = &answers->gone, *session; (session = *at);) {
        session_settle(session);
        if (waits_for_journal(session)) {
            at = &session->next_gone;
            continue;
        }
        *at = session->next_gone;
        session_destroy(&session);
    }
}

void session_kept_drop(struct session *session)
{
    for (struct kept_answer *kept = session->kept, *next; kept; kept = next) {
        next = kept->next;
        mem_free(kept->text);
        mem_free(kept->what);
        mem_free(kept);
    }
    session->kept = NULL;
}
