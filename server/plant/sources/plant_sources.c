/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the list `sources` of a plant file: field devices, servers, brokers and replays. SOURCES.md describes the format. */
#include <errno.h>
#include <limits.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "plant/plant_impl.h"

enum { BY_SOCKET = 1, BY_LINE = 2, MODBUS = BY_SOCKET | BY_LINE, REPLAY = 4, MQTT = 8, OPCUA = 16, BY_HOST = BY_SOCKET | MQTT | OPCUA };

static const struct yaml_choice order_choices[] = {
    { "ABCD", BYTE_ORDER_ABCD }, { "CDAB", BYTE_ORDER_CDAB }, { "BADC", BYTE_ORDER_BADC }, { "DCBA", BYTE_ORDER_DCBA }, { 0 }
};
static const struct yaml_choice transport_choices[] = {
    { "tcp", TRANSPORT_TCP }, { "rtu-over-tcp", TRANSPORT_RTU_TCP }, { "rtu", TRANSPORT_RTU }, { 0 }
};
static const struct yaml_choice parity_choices[] = { { "none", 'N' }, { "even", 'E' }, { "odd", 'O' }, { 0 } };
static const struct yaml_choice payload_choices[] = {
    { "number", MQTT_NUMBER }, { "json", MQTT_JSON }, { "sparkplug", MQTT_SPARKPLUG }, { 0 }
};
static const struct yaml_choice protocol_choices[] = { { "3.1.1", 4 }, { "5", 5 }, { 0 } };
static const struct yaml_choice session_choices[] = { { "clean", false }, { "persistent", true }, { 0 } };
static const struct yaml_choice yes_choices[] = { { "yes", 1 }, { "no", 0 }, { 0 } };

static void read_kind(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant_source *source = record;
    const char *text = yaml_text(node);
    if (text && (!strcmp(text, "modbus") || !strcmp(text, "mqtt") || !strcmp(text, "opcua") || !strcmp(text, "replay")))
        source->kind = mem_strdup(text);
    else
        yaml_expected(reader, node, "type", "modbus, mqtt, opcua or replay");
}

static void add_host(struct yaml_reader *reader, yaml_node_t *node, struct plant_source *source)
{
    const char *text = yaml_text(node);
    if (!text || !*text)
        yaml_expected(reader, node, "hosts", "names or addresses");
    else
        source->hosts[source->host_count++] = mem_strdup(text);
}

static void read_host(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant_source *source = record;
    const char *text = yaml_text(node);
    if (!text || !*text)
        yaml_expected(reader, node, "host", "a name or an address");
    else if (source->host_count == 0)
        add_host(reader, node, source);
}

static void read_hosts(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant_source *source = record;
    int count = yaml_list_count(reader, node, "hosts");
    if (count == 0 || count > PLANT_HOSTS)
        yaml_error(reader, yaml_place(node), "hosts: expected 1 to %d, found %d", PLANT_HOSTS, count);
    for (int i = 0; i < count && source->host_count < PLANT_HOSTS; i++)
        add_host(reader, yaml_list_item(reader, node, i), source);
}

static void read_heartbeat(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const struct yaml_key keys[] = {
        { "tag", KEY_NAME, true, offsetof(struct plant_source, heartbeat), 0, 0, NULL, NULL },
        { "longest_s", KEY_NUMBER, true, offsetof(struct plant_source, heartbeat_s), 0.1, 86400, NULL, NULL },
        { 0 }
    };
    struct yaml_map map;
    yaml_map_read(reader, node, "heartbeat", keys, record, &map);
}

