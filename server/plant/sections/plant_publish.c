/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads `publish`: the broker to which readings and alarms are published. PLANT.md describes its keys. */
#include <string.h>

#include "base/mem.h"
#include "plant/plant_impl.h"

static const char PREFIX[] = "plantcast/";

/* Checks the topic prefix for published readings. It must begin with plantcast/: otherwise a device might subscribe to a topic,
   and publishing would write to the device. */
static void check_prefix(struct yaml_reader *reader, const struct yaml_map *map, const char *prefix)
{
    size_t length = strlen(prefix);
    if (strncmp(prefix, PREFIX, strlen(PREFIX)) != 0 || strpbrk(prefix, "+#") || prefix[length - 1] == '/')
        yaml_error(reader, yaml_map_place(map, "prefix"), "prefix: expected a topic such as %sunit100, found '%.60s'", PREFIX, prefix);
}

void plant_publish_read(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant *plant = record;
    static const struct yaml_choice protocol_choices[] = { { "5", 5 }, { "3.1.1", 4 }, { 0 } };
    static const struct yaml_key keys[] = {
        { "host", KEY_NAME, true, offsetof(struct plant_publish, broker.hosts[0]), 0, 0, NULL, NULL },
        { "port", KEY_INT, false, offsetof(struct plant_publish, broker.port), 1, 65535, NULL, NULL },
        { "protocol", KEY_CHOICE, false, offsetof(struct plant_publish, broker.mqtt.protocol), 0, 0, protocol_choices, NULL },
        { "client_id", KEY_NAME, false, offsetof(struct plant_publish, broker.mqtt.client_id), 0, 0, NULL, NULL },
        { "keepalive_s", KEY_INT, false, offsetof(struct plant_publish, broker.mqtt.keepalive_s), 5, 3600, NULL, NULL },
        { "login", KEY_NAME, false, offsetof(struct plant_publish, broker.login), 0, 0, NULL, NULL },
        /* the offset is 0 because plant_mqtt_read_tls() gets a struct plant_source, which is the first member (`broker`) of struct
           plant_publish */
        { "tls", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_mqtt_read_tls },
        { "prefix", KEY_NAME, true, offsetof(struct plant_publish, prefix), 0, 0, NULL, NULL },
        { "every_s", KEY_NUMBER, false, offsetof(struct plant_publish, every_s), 0.1, 3600, NULL, NULL },
        { 0 }
    };
    struct plant_publish *publish = plant->publish = mem_new(sizeof(*publish));
    struct yaml_map map;
    publish->every_s = 1;
    publish->broker.host_count = 1;
    publish->broker.mqtt = (struct plant_mqtt){ .protocol = 5, .keepalive_s = 10, .will_stays = true };
    if (!yaml_map_read(reader, node, "publish", keys, publish, &map))
        return;
    plant_mqtt_check(reader, &map, plant, &publish->broker);
    if (!publish->prefix)
        return;
    check_prefix(reader, &map, publish->prefix);
    publish->broker.mqtt.will = mem_printf("%s/state", publish->prefix);
}

void plant_publish_free(struct plant_publish **publish)
{
    if (!*publish)
        return;
    mem_free((*publish)->broker.hosts[0]);
    mem_free((*publish)->broker.login);
    plant_mqtt_finish(&(*publish)->broker.mqtt);
    mem_free((*publish)->prefix);
    mem_free(*publish);
    *publish = NULL;
}
