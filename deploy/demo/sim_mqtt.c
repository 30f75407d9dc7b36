/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One message a topic; for JSON, with all values that tags find in it. */
#include "sim_mqtt.h"

#include <jansson.h>
#include <math.h>
#include <mosquitto.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "plant/json_path.h"
#include "sim_encode.h"
#include "value/mqtt/mqtt_topics.h"

enum { KEEPALIVE_S = 10, MOST_ITEMS = 1000 };

struct sim_mqtt {
    const struct plant *plant;
    struct mosquitto *library;
    struct mqtt_topics *topics; /* by source; of those that are not simulated, none */
    int64_t *due_ns;            /* by source */
    size_t tag_count;
};

static bool is_simulated(const struct plant_source *source)
{
    return !strcmp(source->kind, "mqtt") && source->mqtt.payload != MQTT_SPARKPLUG;
}

bool sim_mqtt_has(const struct plant *plant, size_t tag)
{
    return plant->tags[tag].source >= 0 && is_simulated(&plant->sources[plant->tags[tag].source]);
}

/* --- connecting ------------------------------------------------------------------------------------------------------------- */

static bool connect_to(struct sim_mqtt *mqtt, const char *where)
{
    const char *colon = strrchr(where, ':');
    char *end, *host = colon ? mem_printf("%.*s", (int)(colon - where), where) : NULL;
    long port = colon ? strtol(colon + 1, &end, 10) : 0;
    bool good = host && *host && end != colon + 1 && !*end && port >= 1 && port <= 65535;
    if (!good)
        fprintf(stderr, "plantcast-sim: --mqtt %s: expected HOST:PORT\n", where);
    mosquitto_lib_init();
    mqtt->library = good ? mosquitto_new(NULL, true, NULL) : NULL;
    if (mqtt->library) {
        mosquitto_connect_async(mqtt->library, host, (int)port, KEEPALIVE_S); /* a broker that is not there yet is tried again */
        good = mosquitto_loop_start(mqtt->library) == MOSQ_ERR_SUCCESS;
    }
    mem_free(host);
    return good && mqtt->library;
}

struct sim_mqtt *sim_mqtt_create(const struct plant *plant, const char *where)
{
    struct sim_mqtt *mqtt = mem_new(sizeof(*mqtt));
    mqtt->plant = plant;
    mqtt->topics = mem_array(plant->source_count, sizeof(*mqtt->topics));
    mqtt->due_ns = mem_array(plant->source_count, sizeof(*mqtt->due_ns));
    for (size_t i = 0; i < plant->source_count; i++)
        if (is_simulated(&plant->sources[i])) {
            mqtt_topics_init(&mqtt->topics[i], plant, (int)i);
            mqtt->tag_count += mqtt->topics[i].tag_count;
        }
    if (mqtt->tag_count == 0)
        fprintf(stderr, "plantcast-sim: %s: no tag of an MQTT source with numbers or JSON to simulate\n", plant->path);
    if (mqtt->tag_count == 0 || !connect_to(mqtt, where))
        sim_mqtt_destroy(&mqtt);
    return mqtt;
}

void sim_mqtt_destroy(struct sim_mqtt **mqtt)
{
    struct sim_mqtt *gone = *mqtt;
    *mqtt = NULL;
    if (!gone)
        return;
    if (gone->library) {
        mosquitto_disconnect(gone->library);
        mosquitto_loop_stop(gone->library, true);
        mosquitto_destroy(gone->library);
    }
    for (size_t i = 0; i < gone->plant->source_count; i++)
        mqtt_topics_finish(&gone->topics[i]);
    mem_free(gone->topics);
    mem_free(gone->due_ns);
    mem_free(gone);
}

size_t sim_mqtt_tag_count(const struct sim_mqtt *mqtt)
{
    return mqtt->tag_count;
}

/* --- publishing ------------------------------------------------------------------------------------------------------------- */

/* The member or the item of *at that a step leads to; made where it is not there. NULL: it cannot be. */
static json_t **slot_of(json_t **at, const struct json_path_step *step, json_t **made)
{
    if (!*at)
        *at = step->name ? json_object() : json_array();
    if (step->name && json_is_object(*at)) {
        *made = json_object_getn(*at, step->name, step->length);
        return made;
    }
    if (step->name || !json_is_array(*at) || step->index >= MOST_ITEMS)
        return NULL;
    while (json_array_size(*at) <= step->index)
        json_array_append_new(*at, json_null());
    *made = json_array_get(*at, step->index);
    if (json_is_null(*made))
        *made = NULL;
    return made;
}

/* Puts a value, which is taken over, at a path below root. */
static void put(json_t **root, const char *path, json_t *value)
{
    struct json_path_step step;
    json_t *below = NULL;
    if (!*path) {
        json_decref(*root);
        *root = value;
        return;
    }
    json_t **slot = json_path_next(&path, &step) ? slot_of(root, &step, &below) : NULL;
    if (!slot) {
        json_decref(value);
        return;
    }
    json_t *made = *slot ? json_incref(*slot) : NULL;
    put(&made, path, value);
    if (step.name)
        json_object_setn_new(*root, step.name, step.length, made);
    else
        json_array_set_new(*root, step.index, made);
}

static json_t *json_of(const struct sim_mqtt *mqtt, const struct plant_mqtt *config, const struct mqtt_topic *topic,
                       const struct sim_values *values, int64_t now_utc_ns)
{
    json_t *root = NULL;
    for (size_t i = 0; i < topic->tag_count; i++) {
        const struct plant_tag *tag = &mqtt->plant->tags[topic->tags[i]];
        double value = sim_encode_raw(tag, sim_values_at(values, (size_t)topic->tags[i]));
        const char *path = *tag->path ? tag->path : config->value ? config->value : "value";
        put(&root, json_path_begin(path), isfinite(value) ? json_real(value) : json_null());
    }
    if (config->time)
        put(&root, json_path_begin(config->time), json_integer(now_utc_ns / 1000000));
    if (config->quality)
        put(&root, json_path_begin(config->quality), json_integer(0));
    return root;
}

static void publish(struct sim_mqtt *mqtt, const struct plant_mqtt *config, const struct mqtt_topic *topic, const struct sim_values *values,
                    int64_t now_utc_ns)
{
    char *text;
    if (config->payload == MQTT_JSON) {
        json_t *root = json_of(mqtt, config, topic, values, now_utc_ns);
        char *dumped = root ? json_dumps(root, JSON_COMPACT | JSON_ENCODE_ANY) : NULL;
        text = dumped ? mem_strdup(dumped) : NULL;
        free(dumped);
        json_decref(root);
    } else {
        int tag = topic->tags[0];
        text = mem_printf("%.9g", sim_encode_raw(&mqtt->plant->tags[tag], sim_values_at(values, (size_t)tag)));
    }
    if (text)
        mosquitto_publish(mqtt->library, NULL, topic->name, (int)strlen(text), text, 0, false);
    mem_free(text);
}

void sim_mqtt_step(struct sim_mqtt *mqtt, const struct sim_values *values, int64_t now_mono_ns, int64_t now_utc_ns)
{
    for (size_t i = 0; i < mqtt->plant->source_count; i++) {
        const struct plant_source *source = &mqtt->plant->sources[i];
        if (mqtt->topics[i].count == 0 || now_mono_ns < mqtt->due_ns[i])
            continue;
        mqtt->due_ns[i] = now_mono_ns + source->poll_ms * INT64_C(1000000);
        for (size_t t = 0; t < mqtt->topics[i].count; t++)
            publish(mqtt, &source->mqtt, &mqtt->topics[i].at[t], values, now_utc_ns);
    }
}
