/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The devices from which tags are read: each unit of each source. A device that fails as a whole raises one alarm instead of one for
   each of its tags. Pure. Thread: one at a time. */
#ifndef ALARM_DEVICES_H
#define ALARM_DEVICES_H
#include "plant/plant.h"

enum device_status { DEVICE_UNKNOWN, DEVICE_USABLE, DEVICE_GONE /* DEVICE_GONE: no data arrives from the device, or its controller has
                                                                   stopped */, DEVICE_OTHER };

struct alarm_device {
    char *name; /* name of the source, with the unit if the source has several: "plc1", "gateway/7" */
    int source, unit;
    int usable, gone; /* numbers of the device's tags with status DEVICE_USABLE and DEVICE_GONE */
    int64_t back_ns;  /* monotonic time since which a tag of the device is usable; 0: none is */
    int alarm;        /* index of the device's LINK alarm; -1: none */
    bool changed;     /* true: the device changed since alarms.c last evaluated it */
};

struct devices {
    struct alarm_device *list;
    size_t count, capacity;
    int *of_tag;       /* index in `list` of each tag's device, by tag; -1: none */
    uint8_t *statuses; /* enum device_status by tag */
};

/* lists the plant's devices; plant must outlive the result; never returns NULL */
struct devices *devices_create(const struct plant *plant);
/* frees the devices and sets *devices to NULL; accepts a pointer to NULL */
void devices_destroy(struct devices **devices);
int devices_find(const struct devices *devices, const char *name); /* returns the index, or -1 */

/* Returns what a tag's quality says about its device: DEVICE_USABLE, DEVICE_GONE or DEVICE_UNKNOWN. */
enum device_status device_status_of(uint32_t quality);
/* Records the status that a tag has from mono_ns on. */
void devices_put(struct devices *devices, int tag, enum device_status status, int64_t mono_ns);
/* returns whether the device has failed: no tag is usable, and at least one is gone */
bool device_is_lost(const struct alarm_device *device);

#endif