static const struct yaml_key source_keys[] = {
    { "id", KEY_NAME, true, offsetof(struct plant_source, id), 0, 0, NULL, NULL },
    { "type", KEY_CUSTOM, true, 0, 0, 0, NULL, read_kind },
    { "simulated", KEY_FLAG, false, offsetof(struct plant_source, simulated), 0, 0, yes_choices, NULL },
    { "transport", KEY_CHOICE, false, offsetof(struct plant_source, transport), 0, 0, transport_choices, NULL },
    { "host", KEY_CUSTOM, false, 0, 0, 0, NULL, read_host },
    { "hosts", KEY_CUSTOM, false, 0, 0, 0, NULL, read_hosts },
    { "port", KEY_INT, false, offsetof(struct plant_source, port), 1, 65535, NULL, NULL },
    { "device", KEY_NAME, false, offsetof(struct plant_source, device), 0, 0, NULL, NULL },
    { "baud", KEY_INT, false, offsetof(struct plant_source, baud), 110, 4000000, NULL, NULL },
    { "parity", KEY_CHOICE, false, offsetof(struct plant_source, parity), 0, 0, parity_choices, NULL },
    { "stop_bits", KEY_INT, false, offsetof(struct plant_source, stop_bits), 1, 2, NULL, NULL },
    { "unit", KEY_INT, false, offsetof(struct plant_source, unit), 0, 255, NULL, NULL },
    { "poll_ms", KEY_INT, false, offsetof(struct plant_source, poll_ms), 10, 86400000, NULL, NULL },
    { "timeout_ms", KEY_INT, false, offsetof(struct plant_source, timeout_ms), 10, 60000, NULL, NULL },
    { "pause_ms", KEY_INT, false, offsetof(struct plant_source, pause_ms), 0, 10000, NULL, NULL },
    { "connect_delay_ms", KEY_INT, false, offsetof(struct plant_source, connect_delay_ms), 0, 60000, NULL, NULL },
    { "close_between_polls", KEY_FLAG, false, offsetof(struct plant_source, close_between_polls), 0, 0, yes_choices, NULL },
    { "max_registers", KEY_INT, false, offsetof(struct plant_source, max_registers), 4, 125, NULL, NULL },
    { "max_bits", KEY_INT, false, offsetof(struct plant_source, max_bits), 1, 2000, NULL, NULL },
    { "max_gap", KEY_INT, false, offsetof(struct plant_source, max_gap), 0, 2000, NULL, NULL },
    { "byte_order", KEY_CHOICE, false, offsetof(struct plant_source, byte_order), 0, 0, order_choices, NULL },
    { "address_base", KEY_INT, false, offsetof(struct plant_source, address_base), 0, 1, NULL, NULL },
    { "heartbeat", KEY_CUSTOM, false, 0, 0, 0, NULL, read_heartbeat },
    { "protocol", KEY_CHOICE, false, offsetof(struct plant_source, mqtt.protocol), 0, 0, protocol_choices, NULL },
    { "client_id", KEY_NAME, false, offsetof(struct plant_source, mqtt.client_id), 0, 0, NULL, NULL },
    { "session", KEY_FLAG, false, offsetof(struct plant_source, mqtt.persistent), 0, 0, session_choices, NULL },
    { "qos", KEY_INT, false, offsetof(struct plant_source, mqtt.qos), 0, 1, NULL, NULL },
    { "keepalive_s", KEY_INT, false, offsetof(struct plant_source, mqtt.keepalive_s), 5, 3600, NULL, NULL },
    { "payload", KEY_CHOICE, false, offsetof(struct plant_source, mqtt.payload), 0, 0, payload_choices, NULL },
    { "topic", KEY_NAME, false, offsetof(struct plant_source, mqtt.topic), 0, 0, NULL, NULL },
    { "value", KEY_NAME, false, offsetof(struct plant_source, mqtt.value), 0, 0, NULL, NULL },
    { "time", KEY_NAME, false, offsetof(struct plant_source, mqtt.time), 0, 0, NULL, NULL },
    { "quality", KEY_NAME, false, offsetof(struct plant_source, mqtt.quality), 0, 0, NULL, NULL },
    { "login", KEY_NAME, false, offsetof(struct plant_source, login), 0, 0, NULL, NULL },
    { "tls", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_mqtt_read_tls },
    { "will", KEY_NAME, false, offsetof(struct plant_source, mqtt.will), 0, 0, NULL, NULL },
    { "rebirth", KEY_FLAG, false, offsetof(struct plant_source, mqtt.rebirth), 0, 0, yes_choices, NULL },
    { "path", KEY_NAME, false, offsetof(struct plant_source, opcua.path), 0, 0, NULL, NULL },
    { "security", KEY_CUSTOM, false, 0, 0, 0, NULL, plant_opcua_read_security },
    { "namespace", KEY_NAME, false, offsetof(struct plant_source, opcua.name_space), 0, 0, NULL, NULL },
    { "queue", KEY_INT, false, offsetof(struct plant_source, opcua.queue), 1, 1000, NULL, NULL },
    { "deadband", KEY_NUMBER, false, offsetof(struct plant_source, opcua.deadband), 0, PLANT_MAX_VALUE, NULL, NULL },
    { "deadband_percent", KEY_NUMBER, false, offsetof(struct plant_source, opcua.deadband_percent), 0, 100, NULL, NULL },
    { "file", KEY_NAME, false, offsetof(struct plant_source, file), 0, 0, NULL, NULL },
    { "speed", KEY_NUMBER, false, offsetof(struct plant_source, speed), 1e-3, 1e5, NULL, NULL },
    { "loop", KEY_FLAG, false, offsetof(struct plant_source, loop), 0, 0, yes_choices, NULL },
    { 0 }
};

