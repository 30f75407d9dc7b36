/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the values of an MQTT message to the tags of its topic. */
#include <ctype.h>
#include <stdio.h>

#include "base/clock.h"
#include "plant/sources/mqtt_address.h"
#include "value/mqtt/mqtt_impl.h"
#include "value/quality.h"

static const int64_t SKEW_NS = 5 * NS_PER_S, SKEW_SAID_NS = 60 * NS_PER_S;

/* Returns a publisher's name for a log line: shortened and without control characters, in `out`. */
static const char *shown(const char *name, char out[64])
{
    size_t n = 0;
    for (; n < 60 && name[n]; n++)
        out[n] = iscntrl((unsigned char)name[n]) ? '?' : name[n];
    snprintf(out + n, 64 - n, "%s", name[n] ? "..." : "");
    return out;
}

void mqtt_refuse(struct mqtt_source *mqtt, const struct mqtt_message *message, const char *why)
{
    char topic[64], more[LOG_PACE_BYTES];
    counter_inc(mqtt->messages_refused, 1);
    snprintf(mqtt->last_refused, sizeof(mqtt->last_refused), "%s: a message of %zu bytes was refused: %s", shown(message->topic, topic),
             message->count, why);
    if (log_pace_take(&mqtt->refusals, clock_mono_ns(), more))
        log_warn(mqtt->base.log, "source %s: %s%s", mqtt->base.config->id, mqtt->last_refused, more);
}

void mqtt_log_left_out(struct mqtt_source *mqtt, int64_t now_ns)
{
    char more[LOG_PACE_BYTES];
    if (log_pace_flush(&mqtt->refusals, now_ns, more))
        log_warn(mqtt->base.log, "source %s: %s%s", mqtt->base.config->id, mqtt->last_refused, more);
    if (log_pace_flush(&mqtt->absences, now_ns, more))
        log_warn(mqtt->base.log, "source %s: received messages without a value of any tag%s", mqtt->base.config->id, more);
}

static void report_skew(struct mqtt_source *mqtt, const char *topic)
{
    int64_t skew_ns = mqtt->writer.worst_skew_ns, now_ns = mqtt->writer.mono_ns;
    char name[64];
    int64_t *said_ns = &mqtt->skew_said_ns[skew_ns > 0];
    /* No warning for an old time in Sparkplug: its timestamps state when a metric last changed, so they may be old although the
       node's clock is right. */
    if (mqtt->sparkplug && skew_ns < 0)
        return;
    if ((skew_ns < SKEW_NS && skew_ns > -SKEW_NS) || (*said_ns && now_ns - *said_ns < SKEW_SAID_NS))
        return;
    *said_ns = now_ns;
    log_warn(mqtt->base.log, "source %s: %s: the timestamps of the messages are %.1f s %s this machine's clock", mqtt->base.config->id,
             shown(topic, name), (double)(skew_ns > 0 ? skew_ns : -skew_ns) / 1e9, skew_ns > 0 ? "ahead of" : "behind");
}

static void all_bad(struct mqtt_source *mqtt, const struct mqtt_topic *topic)
{
    for (size_t i = 0; i < topic->tag_count; i++)
        stamped_writer_add_bad(&mqtt->writer, topic->tags[i], QUALITY_BAD_CONFIGURATION);
}

static bool take_number(struct mqtt_source *mqtt, const struct mqtt_topic *topic, const struct mqtt_message *message, bool was_kept)
{
    struct stamped_value value = { .quality = QUALITY_GOOD };
    if (!mqtt_number_read(message->payload, message->count, &value.value))
        return false;
    for (size_t i = 0; i < topic->tag_count; i++)
        stamped_writer_add(&mqtt->writer, topic->tags[i], &value, was_kept, false);
    return true;
}

/* Handles a JSON message that lacks a tag's value. If no message has contained a value of the tag yet, the tag's path is
   probably wrong, so the tag becomes Bad_NoMatch. A value in the store may come from an earlier source with the same path: from
   before a reload, or from the core whose lead this daemon has taken over. */
