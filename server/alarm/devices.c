/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Determines the device from which each tag is read, and tracks the status of each device. */
#include "alarm/devices.h"

#include <string.h>

#include "base/mem.h"
#include "value/quality.h"

/* Returns the index of the device with that source and unit, or -1. Searches backwards from the newest device, because tags of
   one device are usually adjacent. */
static int find(const struct devices *devices, int source, int unit)
{
    int i = (int)devices->count - 1;
    while (i >= 0 && (devices->list[i].source != source || devices->list[i].unit != unit))
        i--;
    return i;
}

static int find_or_add(struct devices *devices, int source, int unit)
{
    int at = find(devices, source, unit);
    if (at >= 0)
        return at;
    mem_grow(&devices->list, &devices->capacity, devices->count + 1, sizeof(*devices->list));
    devices->list[devices->count] = (struct alarm_device){ .source = source, .unit = unit, .alarm = -1 };
    return (int)devices->count++;
}

static void name_all(struct devices *devices, const struct plant *plant)
{
    int *units = mem_array(plant->source_count ? plant->source_count : 1, sizeof(*units));
    for (size_t i = 0; i < devices->count; i++)
        units[devices->list[i].source]++;
    for (size_t i = 0; i < devices->count; i++) {
        struct alarm_device *device = &devices->list[i];
        const char *id = plant->sources[device->source].id;
        device->name = units[device->source] > 1 ? mem_printf("%s/%d", id, device->unit) : mem_strdup(id);
    }
    mem_free(units);
}

struct devices *devices_create(const struct plant *plant)
{
    struct devices *devices = mem_new(sizeof(*devices));
    devices->of_tag = mem_array(plant->tag_count ? plant->tag_count : 1, sizeof(*devices->of_tag));
    devices->statuses = mem_array(plant->tag_count ? plant->tag_count : 1, sizeof(*devices->statuses));
    for (size_t i = 0; i < plant->tag_count; i++) {
        const struct plant_tag *tag = &plant->tags[i];
        devices->of_tag[i] = tag->source < 0 ? -1 : find_or_add(devices, tag->source, plant_tag_modbus_unit(plant, tag));
    }
    name_all(devices, plant);
    return devices;
}

void devices_destroy(struct devices **pointer)
{
    struct devices *devices = *pointer;
    if (!devices)
        return;
    for (size_t i = 0; i < devices->count; i++)
        mem_free(devices->list[i].name);
    mem_free(devices->list);
    mem_free(devices->of_tag);
    mem_free(devices->statuses);
    mem_free(devices);
    *pointer = NULL;
}

int devices_find(const struct devices *devices, const char *name)
{
    int i = (int)devices->count - 1;
    while (i >= 0 && strcmp(devices->list[i].name, name) != 0)
        i--;
    return i;
}

enum device_status device_status_of(uint32_t quality)
{
    switch (quality_code(quality)) {
    case QUALITY_BAD_WAITING: return DEVICE_UNKNOWN;
    case QUALITY_BAD_NO_COMMUNICATION:
    case QUALITY_BAD_COMMUNICATION_ERROR:
    case QUALITY_BAD_DEVICE_FAILURE: return DEVICE_GONE;
    case QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE: return DEVICE_OTHER;
    default: return quality_is_bad(quality) ? DEVICE_OTHER : DEVICE_USABLE;
    }
}

void devices_put(struct devices *devices, int tag, enum device_status status, int64_t mono_ns)
{
    int of = devices->of_tag[tag];
    if (of < 0 || devices->statuses[tag] == status)
        return;
    struct alarm_device *device = &devices->list[of];
    device->usable += (status == DEVICE_USABLE) - (devices->statuses[tag] == DEVICE_USABLE);
    device->gone += (status == DEVICE_GONE) - (devices->statuses[tag] == DEVICE_GONE);
    devices->statuses[tag] = (uint8_t)status;
    device->changed = true;
    if (device_is_lost(device))
        device->back_ns = 0;
    else if (!device->back_ns)
        device->back_ns = mono_ns;
}

bool device_is_lost(const struct alarm_device *device)
{
    return device->usable == 0 && device->gone > 0;
}