static int way_of(const struct plant_source *source)
{
    if (!strcmp(source->kind, "replay"))
        return REPLAY;
    if (!strcmp(source->kind, "mqtt"))
        return MQTT;
    if (!strcmp(source->kind, "opcua"))
        return OPCUA;
    return source->transport == TRANSPORT_RTU ? BY_LINE : BY_SOCKET;
}

/* Reports keys of the source that have no effect for its kind (Modbus, MQTT and so on). */
static void check_keys(struct yaml_reader *reader, const struct yaml_map *map, const struct plant_source *source)
{
    static const struct {
        const char *key;
        int ways;
    } belongs[] = {
        { "transport", MODBUS }, { "host", BY_HOST }, { "hosts", BY_HOST }, { "port", BY_HOST }, { "device", BY_LINE },
        { "baud", BY_LINE }, { "parity", BY_LINE }, { "stop_bits", BY_LINE }, { "unit", MODBUS }, { "timeout_ms", MODBUS },
        { "pause_ms", MODBUS }, { "connect_delay_ms", MODBUS }, { "close_between_polls", MODBUS },
        { "max_registers", MODBUS }, { "max_bits", MODBUS }, { "max_gap", MODBUS }, { "byte_order", MODBUS },
        { "address_base", MODBUS }, { "file", REPLAY }, { "speed", REPLAY }, { "loop", REPLAY },
        { "protocol", MQTT }, { "client_id", MQTT }, { "session", MQTT }, { "qos", MQTT }, { "keepalive_s", MQTT }, { "payload", MQTT },
        { "topic", MQTT }, { "value", MQTT }, { "time", MQTT }, { "quality", MQTT }, { "rebirth", MQTT }, { "login", MQTT | OPCUA },
        { "tls", MQTT }, { "will", MQTT },
        { "path", OPCUA }, { "security", OPCUA }, { "namespace", OPCUA }, { "queue", OPCUA }, { "deadband", OPCUA },
        { "deadband_percent", OPCUA },
    };
    static const char *const whats[] = { [REPLAY] = "a replay", [MQTT] = "an mqtt source", [OPCUA] = "an opcua source",
                                         [BY_LINE] = "transport rtu",
                                         [BY_SOCKET] = "a modbus source over TCP" };
    const char *what = whats[way_of(source)];
    for (size_t i = 0; i < sizeof(belongs) / sizeof(*belongs); i++)
        if (yaml_map_good(map, belongs[i].key) && !(belongs[i].ways & way_of(source)))
            yaml_error(reader, yaml_map_place(map, belongs[i].key), "%s: has no effect for %s", belongs[i].key, what);
}

