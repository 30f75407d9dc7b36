/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes alarm messages as e-mail text for users and as JSON for programs. */
#include "notify/notify_text.h"

#include <math.h>
#include <openssl/evp.h>
#include <string.h>
#include <time.h>

#include "base/math/round_reading.h"
#include "base/mem.h"
#include "base/text/json_text.h"
#include "base/text/timestamp.h"

/* BASE64_LINE: number of bytes that a base64 line of 76 characters encodes. WORD: number of bytes encoded by one encoded word
   (RFC 2047); with it, the word fits into a line of 77 characters after the header's name. */
enum { BASE64_LINE = 57, WORD = 42 };

#define TEST_TEXT "Test message, no alarm"

static const struct plant_tag *tag_of(const struct plant *plant, const struct outbox_item *item)
{
    return item->tag < 0 ? NULL : &plant->tags[item->tag];
}

static const struct plant_asset *asset_of(const struct plant *plant, const struct outbox_item *item)
{
    int asset = item->tag < 0 ? -1 : plant->tags[item->tag].asset;
    return asset < 0 ? NULL : &plant->assets[asset];
}

static const char *kind_in_words(enum alarm_kind kind)
{
    static const char *const words[ALARM_KINDS] = { [ALARM_NONE] = "", [ALARM_LL] = "low low", [ALARM_L] = "low", [ALARM_H] = "high",
                                                    [ALARM_HH] = "high high", [ALARM_ON] = "alarm", [ALARM_BAD] = "bad measurement",
                                                    [ALARM_LINK] = "no connection" };
    return words[kind];
}

/* --- e-mail ----------------------------------------------------------------------------------------------------------------- */

static void add_base64(struct text *out, const char *bytes, size_t count)
{
    unsigned char line[4 * (BASE64_LINE / 3 + 1) + 1];
    int length = EVP_EncodeBlock(line, (const unsigned char *)bytes, (int)count);
    text_add_bytes(out, line, (size_t)length);
}

static bool is_plain(const char *text)
{
    for (; *text; text++)
        if ((unsigned char)*text < ' ' || (unsigned char)*text > '~')
            return false;
    return true;
}

/* Adds a header line of an e-mail. Writes a short ASCII value unchanged, and any other value as encoded words (RFC 2047), none
   of which ends within a character. */
static void add_header(struct text *out, const char *name, const char *value)
{
    text_add(out, "%s:", name);
    if (is_plain(value) && strlen(value) < 900 && !strstr(value, "=?")) {
        text_add(out, " %s\r\n", value);
        return;
    }
    for (size_t length; *value; value += length) {
        for (length = strlen(value); length > WORD || (value[length] & 0xC0) == 0x80;)
            length = length > WORD ? WORD : length - 1;
        text_add(out, " =?UTF-8?B?");
        add_base64(out, value, length);
        text_add(out, "?=\r\n");
    }
}

static void add_local_time(struct text *out, const char *format, int64_t utc_us)
{
    char text[64] = "";
    time_t s = (time_t)(utc_us / 1000000);
    struct tm local;
    if (localtime_r(&s, &local))
        strftime(text, sizeof(text), format, &local);
    text_add(out, "%s", text);
}

/* Adds the Date header of an e-mail, in English whatever the locale. */
static void add_date(struct text *out, int64_t utc_us)
{
    static const char *const days[] = { "Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat" };
    static const char *const months[] = { "Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec" };
    time_t s = (time_t)(utc_us / 1000000);
    struct tm utc;
    if (gmtime_r(&s, &utc))
        text_add(out, "Date: %s, %d %s %d %02d:%02d:%02d +0000\r\n", days[utc.tm_wday], utc.tm_mday, months[utc.tm_mon], 1900 + utc.tm_year,
                 utc.tm_hour, utc.tm_min, utc.tm_sec);
}

/* Returns why an escalation step sends an alarm again; "" if the alarm is not escalated or has ended. If the plant has no
   acknowledgements (alarms: display), the daemon knows only that the alarm is still active. */
static const char *escalated_for(const struct outbox_item *item)
{
    bool waits = item->status == ALARM_UNACKNOWLEDGED || item->status == ALARM_RETURNED;
    return item->step == 0 || item->ended_us ? "" : waits ? "Not acknowledged" : "Still present";
}

static void add_name(struct text *out, const struct plant *plant, const struct outbox_item *item)
{
    const struct plant_tag *tag = tag_of(plant, item);
    text_add(out, "%s %s", item->name, kind_in_words(item->kind));
    if (tag && tag->description && *tag->description)
        text_add(out, ", %s", tag->description);
}

