/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Publishes one message per topic; a JSON message contains the values of all tags of the topic. */
#include "sim_mqtt.h"

#include <jansson.h>
#include <math.h>
#include <mosquitto.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "plant/sources/json_path.h"
#include "plant/sources/mqtt_address.h"
#include "sim_encode.h"
#include "value/mqtt/mqtt_topics.h"

enum { KEEPALIVE_S = 10, MAX_ITEMS = 1000 };

struct sim_mqtt {
    const struct plant *plant;
    struct mosquitto *library;
    struct mqtt_topics *topics; /* topics of each source; empty for sources that are not simulated */
    int64_t *due_ns;            /* by source: monotonic time when its topics are next published */
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
        mosquitto_connect_async(mqtt->library, host, (int)port, KEEPALIVE_S); /* the library retries until the broker is up */
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
        fprintf(stderr, "plantcast-sim: %s: the plant file has no MQTT tag with number or JSON payload to simulate\n", plant->files.path);
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

/* Returns a JSON object that passes all comparisons of a filter in a JSON path, such as {"id": "A.T2"}; NULL if the path on the
   left of a comparison has several steps. */
static json_t *described(const struct json_path_step *filter)
{
    json_t *object = json_object();
    for (int i = 0; i < filter->test_count; i++) {
        const struct json_path_test *test = &filter->tests[i];
        struct json_path_step step;
        char why[200];
        const char *at = test->path;
        if (!json_path_next_operand(&at, &step, why) || step.kind != JSON_PATH_NAME || at < test->end) {
            json_decref(object);
            return NULL;
        }
        json_object_set_new(object, step.name,
                            test->kind == JSON_LITERAL_STRING   ? json_string(test->text)
                            : test->kind == JSON_LITERAL_NUMBER ? json_real(test->number)
                            : test->kind == JSON_LITERAL_NULL   ? json_null()
                                                                : json_boolean(test->kind == JSON_LITERAL_TRUE));
    }
    return object;
}

/* Returns the index of the array item that a filter selects; appends such an item if there is none. Returns -1 if the item cannot be
   made. */
static long selected_index(json_t *array, const struct json_path_step *filter)
{
    json_t *wanted = described(filter), *item;
    size_t i, found = SIZE_MAX;
    json_array_foreach(array, i, item)
    {
        json_t *both = wanted && json_is_object(item) ? json_copy(item) : NULL;
        if (both && found == SIZE_MAX && !json_object_update(both, wanted) && json_equal(both, item))
            found = i;
        json_decref(both);
    }
    if (found == SIZE_MAX && wanted && json_array_size(array) < MAX_ITEMS) {
        found = json_array_size(array);
        json_array_append(array, wanted);
    }
    json_decref(wanted);
    return found == SIZE_MAX ? -1 : (long)found;
}

/* Returns the member or item of *root that a step of a JSON path leads to, creating what is missing; *at: the index of an item.
   The caller owns a reference (json_decref()). NULL: it cannot be made. */
static json_t *slot_of(json_t **root, const struct json_path_step *step, long *at)
{
    if (!*root)
        *root = step->kind == JSON_PATH_NAME ? json_object() : json_array();
    *at = step->index;
    if (step->kind == JSON_PATH_NAME && json_is_object(*root)) {
        json_t *member = json_object_get(*root, step->name);
        return member ? json_incref(member) : json_null();
    }
    if (step->kind == JSON_PATH_FILTER && json_is_array(*root))
        *at = selected_index(*root, step);
    if (step->kind == JSON_PATH_NAME || !json_is_array(*root) || *at < 0 || *at >= MAX_ITEMS)
        return NULL;
    while (json_array_size(*root) <= (size_t)*at)
        json_array_append_new(*root, json_null());
    return json_incref(json_array_get(*root, (size_t)*at));
}

/* Puts a value at a path inside the JSON value *root, and creates what is missing. Takes ownership of the value. */
static void put(json_t **root, const char *path, json_t *value)
{
    struct json_path_step step;
    char why[200];
    long at;
    if (!*path) {
        json_decref(*root);
        *root = value;
        return;
    }
    json_t *made = json_path_next(&path, &step, why) ? slot_of(root, &step, &at) : NULL;
    if (!made) {
        json_decref(value);
        return;
    }
    if (json_is_null(made))
        made = NULL; /* makes put() create a new value, because the JSON null is a singleton that cannot be changed */
    put(&made, path, value);
    if (step.kind == JSON_PATH_NAME)
        json_object_set_new(*root, step.name, made);
    else
        json_array_set_new(*root, (size_t)at, made);
}

/* Puts a value at a path that the source configures (for value, time or quality). A path that begins with `@` starts in the
   object that contains the value at the path `of`. */
static void put_stated(json_t **root, const char *path, const char *of, json_t *value)
{
    struct json_path_step step;
    char why[200];
    const char *last = json_path_begin(of);
    if (*path != '@') {
        put(root, json_path_begin(path), value);
        return;
    }
    for (const char *at = last; *at; last = at)
        if (!json_path_next(&at, &step, why) || !*at)
            break;
    int length = (int)(last - json_path_begin(of)) - (last > of && last[-1] == '.');
    const char *rest = json_path_begin(path);
    char *whole = mem_printf("%.*s%s%s", length < 0 ? 0 : length, json_path_begin(of), length > 0 && *rest != '[' ? "." : "", rest);
    put(root, whole, value);
    mem_free(whole);
}

static json_t *json_of(const struct sim_mqtt *mqtt, const struct plant_mqtt *config, const struct mqtt_topic *topic,
                       const struct sim_values *values, int64_t now_utc_ns)
{
    json_t *root = NULL;
    for (size_t i = 0; i < topic->tag_count; i++) {
        const struct plant_tag *tag = &mqtt->plant->tags[topic->tags[i]];
        double value = sim_encode_raw(tag, sim_values_at(values, (size_t)topic->tags[i]));
        const char *stated = mqtt_address_path(mqtt->plant, tag), *path = *stated ? stated : "value";
        put(&root, json_path_begin(path), isfinite(value) ? json_real(value) : json_null());
        if (config->time)
            put_stated(&root, config->time, path, json_integer(now_utc_ns / 1000000));
        if (config->quality)
            put_stated(&root, config->quality, path, json_integer(0));
    }
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