/* Reports missing keys that the source's kind (Modbus, MQTT and so on) requires. */
static void check_way(struct yaml_reader *reader, const struct yaml_map *map, const struct plant_source *source)
{
    bool has_hosts = yaml_map_good(map, "hosts"), has_host = yaml_map_good(map, "host");
    const char *missing = NULL;
    if (way_of(source) & BY_HOST && source->host_count == 0)
        missing = "host";
    if (way_of(source) == BY_LINE && !source->device)
        missing = "device";
    if (way_of(source) == REPLAY && !source->file)
        missing = "file";
    if (missing)
        yaml_error(reader, yaml_map_place(map, missing), "a source requires the key '%s'", missing);
    if (has_host && has_hosts)
        yaml_error(reader, yaml_map_place(map, "hosts"), "hosts: expected host or hosts, not both");
    if (source->file && access(source->file, R_OK) != 0)
        yaml_error(reader, yaml_map_place(map, "file"), "file: '%s' cannot be read: %s", source->file, strerror(errno));
}

static bool same_text(const char *a, const char *b)
{
    return a && b && !strcmp(a, b);
}

/* Reports two sources for one device: many devices accept only one connection, and a serial line can have only one master. */
static void check_alone(struct yaml_reader *reader, const struct yaml_map *map, const struct plant *plant,
                        const struct plant_source *source)
{
    for (const struct plant_source *other = plant->sources; other < source; other++) {
        if (same_text(other->device, source->device))
            yaml_error(reader, yaml_map_place(map, "device"),
                       "device: '%s' is already used by source %s; use one source for all units on a serial line", source->device,
                       other->id ? other->id : "?");
        for (int i = 0; i < source->host_count && way_of(source) == BY_SOCKET; i++)
            for (int k = 0; k < other->host_count; k++)
                if (other->port == source->port && same_text(other->hosts[k], source->hosts[i]))
                    diag_warning(reader->diag, reader->path, map->place.line, map->place.column,
                                 "%s:%d is also used by source %s: the device gets two connections", source->hosts[i], source->port,
                                 other->id ? other->id : "?");
    }
}

static void read_source(struct yaml_reader *reader, yaml_node_t *node, struct plant *plant, struct plant_source *source)
{
    struct yaml_map map;
    *source = (struct plant_source){
        .port = 502, .unit = 1, .poll_ms = 1000, .timeout_ms = 1000, .address_base = 1, .baud = 19200, .parity = 'E', .stop_bits = 1,
        .max_registers = 125, .max_bits = 2000, .heartbeat_tag = -1, .speed = 1, .line = yaml_place(node).line,
        .mqtt = { .protocol = 5, .qos = 1, .keepalive_s = 10 }, .opcua = { .queue = 10 }
    };
    if (!yaml_map_read(reader, node, "a source", source_keys, source, &map))
        return;
    plant_list_check_id(reader, &map, "source", plant->sources, plant->source_count, sizeof(*source), offsetof(struct plant_source, line));
    source->base_stated = yaml_map_good(&map, "address_base");
    plant_resolve_path(plant, &source->file);
    if (!source->kind)
        return;
    source->simulated |= way_of(source) == REPLAY;
    check_keys(reader, &map, source);
    check_way(reader, &map, source);
    check_alone(reader, &map, plant, source);
    if (way_of(source) == MQTT)
        plant_mqtt_check(reader, &map, plant, source);
    if (way_of(source) == OPCUA)
        plant_opcua_check(reader, &map, plant, source);
}

void plant_sources_read(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant *plant = record;
    int count;
    plant->sources = plant_list_make(reader, node, "sources", 0, INT_MAX, sizeof(*plant->sources), &count);
    for (int i = 0; i < count; i++)
        read_source(reader, yaml_list_item(reader, node, i), plant, &plant->sources[plant->source_count++]);
}