static void add_line(struct text *out, const struct plant *plant, const struct outbox_item *item)
{
    const struct plant_asset *asset = asset_of(plant, item);
    const char *unit = plant_tag_unit(plant, item->tag), *space = *unit ? " " : "";
    text_add(out, "P%d  ", item->priority);
    add_local_time(out, "%Y-%m-%d %H:%M:%S", item->raised_us);
    text_add(out, "  ");
    add_name(out, plant, item);
    if (isfinite(item->value) && item->kind != ALARM_ON && item->kind != ALARM_BAD)
        text_add(out, ": raised at %.*g%s%s", READING_DIGITS, round_reading(item->value), space, unit);
    if (isfinite(item->limit))
        text_add(out, " (limit %.*g%s%s)", READING_DIGITS, round_reading(item->limit), space, unit);
    if (asset)
        text_add(out, "; %s%s%s", asset->tag, *asset->area ? ", " : "", asset->area);
    if (*escalated_for(item))
        text_add(out, "; %s", escalated_for(item));
    if (item->ended_us)
        text_add(out, item->status == ALARM_ACKNOWLEDGED ? "; acknowledged since" : "; no longer present");
    text_add(out, "\r\n");
}

static void add_subject(struct text *out, const struct plant *plant, const struct outbox_message *message)
{
    int most_urgent = message->items[0].priority;
    size_t of_it = 0;
    while (of_it < message->count && message->items[of_it].priority == most_urgent)
        of_it++;
    text_add(out, "[%s] ", plant->name);
    if (message->is_test) {
        text_add(out, "%s", TEST_TEXT);
    } else if (message->count == 1) {
        const char *why = escalated_for(&message->items[0]);
        text_add(out, "%s%sP%d ", why, *why ? ": " : "", most_urgent);
        add_name(out, plant, &message->items[0]);
    } else {
        text_add(out, "%zu alarms, %zu of priority %d", message->count, of_it, most_urgent);
    }
}

static void add_body(struct text *out, const struct plant *plant, const struct outbox_message *message)
{
    if (message->is_test)
        text_add(out, "%s: %s\r\n", plant->name, TEST_TEXT);
    else
        text_add(out, "%s: %zu alarm%s\r\n\r\n", plant->name, message->count, message->count == 1 ? "" : "s");
    for (size_t i = 0; i < message->count && i < NOTIFY_LINES && !message->is_test; i++)
        add_line(out, plant, &message->items[i]);
    if (message->count > NOTIFY_LINES)
        text_add(out, "... and %zu more\r\n", message->count - NOTIFY_LINES);
    if (message->left_out > 0)
        text_add(out, "\r\n%lld more alarms are not listed: they were dropped while messages could not be delivered.\r\n",
                 (long long)message->left_out);
    text_add(out, "\r\nTime zone of all times: %s.", plant->time_zone);
    if (plant->notify->link)
        text_add(out, " %s", plant->notify->link);
    text_add(out, "\r\n");
}

void notify_mail_text(struct text *out, const struct plant *plant, const struct notify_recipient *recipient,
                      const struct outbox_message *message, int64_t now_us)
{
    struct text subject = { 0 }, body = { 0 };
    const char *domain = strchr(plant->notify->mail.from, '@');
    add_subject(&subject, plant, message);
    add_body(&body, plant, message);
    text_add(out, "From: %s\r\n", plant->notify->mail.from);
    for (size_t i = 0; i < recipient->addresses.count; i++)
        text_add(out, i == 0 ? "To: %s" : ",\r\n %s", recipient->addresses.at[i]);
    text_add(out, "\r\n");
    add_header(out, "Subject", subject.at);
    add_date(out, now_us);
    text_add(out, "Message-ID: <%s.%s%s>\r\n", message->id, plant->files.hash, domain ? domain : "@plantcast");
    text_add(out, "Auto-Submitted: auto-generated\r\nX-Priority: %d\r\nMIME-Version: 1.0\r\n", message->items[0].priority == 1 ? 1 : 3);
    text_add(out, "Content-Type: text/plain; charset=utf-8\r\nContent-Transfer-Encoding: base64\r\n\r\n");
    for (size_t at = 0; at < body.length; at += BASE64_LINE) {
        add_base64(out, body.at + at, body.length - at < BASE64_LINE ? body.length - at : BASE64_LINE);
        text_add(out, "\r\n");
    }
    text_finish(&subject);
    text_finish(&body);
}

/* --- JSON ------------------------------------------------------------------------------------------------------------------- */

static void set_text(json_t *object, const char *key, const char *value)
{
    if (value && *value)
        json_object_set_new(object, key, json_string(value));
}

static void set_time(json_t *object, const char *key, int64_t utc_us)
{
    char text[TIMESTAMP_BYTES];
    timestamp_print(utc_us, text);
    json_object_set_new(object, key, json_string(text));
}

static void set_number(json_t *object, const char *key, double value)
{
    if (isfinite(value))
        json_object_set_new(object, key, json_real(round_reading(value)));
}

