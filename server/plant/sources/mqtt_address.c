/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses addresses of MQTT values, TOPIC#PATH. The first `#` separates the two parts, because topics cannot contain it. */
#include "plant/sources/mqtt_address.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "plant/sources/json_path.h"

enum address_field { FIELD_TAG, FIELD_ASSET, FIELD_GROUP, FIELD_ADDRESS, FIELD_COUNT };
static const char *const field_names[FIELD_COUNT] = { "{tag}", "{asset}", "{group}", "{address}" };

/* Returns which placeholder of a topic template (enum address_field) the text begins with, or FIELD_COUNT if none. */
static enum address_field field_at(const char *text)
{
    enum address_field field = FIELD_TAG;
    while (field < FIELD_COUNT && strncmp(text, field_names[field], strlen(field_names[field])) != 0)
        field++;
    return field;
}

bool mqtt_template_check(const char *text, char why[200])
{
    for (const char *brace = strchr(text, '{'); brace; brace = strchr(brace + 1, '{'))
        if (field_at(brace) == FIELD_COUNT) {
            snprintf(why, 200, "the MQTT topic may contain only {tag}, {asset}, {group} and {address} in braces, found '%.20s'", brace);
            return false;
        }
    if (strpbrk(text, "+#")) {
        snprintf(why, 200, "the MQTT topic has a wildcard (+ or #), which matches many topics; expected one topic for each tag");
        return false;
    }
    return true;
}

/* Returns the tag's text for a placeholder in a topic template, or NULL if the tag has none. address: the tag's address up to the #. */
static const char *field_text(const struct plant *plant, const struct plant_tag *tag, const char *address, enum address_field field)
{
    switch (field) {
    case FIELD_TAG: return tag->name;
    case FIELD_ASSET: return tag->asset >= 0 ? plant->assets[tag->asset].id : tag->place.lost_asset;
    case FIELD_GROUP: return tag->group >= 0 ? plant->groups[tag->group].id : NULL;
    default: return *address ? address : NULL;
    }
}

static bool fill_template(const struct plant *plant, const struct plant_tag *tag, const char *address, struct text *out, char why[200])
{
    for (const char *at = plant->sources[tag->source].mqtt.topic; *at;) {
        enum address_field field = field_at(at);
        if (field == FIELD_COUNT) {
            text_add(out, "%c", *at++);
            continue;
        }
        const char *text = field_text(plant, tag, address, field);
        if (!text) {
            snprintf(why, 200, "the source's key `topic` contains %s, which this tag does not have", field_names[field]);
            return false;
        }
        text_add(out, "%s", text);
        at += strlen(field_names[field]);
    }
    return true;
}

/* Returns whether a topic has the form GROUP/NODE or GROUP/NODE/DEVICE of Sparkplug. */
static bool is_sparkplug(const char *topic)
{
    int parts = 1;
    for (const char *at = topic; *at; at++) {
        parts += *at == '/';
        if (*at == '/' && (at == topic || !at[1] || at[1] == '/'))
            return false;
    }
    return parts == 2 || parts == 3;
}

static bool check_topic(const char *topic, bool sparkplug, char why[200])
{
    if (!*topic)
        snprintf(why, 200, "this tag has no MQTT topic: write one as its Address, or set the key `topic` of the source");
    else if (strlen(topic) > MQTT_TOPIC_BYTES)
        snprintf(why, 200, "the MQTT topic has %zu bytes; expected at most %d", strlen(topic), MQTT_TOPIC_BYTES);
    else if (strpbrk(topic, "+#"))
        snprintf(why, 200, "the MQTT topic has a wildcard (+ or #), which matches many topics; expected one topic");
    else if (sparkplug && !is_sparkplug(topic))
        snprintf(why, 200, "expected a Sparkplug address GROUP/NODE#METRIC or GROUP/NODE/DEVICE#METRIC");
    else
        return true;
    return false;
}

bool mqtt_address_resolve(const struct plant *plant, struct plant_tag *tag, char why[200])
{
    const struct plant_mqtt *mqtt = &plant->sources[tag->source].mqtt;
    const char *sharp = strchr(tag->signal.address, '#');
    char *address = sharp ? mem_printf("%.*s", (int)(sharp - tag->signal.address), tag->signal.address) : mem_strdup(tag->signal.address);
    struct text topic = { 0 };
    bool by_template = mqtt->topic && (!*address || strstr(mqtt->topic, field_names[FIELD_ADDRESS]));
    bool good = !by_template || fill_template(plant, tag, address, &topic, why);
    tag->signal.topic = mem_strdup(by_template && topic.at ? topic.at : address);
    tag->signal.path = mem_strdup(sharp && sharp[1] ? sharp + 1 : mqtt->payload == MQTT_SPARKPLUG ? tag->name : "");
    good = good && check_topic(tag->signal.topic, mqtt->payload == MQTT_SPARKPLUG, why);
    if (good && *tag->signal.path && mqtt->payload == MQTT_NUMBER) {
        snprintf(why, 200, "a path after # is not allowed with `payload: number`, whose messages contain just a number");
        good = false;
    }
    if (good && *tag->signal.path && mqtt->payload == MQTT_JSON)
        good = json_path_check(tag->signal.path, false, why);
    text_finish(&topic);
    mem_free(address);
    return good;
}

const char *mqtt_address_path(const struct plant *plant, const struct plant_tag *tag)
{
    const char *own = tag->signal.path, *common = plant->sources[tag->source].mqtt.value;
    return own && *own ? own : common ? common : "";
}
