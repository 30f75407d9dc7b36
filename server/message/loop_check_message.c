/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records loop checks: an engineer tests that a tag shows the value of the right transmitter. The result depends on the reading
   that this daemon receives, not on a value entered by a user. */
#include "message/loop_check_message.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "message/json_fields.h"
#include "message/json_values.h"
#include "value/quality.h"

bool loop_check_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    struct loop_check_request *request = &out->loop_check;
    const char *tag = json_string_value(json_object_get(o, "tag"));
    const json_t *fail = json_object_get(o, "fail");
    char name[48];
    request->tag = tag ? plant_find_tag(plant, tag) : -1;
    request->fail = json_is_true(fail);
    if (request->tag < 0)
        message_refuse_with(error, "bad_field", "tag", REFUSAL_NO_TAG, "name=%s", quoted(tag ? tag : "", name));
    else if (plant->tags[request->tag].source < 0)
        message_refuse_with(error, "bad_field", "tag", REFUSAL_COMPUTED, "tag=%s", quoted(tag, name));
    else if (fail && !json_is_boolean(fail))
        message_fail(error, "bad_field", "fail: expected true or false");
    else
        return need_seq(o, &out->seq, error) && need_number(o, "expected", -1e30, 1e30, &request->expected, error) &&
               need_number(o, "tolerance", 0, 1e30, &request->tolerance, error) &&
               need_words(o, "remark", false, request->remark, sizeof(request->remark), error);
    return false;
}

char *loop_check_do(struct loop_checks *loop_checks, const struct plant *plant, const struct snapshot *now, const struct message *message,
                    const char *who)
{
    const struct loop_check_request *request = &message->loop_check;
    const struct reading *reading = &now->readings[request->tag];
    bool good = !quality_is_bad(reading->quality) && !quality_is_uncertain(reading->quality) && isfinite(reading->value);
    bool near = good && fabs(reading->value - request->expected) <= request->tolerance;
    struct loop_check check = { .state = near && !request->fail ? LOOP_CHECK_PASSED : LOOP_CHECK_FAILED,
                                .time_us = now->taken_utc_ns / 1000,
                                .value = good ? reading->value : NAN,
                                .expected = request->expected,
                                .tolerance = request->tolerance };
    snprintf(check.who, sizeof(check.who), "%s", who);
    snprintf(check.remark, sizeof(check.remark), "%s", request->remark);
    enum refusal_code lost = loop_checks_add(loop_checks, request->tag, &check);
    enum refusal_code why = lost                    ? lost
                            : near && request->fail ? REFUSAL_FAILED
                            : near                  ? REFUSAL_NONE
                            : good                  ? REFUSAL_TOLERANCE
                                                    : REFUSAL_READING;
    json_t *answer =
        json_pack("{s:s,s:I,s:s,s:b,s:b,s:o}", "type", "proved", "seq", (json_int_t)message->seq, "tag", plant->tags[request->tag].name,
                  "kept", !lost, "passed", check.state == LOOP_CHECK_PASSED && !lost, "value", number(check.value));
    refusal_add(answer, why);
    return json_text(answer, 9);
}

json_t *loop_checks_message(const struct loop_checks *loop_checks, const struct plant *plant, uint64_t since, bool all)
{
    json_t *list = json_array();
    all = all || since < loop_checks_replaced_number(loop_checks);
    for (size_t i = 0; i < plant->tag_count; i++) {
        const struct loop_check *check = loop_checks_of(loop_checks, (int)i);
        if (check->state == LOOP_CHECK_NONE || (!all && loop_checks_number_of(loop_checks, (int)i) <= since))
            continue;
        json_t *row =
            json_pack("[i,s,I,o,o,o,o,o]", (int)i, loop_check_state_names[check->state], (json_int_t)check->time_us, number(check->value),
                      number(check->expected), number(check->tolerance), json_string(check->who), json_string(check->remark));
        json_array_append_new(list, row); /* leaves out a NULL row (out of memory) */
    }
    return json_pack("{s:s,s:b,s:b,s:o}", "type", "proofs", "all", all, "begun", loop_checks_begun(loop_checks), "tags", list);
}

char *loop_checks_text(const struct loop_checks *loop_checks, const struct plant *plant, uint64_t since, bool all)
{
    return json_text(loop_checks_message(loop_checks, plant, since, all), 9);
}

static double value_of(const json_t *value)
{
    return json_is_number(value) ? json_number_value(value) : NAN;
}

/* Reads a row of `proofs`. Returns false if the row is invalid. */
static bool read_row(const json_t *json, size_t tag_count, struct loop_check_row *out)
{
    json_int_t tag, time_us;
    const char *state, *who, *remark;
    json_t *value, *expected, *tolerance;
    struct loop_check *check = &out->check;
    if (json_unpack((json_t *)json, "[I,s,I,o,o,o,s,s]", &tag, &state, &time_us, &value, &expected, &tolerance, &who, &remark) != 0 ||
        tag < 0 || (size_t)tag >= tag_count)
        return false;
    out->tag = (int)tag;
    *check = (struct loop_check){
        .time_us = time_us, .value = value_of(value), .expected = value_of(expected), .tolerance = value_of(tolerance)
    };
    for (int i = LOOP_CHECK_PASSED; i <= LOOP_CHECK_CHANGED; i++)
        if (!strcmp(state, loop_check_state_names[i]))
            check->state = (enum loop_check_state)i;
    snprintf(check->who, sizeof(check->who), "%s", who);
    snprintf(check->remark, sizeof(check->remark), "%s", remark);
    return check->state != LOOP_CHECK_NONE;
}

bool loop_checks_take(struct loop_checks *loop_checks, const struct plant *plant, const json_t *message)
{
    const json_t *list = json_object_get(message, "tags");
    size_t count = json_array_size(list);
    bool good = json_is_array(list);
    struct loop_check_row *rows = mem_array(count, sizeof(*rows));
    for (size_t i = 0; i < count && good; i++)
        good = read_row(json_array_get(list, i), plant->tag_count, &rows[i]);
    if (good)
        loop_checks_mirror(loop_checks, rows, count, json_is_true(json_object_get(message, "all")),
                           json_is_true(json_object_get(message, "begun")));
    mem_free(rows);
    return good;
}
