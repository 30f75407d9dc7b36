/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Withholds the answer to a user's action until the journal, the saved file and the audit trail have the action on disk. The
   event loop does not wait. */
#include <errno.h>
#include <jansson.h>
#include <string.h>

#include "alarm/alarm_service.h"
#include "audit/audit.h"
#include "base/files/atomic_file.h"
#include "base/text/json_text.h"
#include "base/mem.h"
#include "session/session_impl.h"

struct kept_answer {
    char *text;
    char *what;        /* description of the user's action, for the audit trail */
    const char *event; /* kind of the user's action, for the audit trail */
    /* alarm service that carried out the action and writes its journal; NULL: journal_error has the result, or the action concerns no
       alarm */
    const struct alarm_service *alarms;
    int journal_error; /* result of writing the action to the alarm journal: 0: it is on disk; -errno: writing failed */
    struct settling_ticket journal, file, audit;
    struct kept_answer *next;
};

/* Returns whether the action is in the alarm journal on disk: 0, -EINPROGRESS or an error. A plant reload replaces the journal.
   A result from the old journal stays valid; an action without one counts as not kept (-ECANCELED). */
static int journal_state(const struct session *session, struct kept_answer *kept)
{
    struct alarm_service *service = session->context->services->alarm_service;
    if (kept->alarms)
        kept->journal_error = kept->alarms == service ? alarm_service_settled(service, &kept->journal) : -ECANCELED;
    if (kept->journal_error != -EINPROGRESS)
        kept->alarms = NULL;
    return kept->journal_error;
}

/* Returns whether alarm journal and saved file have the action on disk: 0, -EINPROGRESS or an error. */
static int disk_state(const struct session *session, struct kept_answer *kept)
{
    int journal = journal_state(session, kept), file = file_writer_settled(session->context->records.file_writer, &kept->file);
    return journal ? journal : file;
}

/* Makes an answer that reports an action as saved report the error instead. Returns false if the answer says nothing about saving. */
static bool say_not_kept(json_t *answer, int error)
{
    json_t *done = json_object_get(answer, "done");
    /* the answer concerns alarms: the action has taken effect (`done` alarms changed), although it is not on disk */
    if (json_integer_value(done) > 0) {
        json_object_set(answer, "not_kept", done);
        json_object_set_new(answer, "done", json_integer(0));
    } else if (json_is_true(json_object_get(answer, "kept"))) {
        json_object_set_new(answer, "kept", json_false());
        if (json_object_get(answer, "passed"))
            json_object_set_new(answer, "passed", json_false());
    } else {
        return false;
    }
    refusal_add(answer, atomic_file_not_kept(error));
    return true;
}

static void answer_now(struct session *session, struct kept_answer *kept, int disk_error, int audit_error)
{
    json_t *answer = disk_error || audit_error ? json_loads(kept->text, 0, NULL) : NULL;
    if (answer && disk_error && say_not_kept(answer, disk_error))
        session_record_not_kept(session, kept->event, kept->what, refusal_words(atomic_file_not_kept(disk_error)));
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

/* Queues the answer if it is known whether its action is on disk, or in any case if `now` is true. Returns true if the answer
   was queued and removed from the list; *at then points to the next waiting answer. */
static bool try_to_answer(struct session *session, struct kept_answer **at, bool now)
{
    struct kept_answer *kept = *at;
    int disk = disk_state(session, kept), audit = audit_settled(session->context->records.audit, &kept->audit);
    if (!now && (disk == -EINPROGRESS || audit == -EINPROGRESS))
        return false;
    *at = kept->next;
    session->kept_count--;
    answer_now(session, kept, disk == -EINPROGRESS ? -ETIMEDOUT : disk, audit == -EINPROGRESS ? -ETIMEDOUT : audit);
    return true;
}

struct kept_action session_kept_begin(const struct session *session)
{
    const struct session_context *context = session->context;
    struct kept_action action = { .file = file_writer_begin(context->records.file_writer), .audit = audit_begin(context->records.audit) };
    if (context->services->alarm_service)
        action.journal = alarm_service_begin(context->services->alarm_service);
    return action;
}

void session_kept_reply(struct session *session, const struct kept_action *action, const char *event, char *what, char *answer)
{
    const struct session_context *context = session->context;
    struct kept_answer *kept = mem_new(sizeof(*kept)), **last = &session->kept;
    *kept = (struct kept_answer){
        .text = answer, .what = what, .event = event, .journal = action->journal, .file = action->file, .audit = action->audit
    };
    if (!strcmp(event, "alarm")) {
        kept->alarms = context->services->alarm_service;
        alarm_service_end(context->services->alarm_service, &kept->journal);
    }
    file_writer_end(context->records.file_writer, &kept->file);
    session_record_action(session, event, what, answer);
    audit_end(context->records.audit, &kept->audit);
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
    if (session->kept && session->context->records.kept_answers)
        session->context->records.kept_answers->waiting = true;
    return answered;
}

bool session_kept_waits(const struct session *session)
{
    struct kept_answer *kept = session->kept;
    while (kept && disk_state(session, kept) != -EINPROGRESS)
        kept = kept->next;
    return kept != NULL;
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
