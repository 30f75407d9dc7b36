/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks the keys of a source of type mqtt against each other. SOURCES.md describes the keys. */
#include <string.h>

#include "base/mem.h"
#include "plant/plant_impl.h"
#include "plant/sources/json_path.h"
#include "plant/sources/mqtt_address.h"

enum { PORT = 1883, PORT_TLS = 8883 };
static const char WILL_PREFIX[] = "plantcast/";

void plant_mqtt_read_tls(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const struct yaml_key keys[] = { { "ca", KEY_NAME, true, offsetof(struct plant_source, mqtt.ca), 0, 0, NULL, NULL },
                                            { "certificate", KEY_NAME, false, offsetof(struct plant_source, mqtt.certificate), 0, 0, NULL,
                                              NULL },
                                            { "key", KEY_NAME, false, offsetof(struct plant_source, mqtt.key), 0, 0, NULL, NULL },
                                            { 0 } };
    struct plant_source *source = record;
    struct yaml_map map;
    source->mqtt.has_tls = yaml_map_read(reader, node, "tls", keys, source, &map);
    if (source->mqtt.has_tls && !source->mqtt.certificate != !source->mqtt.key)
        yaml_error(reader, map.place, "tls: expected certificate and key, or neither");
    if (source->mqtt.ca && !strcmp(source->mqtt.ca, "system")) {
        mem_free(source->mqtt.ca);
        source->mqtt.ca = NULL;
    }
}

static void check_files(struct yaml_reader *reader, const struct yaml_map *map, const struct plant *plant, struct plant_source *source)
{
    struct plant_mqtt *mqtt = &source->mqtt;
    char **const files[] = { &mqtt->ca, &mqtt->certificate, &mqtt->key };
    plant_secret_check(reader, map, plant, "login", &source->login);
    for (size_t i = 0; i < sizeof(files) / sizeof(*files); i++)
        plant_secret_check(reader, map, plant, "tls", files[i]);
}

/* Checks the topic of the last will (a message that the broker publishes if the connection breaks). It must begin with
   plantcast/: a device that subscribes to another topic might take the message for a command. */
static void check_will(struct yaml_reader *reader, const struct yaml_map *map, const struct plant_mqtt *mqtt)
{
    if (mqtt->will && (strncmp(mqtt->will, WILL_PREFIX, strlen(WILL_PREFIX)) != 0 || strpbrk(mqtt->will, "+#")))
        yaml_error(reader, yaml_map_place(map, "will"),
                   "will: expected a topic that begins with %s and contains neither + nor #, found '%.60s'", WILL_PREFIX, mqtt->will);
}

static void check_paths(struct yaml_reader *reader, const struct yaml_map *map, const struct plant_mqtt *mqtt)
{
    const struct {
        const char *key, *path;
    } paths[] = { { "value", mqtt->value }, { "time", mqtt->time }, { "quality", mqtt->quality } };
    char why[200];
    for (size_t i = 0; i < sizeof(paths) / sizeof(*paths); i++)
        if (paths[i].path && mqtt->payload != MQTT_JSON)
            yaml_error(reader, yaml_map_place(map, paths[i].key), "%s: allowed only with payload: json", paths[i].key);
        else if (paths[i].path && !json_path_check(paths[i].path, i > 0, why))
            yaml_error(reader, yaml_map_place(map, paths[i].key), "%s: '%.60s': %s", paths[i].key, paths[i].path, why);
}

/* Requires a time path for persistent sessions: without a time of their own, messages that the broker kept during a
   disconnection would look new. */
static void check_session(struct yaml_reader *reader, const struct yaml_map *map, const struct plant_mqtt *mqtt)
{
    if (mqtt->persistent && !mqtt->time)
        yaml_error(reader, yaml_map_place(map, "session"),
                   "session: persistent requires payload: json and the key `time`, otherwise messages stored by the broker would look "
                   "fresh");
    if (mqtt->persistent && !mqtt->client_id)
        yaml_error(reader, yaml_map_place(map, "session"),
                   "session: persistent requires client_id, which identifies the session to the broker");
}

void plant_mqtt_check(struct yaml_reader *reader, const struct yaml_map *map, const struct plant *plant, struct plant_source *source)
{
    struct plant_mqtt *mqtt = &source->mqtt;
    char why[200];
    if (!yaml_map_good(map, "port"))
        source->port = mqtt->has_tls ? PORT_TLS : PORT;
    if (mqtt->topic && !mqtt_template_check(mqtt->topic, why))
        yaml_error(reader, yaml_map_place(map, "topic"), "topic: '%.60s': %s", mqtt->topic, why);
    check_paths(reader, map, mqtt);
    check_session(reader, map, mqtt);
    check_files(reader, map, plant, source);
    check_will(reader, map, mqtt);
    if (mqtt->rebirth && mqtt->payload != MQTT_SPARKPLUG)
        yaml_error(reader, yaml_map_place(map, "rebirth"), "rebirth: allowed only with payload: sparkplug");
}

void plant_mqtt_finish(struct plant_mqtt *mqtt)
{
    char *const texts[] = { mqtt->client_id, mqtt->ca,    mqtt->certificate, mqtt->key,    mqtt->will,
                            mqtt->topic,     mqtt->value, mqtt->time,        mqtt->quality };
    for (size_t i = 0; i < sizeof(texts) / sizeof(*texts); i++)
        mem_free(texts[i]);
}
