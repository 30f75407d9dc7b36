/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Assigns the plant's tags to simulated devices. */
#include "sim.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"

/* Returns whether the source is simulated as a Modbus TCP server; RTU is not simulated. */
static bool is_served(const struct plant_source *source)
{
    return !strcmp(source->kind, "modbus") && source->transport == TRANSPORT_TCP;
}

static struct sim_device *device_at(const struct sim *sim, int port)
{
    for (size_t i = 0; i < sim->device_count; i++)
        if (sim->devices[i].port == port)
            return &sim->devices[i];
    return NULL;
}

struct sim_device *sim_device_of(const struct sim *sim, const struct plant_tag *tag, int *unit)
{
    if (tag->source < 0 || !is_served(&sim->plant->sources[tag->source]))
        return NULL;
    const struct plant_source *source = &sim->plant->sources[tag->source];
    *unit = tag->signal.modbus_unit >= 0 ? tag->signal.modbus_unit : source->unit;
    return device_at(sim, source->port);
}

static bool add_devices(struct sim *sim, int port)
{
    sim->devices = mem_array(sim->plant->source_count, sizeof(*sim->devices));
    for (size_t i = 0; i < sim->plant->source_count; i++) {
        const struct plant_source *source = &sim->plant->sources[i];
        if (!is_served(source) || device_at(sim, source->port))
            continue;
        struct sim_device *device = &sim->devices[sim->device_count];
        device->port = source->port;
        device->listen_port = port > 0 ? port + (int)sim->device_count : source->port;
        sim->device_count++;
        if (!sim_modbus_init(&device->modbus))
            return false;
    }
    return true;
}

bool sim_init(struct sim *sim, const struct plant *plant, struct sim_values *values, int port, const char *broker)
{
    *sim = (struct sim){ .plant = plant, .values = values };
    if (!add_devices(sim, port) || (sim->device_count == 0 && !broker)) {
        fprintf(stderr, "plantcast-sim: %s: the plant file has no Modbus TCP source to simulate\n", plant->files.path);
        return false;
    }
    if (broker && !(sim->mqtt = sim_mqtt_create(plant, broker)))
        return false;
    for (size_t i = 0; i < plant->tag_count; i++) {
        int unit;
        struct sim_device *device = sim_device_of(sim, &plant->tags[i], &unit);
        if (!device)
            continue;
        device->tag_count++;
        sim_image_add(&device->modbus.image, unit, &plant->tags[i]);
    }
    sim_update(sim);
    return true;
}

void sim_finish(struct sim *sim)
{
    sim_mqtt_destroy(&sim->mqtt);
    for (size_t i = 0; i < sim->device_count; i++)
        sim_modbus_finish(&sim->devices[i].modbus);
    mem_free(sim->devices);
    sim->devices = NULL;
    sim->device_count = 0;
}

void sim_update(struct sim *sim)
{
    for (size_t i = 0; i < sim->plant->tag_count; i++) {
        int unit;
        struct sim_device *device = sim_device_of(sim, &sim->plant->tags[i], &unit);
        if (device)
            sim_image_set(&device->modbus.image, unit, &sim->plant->tags[i], sim_values_at(sim->values, i));
    }
}
