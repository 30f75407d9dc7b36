/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses and carries out the message `alarm`, by which a user acknowledges, resets or shelves alarms. */
#include "message/alarm_message.h"

#include <stdio.h>
#include <string.h>

#include "alarm/devices.h"
#include "base/mem.h"
#include "base/text/json_text.h"
#include "message/json_fields.h"

static const struct name names_action[] = { { "acknowledge", ALARM_ACKNOWLEDGE },
                                            { "reset", ALARM_RESET },
                                            { "shelve", ALARM_SHELVE },
                                            { "unshelve", ALARM_UNSHELVE },
                                            { "out_of_service", ALARM_TAKE_OUT },
                                            { "in_service", ALARM_PUT_BACK },
                                            { NULL, 0 } };

/* Returns the index of the tag with that name; for ALARM_LINK (connection alarms), the index of the device with that name; -1: none. */
static int find_named(const struct plant *plant, const char *name, enum alarm_kind kind)
{
    if (kind != ALARM_LINK)
        return plant_find_tag(plant, name);
    struct devices *devices = devices_create(plant);
    int index = devices_find(devices, name);
    devices_destroy(&devices);
    return index;
}

static bool take_alarm(const struct plant *plant, const json_t *pair, struct alarm_request *request, struct message_error *error)
{
    const char *tag = json_string_value(json_array_get(pair, 0)), *kind = json_string_value(json_array_get(pair, 1));
    char name[48];
    if (!tag || !kind || json_array_size(pair) != 2) {
        message_fail(error, "bad_field", "alarms: expected a list of [tag, kind], such as [\"TT-101\", \"HH\"]");
        return false;
    }
    request->kinds[request->count] = (uint8_t)alarm_kind_find(kind);
    request->tags[request->count] = find_named(plant, tag, alarm_kind_find(kind));
    if (request->tags[request->count] < 0)
        message_refuse_with(error, "bad_field", "alarms", strcmp(kind, "LINK") ? REFUSAL_NO_TAG : REFUSAL_NO_DEVICE, "name=%s",
                            quoted(tag, name));
    else if (!request->kinds[request->count])
        message_fail(error, "bad_field", "alarms: expected LL, L, H, HH, ALM, BAD or LINK, found '%s'", quoted(kind, name));
    else
        return ++request->count;
    return false;
}

bool alarm_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    struct alarm_request *request = &out->alarm;
    const json_t *alarms = json_object_get(o, "alarms");
    bool given, shelve, service;
    if (!need_seq(o, &out->seq, error) || !may_name(o, "action", names_action, &request->action, &given, error))
        return false;
    if (!given || json_array_size(alarms) == 0 || json_array_size(alarms) > ALARM_REQUEST_MOST) {
        message_fail(error, "bad_field", "action, alarms: expected an action and a list of 1 to %d alarms", ALARM_REQUEST_MOST);
        return false;
    }
    shelve = request->action == ALARM_SHELVE;
    service = request->action == ALARM_TAKE_OUT;
    for (size_t i = 0; i < json_array_size(alarms); i++)
        if (!take_alarm(plant, json_array_get(alarms, i), request, error))
            return false;
    return (!shelve || need_number(o, "for_s", 1, (double)(ALARM_LONGEST_SHELF_NS / 1000000000), &request->for_s, error)) &&
           need_words(o, "reason", shelve || service, request->reason, sizeof(request->reason), error) &&
           need_words(o, "name", false, request->name, sizeof(request->name), error);
}

char *alarm_do(struct alarm_service *alarm_service, const struct plant *plant, const struct message *message, const char *who)
{
    const struct alarm_request *request = &message->alarm;
    json_t *refused = json_array();
    struct devices *devices = devices_create(plant);
    char *person = request->name[0] ? mem_printf("%.40s (%s)", request->name, who) : mem_strdup(who);
    const struct alarm_act act = { (enum alarm_event)request->action, (int64_t)(request->for_s * 1e9), person, request->reason };
    for (int i = 0; i < request->count; i++) {
        enum alarm_kind kind = (enum alarm_kind)request->kinds[i];
        const char *name = kind == ALARM_LINK ? devices->list[request->tags[i]].name : plant->tags[request->tags[i]].name;
        enum refusal_code why = alarm_service_act(alarm_service, name, kind, &act);
        if (why)
            json_array_append_new(refused, json_pack("[s,s,s,o]", name, alarm_kind_name(kind), refusal_words(why),
                                                     refusal_json(&(struct refusal){ .code = why })));
    }
    int done = request->count - (int)json_array_size(refused);
    json_t *answer = json_pack("{s:s,s:I,s:i,s:o}", "type", "alarmed", "seq", (json_int_t)message->seq, "done", done, "refused", refused);
    char *text = json_text(answer, 0);
    mem_free(person);
    devices_destroy(&devices);
    return text;
}
