/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a message brings to the tags of its topic. */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "value/mqtt/mqtt_impl.h"
#include "value/quality.h"

enum { REFUSALS_SAID = 8 }; /* a second */
static const int64_t SKEW_NS = 5 * NS_PER_S, SKEW_SAID_NS = 60 * NS_PER_S;

/* For a log line: short, and without what would break it. */
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
    char topic[64], more[60] = "";
    int64_t now_ns = clock_mono_ns();
    counter_inc(mqtt->messages_refused, 1);
    if (now_ns - mqtt->refusals_ns > NS_PER_S) {
        mqtt->refusals_ns = now_ns;
        mqtt->refusals_said = 0;
    }
    if (++mqtt->refusals_said > REFUSALS_SAID) {
        mqtt->refusals_unsaid++;
        return;
    }
    if (mqtt->refusals_unsaid > 0)
        snprintf(more, sizeof(more), " (and %ld more refused since)", mqtt->refusals_unsaid);
    log_warn(mqtt->base.log, "source %s: %s: %zu bytes are refused: %s%s", mqtt->base.config->id, shown(message->topic, topic),
             message->count, why, more);
    mqtt->refusals_unsaid = 0;
}

static void report_skew(struct mqtt_source *mqtt, const char *topic)
{
    int64_t skew_ns = mqtt->writer.worst_skew_ns, now_ns = mqtt->writer.mono_ns;
    char name[64];
    int64_t *said_ns = &mqtt->skew_said_ns[skew_ns > 0];
    if (mqtt->sparkplug && skew_ns < 0) /* metrics are as old as their last changes */
        return;
    if ((skew_ns < SKEW_NS && skew_ns > -SKEW_NS) || (*said_ns && now_ns - *said_ns < SKEW_SAID_NS))
        return;
    *said_ns = now_ns;
    log_warn(mqtt->base.log, "source %s: %s: its times are %.1f s %s this machine's clock", mqtt->base.config->id, shown(topic, name),
             (double)(skew_ns > 0 ? skew_ns : -skew_ns) / 1e9, skew_ns > 0 ? "ahead of" : "behind");
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

/* False: at least one tag has a value that is none; it is Bad. */
static bool take_json(struct mqtt_source *mqtt, const struct mqtt_topic *topic, const json_t *root, const struct mqtt_message *message,
                      char why[200])
{
    bool all_good = true;
    for (size_t i = 0; i < topic->tag_count; i++) {
        struct stamped_value value;
        int tag = topic->tags[i];
        enum mqtt_found found = mqtt_json_read(root, &mqtt->base.config->mqtt, mqtt->base.plant->tags[tag].path, &value, why);
        if (found == MQTT_FOUND)
            stamped_writer_add(&mqtt->writer, tag, &value, message->is_retained || (!mqtt->subscribed && !value.utc_ns), false);
        else if (found == MQTT_WRONG)
            stamped_writer_add_bad(&mqtt->writer, tag, QUALITY_BAD_CONFIGURATION);
        all_good &= found != MQTT_WRONG;
    }
    return all_good;
}

/* False: refused. */
static bool take(struct mqtt_source *mqtt, const struct mqtt_topic *topic, const struct mqtt_message *message, char why[200])
{
    snprintf(why, 200, "too long");
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
        mqtt_refuse(mqtt, message, "no tag has this topic");
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