static void note_absent(struct mqtt_source *mqtt, const struct mqtt_topic *topic, const struct mqtt_reader *reader, int tag)
{
    char name[64], more[LOG_PACE_BYTES];
    if (mqtt->matched[tag] || store_has_value(mqtt->base.store, tag))
        return;
    stamped_writer_add_bad(&mqtt->writer, tag, QUALITY_BAD_NO_MATCH);
    if (log_pace_take(&mqtt->absences, clock_mono_ns(), more))
        log_warn(mqtt->base.log, "source %s: %s: no message has had a value of tag %s yet (at the path %.80s)%s", mqtt->base.config->id,
                 shown(topic->name, name), reader->tag, *reader->path ? reader->path : "value", more);
}

/* Writes the values in a JSON message to the tags of its topic. Returns false if the value of at least one tag is refused; such a tag
 * becomes Bad. */
static bool take_json(struct mqtt_source *mqtt, const struct mqtt_topic *topic, const json_t *root, const struct mqtt_message *message,
                      char why[200])
{
    const struct plant_mqtt *config = &mqtt->base.config->mqtt;
    bool all_good = true;
    for (size_t i = 0; i < topic->tag_count; i++) {
        struct stamped_value value;
        int tag = topic->tags[i];
        const struct plant_tag *of = &mqtt->base.plant->tags[tag];
        const struct mqtt_reader reader = { config, mqtt_address_path(mqtt->base.plant, of), of->name };
        enum mqtt_found found = mqtt_json_read(root, &reader, &value, why);
        if (found == MQTT_FOUND)
            stamped_writer_add(&mqtt->writer, tag, &value, message->is_retained || (!mqtt->subscribed && !value.utc_ns), false);
        else if (found == MQTT_WRONG)
            stamped_writer_add_bad(&mqtt->writer, tag, value.quality);
        else
            note_absent(mqtt, topic, &reader, tag);
        mqtt->matched[tag] |= found == MQTT_FOUND;
        all_good &= found != MQTT_WRONG;
    }
    return all_good;
}

/* Writes the values of a message to the tags of its topic. Returns false with the reason in `why` if the message is refused. */
static bool take(struct mqtt_source *mqtt, const struct mqtt_topic *topic, const struct mqtt_message *message, char why[200])
{
    snprintf(why, 200, "longer than %d MiB", MQTT_MAX_PAYLOAD >> 20);
    if (message->count > MQTT_MAX_PAYLOAD) {
        all_bad(mqtt, topic);
        return false;
    }
    snprintf(why, 200, "expected one number");
    if (mqtt->base.config->mqtt.payload == MQTT_NUMBER) {
        bool good = take_number(mqtt, topic, message, message->is_retained || !mqtt->subscribed);
        if (!good)
            all_bad(mqtt, topic);
        return good;
    }
    json_t *root = mqtt_json_parse(message->payload, message->count, why);
    if (!root)
        all_bad(mqtt, topic);
    bool good = root && take_json(mqtt, topic, root, message, why);
    json_decref(root);
    return good;
}

void mqtt_take_message(struct mqtt_source *mqtt, const struct mqtt_message *message)
{
    const struct mqtt_topic *topic = mqtt->sparkplug ? NULL : mqtt_topics_find(&mqtt->topics, message->topic);
    char why[200];
    if (!topic && !mqtt->sparkplug) {
        mqtt_refuse(mqtt, message, "no tag of the source uses this topic");
        return;
    }
    stamped_writer_begin(&mqtt->writer, clock_mono_ns(), clock_utc_ns());
    bool good = mqtt->sparkplug ? sparkplug_take(mqtt->sparkplug, message, why) : take(mqtt, topic, message, why);
    stamped_writer_end(&mqtt->writer);
    counter_inc(mqtt->samples, (int64_t)mqtt->writer.written);
    report_skew(mqtt, message->topic);
    if (good)
        counter_inc(mqtt->messages_ok, 1);
    else
        mqtt_refuse(mqtt, message, why);
}
