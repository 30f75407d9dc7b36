/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes audit trail entries for a session's messages: who changed what, and which requests were refused. */
#include <jansson.h>
#include <string.h>

#include "alarm/devices.h"
#include "audit/audit.h"
#include "base/mem.h"
#include "message/names.h"
#include "session/session_impl.h"

static void record(const struct session *session, const char *event, const char *result, const char *what, const char *why)
{
    const struct session_identity *identity = &session->identity;
    audit_say(session->context->records.audit, &(struct audit_entry){ .event = event,
                                                                      .result = result,
                                                                      .who = identity->role == ROLE_NOBODY ? NULL : session_who(session),
                                                                      .role = name_of(names_role, (int)identity->role),
                                                                      .from = identity->from,
                                                                      .how = "stream",
                                                                      .through = identity->through[0] ? identity->through : NULL,
                                                                      .what = what,
                                                                      .why = why });
}

static void add_alarms(struct text *what, const struct plant *plant, const struct alarm_request *request)
{
    struct devices *devices = devices_create(plant);
    text_add(what, "%s", alarm_event_name((enum alarm_event)request->action));
    for (int i = 0; i < request->count; i++) {
        enum alarm_kind kind = (enum alarm_kind)request->kinds[i];
        const char *name = kind == ALARM_LINK ? devices->list[request->tags[i]].name : plant->tags[request->tags[i]].name;
        text_add(what, "%s %s %s", i ? "," : "", name, alarm_kind_name(kind));
    }
    if (request->for_s > 0)
        text_add(what, " for %.0f s", request->for_s);
    devices_destroy(&devices);
}

char *session_alarm_what(const struct session *session, const struct message *message)
{
    const struct alarm_request *request = &message->alarm;
    struct text what = { 0 };
    add_alarms(&what, session->context->plant, request);
    if (request->name[0])
        text_add(&what, " as %s", request->name);
    if (request->reason[0])
        text_add(&what, ": %s", request->reason);
    return what.at;
}

void session_record_action(const struct session *session, const char *event, const char *what, const char *answer)
{
    json_t *said = json_loads(answer, 0, NULL), *refused = json_object_get(said, "refused");
    char *all = json_array_size(refused) ? json_dumps(refused, JSON_COMPACT) : NULL;
    bool done = json_integer_value(json_object_get(said, "done")) > 0 || json_is_true(json_object_get(said, "kept"));
    record(session, event, done ? "done" : "failed", what, all ? all : json_string_value(json_object_get(said, "why")));
    free(all);
    json_decref(said);
}

void session_record_not_kept(const struct session *session, const char *event, const char *what, const char *why)
{
    record(session, event, "failed", what, why);
}

char *session_loop_check_what(const struct session *session, const struct message *message, const char *answer)
{
    json_t *said = json_loads(answer, 0, NULL);
    char *what = mem_printf("%s: %s", session->context->plant->tags[message->loop_check.tag].name,
                            json_is_true(json_object_get(said, "passed")) ? "passed" : "not passed");
    json_decref(said);
    return what;
}

char *session_view_what(const struct message *message)
{
    return mem_printf("%s %s", message->type == MESSAGE_SAVE_VIEW ? "save" : "remove", message->view_edit.id);
}

char *session_note_what(const struct session *session, const struct message *message)
{
    const struct note_request *note = &message->note;
    const struct plant *plant = session->context->plant;
    const char *as = note->name[0] ? " as " : "", *author = notes_author(session->context->services->notes, note->id);
    if (message->type == MESSAGE_REMOVE_NOTE)
        return mem_printf("remove %s%s%s%s%s", note->id, author ? ", written by " : "", author ? author : "", as, note->name);
    const char *at = note->tag >= 0       ? plant->tags[note->tag].name
                     : note->asset >= 0   ? plant->assets[note->asset].id
                     : note->id[0]        ? note->id
                     : note->has_position ? "a place"
                                          : "the plant";
    return mem_printf("at %s%s%s: %s", at, as, note->name, note->text);
}

char *session_wall_what(const struct message *message)
{
    const struct wall_place *place = &message->wall.place;
    const char *did = message->view_edit.address[0] ? "send a view to" : message->wall.held ? "hold" : "give back";
    return mem_printf("%s %s, display %d, %s", did, place->wall, place->display, place->area);
}

static bool has_name(const struct session *session)
{
    return session->identity.role > ROLE_OPEN || session->identity.holder.name[0] || session->identity.through[0];
}

void session_record_leave(const struct session *session, const char *why)
{
    if (has_name(session))
        record(session, "leave", "done", NULL, why);
}

static char *accepted_what(const struct session *session, const struct message *message)
{
    const struct scene *scene = session->context->services->scene;
    uint8_t *outcome = mem_array(scene->plant->tag_count + 1, 1);
    size_t count = assumed_places_choose(scene, &message->tag_list.accept, outcome);
    char filter[400];
    assumed_filter_text(scene->plant, &message->tag_list.accept, filter, sizeof(filter));
    mem_free(outcome);
    return mem_printf("tag list: %zu assumed sensor place%s accepted (%s); the list is being activated", count, count == 1 ? "" : "s",
                      filter);
}

void session_record_save(const struct session *session, const struct message *message, size_t moved)
{
    const char *plural = moved == 1 ? "" : "s";
    char *what = message->type == MESSAGE_ACCEPT_PLACES ? accepted_what(session, message)
                 : message->type == MESSAGE_RESTORE_TAGS
                     ? mem_printf("tag list: %s restored; the list is being activated", message->tag_list.kept)
                     : mem_printf("tag list: %zu sensor%s placed; the list is being activated", moved, plural);
    record(session, "place", "done", what, NULL);
    mem_free(what);
}

static void record_baseline(const struct session *session, const struct params_change *change)
{
    bool removed = change->baseline == BASELINE_REMOVE;
    if (change->baseline != BASELINE_SET && change->baseline != BASELINE_NOW && !removed)
        return;
    char *what = mem_printf("%s %s", removed ? "forget" : "keep", change->baseline_name[0] ? change->baseline_name : "now");
    record(session, "baseline", "done", what, NULL);
    mem_free(what);
}

void session_record_params(const struct session *session, const struct message *message)
{
    record_baseline(session, &message->params);
    record_baseline(session, &message->split.right);
}

/* Returns whether a refused message is too frequent to be recorded. While a user drags the mouse, the page sends `camera` and
   `params` many times a second; if the user's token is limited to some views, all these messages are refused. */
static bool is_idle(const struct session *session, const char *about)
{
    return session->identity.holder.views[0] && (!strcmp(about, "camera") || !strcmp(about, "params"));
}

void session_record_refusal(const struct session *session, const struct message_error *error)
{
    if (has_name(session) && !is_idle(session, error->about) && !strcmp(error->code, "not_allowed"))
        record(session, "access", "refused", NULL, error->text);
}