static json_t *webhook_alarm(const struct plant *plant, const struct outbox_item *item)
{
    const struct plant_tag *tag = tag_of(plant, item);
    const struct plant_asset *asset = asset_of(plant, item);
    json_t *alarm = json_pack("{s:s,s:s,s:i,s:s,s:i}", item->tag < 0 ? "device" : "tag", item->name, "kind", alarm_kind_name(item->kind),
                              "priority", item->priority, "state", alarm_status_name(item->status), "escalation", item->step);
    set_time(alarm, "raised", item->raised_us);
    if (item->ended_us)
        set_time(alarm, "ended", item->ended_us);
    set_number(alarm, "value", item->value);
    set_number(alarm, "limit", item->limit);
    set_text(alarm, "unit", plant_tag_unit(plant, item->tag));
    set_text(alarm, "description", tag ? tag->description : NULL);
    set_text(alarm, "asset", asset ? asset->tag : NULL);
    set_text(alarm, "area", asset ? asset->area : NULL);
    return alarm;
}

char *notify_webhook_text(const struct plant *plant, const struct notify_recipient *recipient, const struct outbox_message *message)
{
    json_t *alarms = json_array();
    for (size_t i = 0; i < message->count; i++)
        json_array_append_new(alarms, webhook_alarm(plant, &message->items[i]));
    json_t *body = json_pack("{s:i,s:s,s:s,s:s}", "version", 1, "id", message->id, "plant", plant->name, "recipient", recipient->id);
    set_time(body, "made", message->made_us);
    set_text(body, "link", plant->notify->link);
    if (message->is_test)
        json_object_set_new(body, "test", json_true());
    if (message->left_out > 0)
        json_object_set_new(body, "left_out", json_integer((json_int_t)message->left_out));
    json_object_set_new(body, "alarms", alarms);
    return json_text(body, READING_DIGITS);
}

static const char *severity_of(int priority)
{
    return priority == 1 ? "critical" : priority == 2 ? "error" : priority == 3 ? "warning" : "info";
}

static json_t *alert(const struct plant *plant, const struct outbox_item *item, bool is_test, int64_t now_us)
{
    const struct plant_tag *tag = tag_of(plant, item);
    const struct plant_asset *asset = asset_of(plant, item);
    char priority[2] = { (char)('0' + item->priority), 0 };
    struct text summary = { 0 };
    if (is_test)
        text_add(&summary, "%s", TEST_TEXT);
    else
        add_name(&summary, plant, item);
    json_t *labels = json_pack("{s:s,s:s,s:s,s:s,s:s,s:s}", "alertname", "PlantAlarm", "plant", plant->name,
                               item->tag < 0 ? "device" : "tag", item->name, "kind", alarm_kind_name(item->kind), "priority", priority,
                               "severity", severity_of(item->priority));
    set_text(labels, "asset", asset ? asset->tag : NULL);
    set_text(labels, "area", asset ? asset->area : NULL);
    json_t *annotations = json_pack("{s:s,s:s}", "summary", summary.at, "state", alarm_status_name(item->status));
    set_text(annotations, "description", tag ? tag->description : NULL);
    if (isfinite(item->value)) {
        char *value = mem_printf("%.*g", READING_DIGITS, round_reading(item->value));
        set_text(annotations, "value", value);
        set_text(annotations, "unit", plant_tag_unit(plant, item->tag));
        mem_free(value);
    }
    json_t *one = json_pack("{s:o,s:o}", "labels", labels, "annotations", annotations);
    /* Alertmanager refuses an alert that starts after it ends, as after the wall clock was set back */
    int64_t latest_us = item->ended_us ? item->ended_us : now_us;
    set_time(one, "startsAt", item->raised_us < latest_us ? item->raised_us : latest_us);
    set_time(one, "endsAt", item->ended_us ? item->ended_us : now_us + OUTBOX_ALERT_US);
    set_text(one, "generatorURL", plant->notify->link);
    text_finish(&summary);
    return one;
}

char *notify_alerts_text(const struct plant *plant, const struct outbox_message *message, int64_t now_us)
{
    json_t *alerts = json_array();
    for (size_t i = 0; i < message->count; i++)
        json_array_append_new(alerts, alert(plant, &message->items[i], message->is_test, now_us));
    return json_text(alerts, 0);
}

char *notify_text(const struct plant *plant, const struct notify_recipient *recipient, const struct outbox_message *message, int64_t now_us,
                  size_t *bytes)
{
    struct text mail = { 0 };
    char *json = NULL;
    switch (recipient->kind) {
    case NOTIFY_EMAIL: notify_mail_text(&mail, plant, recipient, message, now_us); break;
    case NOTIFY_WEBHOOK: json = notify_webhook_text(plant, recipient, message); break;
    case NOTIFY_ALERTMANAGER: json = notify_alerts_text(plant, message, now_us); break;
    }
    *bytes = json ? strlen(json) : mail.length;
    return json ? json : mail.at;
}
