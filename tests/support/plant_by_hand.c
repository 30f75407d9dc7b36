/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds a struct plant in memory, member by member, for tests without plant files. */
#include "plant_by_hand.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "tests/support/owned.h"

enum { MAX_SOURCES = 16 };

static void release(void *resource)
{
    struct plant *plant = resource;
    for (size_t i = 0; i < plant->tag_count; i++) {
        mem_free(plant->tags[i].name);
        mem_free(plant->tags[i].unit);
    }
    for (size_t i = 0; i < plant->source_count; i++) {
        mem_free(plant->sources[i].id);
        mem_free(plant->sources[i].kind);
        for (int h = 0; h < plant->sources[i].host_count; h++)
            mem_free(plant->sources[i].hosts[h]);
    }
    mem_free(plant->tags);
    mem_free(plant->tags_by_name);
    mem_free(plant->sources);
    mem_free(plant);
}

struct plant *plant_by_hand_create(size_t max_tags)
{
    struct plant *plant = mem_new(sizeof(*plant));
    plant->tags = mem_array(max_tags, sizeof(*plant->tags));
    plant->tags_by_name = mem_array(max_tags, sizeof(*plant->tags_by_name));
    plant->sources = mem_array(MAX_SOURCES, sizeof(*plant->sources));
    owned_add(release, plant);
    return plant;
}

struct plant_source *plant_by_hand_source(struct plant *plant, const char *id, int port)
{
    assert(plant->source_count < MAX_SOURCES);
    struct plant_source *source = &plant->sources[plant->source_count++];
    *source = (struct plant_source){
        .id = mem_strdup(id),
        .kind = mem_strdup("modbus"),
        .hosts = { mem_strdup("127.0.0.1") },
        .host_count = 1,
        .max_registers = 125,
        .max_bits = 2000,
        .heartbeat_tag = -1,
        .baud = 9600,
        .parity = 'N',
        .stop_bits = 1,
        .port = port,
        .unit = 1,
        .poll_ms = 100,
        .timeout_ms = 2000,
    };
    return source;
}

struct plant_tag *plant_by_hand_tag(struct plant *plant, const char *name, enum register_table table, int register_index,
                                    enum data_type type)
{
    bool one_register = type == DATA_BIT || type == DATA_INT16 || type == DATA_UINT16 || type == DATA_BCD;
    size_t place = plant->tag_count++;
    struct plant_tag *tag = &plant->tags[place];
    for (; place > 0 && strcmp(plant->tags[plant->tags_by_name[place - 1]].name, name) > 0; place--)
        plant->tags_by_name[place] = plant->tags_by_name[place - 1];
    plant->tags_by_name[place] = (int)(tag - plant->tags);
    *tag = (struct plant_tag){
        .alarms.suppressed_by = -1,
        .alarms.mirror.tag = -1,
        .alarms.settings.priority = ALARM_PRIORITY_DEFAULT,
        .name = mem_strdup(name),
        .source = (int)plant->source_count - 1,
        .group = -1,
        .asset = -1,
        .signal.modbus_unit = -1,
        .signal.table = table,
        .signal.register_index = register_index,
        .signal.bit = -1,
        .signal.type = type,
        .signal.byte_order = one_register ? BYTE_ORDER_NONE : BYTE_ORDER_ABCD,
        .validity.stale_s = 5,
        .alarms.limits = { NAN, NAN, NAN, NAN },
        .deadband = NAN,
    };
    return tag;
}
